"""Scenarios: from files, text and dictionaries, and back; mistakes in the words of the command line."""

from __future__ import annotations

import copy
import math
import pickle

import numpy
import pytest

import mckibben
from conftest import SWING


def test_every_example_is_read_and_comes_back(examples):
    files = [path for path in sorted(examples.rglob("*.toml")) if "[study]" not in path.read_text()]
    assert len(files) > 40
    for path in files:
        scenario = mckibben.Scenario.from_file(path)
        assert scenario.text == path.read_text()
        assert mckibben.Scenario.from_dict(scenario.to_dict()) == scenario, path
        assert mckibben.Scenario(scenario.to_toml()) == scenario, path


def test_a_dictionary_says_what_a_file_says(swing):
    sections = {
        "load": {"kind": "hanging-mass", "mass": "5 lb"},
        "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        "run": {"duration": "0.1 s"},
    }
    assert mckibben.Scenario.from_dict(sections) == swing


def test_numbers_and_arrays_of_numpy_are_values(swing):
    swing = swing.with_values({"actuator.preset": "colbrunn-2001"})
    plain = swing.with_values({"actuator.turns": 2.5, "actuator.effectiveness.polynomial": [0.5, 0.001],
                               "actuator.effectiveness.pressure_unit": "psi"})
    arrays = swing.with_values({"actuator.turns": numpy.float32(2.5),
                                "actuator.effectiveness.polynomial": numpy.array([0.5, 0.001]),
                                "actuator.effectiveness.pressure_unit": "psi"})
    assert plain == arrays != swing


def test_other_values_leave_a_scenario_as_it_was(swing):
    heavy = swing.with_values({"load.mass": "10 lb"})
    assert swing.to_dict()["load"]["mass"] == "2.26796185 kg"
    assert heavy.to_dict()["load"]["mass"] == "4.5359237 kg"
    assert heavy.with_values({"load.mass": "5 lb"}) == swing


@pytest.mark.parametrize(
    "wrong",
    ["mass = 5", 'mass = "5 lbf"', 'mass = "-5 lb"', 'mas = "5 lb"', 'mass = "5 quux"', 'mass = ["5 lb"]', "mass ="],
)
def test_a_mistake_has_the_message_of_the_command_line(wrong, program, tmp_path, monkeypatch):
    (tmp_path / "swing.toml").write_text(SWING.replace('mass = "5 lb"', wrong))
    monkeypatch.chdir(tmp_path)
    printed = program(tmp_path, "simulate", "swing.toml", code=2).stderr
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.Scenario.from_file("swing.toml")
    assert str(raised.value) == printed.rstrip("\n")
    assert isinstance(raised.value, ValueError) and isinstance(raised.value, mckibben.Error)


def test_a_contradiction_has_the_message_of_the_command_line(program, tmp_path, monkeypatch):
    (tmp_path / "swing.toml").write_text(SWING + '[actuator]\nmax_length = "30 mm"\n')
    monkeypatch.chdir(tmp_path)
    printed = program(tmp_path, "simulate", "swing.toml", code=2).stderr
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.simulate(mckibben.Scenario.from_file("swing.toml"))
    assert str(raised.value) == printed.rstrip("\n")


