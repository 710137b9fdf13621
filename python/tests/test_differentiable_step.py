"""The Jacobian of a step of an actuator: against closed forms, and of many steps against differences."""

from __future__ import annotations

import pickle

import jax
import numpy
import pytest

import mckibben

jax.config.update("jax_enable_x64", True)

SEALED = {
    "air": {"process": "isentropic"},
    "load": {"kind": "isometric"},
    "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
    "run": {"duration": "1 s"},
}
PULSED = SEALED | {
    "supply": {"gauge_pressure": "100 psi"},
    "valve": {"preset": "matrix-eight-channel"},
    "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.4},
}
STEP = 1e-3


@pytest.fixture(scope="module")
def sealed() -> mckibben.Actuator:
    return mckibben.Actuator(mckibben.Scenario.from_dict(SEALED))


@pytest.fixture(scope="module")
def pulsed() -> mckibben.Actuator:
    return mckibben.Actuator(mckibben.Scenario.from_dict(PULSED))


def test_closed_air_follows_the_isentropic_law(sealed):
    """P V^k stays, with V(L) = L (b² - L²)/(4 π n²): the derivatives of the pressure are those of P₀ (V₀/V)^k."""
    step = mckibben.DifferentiableStep(sealed, STEP, max_step=2e-5)
    start, length = sealed.start(), 0.0852
    values, jacobian = step.value_and_jacobian(step.pack(start, length, 0.2))
    actuator, exponent = sealed.scenario.actuator, sealed.scenario.air.heat_capacity_ratio
    thread, around = actuator.thread_length, 4.0 * numpy.pi * actuator.turns**2

    def volume(at):
        return at * (thread**2 - at**2) / around + actuator.external_volume

    def rate(at):
        return (thread**2 - 3.0 * at**2) / around

    ratio = (volume(start.length) / volume(length)) ** exponent
    pressure = start.absolute_pressure * ratio
    row = jacobian[step.outputs.index("state.absolute_pressure")]
    found = {name: row[step.inputs.index(name)] for name in step.inputs}
    assert values[step.outputs.index("state.absolute_pressure")] == pytest.approx(pressure, rel=1e-8)
    assert found["state.absolute_pressure"] == pytest.approx(ratio, rel=1e-7)
    assert found["length"] == pytest.approx(-exponent * pressure * rate(length) / volume(length), rel=1e-6)
    assert found["state.length"] == pytest.approx(exponent * pressure * rate(start.length) / volume(start.length), rel=1e-6)
    assert found["velocity"] == 0.0 and "command" not in found
    # The air is shut in, and its mass is that of before.
    mass = jacobian[step.outputs.index("state.air_mass")]
    assert mass[step.inputs.index("state.air_mass")] == pytest.approx(1.0, rel=1e-12) and mass[step.inputs.index("length")] == 0.0


def test_the_tension_follows_length_pressure_and_velocity(sealed):
    """By the chain rule from the partial derivatives that `Actuator.step` gives."""
    step = mckibben.DifferentiableStep(sealed, STEP)
    inputs = step.pack(sealed.start(), 0.0852, 0.2)
    values, jacobian = step.value_and_jacobian(inputs)
    state, tension, response = sealed.step(sealed.start(), 0.0852, 0.2, None, STEP)
    assert step.unpack(values) == (state, tension)
    numpy.testing.assert_array_equal(step(inputs), values)
    pressure = jacobian[step.outputs.index("state.absolute_pressure")]
    at = step.inputs.index
    expected = response.per_length + response.per_pressure * pressure[at("length")]
    assert jacobian[-1, at("length")] == pytest.approx(expected, rel=1e-9)
    assert jacobian[-1, at("velocity")] == pytest.approx(response.per_velocity, rel=1e-9)


