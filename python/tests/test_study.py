"""Identification from arrays and data frames: what was put in comes out, with how sure it is; and how a search is followed."""

from __future__ import annotations

import warnings

import numpy
import pandas
import polars
import pytest

import mckibben

TIMES = numpy.linspace(0.0, 0.3, 301)
TRUTH = {"actuator.friction.viscous": 5.0, "load.mass": 2.4}
FIT = {"actuator.friction.viscous": (0.0, 50.0), "load.mass": {"from": 1.0, "to": "5 kg"}}
NOISE = 2e-5


@pytest.fixture(scope="module")
def rig(swing) -> mckibben.Scenario:
    return swing.with_values({"run.duration": 0.3})


@pytest.fixture(scope="module")
def lengths(rig) -> numpy.ndarray:
    run = mckibben.simulate(rig.with_values(TRUTH))
    return run.at_times(TIMES)["length_m"] + NOISE * numpy.random.default_rng(1).normal(size=TIMES.size)


@pytest.fixture(scope="module")
def found(rig, lengths) -> mckibben.Identification:
    return mckibben.identify(study(rig, {"t": TIMES, "L": lengths}))


def study(rig: mckibben.Scenario, data, length="L", **options) -> mckibben.Study:
    options = {"columns": {"time": "t", "length": length}, "fit": FIT} | options
    return mckibben.Study(kind="trajectories", scenario=rig, runs=[mckibben.Run(data, name="swing")], **options)


def test_what_made_the_data_is_within_its_interval(found):
    for name, truth in TRUTH.items():
        estimate = found[name]
        assert abs(estimate.value - truth) < 4 * estimate.standard_error
        low, high = estimate.confidence_interval
        assert low < estimate.value < high and not estimate.on_bound
    assert list(found) == list(TRUTH) and len(found) == 2
    rerun = mckibben.simulate(found.scenarios["scenario.toml"].with_values({"run.duration": "0.1 s"}))
    assert rerun.scenario.load.mass == pytest.approx(found["load.mass"].value, rel=1e-12)


def test_residuals_are_the_noise_and_the_covariance_is_that_of_the_errors(found, lengths):
    (prediction,) = found.predictions
    numpy.testing.assert_array_equal(prediction.coordinates["time_s"], TIMES)
    numpy.testing.assert_array_equal(prediction.measured, lengths)
    assert (prediction.run, prediction.quantity, prediction.unit) == ("swing", "length", "m")
    assert prediction.residuals.std() == pytest.approx(NOISE, rel=0.15)
    errors = [found[name].standard_error for name in found]
    numpy.testing.assert_allclose(numpy.sqrt(numpy.diag(found.covariance)), errors, rtol=1e-12)
    numpy.testing.assert_allclose(numpy.diag(found.correlations), 1.0, rtol=1e-12)
    # The interval is that of Student's distribution, near the normal one with 299 degrees of freedom.
    low, high = found["load.mass"].confidence_interval
    assert (high - low) / 2 == pytest.approx(1.968 * found["load.mass"].standard_error, rel=1e-3)
    frame = found.predictions_to_pandas()
    numpy.testing.assert_array_equal(frame.residual, prediction.residuals)
    assert found.to_pandas().loc["load.mass", "unit"] == "kg"


@pytest.mark.parametrize("table", [pandas.DataFrame, polars.DataFrame, dict])
def test_frames_and_units_give_the_same_estimates(table, rig, lengths, found):
    data = table({"t": TIMES * 1e3, "L": 1e3 * lengths, "note": ["a"] * len(TIMES)})
    again = mckibben.identify(study(rig, data, columns={"time": ("t", "ms"), "length": {"name": "L", "unit": "mm"}}))
    for name in found:
        assert again[name].value == pytest.approx(found[name].value, rel=1e-6)


