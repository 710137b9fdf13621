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
