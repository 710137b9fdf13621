"""Scenarios: from files, text and dictionaries, and back; mistakes in the words of the command line."""

from __future__ import annotations

import numpy
import pytest

import mckibben
from conftest import SWING


def test_every_example_is_read_and_comes_back(examples):
    files = [path for path in sorted(examples.rglob("*.toml")) if "[study]" not in path.read_text()]
    assert len(files) > 40
    for path in files:
        scenario = mckibben.Scenario.load(path)
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
def test_a_mistake_is_told_in_the_words_of_the_command_line(wrong, program, tmp_path, monkeypatch):
    (tmp_path / "swing.toml").write_text(SWING.replace('mass = "5 lb"', wrong))
    monkeypatch.chdir(tmp_path)
    told = program(tmp_path, "simulate", "swing.toml", code=2).stderr
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.Scenario.load("swing.toml")
    assert str(raised.value) == told.rstrip("\n")
    assert isinstance(raised.value, ValueError) and isinstance(raised.value, mckibben.Error)


def test_a_contradiction_is_told_in_the_words_of_the_command_line(program, tmp_path, monkeypatch):
    (tmp_path / "swing.toml").write_text(SWING + '[actuator]\nmax_length = "30 mm"\n')
    monkeypatch.chdir(tmp_path)
    told = program(tmp_path, "simulate", "swing.toml", code=2).stderr
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.simulate(mckibben.Scenario.load("swing.toml"))
    assert str(raised.value) == told.rstrip("\n")


def test_a_file_that_is_not_there(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    told = program(tmp_path, "simulate", "absent.toml", code=2).stderr
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.Scenario.load("absent.toml")
    assert str(raised.value) == told.rstrip("\n")


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