def test_masked_cells_are_missing_as_those_that_are_nan(rig, lengths):
    masked = numpy.zeros(TIMES.size, dtype=bool)
    masked[100:140] = True
    # What lies under the mask is far from the truth.
    wrong = numpy.where(masked, 0.09, lengths)
    of_mask = mckibben.identify(study(rig, {"t": TIMES, "L": numpy.ma.masked_array(wrong, masked)}))
    of_nan = mckibben.identify(study(rig, {"t": TIMES, "L": numpy.where(masked, numpy.nan, lengths)}))
    assert of_mask.estimates == of_nan.estimates
    assert len(of_mask.predictions[0].measured) == TIMES.size - 40


def test_a_column_of_dates_is_refused_with_its_type(rig, lengths):
    since = (TIMES * 1e9).astype("timedelta64[ns]")
    for times, words in [(numpy.datetime64("2020-01-01") + since, r"datetime64\[ns\].*\(column - column\[0\]\) / numpy"),
                         (since, r"timedelta64\[ns\].*such as column / numpy")]:
        for table in (dict, pandas.DataFrame):
            with pytest.raises(mckibben.InputError, match="the column `t` of the run `swing` is of type " + words):
                mckibben.identify(study(rig, table({"t": times, "L": lengths})))
    with pytest.raises(mckibben.InputError, match="the column `L` of the run `swing` has complex numbers"):
        mckibben.identify(study(rig, {"t": TIMES, "L": lengths + 3j}))


@pytest.mark.parametrize("one", [dict, pandas.DataFrame, mckibben.Run])
def test_one_run_needs_no_sequence(one, rig, lengths, found):
    data = {"t": TIMES, "L": lengths}
    alone = mckibben.Study(
        kind="trajectories", scenario=rig, runs=one(data), columns={"time": "t", "length": "L"}, fit=FIT
    )
    assert mckibben.identify(alone)["load.mass"].value == found["load.mass"].value


def test_columns_with_separate_times_are_in_separate_tables(rig, lengths):
    run = mckibben.simulate(rig.with_values(TRUTH))
    pressures = run.at_times(TIMES[::3])["gauge_pressure_pa"]
    data = [{"t": TIMES, "L": lengths}, {"t": TIMES[::3], "P": pressures}]
    columns = {"time": "t", "length": "L", "gauge_pressure": "P"}
    both = mckibben.identify(study(rig, data, columns=columns))
    assert [prediction.quantity for prediction in both.predictions] == ["length", "gauge pressure"]
    assert both["load.mass"].value == pytest.approx(2.4, rel=1e-3)


def test_sensors_are_estimated_with_the_parameters(rig, lengths):
    """Each session has its own offset; the shift is known, and late readings are those of earlier instants."""
    late = numpy.interp(TIMES - 4e-3, TIMES, mckibben.simulate(rig.with_values(TRUTH)).at_times(TIMES)["length_m"])
    noise = numpy.random.default_rng(2).normal(size=(2, TIMES.size))
    runs = [
        mckibben.Run({"t": TIMES, "L": late + offset + NOISE * of_run}, session=session)
        for session, offset, of_run in (("morning", 1e-3, noise[0]), ("evening", -2e-3, noise[1]))
    ]
    fit = {"actuator.friction.viscous": (0.0, 50.0), "load.mass": (1.0, 5.0), "columns.length.offset": {"per_session": True}}
    found = mckibben.identify(
        mckibben.Study(
            kind="trajectories", scenario=rig, runs=runs, fit=fit, columns={"time": "t", "length": {"name": "L", "shift": 4e-3}}
        )
    )
    expected = TRUTH | {"columns.length.offset [morning]": 1e-3, "columns.length.offset [evening]": -2e-3}
    assert sorted(found) == sorted(expected)
    for name, truth in expected.items():
        assert abs(found[name].value - truth) < 4 * found[name].standard_error, name
    assert found.predictions[0].residuals.std() == pytest.approx(NOISE, rel=0.2)


def test_a_plot_has_readings_predictions_and_residuals(found):
    figure = found.plot()
    upper, lower = figure.axes
    assert [line.get_label() for line in upper.lines] == ["measured", "predicted"]
    numpy.testing.assert_array_equal(lower.lines[0].get_ydata(), found.predictions[0].residuals)
    assert "<svg" in found.figures["run-1"]
    with pytest.raises(mckibben.InputError, match="no run `other`; name one of swing"):
        found.plot("other")


