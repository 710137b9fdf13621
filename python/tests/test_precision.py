"""Single precision: the numbers of plants that are stepped together."""

from __future__ import annotations

import pickle

import gymnasium
import numpy
import pytest

import mckibben
import mckibben.learning  # the environments

SCENARIO = mckibben.Scenario.from_dict(
    {
        "supply": {"gauge_pressure": "100 psi"},
        "valve": {"preset": "matrix-eight-channel"},
        "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
        "load": {"kind": "hanging-mass", "mass": "5 lb"},
        "initial": {"gauge_pressure": "40 psi", "length": "equilibrium"},
        "run": {"duration": "1 s", "engine": "fixed-step", "step": "0.5 ms"},
    }
)
COUNT = 40
# Of the largest value: seven digits, less what some hundred steps and the edges of pulses lose.
NEAR = 1e-3


def near(single: numpy.ndarray, double: numpy.ndarray) -> None:
    """Check that numbers are near each other, but not equal: then both would be of one precision."""
    assert numpy.abs(single - double).max() <= NEAR * numpy.abs(double).max()
    assert (single != double).any()


def test_vector_plants_in_single_precision_are_near_those_in_double():
    observed = []
    for precision in ("single", "double"):
        plants = mckibben.VectorPlant(SCENARIO, COUNT, parameters=["load.mass"], precision=precision)
        plants.start(numpy.linspace(2.0, 3.0, COUNT)[:, None])
        observations, stopped = numpy.zeros((COUNT, len(plants.columns))), numpy.zeros(COUNT, dtype=bool)
        for step in range(10):
            plants.step(numpy.full((COUNT, plants.valves), 0.3 + 0.05 * step), 0.04, observations, stopped)
        assert not stopped.any()
        observed.append(observations[:, plants.columns.index("length_m")])
    near(*observed)


def test_a_row_in_single_precision_does_not_depend_on_how_many_there_are():
    ends = []
    for count in (1, 3, 4, COUNT):
        plants = mckibben.VectorPlant(SCENARIO, count, precision="single")
        plants.start(numpy.empty((count, 0)))
        shown, stopped = numpy.zeros((count, len(plants.columns))), numpy.zeros(count, dtype=bool)
        for step in range(20):
            plants.step(numpy.full((count, 1), 0.2 + 0.03 * step), 0.01, shown, stopped)
        assert (shown == shown[0]).all(), count
        ends.append(shown[0].copy())
    numpy.testing.assert_array_equal(ends, [ends[0]] * len(ends))


def test_actuators_in_single_precision_are_near_those_in_double():
    tensions = []
    for precision in ("single", "double"):
        muscles = mckibben.Actuators(SCENARIO, COUNT, precision=precision)
        again = pickle.loads(pickle.dumps(muscles))
        length, velocity, tension, its = numpy.linspace(0.085, 0.09, COUNT), numpy.zeros(COUNT), numpy.zeros(COUNT), numpy.zeros(COUNT)
        for step in range(200):
            length += 1e-6
            velocity[:] = 1e-3
            muscles.step(length, velocity, numpy.full(COUNT, 0.5), 1e-3, tension)
            again.step(length, velocity, numpy.full(COUNT, 0.5), 1e-3, its)
        numpy.testing.assert_array_equal(tension, its)
        tensions.append(tension)
    near(*tensions)


def test_hosted_plants_in_single_precision_are_near_those_in_double():
    tensions = []
    for precision in ("single", "double"):
        plant = mckibben.HostedPlant(SCENARIO, COUNT, precision=precision)
        distances, rates = numpy.linspace(0.085, 0.09, COUNT)[:, None], numpy.zeros((COUNT, 1))
        plant.begin(distances, rates)
        for _ in range(200):
            distances = distances - 1e-6
            plant.step(distances, numpy.full((COUNT, 1), 0.6), 1e-3)
        tensions.append(plant.compute(distances, rates))
    near(*tensions)


def test_environments_take_a_precision():
    observed = []
    for precision in ("single", "double"):
        many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=COUNT, precision=precision)
        many.reset(seed=1)
        for _ in range(10):
            observations, *_ = many.step(numpy.full(many.action_space.shape, 0.4, dtype=many.action_space.dtype))
        observed.append(observations)
    assert numpy.abs(observed[0] - observed[1]).max() <= 1e-2


def test_an_unknown_precision_is_refused():
    with pytest.raises(mckibben.InputError, match="precision"):
        mckibben.VectorPlant(SCENARIO, 2, precision="half")  # type: ignore[arg-type]
