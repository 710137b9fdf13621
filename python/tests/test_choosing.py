"""Sizes and designs: closed forms, what the program says, and what is refused."""

from __future__ import annotations

import csv
import json
import math
import re

import numpy
import pytest

import mckibben

WANTED = {"load": "5 kg", "stroke": "30 mm", "gauge_pressure": "4 bar"}
THREAD, TURNS, LENGTH = 0.12, 1.5, 0.1
MUSCLE = {
    "actuator": {
        "thread_length": THREAD,
        "turns": TURNS,
        "max_length": 0.11,
        "friction": {"viscous": 20.0, "coulomb_width": 0.0},
    },
    "supply": {"gauge_pressure": "6 bar"},
    "valve": {"kind": "three-way", "flow_area": "3 mm^2"},
    "command": {"kind": "fill"},
    "load": {"kind": "isometric"},
    "initial": {"length": LENGTH},
    "run": {"duration": "0.5 s"},
}


def force(pressure: float, length: float, thread: float, turns: float) -> float:
    """The paper's (3)."""
    return pressure * thread**2 / (4 * math.pi * turns**2) * (3 * (length / thread) ** 2 - 1)


@pytest.fixture(scope="module")
def rig() -> mckibben.Scenario:
    return mckibben.Scenario.from_dict(MUSCLE, "muscle.toml")


def test_braids_made_to_measure_hold_the_load_at_the_stroke():
    sizes = mckibben.size(**WANTED, braid_angles=["20 deg", math.radians(25)], effectiveness=0.8)
    made = [muscle for muscle in sizes if muscle.name.startswith("braid")]
    assert len(made) == 2 and [muscle.air for muscle in sizes] == sorted(muscle.air for muscle in sizes)
    for muscle in made:
        at_end = 0.8 * muscle.count * force(4e5, muscle.length - 0.03, muscle.thread_length, muscle.turns)
        assert at_end == pytest.approx(5 * 9.80665, rel=1e-5)
        assert muscle.needed_gauge_pressure == pytest.approx(4e5, rel=1e-6)
        assert muscle.scenario.load.mass == pytest.approx(5 / muscle.count, rel=1e-8)
        assert muscle.sonic_conductance is None
    assert len(sizes.to_pandas()) == len(sizes) and "scenario" not in sizes.to_pandas()
    # Numbers are in SI: a load is a force.
    again = mckibben.size(load=5 * 9.80665, stroke=0.03, gauge_pressure=4e5, braid_angles=["20 deg", "25 deg"], effectiveness=0.8)
    assert [muscle.length for muscle in again] == pytest.approx([muscle.length for muscle in sizes], rel=1e-9)


def test_it_is_what_the_program_writes(program, tmp_path):
    wanted = [part for name, value in WANTED.items() for part in (f"--{name.replace('_', '-')}", value)]
    program(tmp_path, "size", *wanted, "--time", "0.3 s", "--ripple", "0.2 mm", "--braid-angles", "25", "--output",
            "sizes.csv")
    with (tmp_path / "sizes.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    sizes = mckibben.size(**WANTED, time="0.3 s", ripple="0.2 mm", braid_angles=["25 deg"])
    assert any(muscle.pwm_frequency is not None for muscle in sizes) and len(rows) == len(sizes)
    for row, muscle in zip(rows, sizes):
        assert float(row["length_m"]) == muscle.length and float(row["air_kg"]) == muscle.air
        for column, value in [
            ("sonic_conductance_m3_s_pa", muscle.sonic_conductance),
            ("pwm_frequency_hz", muscle.pwm_frequency),
            ("pwm_duty", muscle.pwm_duty),
        ]:
            assert (float(row[column]) if row[column] else None) == value


def test_the_valve_is_in_time_and_a_hose_needs_a_larger_one():
    sizes = mckibben.size(**WANTED, time=0.3, braid_angles=["25 deg"])
    place = next(place for place, muscle in enumerate(sizes) if muscle.name.startswith("braid"))
    muscle = sizes[place]
    run = mckibben.simulate(muscle.scenario.with_values({"run.duration": 0.3}))
    assert run.length[-1] <= muscle.length - 0.9 * 0.03 + 1e-5
    valves = sizes.valves(place)
    times = [time if time is not None else math.inf for time in valves.values()]
    assert "festo-mha2" in valves and times == sorted(times)
    assert all(least is None or least > muscle.sonic_conductance for least in sizes.hoses("2 m", place).values())
    for wrong in (-1, True, len(sizes)):
        with pytest.raises(mckibben.InputError, match=f"`place` = {wrong}"):
            sizes.valves(wrong)
        with pytest.raises(mckibben.InputError, match=f"`place` = {wrong}"):
            sizes.hoses("2 m", place=wrong)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"stroke": -0.03}, "`stroke`"),
        ({"stroke": "30 kg"}, "stroke"),
        ({"gauge_pressure": math.nan}, "gauge_pressure"),
        ({"braid_angles": ["60 deg"]}, "braid angle"),
        ({"effectiveness": 0.0}, "`effectiveness`"),
    ],
)
def test_what_cannot_be_is_refused_by_its_name(change, words):
    with pytest.raises(mckibben.InputError) as refused:
        mckibben.size(**(WANTED | change))
    assert words in str(refused.value) and "--" not in str(refused.value)


