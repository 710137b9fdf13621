"""Functional mock-up units in FMPy: no problem in the validation, and the trajectories of the core by both interfaces and versions."""

from __future__ import annotations

import math
import pathlib

import fmpy
import numpy
import pytest
from fmpy.validation import validate_fmu

import mckibben

MUSCLE = """\
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.8
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
length = "90 mm"
gauge_pressure = "40 psi"
[run]
duration = "0.5 s"
"""


@pytest.fixture(scope="module")
def unit(program, tmp_path_factory):
    """Writes a unit; the path of the file."""
    folder = tmp_path_factory.mktemp("fmu")
    (folder / "muscle.toml").write_text(MUSCLE)

    def write(name: str, *arguments: str, file: str | pathlib.Path = "muscle.toml") -> str:
        program(folder, "fmu", str(file), "--output", name, *arguments)
        return str(folder / name)

    return write


def simulate(path: str, kind: str, **options) -> numpy.ndarray:
    messages: list[str] = []
    run = fmpy.simulate_fmu(
        path,
        fmi_type=kind,
        stop_time=options.pop("stop_time", 0.5),
        output_interval=1e-3,
        record_events=False,
        logger=lambda *message: messages.append(str(message)),
        **options,
    )
    assert not messages
    return run


@pytest.fixture(scope="module")
def reference() -> mckibben.Trajectory:
    scenario = mckibben.Scenario(MUSCLE, "muscle.toml").with_values({"run.relative_tolerance": 1e-10})
    return mckibben.simulate(scenario)


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("kind", ["cs", "me", "both"])
@pytest.mark.parametrize("motion", ["host", "scenario"])
def test_the_validation_finds_no_problem(unit, version, kind, motion):
    path = unit(f"{motion}-{version}-{kind}.fmu", "--fmi", version, "--kind", kind, "--motion", motion)
    assert validate_fmu(path) == []


def test_an_arm_on_one_tank_has_no_problem(unit, examples):
    path = unit("arm.fmu", "--motion", "scenario", "--set", "run.step=0.5 ms", file=examples / "plant/arm.toml")
    assert validate_fmu(path) == []
    start = {"commands": [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]}
    runs = [
        simulate(path, kind, stop_time=0.2, start_values=start, output=["shoulder.angle"], relative_tolerance=1e-6)
        for kind in ("CoSimulation", "ModelExchange")
    ]
    assert numpy.abs(runs[0]["shoulder.angle"] - runs[1]["shoulder.angle"]).max() < 2e-3


@pytest.mark.parametrize("version", ["2", "3"])
def test_model_exchange_keeps_to_the_event_located_engine(unit, reference, version):
    path = unit(f"me-{version}.fmu", "--fmi", version, "--kind", "me", "--motion", "scenario")
    for tolerance, bound in [(1e-6, 1e-5), (1e-8, 2e-7)]:
        run = simulate(
            path,
            "ModelExchange",
            start_values={"actuator.duty": 0.8},
            output=["actuator.length"],
            relative_tolerance=tolerance,
        )
        length = numpy.interp(reference["time_s"], run["time"], run["actuator.length"])
        assert numpy.abs(length - reference["length_m"]).max() < bound


@pytest.mark.parametrize("version", ["2", "3"])
def test_co_simulation_is_the_fixed_step_engine(unit, version):
    step = ["--set", "run.engine=fixed-step", "--set", "run.step=0.5 ms"]
    path = unit(f"cs-{version}.fmu", "--fmi", version, "--motion", "scenario", *step)
    scenario = mckibben.Scenario(MUSCLE, "muscle.toml").with_values({"run.engine": "fixed-step", "run.step": "0.5 ms"})
    expected = mckibben.simulate(scenario)
    run = simulate(path, "CoSimulation", start_values={"actuator.duty": 0.8}, output=["actuator.length"])
    assert numpy.abs(run["actuator.length"] - expected["length_m"]).max() < 1e-9


def test_the_host_moves_the_ends(unit):
    path = unit("host.fmu")
    times = numpy.arange(0.0, 0.2005, 1e-3)
    signals = numpy.array(
        [(time, 0.088 + 1e-3 * math.cos(40 * time)) for time in times + 1e-3],
        dtype=[("time", float), ("actuator.distance", float)],
    )
    signals["time"] = times
    run = simulate(
        path,
        "CoSimulation",
        stop_time=0.2,
        input=signals,
        start_values={"actuator.duty": 0.6},
        output=["actuator.length", "actuator.tension"],
    )
    assert numpy.abs(run["actuator.length"][1:] - signals["actuator.distance"][: len(run) - 1]).max() < 1e-12
    assert (run["actuator.tension"] > 0.0).any()


