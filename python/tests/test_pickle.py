"""Everything can be pickled and copied, and is afterwards what it was."""

from __future__ import annotations

import copy
import pickle

import numpy
import pytest

import mckibben
from conftest import same

STEP = 1e-3
PULSES = 25.0

#: What a state may hold besides air: a hose in one volume and in cells, a tank with its compressor and a regulator, each law
#: of hysteresis, dry friction, poppets under way.
RIGS = {
    "plain": {},
    "hose": {"hose": {"length": "1 m", "diameter": "3 mm"}},
    "cells": {"hose": {"kind": "distributed", "cells": 4, "length": "1 m", "diameter": "3 mm"}},
    "tank": {"supply.reservoir_volume": "0.2 L", "supply.compressor_displacement": "50 L/min",
             "supply.cut_in_gauge_pressure": "99.9 psi", "supply.cut_out_gauge_pressure": "100.1 psi",
             "supply.lag": "5 ms", "supply.droop": "1e7 Pa*s/kg"},
    "dry": {"actuator.friction.coulomb_force": "0.5 N", "actuator.friction.static_ratio": 1.2},
    "maxwell-slip": {"actuator.friction.hysteresis": {"law": "maxwell-slip", "reach": ["0.05 mm", "0.3 mm"],
                                                      "stiffness_ratio": [0.5, 0.1]}},
    "bouc-wen": {"actuator.friction.hysteresis": {"law": "bouc-wen", "width": "0.1 mm", "beta": "4000 m^-1",
                                                  "gamma": "-1500 m^-1"}},
    "lugre": {"actuator.friction.hysteresis": {"law": "lugre", "width": "0.1 mm", "bristle_reach": "0.05 mm",
                                               "static_ratio": 1.5, "stribeck_velocity": "10 mm/s",
                                               "damping_time": "5 ms"}},
    "ramp": {"valve.opening_time": "6 ms", "valve.closing_time": "4 ms"},
    "fill-hold-exhaust": {"valve.kind": "fill-hold-exhaust", "valve.opening_time": "3 ms"},
}


def pickled(protocol: int):
    return pytest.param(lambda thing: pickle.loads(pickle.dumps(thing, protocol)), id=f"pickle-{protocol}")


@pytest.fixture(params=[*map(pickled, range(2, pickle.HIGHEST_PROTOCOL + 1)), copy.deepcopy, copy.copy])
def again(request):
    return request.param


@pytest.fixture(params=RIGS)
def rig(request) -> mckibben.Scenario:
    scenario = mckibben.Scenario("""\
        [actuator]
        preset = "colbrunn-2001"
        [supply]
        gauge_pressure = "100 psi"
        [valve]
        preset = "matrix-eight-channel"
        [command]
        kind = "pwm"
        frequency = "25 Hz"
        duty = 0.5
        [load]
        kind = "isometric"
        [initial]
        gauge_pressure = "20 psi"
        length = "85 mm"
        [run]
        duration = "1 s"
        """, "rig.toml")
    return scenario.with_values(RIGS[request.param])


def length_series(count: int) -> numpy.ndarray:
    random = numpy.random.default_rng(11)
    return 0.085 + 1e-4 * numpy.cumsum(random.uniform(-0.5, 0.5, count))


def command(row: int) -> float | str | None:
    """Now and then the command changes, mostly in the middle of a pulse."""
    return {0: 0.4, 9: 0.7, 31: "exhaust", 36: "fill", 43: 0.3}.get(row)


def test_a_state_goes_on_to_the_same_bits(rig):
    """At every step the next is taken from the state and from what is left of it after a pickle."""
    actuator = mckibben.Actuator(rig)
    other = pickle.loads(pickle.dumps(actuator))
    state, before = actuator.start(), actuator.start().length
    for row, length in enumerate(length_series(60)):
        velocity, before = (length - before) / STEP, length
        copied = copy.deepcopy(state) if row % 2 else pickle.loads(pickle.dumps(state))
        assert copied == state and copied.time == state.time and copied.valve == state.valve
        whole = actuator.step(state, length, velocity, command(row), STEP)
        went = other.step(copied, length, velocity, command(row), STEP)
        # To the bit: both are compared by their bits or by all of their numbers.
        assert went[0] == whole[0] and went[1] == whole[1] and went[2] == whole[2]
        assert whole[0] != state
        state = whole[0]


