"""What runs come to: summaries against their columns, events as a frame, plots of chosen columns."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy
import pytest
import scipy.io

import mckibben


def test_a_summary_is_that_of_the_columns(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml").with_values({"run.sample_interval": "0.1 ms"})
    run = mckibben.simulate(scenario)
    summary = run.summary()
    assert summary["length.final"] == run.length[-1]
    for name, column in [("length", run.length), ("tension", run.tension), ("velocity", run.velocity)]:
        # The summary looks between the samples too.
        assert summary[f"{name}.min"] <= column.min() and summary[f"{name}.max"] >= column.max()
        assert summary[f"{name}.min"] == pytest.approx(column.min(), abs=1e-3 * abs(column).max())
    atmosphere = 101325.0
    assert summary["gauge_pressure.final"] == pytest.approx(run.absolute_pressure[-1] - atmosphere, rel=1e-12)
    last = run.t > run.t[-1] - 0.04
    assert summary["length.ripple"] == pytest.approx(numpy.ptp(run.length[last]), rel=0.02)
    assert summary.units["air.used"] == "kg" and summary["air.used"] > 0
    assert abs(summary["energy.residual"]) < 1e-6 * summary["energy.gas_work"]
    counts = {kind: sum(event.kind == kind for event in run.events) for kind in summary.events}
    assert summary.events == counts and sum(counts.values()) == len(run.events)
    assert "actuator.turns" in summary.assumed
    assert "length.ripple" in str(summary) and "<table>" in summary._repr_html_()
    assert summary.to_pandas().loc["length.final", "unit"] == "m"
    assert len(summary) == len(dict(summary)) == len(list(summary))


def test_fixed_steps_say_which_step_was_chosen_and_its_error(swing):
    summary = mckibben.simulate(swing.with_values({"run.engine": "fixed-step", "run.duration": "0.2 s"})).summary()
    assert 0 < summary["run.step"] < 0.01 and 0 <= summary["run.step_error"] <= 1e-3


def test_what_a_run_settles_to_is_what_a_long_run_comes_to(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml").with_values({"run.sample_interval": "0.1 ms"})
    settled = scenario.settle()
    assert settled.settled and settled.period == pytest.approx(0.04)
    run = mckibben.simulate(scenario)
    last = run.t > run.t[-1] - settled.period
    assert settled["length"].ripple == pytest.approx(numpy.ptp(run.length[last]), rel=0.01)
    # Momentum returns on an orbit: the mean tension is the weight of 5 lb.
    assert settled["tension"].mean == pytest.approx(5 * 0.45359237 * 9.80665, rel=1e-3)
    assert settled["gauge_pressure"].unit == "Pa" and "time" not in settled
    assert "gauge_pressure" in str(settled)


def test_a_mat_file_is_read_by_scipy(swing, tmp_path):
    run = mckibben.simulate(swing)
    run.to_mat(tmp_path / "run.mat")
    read = scipy.io.loadmat(tmp_path / "run.mat")
    for name, unit in run.units.items():
        if unit:
            numpy.testing.assert_array_equal(read[name.replace(".", "_")].ravel(), run[name])
    assert [word.item() for word in read["valve"].ravel()] == list(run["valve"])
    assert '"length_m": "m"' in read["mckibben_units"].item().replace(":", ": ")


def test_events_are_a_frame(swing):
    run = mckibben.simulate(swing)
    frame = run.events_to_pandas()
    assert list(frame["time_s"]) == [event.time for event in run.events]
    assert list(frame["event"]) == [event.kind for event in run.events] and "sliding" in frame


def test_chosen_columns_are_drawn_into_given_axes(swing):
    run = mckibben.simulate(swing.with_values({"run.duration": "0.1 s"}))
    figure, axes = plt.subplots(2)
    assert run.plot(columns=["length_m", "valve"], ax=axes) is figure
    numpy.testing.assert_array_equal(axes[0].lines[0].get_ydata(), run.length)
    assert axes[0].get_ylabel() == "length_m (m)"
    for wrong, words in [({"columns": []}, "empty"), ({"columns": ["length_m"], "ax": axes}, "one for each")]:
        with pytest.raises(mckibben.InputError, match=words):
            run.plot(**wrong)
    with pytest.raises(KeyError, match="no column `mass`"):
        run.plot(columns=["mass"])
    plt.close("all")


def test_the_maximum_of_a_summary_is_that_between_the_samples_too(examples):
    """The peak of a fine run; a sweep over coarse samples has the largest of them, and misses it."""
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml").with_values({"run.duration": "0.5 s"})
    peak = mckibben.simulate(scenario.with_values({"run.sample_interval": "0.1 ms"})).tension.max()
    coarse = scenario.with_values({"run.sample_interval": "30 ms"})
    run = mckibben.simulate(coarse)
    assert run.summary()["tension.max"] == pytest.approx(peak, rel=1e-3)
    swept = mckibben.sweep(coarse, vary={"load.mass": [scenario.load.mass]}, reductions=["tension.max"])
    assert swept["tension_max_n"][0] == pytest.approx(run.tension.max(), rel=1e-3)
    assert swept["tension_max_n"][0] < 0.7 * peak


def test_a_run_whose_figures_are_not_finite_is_refused_as_by_the_program(tmp_path, program):
    """A law that ends at a contraction of 3e-5 has no energy beyond it, while its tension there is zero."""
    scenario = mckibben.Scenario.from_dict({
        "actuator": {
            "length": "0.1 m", "diameter": "0.02 m", "braid_angle": "25 deg",
            "force": {
                "law": "bolen", "max_force": "500 N", "max_pressure": "6 bar", "max_contraction": 3e-5, "shape": [0.3, 3.0, 1.0]
            },
        },
        "load": {"kind": "hanging-mass", "mass": "5 kg"},
        "initial": {"length": "0.0999 m"},
        "run": {"duration": "0.1 s"},
    })
    (tmp_path / "beyond.toml").write_text(scenario.to_toml())
    said = "energy.stored = NaN is not a finite number"
    assert said in program(tmp_path, "simulate", "beyond.toml", "--output", "run.csv", code=3).stderr
    run = mckibben.simulate(scenario)
    assert numpy.isfinite(run.tension).all()
    writers = [lambda to=to: to(tmp_path / "run") for to in (run.to_csv, run.to_parquet, run.to_mat)]
    for use in (run.summary, lambda: run.warnings, *writers):
        with pytest.raises(mckibben.SimulationError, match=said):
            use()
    assert [path.name for path in tmp_path.iterdir()] == ["beyond.toml"]