def test_jacobians_of_many_steps_multiply(pulsed):
    """Through pulses whose edges move with the duty cycle: against central differences of 120 steps, at whose ends no edge lies."""
    step = mckibben.DifferentiableStep(pulsed, 0.7e-3)
    times = 0.7e-3 * numpy.arange(1, 121)
    lengths, velocities = 0.085 + 0.002 * numpy.sin(20.0 * times), 0.04 * numpy.cos(20.0 * times)
    pressure = step.inputs.index("state.absolute_pressure")
    places = [pressure, step.inputs.index("state.air_mass")]

    def end(duty: float, state) -> numpy.ndarray:
        for length, velocity in zip(lengths, velocities):
            outputs = step(numpy.concatenate([state, [length, velocity, duty]]))
            state = outputs[:-1]
        return outputs[[*places, -1]]

    start = step.pack(pulsed.start(), 0.085, 0.0)[:-3]
    count = len(start)
    state, by_state, by_duty = start, numpy.eye(count), numpy.zeros(count)
    for length, velocity in zip(lengths, velocities):
        outputs, jacobian = step.value_and_jacobian(numpy.concatenate([state, [length, velocity, 0.4]]))
        tension = jacobian[-1, :count] @ by_duty + jacobian[-1, -1]
        by_duty = jacobian[:-1, :count] @ by_duty + jacobian[:-1, -1]
        by_state = jacobian[:-1, :count] @ by_state
        state = outputs[:-1]
    difference = (end(0.4 + 1e-5, start) - end(0.4 - 1e-5, start)) / 2e-5
    numpy.testing.assert_allclose([*by_duty[places], tension], difference, rtol=1e-6)
    assert by_duty[pressure] > 1e5, "more air for a longer pulse"
    nudge = 1e-5 * start[pressure] * (numpy.arange(count) == pressure)
    difference = (end(0.4, start + nudge) - end(0.4, start - nudge)) / (2e-5 * start[pressure])
    numpy.testing.assert_allclose(by_state[places, pressure], difference[:2], rtol=1e-6)


@pytest.mark.parametrize(
    ("file", "command"),
    [
        ("friction/maxwell-slip", None),
        ("line/hanging-mass", 0.4),
        ("valves/proportional-spool", 0.4),
        ("valves/pressure-regulator", 3e5),
    ],
)
def test_every_input_is_differentiated_by(file, command, examples):
    """Hysteresis, hoses, spools and regulators: against central differences of a step within a motion."""
    scenario = mckibben.Scenario.from_file(examples / f"{file}.toml")
    muscle = mckibben.Actuator(scenario, pulse_frequency=25.0)
    step = mckibben.DifferentiableStep(muscle, STEP, max_step=2e-4)
    length, state = muscle.initial_length, muscle.start()
    for _ in range(20):
        length += 1e-5
        state, _, _ = muscle.step(state, length, 0.01, command, STEP)
    inputs = step.pack(state, length + 1e-5, 0.01, command or 0.0)
    _, jacobian = step.value_and_jacobian(inputs)
    names = ["state.absolute_pressure", "state.air_mass", "length", "velocity", "command"]
    for name in names if command is not None else names[:-1]:
        place = step.inputs.index(name)
        nudge = 1e-6 * inputs[place] * (numpy.arange(len(inputs)) == place)
        above, below = step(inputs + nudge), step(inputs - nudge)
        # An instant that does not come is infinite.
        finite = numpy.isfinite(above) & numpy.isfinite(below)
        difference = (above[finite] - below[finite]) / (2 * nudge[place])
        scale = numpy.maximum(abs(difference), abs(above[finite] / inputs[place]))
        assert (abs(jacobian[finite, place] - difference) <= 1e-4 * scale).all(), name
        assert (jacobian[~finite, place] == 0.0).all()


def test_jax_and_batches(pulsed):
    step = mckibben.DifferentiableStep(pulsed, STEP)
    inputs = step.pack(pulsed.start(), 0.0851, 0.1, 0.4)
    function = step.for_jax()
    values, jacobian = step.value_and_jacobian(inputs)
    numpy.testing.assert_array_equal(jax.jit(function)(inputs), values)
    numpy.testing.assert_allclose(jax.jacfwd(function)(inputs), jacobian, rtol=1e-14)
    numpy.testing.assert_allclose(jax.jacrev(function)(inputs), jacobian, rtol=1e-14)
    several = numpy.stack([inputs, inputs])
    numpy.testing.assert_array_equal(jax.vmap(function)(several)[1], values)