def test_without_a_time_there_are_no_valves():
    sizes = mckibben.size(**WANTED)
    for call in (sizes.valves, lambda: sizes.hoses(2.0), lambda: sizes.valves(99)):
        with pytest.raises(mckibben.InputError) as refused:
            call()
        assert "--" not in str(refused.value)


def test_the_least_pressure_is_that_of_the_closed_form(rig, program, tmp_path):
    wanted = {"minimize": "gauge_pressure.final", "subject_to": ["tension.final>=60 N"], "evaluations": 80}
    found = mckibben.design(rig, {"supply.gauge_pressure": (1e5, 6e5)}, **wanted)
    least = 60.0 / force(1.0, LENGTH, THREAD, TURNS)
    assert found.value == pytest.approx(least, rel=1e-4) and found.unit == "Pa" and found.objective == wanted["minimize"]
    assert found.values["supply.gauge_pressure"] == pytest.approx(least, rel=1e-3) and not found.ends
    (constraint,) = found.constraints
    assert constraint.active and constraint.value == pytest.approx(60.0, rel=1e-6) and abs(constraint.margin) < 1e-3
    run = mckibben.simulate(found.scenario)
    assert run.summary()["tension.final"] == constraint.value
    assert len(found.to_pandas()) == found.evaluations <= 80
    best = found.to_pandas().query("feasible")["gauge_pressure.final"].min()
    assert best == found.value
    # Ends as text, and the program.
    for ends in ("1..6 bar", ("1 bar", "6 bar")):
        text = mckibben.design(rig, {"supply.gauge_pressure": ends}, **wanted)
        assert text.value == pytest.approx(found.value, rel=1e-5)
    (tmp_path / "muscle.toml").write_text(rig.to_toml(), encoding="utf-8")
    options = ["--vary", "supply.gauge_pressure=1..6 bar", "--minimize", wanted["minimize"], "--evaluations", "80"]
    options += ["--subject-to", wanted["subject_to"][0], "--format", "json"]
    assert json.loads(program(tmp_path, "design", "muscle.toml", *options).stdout)["value"] == text.value


def test_a_search_over_orbits_has_their_numbers(rig):
    weight = rig.with_values({"load.kind": "hanging-mass", "load.mass": 2.0, "run.duration": 0.2, "initial.gauge_pressure": 1e5})
    found = mckibben.design(
        weight, {"supply.gauge_pressure": "2..6 bar"}, maximize="settled.length.mean", settle=True, evaluations=40
    )
    assert found.ends == {"supply.gauge_pressure": "low"}, "the less pressure, the longer it is"
    assert found.value == pytest.approx(found.scenario.settle()["length"].mean, rel=1e-12)


def test_values_that_were_set_are_those_of_the_result(rig):
    found = mckibben.design(
        rig.with_values({"initial.length": 0.105}),
        {"supply.gauge_pressure": (0.5e5, 6e5)},
        minimize="gauge_pressure.final",
        subject_to=["tension.final>=60 N"],
        evaluations=40,
    )
    assert found.value == pytest.approx(60.0 / force(1.0, 0.105, THREAD, TURNS), rel=1e-3)
    assert found.scenario.initial.length == 0.105


def test_an_interrupted_search_returns_the_best_values(rig):
    def interrupt(done: int, most: int) -> None:
        assert most == 1_000_000
        if done > 50:
            raise KeyboardInterrupt

    wanted = {"minimize": "gauge_pressure.final", "evaluations": 1_000_000}
    with pytest.warns(UserWarning, match="interrupted"):
        found = mckibben.design(rig, {"supply.gauge_pressure": (1e5, 6e5)}, progress=interrupt, **wanted)
    assert found.interrupted and not found.converged and 50 < found.evaluations < 1_000_000

    def fail(done: int, most: int) -> None:
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        mckibben.design(rig, {"supply.gauge_pressure": (1e5, 6e5)}, progress=fail, **wanted)


