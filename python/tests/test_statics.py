"""Statics on arrays against the closed form of the ideal braid, what is out of reach, and curves as frames."""

from __future__ import annotations

import math

import numpy
import pytest

import mckibben


@pytest.fixture(scope="module")
def scenario(examples) -> mckibben.Scenario:
    return mckibben.Scenario.from_file(examples / "paper/fig-12.toml")


@pytest.fixture(scope="module")
def statics(scenario) -> mckibben.Statics:
    return mckibben.Statics(scenario)


def area(scenario: mckibben.Scenario, length: numpy.ndarray) -> numpy.ndarray:
    """Force over pressure of the ideal braid, (1): (3 L² − b²)/(4 π n²)."""
    thread, turns = scenario.actuator.thread_length, scenario.actuator.turns
    return (3 * length**2 - thread**2) / (4 * math.pi * turns**2)


def test_the_force_is_that_of_the_paper_on_arrays_of_any_shape(scenario, statics):
    length = numpy.linspace(statics.min_length, statics.max_length, 7)[:, None]
    pressure = numpy.array([1e5, 3e5, 6e5])
    expected = pressure * area(scenario, length)
    numpy.testing.assert_allclose(statics.force(length, pressure), expected, rtol=1e-12, atol=1e-12)
    assert statics.force(0.08, 2e5).shape == () and statics.volume(length).shape == (7, 1)
    # (2): V = L (b² − L²)/(4 π n²), and the volume outside the braid.
    thread, turns = scenario.actuator.thread_length, scenario.actuator.turns
    braid = length * (thread**2 - length**2) / (4 * math.pi * turns**2)
    numpy.testing.assert_allclose(statics.volume(length), braid + scenario.actuator.external_volume, rtol=1e-12)


def test_the_stiffness_is_the_slope_of_the_force(statics):
    length, pressure, step = numpy.array([0.075, 0.085]), 3e5, 1e-6
    slope = (statics.force(length + step, pressure) - statics.force(length - step, pressure)) / (2 * step)
    numpy.testing.assert_allclose(statics.stiffness(length, pressure), slope, rtol=1e-7)
    assert (statics.stiffness(length, pressure, sealed=True) > statics.stiffness(length, pressure)).all()


def test_pressure_and_length_are_the_inverses_of_the_force(scenario, statics):
    length, force = numpy.meshgrid([0.075, 0.08, 0.09], [5.0, 40.0])
    pressure = statics.gauge_pressure_for(length, force)
    numpy.testing.assert_allclose(pressure, force / area(scenario, length), rtol=1e-12)
    numpy.testing.assert_allclose(statics.length_for(pressure, force), length, rtol=1e-9)


def test_what_is_out_of_reach_is_no_number(statics):
    supply = statics.supply_gauge_pressure
    assert supply == pytest.approx(100 * 6894.757293168361)
    longest = statics.force(0.09, supply).item()
    assert math.isnan(statics.gauge_pressure_for(0.09, 1.001 * longest))
    assert statics.gauge_pressure_for(0.09, 1.001 * longest, max_gauge_pressure=2 * supply) > supply
    for length in (0.99 * statics.min_length, 1.01 * statics.max_length):
        assert math.isnan(statics.force(length, 2e5)) and math.isnan(statics.volume(length))
    assert math.isnan(statics.force(0.08, -2e5))
    assert math.isnan(statics.length_for(2e5, 1e5)), "more than the braid bears at its longest"
    assert math.isnan(statics.length_for(6e5, 0.0)), "it pulls harder than nothing at its shortest"
    assert math.isnan(statics.gauge_pressure_for(0.08, -1.0))
    with pytest.raises(mckibben.InputError, match=r"length\[1\] = inf"):
        statics.force([0.08, math.inf], 2e5)
    with pytest.raises(mckibben.InputError, match="max_gauge_pressure = "):
        statics.gauge_pressure_for(0.08, 1.0, max_gauge_pressure=-1.0)


def test_no_number_gives_no_number(statics):
    """What an inverse has returned can be passed on."""
    pressure = statics.gauge_pressure_for(0.08, [10.0, 1e4])
    assert math.isfinite(pressure[0]) and math.isnan(pressure[1])
    for of in (statics.force, statics.stiffness, lambda *both: statics.stiffness(*both, sealed=True)):
        numpy.testing.assert_array_equal(of(0.08, pressure), [of(0.08, pressure[0]), math.nan])
        numpy.testing.assert_array_equal(of([math.nan, 0.08], pressure[0]), [math.nan, of(0.08, pressure[0])])
    numpy.testing.assert_array_equal(statics.volume([0.08, math.nan]), [statics.volume(0.08), math.nan])
    numpy.testing.assert_array_equal(statics.length_for(pressure, 10.0), [statics.length_for(pressure[0], 10.0), math.nan])
    assert math.isnan(statics.gauge_pressure_for(0.08, math.nan))


def test_a_sealed_muscle_has_no_supply_that_limits_it(swing):
    statics = mckibben.Statics(swing)
    assert statics.supply_gauge_pressure is None
    with pytest.raises(mckibben.InputError, match="max_gauge_pressure"):
        statics.gauge_pressure_for(0.08, 10.0)
    assert statics.gauge_pressure_for(0.08, 10.0, max_gauge_pressure=4e5) > 0.0


def test_curves_are_arrays_a_tidy_frame_and_a_figure(scenario, statics):
    curves = mckibben.curves(scenario, [2e5, 4e5])
    frame = curves.to_pandas()
    assert len(frame) == curves["force_n"].size and set(frame.gauge_pressure_pa) == {2e5, 4e5}
    inside = frame[frame.force_n > 0]
    expected = statics.force(inside.length_m, inside.gauge_pressure_pa)
    numpy.testing.assert_allclose(inside.force_n, expected, rtol=1e-12)
    figure = curves.plot("stiffness_n_m", over="contraction")
    (axes,) = figure.axes
    assert axes.get_ylabel() == "stiffness_n_m" and [text.get_text() for text in axes.get_legend().texts] == ["2 bar", "4 bar"]
    numpy.testing.assert_array_equal(mckibben.curves(scenario, 4e5)["force_n"], curves["force_n"][1:])
    with pytest.raises(KeyError, match="forces.*force_n"):
        curves["forces"]
    with pytest.raises(mckibben.InputError, match=r"gauge_pressures\[1\]"):
        mckibben.curves(scenario, [2e5, math.inf])


def test_what_a_mask_hides_is_missing(statics):
    hidden = numpy.ma.masked_array([0.08, 0.09], [True, False])
    force = statics.force(hidden, 3e5)
    assert math.isnan(force[0]) and force[1] == statics.force(0.09, 3e5)
    assert numpy.isnan(statics.volume(hidden)).tolist() == [True, False]


def test_curves_are_equal_where_their_arrays_are(scenario):
    of = mckibben.curves(scenario, "2, 4 bar")
    assert of == mckibben.curves(scenario, [2e5, 4e5])
    assert of != mckibben.curves(scenario, "2, 3 bar") and of != mckibben.curves(scenario, "2 bar") and of != 1