def test_doubts_are_warnings_of_python(rig, lengths):
    drifting = lengths + 2e-3 * TIMES
    with pytest.warns(UserWarning, match="drifts"):
        doubted = mckibben.identify(study(rig, {"t": TIMES, "L": drifting}))
    assert any("drifts" in words for words in doubted.warnings)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mckibben.identify(study(rig, {"t": TIMES, "L": lengths}))


def test_a_search_is_followed_and_ended(rig, lengths):
    class Enough(Exception):
        pass

    calls = []

    def follow(evaluations: int, total: None) -> None:
        calls.append(evaluations)
        raise Enough

    slow = study(rig, {"t": TIMES, "L": lengths}, more_starts=2000)
    with pytest.raises(Enough):
        mckibben.identify(slow, progress=follow)
    assert len(calls) == 1 and calls[0] >= 0


def test_ctrl_c_returns_the_best_values_so_far(rig, lengths, tmp_path):
    def interrupt(evaluations: int, total: None) -> None:
        # As Python does on Ctrl-C, once a value has been found.
        if evaluations > 20:
            raise KeyboardInterrupt

    slow = study(rig, {"t": TIMES, "L": lengths}, more_starts=20_000)
    with pytest.warns(UserWarning, match="the search was interrupted"):
        best = mckibben.identify(slow, tmp_path / "out", progress=interrupt)
    assert best.interrupted and list(best) == list(TRUTH)
    assert (tmp_path / "out" / "values.csv").exists() and (tmp_path / "out" / "scenario.toml").exists()
    # The first search from the scenario's values takes about as many evaluations: the values are at least better than its start.
    run = mckibben.simulate(best.scenarios["scenario.toml"]).at_times(TIMES)["length_m"]
    start = mckibben.simulate(rig).at_times(TIMES)["length_m"]
    assert numpy.abs(run - lengths).max() < numpy.abs(start - lengths).max()


def test_limits_return_the_best_values_so_far(rig, lengths, found):
    with pytest.warns(UserWarning, match="took all its 1 steps"):
        stepped = mckibben.identify(study(rig, {"t": TIMES, "L": lengths}, most_steps=1, more_starts=0))
    assert not stepped.interrupted and stepped.correlations is None and stepped.covariance is None
    assert all(one.standard_error is None and one.confidence_interval is None for one in stepped.estimates)
    with pytest.warns(UserWarning, match="time of the search was over"):
        timed = mckibben.identify(study(rig, {"t": TIMES, "L": lengths}, more_starts=100_000, time_limit=1.0))
    assert timed.interrupted
    assert timed["load.mass"].value == pytest.approx(found["load.mass"].value, rel=1e-3)


def test_other_minima_have_their_values(rig, lengths):
    wide = study(rig, {"t": TIMES, "L": lengths}, fit={"load.mass": (0.3, 60.0)}, more_starts=12)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = mckibben.identify(wide)
    assert result.other_minima, "every search led to the same minimum"
    for other in result.other_minima:
        assert set(other.values) == {"load.mass"} and other.error_ratio > 1.0 and other.searches >= 1
    ratios = [other.error_ratio for other in result.other_minima]
    assert ratios == sorted(ratios)