@pytest.mark.parametrize(
    ("vary", "options", "words"),
    [
        ({"supply.gauge_pressure": (1e5, 6e5)}, {}, "`minimize` or `maximize`"),
        ({"supply.gauge_pressure": (1e5, 6e5)}, {"minimize": "a", "maximize": "b"}, "only one"),
        ({"supply.gauge_pressure": (6e5, 1e5)}, {"minimize": "air.used"}, "lower value"),
        ({"supply.gauge_pressure": (1e5, math.nan)}, {"minimize": "air.used"}, "`vary`"),
        ({"supply.gauge_pressure": "3 bar"}, {"minimize": "air.used"}, "3..7 bar"),
        ({"supply.gauge_pressure": "1..6 kg"}, {"minimize": "air.used"}, "`vary` supply.gauge_pressure=1..6 kg"),
        ({"supply.gauge_presure": (1.0, 2.0)}, {"minimize": "air.used"}, "gauge_pressure"),
        ({"supply.gauge_pressure": (1e5, 6e5)}, {"minimize": "air.usd"}, "air.used"),
        ({"supply.gauge_pressure": (1e5, 6e5)}, {"minimize": "air.used", "subject_to": ["length.final"]}, "`subject_to`"),
        ({"supply.gauge_pressure": (1e5, 6e5)}, {"minimize": "settled.length.mean"}, "give `settle`"),
        ({"supply.gauge_pressure": (1e5, 6e5)}, {"minimize": "air.used", "evaluations": 0}, "`evaluations`"),
        ({"supply.gauge_pressure": (1e5, 6e5)}, {"minimize": "air.used", "evaluations": True}, "`evaluations` = True"),
    ],
)
def test_what_cannot_be_searched_is_refused(rig, vary, options, words):
    with pytest.raises(mckibben.InputError) as refused:
        mckibben.design(rig, vary, **options)
    text = str(refused.value)
    assert words in text and "--" not in text.replace("--format json", "").replace("-->", ""), text


def test_what_nothing_meets_is_no_result(rig):
    with pytest.raises(mckibben.SimulationError, match="tension.final"):
        mckibben.design(
            rig, {"supply.gauge_pressure": "1..2 bar"}, minimize="air.used", subject_to=["tension.final>=600 N"], evaluations=20
        )

def test_the_warnings_of_the_best_run_are_those_of_its_simulation():
    """At 400 bar the load is thrown above the attachment."""
    hanging = mckibben.Scenario.from_dict({
        **MUSCLE, "load": {"kind": "hanging-mass", "mass": "5 kg"}, "initial": {"gauge_pressure": "1 bar"},
    })
    with pytest.warns(UserWarning, match="above the attachment"):
        found = mckibben.design(hanging, {"supply.gauge_pressure": "0.5..400 bar"}, minimize="length.min", evaluations=12)
    assert found.warnings == mckibben.simulate(found.scenario).warnings and len(found.warnings) > 1


def test_texts_in_place_of_lists_and_no_evaluations_are_refused(rig):
    vary = {"supply.gauge_pressure": "1..2 bar"}
    with pytest.raises(TypeError, match="`subject_to`: a list is wanted and no str"):
        mckibben.design(rig, vary, minimize="air.used", subject_to="tension.final>=10 N")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="`braid_angles`: a list is wanted and no str"):
        mckibben.size(**WANTED, braid_angles="25 deg")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"`braid_angles`: a list is wanted and no float; give \[0.4\]"):
        mckibben.size(**WANTED, braid_angles=0.4)  # type: ignore[arg-type]
    for evaluations in (0, -1):
        with pytest.raises(mckibben.InputError, match=f"evaluations`? = {evaluations}.*from 1 on"):
            mckibben.design(rig, vary, minimize="air.used", evaluations=evaluations)


def test_the_place_of_a_range_keeps_its_arrow_and_its_lines(rig):
    with pytest.raises(mckibben.InputError, match="--> `vary`:1:6") as refused:
        mckibben.design(rig, {"load.mass": (1.0, 2.0)}, minimize="length.final", evaluations=5)
    assert re.search("[^-`]--+ chosen here", str(refused.value)) and "`_" not in str(refused.value)


def test_the_air_of_a_stroke_is_that_of_room_temperature():
    """By the gas law at 293.15 K; a fill by the isentropic process of the scenario takes less."""
    muscle = mckibben.size(**WANTED, time=0.3, braid_angles=["25 deg"])[0]
    statics = mckibben.Statics(muscle.scenario)
    volumes = statics.volume([muscle.length - 0.03, muscle.length])
    pressures = 101325.0 + numpy.array([muscle.needed_gauge_pressure, 0.0])
    masses = pressures * volumes / (286.99 * 293.15)
    assert muscle.air == pytest.approx(muscle.count * (masses[0] - masses[1]), rel=1e-4)
    assert muscle.count * mckibben.simulate(muscle.scenario).summary()["air.used"] < muscle.air