def test_many_go_on_to_the_same_bits(rig, again):
    count = 5
    duty = numpy.linspace(0.1, 0.9, count)
    many = mckibben.Actuators(rig, count)

    def step(which: mckibben.Actuators, lengths: numpy.ndarray) -> numpy.ndarray:
        found = numpy.zeros((4, count))
        tension, per_length, per_velocity, pressure = found
        for length in lengths:
            which.step(numpy.full(count, length), numpy.full(count, 0.01), duty, STEP, tension, per_length=per_length,
                       per_velocity=per_velocity, absolute_pressure=pressure)
        return found

    step(many, length_series(17))
    copied = again(many)
    assert len(copied) == count
    expected = step(many, length_series(20))
    numpy.testing.assert_array_equal(step(copied, length_series(20)), expected)
    assert len(set(expected[3])) == count, "each has its own pressure"
    copied.reset()
    many.reset()
    numpy.testing.assert_array_equal(step(copied, length_series(5)), step(many, length_series(5)))


def test_plants_are_rebuilt_from_a_pickle(rig, again):
    plants = mckibben.VectorPlant(rig, 3, parameters=["initial.gauge_pressure"], action_mode="request", pulse_frequency=PULSES)
    shown, stopped = numpy.zeros((3, len(plants.columns))), numpy.zeros(3, dtype=bool)

    def step(which: mckibben.VectorPlant) -> numpy.ndarray:
        for row in range(12):
            which.step(numpy.full((3, 1), 1.0 if row < 9 else -1.0), STEP, shown, stopped)
        assert not stopped.any()
        return shown.copy()

    first = step(plants)
    copied = again(plants)
    assert len(copied) == 3 and copied.parameters == plants.parameters and copied.requests == plants.requests
    numpy.testing.assert_array_equal(step(copied), first)
    assert (step(plants) != first).any(), "the other went on"


def test_plants_whose_actuators_have_names_are_rebuilt_from_a_pickle(again, examples):
    leg = mckibben.Scenario.from_file(examples / "plant" / "leg.toml").with_values({"run.step": "1 ms"})
    plants = mckibben.VectorPlant(leg, 2, parameters=["mechanism.joints.knee.mass"], action_mode="set-point")
    copied = again(plants)
    assert copied.columns == plants.columns and copied.defaults == plants.defaults and copied.valves == 6


def test_hosted_plants_go_on_to_the_same_bits(rig, again):
    plants = mckibben.HostedPlant(rig, 3, command_mode="request", pulse_frequency=PULSES, max_step=4e-4)
    commands = numpy.array([[1.0], [0.0], [-1.0]] if rig.valve.kind == "fill-hold-exhaust" else [[1.0], [-1.0], [1.0]])

    def step(which: mckibben.HostedPlant, lengths: numpy.ndarray) -> numpy.ndarray:
        for length in lengths:
            which.step(numpy.full((3, 1), length), commands, STEP)
        return which.observe()

    step(plants, length_series(17))
    copied = again(plants)
    assert copied.count == 3 and copied.commands == plants.commands and copied.scenario == rig and copied.time == plants.time
    numpy.testing.assert_array_equal(copied.save(), plants.save())
    expected = step(plants, length_series(20))
    numpy.testing.assert_array_equal(step(copied, length_series(20)), expected)
    # The clock is no sum of steps, and goes on as that of the other.
    assert copied.time == plants.time
    numpy.testing.assert_array_equal(copied.save(), plants.save())


