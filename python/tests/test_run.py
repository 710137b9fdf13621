"""A run is bit-identical to that of `mckibben simulate`, for every kind of scenario and both engines."""

from __future__ import annotations

import csv
import math

import matplotlib
import numpy
import pytest

import mckibben

#: One example for each kind of thing that is simulated.
KINDS = [
    "paper/fig-12",
    "energy-balance",
    "laws/map",
    "friction/maxwell-slip",
    "line/hanging-mass",
    "line/tank",
    "valves/pressure-regulator",
    "valves/proportional-spool",
    "control/pid",
    "antagonistic-joint",
    "control/joint-bang-bang",
    "control/joint-air-mass",
    "tendon",
]
SHORT = {"run.duration": "80 ms", "run.sample_interval": "1 ms"}
FIXED = SHORT | {"run.engine": "fixed-step", "run.step": "0.2 ms"}


def as_options(values):
    """The values as options of the command line, in the words that the package keeps."""
    return [word for key, value in values.items() for word in ("--set", f'{key}="{value}"')]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("values", [SHORT, FIXED], ids=["event-located", "fixed-step"])
def test_a_run_is_that_of_the_command_line(kind, values, program, examples, tmp_path):
    path = examples / f"{kind}.toml"
    run = mckibben.simulate(mckibben.Scenario.from_file(path).with_values(values))
    events = ["--events-output", "events.csv"]
    for ending in ["csv", "parquet"]:
        options = as_options(values)
        program(tmp_path, "simulate", str(path), *options, "--quiet", "--output", f"run.{ending}", *events)

    with open(tmp_path / "run.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert run.columns == header
    assert len(run) == len(rows)
    for name, written in zip(header, zip(*rows)):
        if name in run.units:
            numpy.testing.assert_array_equal(run[name], [float(number) for number in written])
        else:
            assert list(run[name]) == list(written)

    run.to_csv(tmp_path / "own.csv")
    run.to_parquet(tmp_path / "own.parquet")
    for ending in ["csv", "parquet"]:
        assert (tmp_path / f"own.{ending}").read_bytes() == (tmp_path / f"run.{ending}").read_bytes()

    with open(tmp_path / "events.csv", newline="") as file:
        logged = list(csv.DictReader(file))
    truths = {True: "true", False: "false"}
    after = [{name: truths.get(value, value) for name, value in event.after.items()} for event in run.events]
    own = [{"time_s": event.time, "event": event.kind, **words} for event, words in zip(run.events, after)]
    assert own == [{**event, "time_s": float(event["time_s"])} for event in logged]


def test_between_the_samples_is_what_the_samples_of_a_finer_run_are(swing):
    coarse = mckibben.simulate(swing.with_values({"run.sample_interval": "10 ms"}))
    fine = mckibben.simulate(swing.with_values({"run.sample_interval": "1 ms"}))
    there = coarse.at_times(fine.t)
    assert list(there) == fine.columns
    for name in fine.columns:
        numpy.testing.assert_array_equal(there[name], fine[name])
    row = coarse.at(fine.t[7])
    assert row == {name: fine[name][7] for name in fine.columns}
    assert all(type(value) in (float, str) for value in row.values())


@pytest.mark.parametrize("time", [-1e-9, 0.1000001, math.nan, math.inf])
def test_outside_the_run_there_is_nothing(swing, time):
    with pytest.raises(mckibben.InputError, match="outside the run"):
        mckibben.simulate(swing).at(time)


def test_fixed_steps_have_values_between_the_samples_too(swing):
    located = mckibben.simulate(swing)
    run = mckibben.simulate(swing.with_values({"run.engine": "fixed-step", "run.step": "50 us"}))
    assert run.at(0.0505)["length_m"] == pytest.approx(located.at(0.0505)["length_m"], rel=1e-3)


def test_columns_are_handed_out_without_a_copy_and_cannot_be_written_to(swing):
    run = mckibben.simulate(swing)
    assert run.length is run.length
    assert run.length is run["length_m"]
    assert run.length.flags.c_contiguous and run.length.dtype == numpy.float64
    with pytest.raises(ValueError, match="read-only"):
        run.length[0] = 0.0
    with pytest.raises(ValueError, match="read-only"):
        run.valve[0] = "supply"


def test_what_a_run_does_not_have_is_named(swing):
    run = mckibben.simulate(swing)
    with pytest.raises(AttributeError, match="angle_rad.*time_s, length_m"):
        run.angle
    with pytest.raises(KeyError, match="hose_absolute_pressure_pa.*time_s, length_m"):
        run["hose_absolute_pressure_pa"]


def test_every_column_that_is_an_attribute_says_its_unit(examples, swing):
    """The units in the documentation are those of the columns."""
    joint = mckibben.Scenario.from_file(examples / "antagonistic-joint.toml").with_values({"run.duration": "1 ms"})
    for scenario in [swing, joint]:
        run = mckibben.simulate(scenario)
        found = 0
        for name, described in vars(mckibben.Trajectory).items():
            of = next((column for column in run.units if getattr(run, name, None) is run[column]), None)
            if of is not None:
                assert f"in {run.units[of]}" in described.__doc__, name
                found += 1
        assert found == (13 if "angle_rad" in run.columns else 10)


def test_data_frames_are_the_columns(swing):
    run = mckibben.simulate(swing)
    pandas, polars = run.to_pandas(), run.to_polars()
    assert pandas.attrs["units"] == run.units
    for frame in [pandas, polars]:
        assert list(frame.columns) == run.columns
        for name in run.columns:
            assert list(frame[name]) == list(run[name])


def test_figures_have_a_panel_for_each_quantity(swing, examples):
    matplotlib.use("agg")
    joint = mckibben.Scenario.from_file(examples / "antagonistic-joint.toml").with_values(SHORT)
    for scenario in [swing, joint]:
        run = mckibben.simulate(scenario)
        figure = run.plot()
        assert len(figure.axes) == 3
        numpy.testing.assert_array_equal(figure.axes[0].lines[0].get_xdata(), run.t)
        assert "<svg" in run.to_svg() and run.to_svg() == run._repr_svg_()


def test_a_run_warns_of_what_its_scenario_cannot_mean(swing, examples):
    assert mckibben.simulate(swing).warnings == []
    short = {"run.duration": "80 ms", "command.duty": 0.05, "command.frequency": "25 Hz"}
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml").with_values(short)
    (warning,) = mckibben.simulate(scenario).warnings
    assert warning.startswith("the valve never opens to the supply: a pulse of 2 ms is shorter than valve.opening_delay = 4 ms")
