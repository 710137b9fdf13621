"""The modular actuator in a loop of Python's own, one by one and many together."""

from __future__ import annotations

import pickle

import numpy
import pytest

import mckibben

STEP = 1e-3


@pytest.fixture(scope="module")
def scenario(examples):
    return mckibben.Scenario.from_file(examples / "paper/fig-12.toml")


@pytest.fixture(params=["paper/fig-12", "line/hanging-mass", "valves/opening-ramp", "laws/map", "energy-balance"])
def any_scenario(request, examples):
    return mckibben.Scenario.from_file(examples / f"{request.param}.toml")


def moved_and_given(scenario, step: float) -> float:
    """The largest relative difference in pressure of an actuator whose ends are moved from the run along that table."""
    rows = round(0.06 / step)
    times = numpy.arange(rows + 1) * step
    lengths = 0.09 - 0.004 * numpy.sin(40.0 * times)
    moved = scenario.with_values({
        "load": {"kind": "prescribed-motion", "time": [f"{t!r} s" for t in times.tolist()],
                 "table_length": [f"{length!r} m" for length in lengths.tolist()]},
        "initial": {"gauge_pressure": "20 psi"},
        "run": {"duration": "60 ms", "sample_interval": f"{step!r} s", "engine": "fixed-step", "step": f"{step!r} s"},
    })
    run = mckibben.simulate(moved)
    actuator = mckibben.Actuator(moved)
    state, duty, worst = actuator.start(), 0.5, 0.0
    for row in range(1, rows + 1):
        velocity = (lengths[row] - lengths[row - 1]) / step
        command = duty if row == 1 else None
        state, tension, response = actuator.step(state, lengths[row], velocity, command, step)
        assert state.time == pytest.approx(times[row], rel=1e-12)
        assert state.valve == run.valve[row]
        assert tension == response.tension
        worst = max(worst, abs(state.absolute_pressure / run.absolute_pressure[row] - 1.0))
    return worst


def test_a_motion_that_is_given_is_the_run_of_that_motion(scenario):
    """The ends moved as a table says come to the fixed-step run along that table."""
    for step in (STEP, STEP / 2.0, STEP / 4.0):
        assert moved_and_given(scenario, step) < 1e-12


def test_two_open_ports_have_the_word_of_the_column():
    """The poppet to the supply closes 4 ms after the one to the atmosphere has opened."""
    scenario = mckibben.Scenario.from_dict({
        "supply": {"gauge_pressure": "4 bar"},
        "valve": {"kind": "fill-hold-exhaust", "flow_area": "1 mm^2", "opening_delay": "1 ms", "closing_delay": "5 ms"},
        "command": {"kind": "table", "time": ["0 s", "20 ms"], "state": ["fill", "exhaust"]},
        "load": {"kind": "isometric"},
        "initial": {"length": "85 mm"},
        "run": {"duration": "23 ms"},
    })
    actuator = mckibben.Actuator(scenario, pulse_frequency=25.0)
    filled, *_ = actuator.step(actuator.start(), 0.085, 0.0, "fill", 0.02)
    state, *_ = actuator.step(filled, 0.085, 0.0, "exhaust", 0.003)
    assert state.valve == mckibben.simulate(scenario).valve[-1] == "supply+exhaust"