def test_statics(swing, again):
    statics = mckibben.Statics(swing)
    copied = again(statics)
    assert copied.scenario == swing
    numpy.testing.assert_array_equal(copied.force([0.08, 0.085], 2e5), statics.force([0.08, 0.085], 2e5))


def test_a_response_has_all_of_its_numbers(swing, again):
    actuator = mckibben.Actuator(swing, pulse_frequency=25.0)
    _, _, response = actuator.step(actuator.start(), 0.084, -0.01, None, STEP)
    names = [name for name in dir(response) if not name.startswith("_")]
    assert len(names) == 8
    copied = again(response)
    assert copied == response
    assert [getattr(copied, name) for name in names] == [getattr(response, name) for name in names]
    assert len({getattr(response, name) for name in names}) >= 7, "none stands for another"
    made = mckibben.Response(**{name: getattr(response, name) for name in names})
    assert made == response


def test_what_is_no_state_is_refused(swing):
    state = mckibben.Actuator(swing, pulse_frequency=25.0).start()
    (numbers,) = state.__getnewargs__()
    assert mckibben.ActuatorState(numbers) == state
    for wrong in [numbers[1:], numpy.append(numbers, 0.0), numpy.full_like(numbers, numpy.nan), [], numpy.zeros_like(numbers)]:
        with pytest.raises(mckibben.InputError, match="no state"):
            mckibben.ActuatorState(wrong)
    many = mckibben.Actuators(swing, 2, pulse_frequency=25.0)
    with pytest.raises(mckibben.InputError, match="1 states are given for 2"):
        many.__setstate__(numbers[numpy.newaxis])


def test_scenarios_and_runs(swing, again):
    changed = swing.with_values({"load.mass": "6 lb", "run.duration": "0.5 s"})
    assert again(changed) == changed
    run = mckibben.simulate(changed)
    assert run.events, "the velocity reverses"
    copied = again(run)
    same(run, copied)
    assert copied.scenario == changed and not copied.length.flags.writeable
    assert copied.at(0.0123) == run.at(0.0123), "what lies between the samples is simulated again"
    assert again(run.events[0]) == run.events[0]


def test_models(swing, examples, again):
    model = mckibben.linearize(mckibben.Scenario.from_file(examples / "paper/fig-12.toml"), gauge_pressure="60 psi")
    copied = again(model)
    for name in ["A", "B", "C", "D", "poles"]:
        numpy.testing.assert_array_equal(getattr(copied, name), getattr(model, name))
    for name in ["states", "inputs", "outputs", "units", "operating_point"]:
        assert getattr(copied, name) == getattr(model, name)
    assert copied.to_json() == model.to_json()

    found = mckibben.identify(examples / "identify/tank.toml")
    copied = again(found)
    assert found.estimates and copied.estimates == found.estimates and copied.notes == found.notes
    assert copied.warnings == found.warnings and copied.scenarios == found.scenarios
    assert again(found.estimates[0]) == found.estimates[0]

    length = mckibben.Differentiable(swing, ["load.mass", "initial.gauge_pressure"], ["length", "tension"], [0.02, 0.1])
    copied = again(length)
    assert copied.parameters == length.parameters and copied.quantities == length.quantities and copied.units == length.units
    numpy.testing.assert_array_equal(copied(copied.defaults), length(length.defaults))


def test_sweeps(swing, again, tmp_path):
    todo = mckibben.Sweep(swing.with_values({"sweep.vary": {"load.mass": ["5 lb", "6 lb"]}, "run.duration": "10 ms"}))
    assert again(todo).part(0) == todo.part(0)
    done = mckibben.sweep(todo.scenario, tmp_path)
    assert again(done) == done and again(done).to_polars().equals(done.to_polars())


def test_errors_keep_their_kind_and_words(again):
    with pytest.raises(mckibben.InputError) as raised:
        mckibben.Scenario("[load]\n")
    error = again(raised.value)
    assert type(error) is mckibben.InputError and str(error) == str(raised.value)
