"""Plants whose ends a simulator moves: what is refused takes no time, and states are saved and restored."""

from __future__ import annotations

import numpy
import pytest

import mckibben


def plant(count: int = 1) -> mckibben.HostedPlant:
    scenario = mckibben.Scenario.from_dict(
        {
            "supply": {"gauge_pressure": "100 psi"},
            "valve": {"preset": "matrix-eight-channel"},
            "command": {"kind": "fill"},
            "load": {"kind": "isometric"},
            "initial": {"length": "90 mm", "gauge_pressure": "40 psi"},
            "run": {"duration": "1 s"},
        }
    )
    return mckibben.HostedPlant(scenario, count, command_mode="request")


def test_a_refused_step_takes_no_time():
    refused, plain = plant(), plant()
    distances, fill = numpy.array([[0.09]]), numpy.ones((1, 1))
    for _ in range(3):
        with pytest.raises(mckibben.InputError, match="actuator.request"):
            refused.step(distances, 7.0 * fill, 1e-3)
        for of in (refused, plain):
            of.step(distances, fill, 1e-3)
    assert refused.time == plain.time == 3e-3
    numpy.testing.assert_array_equal(refused.save(), plain.save())


def test_states_go_on_where_they_were_saved():
    first, second = plant(2), plant(2)
    distances, commands = numpy.array([[0.09], [0.088]]), numpy.array([[1.0], [-1.0]])
    for _ in range(20):
        first.step(distances, commands, 1e-3)
    second.restore(first.save())
    assert second.time == first.time
    for of in (first, second):
        of.step(distances, commands, 1e-3)
    numpy.testing.assert_array_equal(second.observe(), first.observe())


def test_arrays_have_a_row_for_each_plant():
    with pytest.raises(mckibben.InputError, match="shape"):
        plant(2).step(numpy.array([[0.09]]), numpy.ones((1, 1)), 1e-3)
    with pytest.raises(mckibben.InputError, match="no finite number"):
        plant().step(numpy.array([[numpy.nan]]), numpy.ones((1, 1)), 1e-3)


def test_a_step_of_very_many_parts_is_that_of_shorter_steps():
    """It is taken in spans, between which Ctrl-C is handled: the end is that of steps along the same line, to rounding."""
    scenario = plant().scenario
    whole, shorter = (mckibben.HostedPlant(scenario, 2, command_mode="request", max_step=1e-5) for _ in range(2))
    begin, end = numpy.array([[0.09], [0.088]]), numpy.array([[0.087], [0.089]])
    fill = numpy.array([[1.0], [-1.0]])
    for of in (whole, shorter):
        of.begin(begin, numpy.zeros((2, 1)))
    whole.step(end, fill, 0.05)
    for step in range(1, 51):
        shorter.step(begin + step / 50 * (end - begin), fill, 1e-3)
    assert whole.time == pytest.approx(shorter.time, rel=1e-12)
    numpy.testing.assert_allclose(whole.observe(), shorter.observe(), rtol=1e-6, atol=1e-9)
    numpy.testing.assert_array_equal(whole.distances, end)
    before = whole.save()
    with pytest.raises(mckibben.InputError, match="more than 1e7"):
        whole.step(end, fill, 1000.0)
    numpy.testing.assert_array_equal(whole.save(), before)


def test_plants_together_are_those_alone():
    count = 200
    many, alone = plant(count), [plant() for _ in range(3)]
    number = numpy.arange(count)
    for step in range(30):
        distances = 0.09 - 1e-3 * numpy.sin(0.2 * step + number)[:, None] ** 2
        commands = ((number + step // 10) % 2 * 2 - 1.0)[:, None]
        many.step(distances, commands, 1e-3)
        for at, of in zip((0, 77, 199), alone, strict=True):
            of.step(distances[at : at + 1], commands[at : at + 1], 1e-3)
    velocities = numpy.full((count, 1), 0.01)
    tensions, observed = many.compute(distances, velocities), many.observe()
    for at, of in zip((0, 77, 199), alone, strict=True):
        numpy.testing.assert_array_equal(observed[at], of.observe()[0])
        numpy.testing.assert_array_equal(tensions[at], of.compute(distances[at : at + 1], velocities[:1])[0])


def test_a_plant_that_stops_leaves_the_others():
    two, one = plant(2), plant()
    fill = numpy.ones((2, 1))
    beyond_the_thread = numpy.array([[0.09], [0.5]])
    for step in (1, 2):
        with pytest.raises(mckibben.SimulationError, match="plant 1"):
            two.step(beyond_the_thread if step == 1 else numpy.full((2, 1), 0.09), fill, 1e-3)
        one.step(numpy.array([[0.09]]), fill[:1], 1e-3)
    assert two.time == one.time == 2e-3
    with pytest.raises(mckibben.SimulationError, match="plant 1"):
        two.observe()
    two.begin(numpy.full((2, 1), 0.09), numpy.zeros((2, 1)))
    two.step(numpy.full((2, 1), 0.09), fill, 1e-3)
    numpy.testing.assert_array_equal(two.observe()[0], two.observe()[1])