def test_event_mode_and_parameters(unit):
    path = unit("events.fmu", "--motion", "scenario", "--set", "run.step=0.1 ms")
    runs = [
        simulate(
            path,
            "CoSimulation",
            stop_time=0.1,
            start_values={"actuator.duty": 0.5, "load.mass": mass},
            output=["actuator.length"],
            use_event_mode=events,
            early_return_allowed=events,
        )
        for mass, events in [(2.0, False), (2.0, True), (3.0, False)]
    ]
    end = [run["actuator.length"][-1] for run in runs]
    assert abs(end[0] - end[1]) < 1e-5 < abs(end[0] - end[2])


def test_tunable_parameters_change_during_a_run(unit):
    """In FMPy's input a column is a tunable parameter: the pressure becomes that of the new supply."""
    path = unit("tunable.fmu", "--motion", "scenario", "--set", "run.step=0.5 ms")
    signals = numpy.array(
        [(0.0, 1.0, 6e5), (0.2, 1.0, 6e5), (0.2, 1.0, 3e5), (2.0, 1.0, 3e5)],
        dtype=[("time", float), ("actuator.duty", float), ("supply.gauge_pressure", float)],
    )
    for kind in ("CoSimulation", "ModelExchange"):
        run = simulate(path, kind, stop_time=2.0, input=signals, output=["actuator.gauge_pressure"])
        pressure = numpy.interp([0.19, 2.0], run["time"], run["actuator.gauge_pressure"])
        assert numpy.abs(pressure - [6e5, 3e5]).max() < 1e3


def test_a_command_at_the_instant_of_a_movement_comes_after_it(unit, tmp_path):
    """A poppet that arrives 4 ms after its coil has arrived before a command at 4 ms, by either interface: the muscle fills."""
    delays = 'kind = "fill-hold-exhaust"\nflow_area = "0.5 mm^2"\nopening_delay = "4 ms"\nclosing_delay = "4 ms"'
    (tmp_path / "delayed.toml").write_text(MUSCLE.replace('preset = "matrix-eight-channel"', delays))
    options = ["--motion", "scenario", "--command-mode", "request", "--set", "run.step=0.1 ms"]
    path = unit("delayed.fmu", *options, file=tmp_path / "delayed.toml")
    signals = numpy.array(
        [(0.0, 1.0), (4e-3, 1.0), (4e-3, 0.0), (0.02, 0.0)],
        dtype=[("time", float), ("actuator.request", float)],
    )
    kinds = ["ModelExchange", "CoSimulation"]
    runs = [simulate(path, kind, stop_time=0.02, input=signals, output=["actuator.air_mass"]) for kind in kinds]
    (begin, integrated), (_, stepped) = [run["actuator.air_mass"][[0, -1]] for run in runs]
    assert stepped > 1.05 * begin
    assert abs(integrated - stepped) < 1e-2 * (stepped - begin)


def test_dry_friction_acts_once_a_rate_has_left_zero(unit, tmp_path):
    """The host moves the ends along a cosine, which begins at rest: the tension is that of the prescribed motion in a run."""
    motion = """\
[actuator]
preset = "colbrunn-2001"
friction = { viscous = "0 N*s/m", coulomb_force = "5 N" }
[supply]
gauge_pressure = "60 psi"
[valve]
kind = "fill-hold-exhaust"
flow_area = "0.5 mm^2"
[command]
kind = "hold"
[load]
kind = "prescribed-motion"
length = "85 mm"
amplitude = "2 mm"
frequency = "2 Hz"
phase = "90 deg"
[initial]
gauge_pressure = "30 psi"
[run]
duration = "0.35 s"
"""
    (tmp_path / "cosine.toml").write_text(motion)
    path = unit("cosine.fmu", "--kind", "me", file=tmp_path / "cosine.toml")
    angular, times = 4.0 * math.pi, numpy.linspace(0.0, 0.35, 351)
    signals = numpy.array(
        [(t, 0.085 + 2e-3 * math.cos(angular * t), -2e-3 * angular * math.sin(angular * t)) for t in times],
        dtype=[("time", float), ("actuator.distance", float), ("actuator.rate", float)],
    )
    options = {"stop_time": 0.35, "relative_tolerance": 1e-7}
    run = simulate(path, "ModelExchange", input=signals, output=["actuator.tension"], **options)
    expected = mckibben.simulate(mckibben.Scenario(motion, "cosine.toml"))
    # Between the ends of the motion, where friction turns.
    for time in (0.05, 0.1, 0.15, 0.2, 0.3):
        found, tension = (
            numpy.interp(time, of[name], of[what])
            for of, name, what in ((run, "time", "actuator.tension"), (expected, "time_s", "tension_n"))
        )
        assert abs(found - tension) < 0.1, f"{found} N for {tension} N at {time} s"
