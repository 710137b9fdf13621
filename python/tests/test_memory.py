"""Memory does not grow, however often something is called.

How much is resident depends on the machine: on its pages, its allocator and how many threads it starts. So it is measured once
everything has been called often, and the room that is left is far below what is looked for. Where the system does not say how
much is resident, these tests are skipped and say so.
"""

from __future__ import annotations

import gc
import os
import pathlib

import numpy
import pytest

import mckibben

STATM = pathlib.Path("/proc/self/statm")
#: Bytes by which memory may grow once everything has been called often: a few pages of allocators and threads. Were a number
#: left behind at each of 100 000 calls, it would be 1.6 MB, the least that is allocated being 16 bytes; a state or a tuple
#: are 600 and 60.
ROOM = 1 << 20
SHORT = {"run.duration": "0.1 ms", "run.sample_interval": "0.1 ms"}


def resident() -> int:
    gc.collect()
    return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def step(scenario: mckibben.Scenario):
    actuator = mckibben.Actuator(scenario, pulse_frequency=25.0)
    at = [actuator.start()]
    length = at[0].length

    def call() -> None:
        at[0] = actuator.step(at[0], length, 0.0, None, 1e-6)[0]

    return call


def steps(scenario: mckibben.Scenario):
    many, length, velocity, tension, pressure = mckibben.Actuators(scenario, 3, pulse_frequency=25.0), *numpy.zeros((4, 3))
    length[:] = mckibben.Actuator(scenario, pulse_frequency=25.0).start().length
    return lambda: many.step(length, velocity, None, 1e-6, tension, absolute_pressure=pressure)


def shared_steps(scenario: mckibben.Scenario):
    """Enough to be shared among threads."""
    many, length, velocity, tension = mckibben.Actuators(scenario, 200, pulse_frequency=25.0), *numpy.zeros((3, 200))
    length[:] = mckibben.Actuator(scenario, pulse_frequency=25.0).start().length
    return lambda: many.step(length, velocity, None, 1e-6, tension)


def pickled(scenario: mckibben.Scenario):
    actuator = mckibben.Actuator(scenario, pulse_frequency=25.0)
    state = actuator.start()
    return lambda: mckibben.ActuatorState(*state.__getnewargs__())


def refused(scenario: mckibben.Scenario):
    """A reported mistake: its message goes with the exception."""
    actuator = mckibben.Actuator(scenario, pulse_frequency=25.0)
    state = actuator.start()

    def call() -> None:
        with pytest.raises(mckibben.InputError):
            actuator.step(state, 0.08, 0.0, None, -1.0)

    return call


def run(scenario: mckibben.Scenario):
    short = scenario.with_values(SHORT)
    return lambda: mckibben.simulate(short)


def columns(scenario: mckibben.Scenario):
    """A run with 4 MB of columns, read in every way."""
    long = scenario.with_values({"run.sample_interval": "2 us"})

    def call() -> None:
        run = mckibben.simulate(long)
        run.at(0.01), run.events, run.to_dict(), run.at_times(run.t[:100])
        with pytest.raises(mckibben.InputError):
            run.at(-1.0)

    return call


def values(scenario: mckibben.Scenario):
    return lambda: scenario.with_values({"load.mass": "6 lb"})


def called(scenario: mckibben.Scenario):
    short = scenario.with_values(SHORT)
    length = mckibben.Differentiable(short, ["load.mass"], ["length"], [1e-4])
    return lambda: length(length.defaults)


@pytest.mark.skipif(not STATM.exists(), reason="Linux says how much memory is resident")
@pytest.mark.parametrize("what, count", [
    (step, 100_000), (steps, 100_000), (shared_steps, 20_000), (pickled, 100_000), (refused, 100_000), (run, 20_000),
    (columns, 40), (values, 100_000), (called, 100_000),
])
def test_memory_does_not_grow(what, count, swing):
    call = what(swing)
    # As often as it takes for the allocator to have its pools and for what is made once to be there.
    for _ in range(count // 4):
        call()
    before = resident()
    for _ in range(count):
        call()
    assert resident() - before < ROOM