def test_a_file_that_is_not_there(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    printed = program(tmp_path, "simulate", "absent.toml", code=2).stderr
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.Scenario.from_file("absent.toml")
    assert str(raised.value) == printed.rstrip("\n")


def test_a_place_that_cannot_be_written_to(swing, tmp_path):
    with pytest.raises(mckibben.OutputError, match="nothing was left behind") as raised:
        mckibben.simulate(swing).to_csv(tmp_path / "absent" / "run.csv")
    assert isinstance(raised.value, OSError)


def test_what_is_no_value_is_named(swing):
    with pytest.raises(TypeError, match=r"load\.mass.*NoneType"):
        swing.with_values({"load.mass": None})
    with pytest.raises(TypeError, match="a key"):
        mckibben.Scenario.from_dict({"load": {5: "lb"}})
    with pytest.raises(mckibben.InputError, match="with_values"):
        swing.with_values({"load.mass": "5 lbf"})


def test_numbers_from_python_are_in_si(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    assert scenario.with_values({"load.mass": 4.5}) == scenario.with_values({"load.mass": "4.5 kg"})
    sections = scenario.to_dict() | {"load": {"kind": "hanging-mass", "mass": 4.5}, "run": {"duration": 0.5}}
    made = mckibben.Scenario.from_dict(sections)
    assert made.load.mass == 4.5 and made.run.duration == 0.5
    assert pickle.loads(pickle.dumps(made)) == made
    arm = mckibben.Scenario.from_file(examples / "plant/arm.toml").with_values({"mechanism.joints.elbow.mass": 0.75})
    assert arm.mechanism.joints.elbow.mass == 0.75
    assert mckibben.Scenario(arm.to_toml()) == arm, "a number in SI is written with its unit"
    swept = scenario.with_values({"sweep.vary": {"load.mass": [1.5, 2.5]}, "sweep.reductions": ["length.final"]})
    assert mckibben.Sweep(swept).rows == 2
    with pytest.raises(mckibben.InputError, match="needs a unit"):
        mckibben.Scenario("[load]\nkind = \"hanging-mass\"\nmass = 4.5\n[run]\nduration = \"1 s\"")
    with pytest.raises(mckibben.InputError, match="load.mass.*out of range"):
        scenario.with_values({"load.mass": -1.0})


def test_sections_are_attributes_in_si(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    assert scenario.load.mass == pytest.approx(5 * 0.45359237) and scenario.load.kind == "hanging-mass"
    assert scenario.supply.gauge_pressure == pytest.approx(100 * 6894.757293168361)
    assert scenario.actuator.friction["viscous"] > 0 and dict(scenario.command)["duty"] == 0.5
    assert {"load", "supply", "with_values"} <= set(dir(scenario)) and "mass" in dir(scenario.load)
    with pytest.raises(AttributeError, match="no section `laod`; it has actuator, air"):
        scenario.laod
    with pytest.raises(AttributeError, match="no `masss`; it has kind, mass"):
        scenario.load.masss
    leg = mckibben.Scenario.from_file(examples / "plant/leg.toml")
    assert set(leg.actuators) and all(name in dir(leg.actuators) for name in leg.actuators)
    assert "mass = '2.26796185 kg'" in repr(scenario.load)


def test_attributes_cannot_change_the_scenario(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    mass = scenario.load.mass
    scenario.to_dict()["load"]["mass"] = "1 kg"
    assert scenario.load.mass == mass


def test_a_section_is_immutable_and_can_be_copied(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    mass, viscous = scenario.load.mass, scenario.actuator.friction.viscous
    with pytest.raises(AttributeError, match=r'`load.mass` cannot be set.*with_values\({"load.mass": 3.0}\)'):
        scenario.load.mass = 3.0
    with pytest.raises(AttributeError, match=r'with_values\({"actuator.friction.viscous": 9.0}\)'):
        scenario.actuator.friction.viscous = 9.0
    with pytest.raises(AttributeError, match="`load.mass` cannot be deleted"):
        del scenario.load.mass
    assert (scenario.load.mass, scenario.actuator.friction.viscous) == (mass, viscous)
    for again in (copy.copy, copy.deepcopy, lambda section: pickle.loads(pickle.dumps(section))):
        assert again(scenario.load) == scenario.load and again(scenario.actuator).friction.viscous == viscous
        with pytest.raises(AttributeError, match="`actuator.friction.viscous` cannot be set"):
            again(scenario.actuator).friction.viscous = 9.0


def test_differences_are_reported_by_paths(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    other = scenario.with_values({"load.mass": 4.5, "actuator.friction.viscous": 2.0})
    viscous = scenario.to_dict()["actuator"]["friction"]["viscous"]
    assert scenario.diff(other) == {
        "actuator.friction.viscous": (viscous, "2 N*s/m"),
        "load.mass": ("2.26796185 kg", "4.5 kg"),
    }
    assert scenario.diff(scenario) == {}
    valveless = {name: section for name, section in scenario.to_dict().items() if name not in ("valve", "command", "supply")}
    assert scenario.diff(mckibben.Scenario.from_dict(valveless))["valve.kind"] == ("three-way", None)
    assert str(scenario) == scenario.to_toml()
    table = scenario._repr_html_()
    assert table.count("<tr>") == sum(1 for line in scenario.to_toml().splitlines() if "=" in line and not line.startswith("#"))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"tension": [1.0, 2.0, 3.0, 4.0, 5.0]}, "`actuator.force.tension` has 5 entries, and 6 are due"),
        ({"tension": [1.0] * 7}, "3 pressures times 2 lengths are 6"),
        ({"length": [0.09, 0.08]}, "the entries do not rise"),
        ({"tension": [1.0, 2.0, 3.0, 4.0, 5.0, math.nan]}, "(?s)tension` = NaN N.*give a finite number"),
        ({"tension": numpy.ones((3, 2))}, "(?s)one list of numbers, not a list of lists.*a row for each pressure.*ravel"),
    ],
)
def test_what_check_refuses_is_no_scenario(values, words, swing):
    """A force map that the model cannot be built of: at once, and not by what uses the scenario."""
    law = {"law": "map", "gauge_pressure": [0.0, 2e5, 4e5], "length": [0.08, 0.09], "tension": [0.0, 1.0, 10.0, 20.0, 20.0, 40.0]}
    good = swing.with_values({"actuator.preset": "colbrunn-2001", "actuator.force": law})
    with pytest.raises(mckibben.InputError, match=words):
        swing.with_values({"actuator.preset": "colbrunn-2001", "actuator.force": {**law, **values}})
    with pytest.raises(mckibben.InputError, match=words):
        good.with_values({f"actuator.force.{key}": value for key, value in values.items()})


def test_an_engine_counts_where_it_is_given(swing):
    """A sweep chooses the engine where none is given: equal scenarios have equal sweeps."""
    again, located = mckibben.Scenario(swing.to_toml()), swing.with_values({"run.engine": "event-located"})
    assert again == swing and swing.diff(again) == {}
    assert located != swing and swing.diff(located) == {"run.engine": (None, "event-located")}
    assert mckibben.Scenario(located.to_toml()) == located and swing.run.engine == "event-located"
    vary = {"load.mass": [2.0]}
    one, other = (mckibben.sweep(of, vary=vary, reductions=["length.final"])["length_final_m"][0] for of in (swing, again))
    assert one == other


def test_a_sweep_is_part_of_its_scenario(swing, tmp_path):
    """Its numbers in SI have units in the text, and what it varies is not fixed there."""
    vary = {"actuator.thread_length": [0.112, 0.115], "initial.gauge_pressure": {"from": 2e5, "to": 4e5, "count": 3}}
    swept = swing.with_values({"actuator.preset": "colbrunn-2001", "sweep": {"reductions": ["length.final"], "vary": vary}})
    again = mckibben.Scenario(swept.to_toml())
    assert again == swept == mckibben.Scenario.from_dict(swept.to_dict())
    one, other = (mckibben.sweep(of, tmp_path / name).to_polars() for of, name in ((swept, "one"), (again, "other")))
    assert one.equals(other) and len(one) == 6
    other = swept.with_values({"sweep.reductions": ["tension.final"]})
    assert other != swept and swept.diff(other) == {"sweep.reductions": (["length.final"], ["tension.final"])}
    assert swept.sweep.reductions == ["length.final"] and swept.actuator.max_length > 0.0