def test_derivatives_are_those_of_the_tension(any_scenario):
    actuator = mckibben.Actuator(any_scenario, pulse_frequency=25.0)
    state = actuator.start()
    length = state.length
    for _ in range(20):
        state, _, response = actuator.step(state, length, 0.01, 0.7, STEP)

    def tension(velocity: float) -> float:
        return actuator.step(state, length, velocity, None, 1e-9)[1]

    small = 1e-6
    slope = (tension(0.01 + small) - tension(0.01 - small)) / (2.0 * small)
    assert response.per_velocity == pytest.approx(slope, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize(
    ("example", "commanded"),
    [("tendon", 0.5), ("valves/pressure-regulator", 2e5), ("valves/proportional-spool", 0.4)],
)
def test_a_number_is_a_command_of_the_kind_of_valve(examples, example, commanded):
    """A duty cycle with a tendon, the set point of a regulator, the position of a spool: alone and together."""
    scenario = mckibben.Scenario.from_file(examples / f"{example}.toml")
    one, many = mckibben.Actuator(scenario, pulse_frequency=25.0), mckibben.Actuators(scenario, 3, pulse_frequency=25.0)
    state = one.start()
    first, filled, tension = state.length, state.absolute_pressure, numpy.zeros(3)
    for _ in range(500):
        state, alone, response = one.step(state, first, 0.0, commanded, STEP)
        many.step(numpy.full(3, first), numpy.zeros(3), numpy.full(3, commanded), STEP, tension)
        numpy.testing.assert_array_equal(tension, alone)
    if example == "tendon":
        # A tendon of 16 kN/m in series: the tension follows its distance alone while the muscle has not moved.
        assert response.per_length == 16_000.0
    elif example == "valves/pressure-regulator":
        assert state.absolute_pressure - 101_325.0 == pytest.approx(commanded, rel=1e-3)
    else:
        assert state.absolute_pressure > 1.5 * filled
    with pytest.raises(mckibben.InputError):
        one.step(state, first, 0.0, -3.0, STEP)


def test_a_step_can_be_taken_again(any_scenario):
    actuator = mckibben.Actuator(any_scenario, pulse_frequency=25.0)
    state = actuator.start()
    for row in range(30):
        other = actuator.step(state, state.length - 1e-4, -0.1, "fill", STEP)
        state, tension, response = actuator.step(state, state.length - 2e-5, -0.02, 0.4, STEP)
    again = actuator.step(state, state.length, 0.0, None, STEP)
    once = pickle.loads(pickle.dumps(actuator)).step(state, state.length, 0.0, None, STEP)
    assert again[1] == once[1] and again[0].absolute_pressure == once[0].absolute_pressure
    assert other[1] != tension


def test_many_together_are_each_by_itself(any_scenario):
    count, steps = 300, 25
    random = numpy.random.default_rng(7)
    one = mckibben.Actuator(any_scenario, pulse_frequency=25.0)
    many = mckibben.Actuators(any_scenario, count, pulse_frequency=25.0)
    assert len(many) == count
    first = one.start().length
    length, velocity = numpy.full(count, first), numpy.zeros(count)
    duty = random.uniform(0.0, 1.0, count)
    tension, per_length, per_velocity, pressure = numpy.zeros((4, count))
    all_lengths = first + numpy.cumsum(random.uniform(-4e-5, 3e-5, (steps, count)), axis=0)
    for lengths_now in all_lengths:
        numpy.subtract(lengths_now, length, out=velocity)
        velocity /= STEP
        length[:] = lengths_now
        many.step(length, velocity, duty, STEP, tension, per_length=per_length, per_velocity=per_velocity,
                  absolute_pressure=pressure)
    for row in [0, 1, 150, 299]:
        state, before = one.start(), first
        for lengths_now in all_lengths:
            state, pull, response = one.step(state, lengths_now[row], (lengths_now[row] - before) / STEP, duty[row], STEP)
            before = lengths_now[row]
        assert (pull, response.per_length, response.per_velocity, state.absolute_pressure) == (
            tension[row], per_length[row], per_velocity[row], pressure[row]
        )
    many.reset()
    ended = tension.copy()
    for row, lengths_now in enumerate(all_lengths):
        velocity[:] = (lengths_now - (all_lengths[row - 1] if row else first)) / STEP
        many.step(lengths_now, velocity, duty, STEP, tension)
    numpy.testing.assert_array_equal(tension, ended)


def test_invalid_commands_are_refused(scenario):
    actuator = mckibben.Actuator(scenario)
    state = actuator.start()
    for command, words in [(1.5, "duty"), (-0.1, "duty"), (float("nan"), "duty"), ("hold", "cannot hold"), ("open", "fill")]:
        with pytest.raises(mckibben.InputError, match=words):
            actuator.step(state, 0.09, 0.0, command, STEP)
    with pytest.raises(mckibben.InputError, match="no step in time"):
        actuator.step(state, 0.09, 0.0, 0.5, 0.0)
    with pytest.raises(mckibben.SimulationError, match="longer than its thread of 109.8 mm"):
        actuator.step(state, 0.2, 0.0, 0.5, STEP)
    with pytest.raises(mckibben.InputError, match="pulse_frequency"):
        mckibben.Actuator(scenario.with_values({"command": {"kind": "fill"}}))
    sealed = mckibben.Scenario('[load]\nkind = "isometric"\n[initial]\nlength = "85 mm"\n[run]\nduration = "1 s"\n')
    actuator = mckibben.Actuator(sealed)
    with pytest.raises(mckibben.InputError, match="has none"):
        actuator.step(actuator.start(), 0.085, 0.0, 0.5, STEP)
    actuator.step(actuator.start(), 0.085, 0.0, None, STEP)


def test_arrays_that_do_not_fit_are_refused_and_change_nothing(scenario):
    many = mckibben.Actuators(scenario, 4)
    length, velocity, duty, tension = numpy.full(4, 0.09), numpy.zeros(4), numpy.full(4, 0.5), numpy.full(4, -1.0)
    for arguments, error, words in [
        ((length[:3], velocity, duty, STEP, tension), mckibben.InputError, "length has 3 entries for 4"),
        ((length, velocity, duty, STEP, numpy.zeros(8)[::2]), mckibben.InputError,
         "`tension` is not C-contiguous"),
        ((length, velocity, numpy.array([0.5, 0.5, 1.5, 0.5]), STEP, tension), mckibben.InputError, "actuator 2.*command"),
        ((length, velocity, duty, STEP, numpy.zeros(4, dtype=numpy.float32)), TypeError, None),
    ]:
        with pytest.raises(error, match=words):
            many.step(*arguments)
    assert (tension == -1.0).all()
    length[1] = 0.2
    with pytest.raises(mckibben.SimulationError, match="actuator 1"):
        many.step(length, velocity, duty, STEP, tension)
    assert tension[1] == -1.0 and (tension[[0, 2, 3]] >= 0.0).all()
    # Its ends have stayed, and its valve went on with the others'.
    length[1] = 0.09
    many.step(length, velocity, duty, STEP, tension)
    assert tension[1] >= 0.0


def test_an_actuator_that_leaves_the_physics_stops_until_all_are_reset(examples):
    """A tendon that is drawn by ten metres pulls the braid of one straight."""
    scenario = mckibben.Scenario.from_file(examples / "tendon.toml")
    many, fresh = [mckibben.Actuators(scenario, 3, pulse_frequency=25.0) for _ in range(2)]
    length, velocity, duty, tension = numpy.full(3, 0.19), numpy.zeros(3), numpy.full(3, 0.5), numpy.full(3, -1.0)
    many.step(length, velocity, duty, STEP, tension)
    before = tension.copy()
    length[1] = 10.0
    with pytest.raises(mckibben.SimulationError, match="actuator 1.*pulled a braid straight"):
        many.step(length, velocity, duty, STEP, tension)
    length[1] = 0.19
    with pytest.raises(mckibben.SimulationError, match="actuator 1.*pulled a braid straight"):
        many.step(length, velocity, duty, STEP, tension)
    assert tension[1] == before[1] and (tension != before)[[0, 2]].all()
    with pytest.raises(mckibben.SimulationError, match="actuator 1"):
        many.__getstate__()
    many.reset()
    again, found = numpy.zeros(3), numpy.zeros(3)
    for _ in range(10):
        many.step(length, velocity, duty, STEP, again)
        fresh.step(length, velocity, duty, STEP, found)
    numpy.testing.assert_array_equal(again, found)


def test_the_actuators_of_a_joint_are_taken_by_name(examples):
    joint = mckibben.Scenario.from_file(examples / "antagonistic-joint.toml")
    run = mckibben.simulate(joint.with_values({"run.duration": "1 ms"}))
    for name, prefix in [("agonist", ""), ("antagonist", "antagonist_")]:
        actuator = mckibben.Actuator(joint, name, pulse_frequency=25.0)
        assert actuator.initial_length == pytest.approx(run[f"{prefix}length_m"][0], rel=1e-12)
        assert actuator.initial_tension == pytest.approx(run[f"{prefix}tension_n"][0], rel=1e-9)
        assert actuator.start().absolute_pressure == pytest.approx(run[f"{prefix}absolute_pressure_pa"][0], rel=1e-12)
        assert len(mckibben.Actuators(joint, 2, name, pulse_frequency=25.0)) == 2
    with pytest.raises(mckibben.InputError, match='(?s)`name` is missing.*name="agonist" or name="antagonist"'):
        mckibben.Actuator(joint)
    with pytest.raises(mckibben.InputError, match='name "agonist" or "antagonist"'):
        mckibben.Actuator(joint, "biceps")
    with pytest.raises(mckibben.InputError, match="no actuator `agonist`"):
        mckibben.Actuator(mckibben.Scenario.from_file(examples / "paper/fig-12.toml"), "agonist")
    with pytest.raises(mckibben.InputError, match="VectorPlant"):
        mckibben.Actuator(mckibben.Scenario.from_file(examples / "plant/arm.toml"), "biceps")


def test_each_actuator_has_separate_parameters(scenario):
    parameters = ["actuator.turns", "valve.efficiency", "initial.gauge_pressure"]
    values = numpy.array([[2.4, 0.8, 1e5], [2.5, 0.85, 2e5], [2.6, 0.9, 0.0]])
    many = mckibben.Actuators(scenario, 3, parameters=parameters, values=values)
    copied = pickle.loads(pickle.dumps(many))
    assert many.parameters == parameters
    tension, again, duty = numpy.zeros(3), numpy.zeros(3), numpy.full(3, 0.6)
    for _ in range(40):
        many.step(numpy.full(3, 0.085), numpy.zeros(3), duty, STEP, tension)
        copied.step(numpy.full(3, 0.085), numpy.zeros(3), duty, STEP, again)
    numpy.testing.assert_array_equal(tension, again)
    for row, of in enumerate(values):
        actuator = mckibben.Actuator(scenario.with_values(dict(zip(parameters, of.tolist()))))
        state = actuator.start()
        for _ in range(40):
            state, alone, _ = actuator.step(state, 0.085, 0.0, 0.6, STEP)
        assert alone == tension[row], row
    with pytest.raises(mckibben.InputError, match="2 values are given for 3 actuators with 1 parameters"):
        mckibben.Actuators(scenario, 3, parameters=["actuator.turns"], values=numpy.ones((2, 1)))
    with pytest.raises(mckibben.InputError, match="actuator 1: .*turns"):
        mckibben.Actuators(scenario, 2, parameters=["actuator.turns"], values=numpy.array([[2.5], [-1.0]]))


def test_a_rest_length_without_a_pressure_is_that_of_the_start(examples):
    scenario = mckibben.Scenario.from_file(examples / "laws/bladder.toml")
    filled = mckibben.Actuator(scenario.with_values({"initial.gauge_pressure": 2e5}), pulse_frequency=25.0)
    assert filled.rest_length() == filled.rest_length(2e5) != filled.rest_length(1e5)


@pytest.mark.parametrize(("step", "pulse_frequency", "pulses"), [(1 / 30, 30.0, 600), (1e-3, 25.0, 140)])
def test_a_duty_set_where_a_pulse_begins_is_that_of_the_pulse(scenario, step, pulse_frequency, pulses):
    """Each pulse of duty one raises the pressure and each of duty zero lowers it, also after many steps.

    Summed steps of 1/30 s come after the begin of a pulse of 30 Hz from step 529 on, those of 1 ms after one of 25 Hz from step 5040.
    """
    actuator = mckibben.Actuator(scenario, pulse_frequency=pulse_frequency)
    many = mckibben.Actuators(scenario, 1, pulse_frequency=pulse_frequency)
    count, length = round(1 / (pulse_frequency * step)), actuator.initial_length
    state, velocity, tension, pressure = actuator.start(), numpy.zeros(1), numpy.zeros(1), numpy.zeros(1)
    many.respond(velocity, tension, absolute_pressure=pressure)
    for pulse in range(pulses):
        duty = 1.0 - pulse % 2
        before, before_many = state.absolute_pressure, pressure[0]
        for _ in range(count):
            state, _, _ = actuator.step(state, length, 0.0, duty, step)
            many.step(numpy.array([length]), velocity, numpy.array([duty]), step, tension, absolute_pressure=pressure)
        assert (state.absolute_pressure > before) == (duty == 1.0), pulse
        assert (pressure[0] > before_many) == (duty == 1.0), pulse
    assert state.time == pytest.approx(pulses / pulse_frequency, rel=1e-15)
    # A state that has been kept goes on at the times of the one that went on.
    kept, _, _ = actuator.step(pickle.loads(pickle.dumps(state)), length, 0.0, 1.0, step)
    assert kept == actuator.step(state, length, 0.0, 1.0, step)[0]