def test_a_swing_that_comes_to_rest_has_a_step_response(rig):
    times = numpy.linspace(0.0, 2.0, 1001)
    settling = rig.with_values({"run.duration": 2.0, "actuator.friction.viscous": 20.0})
    data = {"t": times, "L": mckibben.simulate(settling).at_times(times)["length_m"]}
    (step,) = mckibben.identify(study(settling, data, fit={"actuator.friction.viscous": (1.0, 50.0)})).step_responses
    assert (step.run, step.quantity, step.unit) == ("swing", "length", "m") and step.held_out is None
    assert step.measured.overshoot > 0.0 and step.measured.error is None
    assert step.predicted.overshoot == pytest.approx(step.measured.overshoot, rel=1e-3)
    assert step.predicted.frequency == pytest.approx(step.measured.frequency, rel=1e-3)
    assert step.predicted.error < 1e-4


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"most_steps": 0}, "takes 1 step or more"),
        ({"most_steps": 2.5}, "most_steps is 2.5; give a whole number"),
        ({"more_starts": -1}, "more_starts is -1"),
        ({"time_limit": 0.0}, "time_limit.*not above zero"),
        ({"columns": {"time": "t", "length": "x"}}, "no table of the run `swing` has a column `x`; they have: t, L, P"),
        ({"columns": ["t", "L"]}, "columns is .*; give a dictionary"),
        ({"columns": {"time": "t", "length": {"name": "L", "deviation": "-0.05 mm"}}}, "-0.05 mm, which is not above zero"),
        ({"columns": {"time": "t", "length": {"name": "L", "deviation": 0.0}}}, "which is not above zero"),
        ({"columns": {"time": "t", "length": {"name": "L", "deviatio": 1.0}}}, r"(?s)^error: the study: .*help\(mckibben.Study\)"),
        ({"fit": [("load.mass", (1.0, 2.0))]}, "fit is .*; give a dictionary"),
        ({"columns": {"time": "t", "length": ("L", "bar")}}, "`bar` is no unit of length"),
        ({"columns": {"time": "t", "length": 3}}, "give the name of a column"),
        ({"columns": {"time": "t", "lenght": "L"}}, "`lenght` is no quantity"),
        ({"fit": {"load.mass": 2.0}}, r"give its bounds as \(low, high\)"),
        ({"fit": {"load.masss": (1.0, 2.0)}}, "load.masss"),
        ({"fit": {"load.mass": (3.0, 1.0)}}, "`from` below `to`"),
        ({"fit": {"load.mass": {"start": 9.0, "from": 1.0, "to": 5.0}}}, "`start` of `load.mass`.* is 9 .*above its largest value"),
        ({"segments": -1.0}, "segments"),
    ],
)
def test_messages_name_the_arguments_of_python(options, words, rig, lengths):
    with pytest.raises(mckibben.InputError, match=words):
        mckibben.identify(study(rig, {"t": TIMES, "L": lengths, "P": lengths}, **options))


def test_tables_that_are_none_are_refused(rig, lengths):
    with pytest.raises(mckibben.InputError, match="the column `L` has 2 numbers, but the first has 301"):
        mckibben.identify(study(rig, {"t": TIMES, "L": lengths[:2]}))
    with pytest.raises(mckibben.InputError, match="is no array of numbers"):
        mckibben.identify(study(rig, {"t": TIMES, "L": ["long"] * len(TIMES)}))
    for column, wrong in [("t", TIMES), ("L", lengths)]:
        infinite = numpy.where(TIMES == TIMES[7], -numpy.inf, wrong)
        with pytest.raises(mckibben.InputError, match=f"the column `{column}` of the run `swing` is -inf in row 7"):
            mckibben.identify(study(rig, {"t": TIMES, "L": lengths, column: infinite}))
    with pytest.raises(mckibben.InputError, match="runs is empty"):
        mckibben.identify(mckibben.Study(kind="trajectories", scenario=rig, runs=[], columns={"time": "t", "length": "L"}, fit=FIT))
    with pytest.raises(mckibben.InputError, match="kind is 'trajectory'; give one of force-map"):
        mckibben.identify(mckibben.Study(kind="trajectory", scenario=rig, runs=[{"t": TIMES}], columns={}))  # type: ignore[arg-type]
    with pytest.raises(mckibben.InputError, match="2 dimensions"):
        mckibben.identify(study(rig, {"t": TIMES, "L": lengths.reshape(7, 43)}))


@pytest.mark.parametrize("section", ["flow", "tank", "pulses"])
def test_a_section_that_is_no_dictionary_is_refused_by_its_name(section, swing):
    study = mckibben.Study(kind="trajectories", scenario=swing, runs={"t": [0.0, 0.1]}, columns={"time": "t"}, **{section: 5})
    with pytest.raises(mckibben.InputError, match=f"{section} is 5; give a dictionary"):
        mckibben.identify(study)