def test_torch(pulsed):
    torch = pytest.importorskip("torch")
    step = mckibben.DifferentiableStep(pulsed, STEP)
    inputs = torch.from_numpy(step.pack(pulsed.start(), 0.0851, 0.1, 0.4)).requires_grad_()
    step.for_torch()(inputs)[-1].backward()
    _, jacobian = step.value_and_jacobian(inputs.detach().numpy())
    numpy.testing.assert_allclose(inputs.grad.numpy(), jacobian[-1], rtol=1e-14)


def test_what_cannot_be_is_refused(pulsed, sealed):
    step = mckibben.DifferentiableStep(pulsed, STEP)
    inputs = step.pack(pulsed.start(), 0.0851, 0.1, 0.4)
    for place, wrong, words in [(-1, 1.5, "duty cycle"), (-2, 1e9, "velocity"), (-3, 0.5, "longer than"), (0, -1.0, "no state")]:
        values = inputs.copy()
        values[place] = wrong
        with pytest.raises(mckibben.Error, match=words):
            step.value_and_jacobian(values)
    with pytest.raises(mckibben.InputError, match="values were given for"):
        step(inputs[1:])
    with pytest.raises(mckibben.InputError, match="another actuator"):
        step.pack(sealed.start(), 0.085, 0.0)
    with pytest.raises(mckibben.InputError, match="dt = 0"):
        mckibben.DifferentiableStep(pulsed, 0.0)
    again = pickle.loads(pickle.dumps(step))
    assert again.inputs == step.inputs and again.dt == STEP
    numpy.testing.assert_array_equal(again(inputs), step(inputs))


SPOOL = {
    "valve": {"kind": "proportional-spool", "flow_area": "0.3 mm^2", "spool": {"natural_frequency": "50 Hz", "damping_ratio": 0.7}},
    "command": {"kind": "positions", "time": ["0 s"], "position": [0.02]},
}
REGULATOR = {
    "valve": {"kind": "pressure-regulator", "flow_area": "0.3 mm^2", "time_constant": "20 ms", "rate_limit": "500 bar/s"},
    "command": {"kind": "set-points", "time": ["0 s"], "gauge_pressure": ["2 bar"]},
}


@pytest.mark.parametrize("dead_time", [0.0, 1e-3, 5e-3])
@pytest.mark.parametrize(("of_valve", "command"), [(SPOOL, 0.5), (REGULATOR, 2.5e5)])
def test_a_command_that_stays_equal_is_one_in_each_step(of_valve, command, dead_time):
    """With respect to all commands together and to each alone: against central differences of motions by `Actuator.step`."""
    scenario = mckibben.Scenario.from_dict(SEALED | {"supply": {"gauge_pressure": "5 bar"}} | of_valve)
    muscle = mckibben.Actuator(scenario.with_values({"valve.dead_time": dead_time, "initial.gauge_pressure": "2 bar"}))
    step, length, steps = mckibben.DifferentiableStep(muscle, STEP), muscle.initial_length, 12
    pressure, count = step.outputs.index("state.absolute_pressure"), len(step.outputs) - 1
    state, by_each = muscle.start(), numpy.zeros((count, steps))
    for at in range(steps):
        outputs, jacobian = step.value_and_jacobian(step.pack(state, length, 0.0, command))
        by_each = jacobian[:-1, :count] @ by_each
        by_each[:, at] += jacobian[:-1, -1]
        state, _ = step.unpack(outputs)

    def end(commands) -> float:
        state = muscle.start()
        for its in commands:
            state, _, _ = muscle.step(state, length, 0.0, its, STEP)
        return state.absolute_pressure

    # A dead time of whole steps: a command that is given again divides no step, so both take equal steps.
    assert state.absolute_pressure == pytest.approx(end(numpy.full(steps, command)), rel=1e-12)
    nudge = 1e-6 * command
    for name, along in [("all", numpy.ones(steps)), ("the second", numpy.eye(steps)[1]), ("a late one", numpy.eye(steps)[5])]:
        difference = (end(command + nudge * along) - end(command - nudge * along)) / (2 * nudge)
        assert difference > 0.0
        assert by_each[pressure] @ along == pytest.approx(difference, rel=1e-5), name
