"""Loops of a host's own: what a long step errs by, what dividing it gives back, and in which order to call."""

from __future__ import annotations

import re

import numpy
import pytest

import mckibben
from conftest import ROOT

#: Rows of the table in docs/python.md: the step, the largest error of the pressure in whole steps, and with max_step.
ROW = re.compile(r"^\| ([\d.]+) ms \| ([\d.]+) kPa \| ([\d.]+) kPa \|$", re.MULTILINE)
MAX_STEP = 2e-4
FINEST = 1e-5
#: Corners of the line along which the ends are moved, so that all steps of the table move them along the same.
CORNER = 0.02
LENGTHS = [0.09, 0.088, 0.085, 0.082, 0.081, 0.083, 0.086, 0.0895, 0.091, 0.088, 0.084]


@pytest.fixture(scope="module")
def scenario(examples) -> mckibben.Scenario:
    return mckibben.Scenario.from_file(examples / "paper/fig-12.toml").with_values({"initial.length": "90 mm"})


def moved(scenario: mckibben.Scenario, dt: float, max_step: float | None = None) -> numpy.ndarray:
    """Pressures at the end of each step along the line, at half duty."""
    actuator = mckibben.Actuator(scenario)
    state, pressures = actuator.start(), []
    for begin, end in zip(LENGTHS, LENGTHS[1:]):
        steps, velocity = round(CORNER / dt), (end - begin) / CORNER
        for step in range(1, steps + 1):
            state, _, _ = actuator.step(state, begin + (end - begin) * step / steps, velocity, 0.5, dt, max_step=max_step)
            pressures.append(state.absolute_pressure)
    return numpy.array(pressures)


@pytest.fixture(scope="module")
def exact(scenario) -> numpy.ndarray:
    """Pressures at the end of each of the finest steps."""
    return moved(scenario, FINEST)


def at_steps(exact: numpy.ndarray, dt: float) -> numpy.ndarray:
    """Those of them at the ends of longer steps."""
    each = round(dt / FINEST)
    return exact[each - 1 :: each]


def test_the_table_of_errors_holds(scenario, exact):
    """Each number of the table is what is measured against steps of 10 us, to the digits that are printed."""
    page = (ROOT / "docs" / "python.md").read_text()
    rows = ROW.findall(page)
    corners = re.search(r"its ends are ([\d., ]+) and ([\d.]+) mm apart", page)
    pressures = re.search(r"After the first 20 ms the absolute pressure is (\d+) to (\d+) kPa", page)
    assert corners is not None and pressures is not None
    assert [1e-3 * float(end) for end in [*corners[1].split(", "), corners[2]]] == pytest.approx(LENGTHS)
    later = 1e-3 * exact[round(CORNER / FINEST) :]
    assert [later.min(), later.max()] == pytest.approx([float(end) for end in pressures.groups()], abs=0.6)
    assert [float(dt) for dt, _, _ in rows] == [0.5, 1.0, 2.0, 5.0, 10.0]
    for dt, whole, divided in rows:
        for written, max_step in [(whole, None), (divided, MAX_STEP)]:
            step = 1e-3 * float(dt)
            error = 1e-3 * abs(moved(scenario, step, max_step) - at_steps(exact, step)).max()
            digits = len(written.partition(".")[2])
            assert error == pytest.approx(float(written), abs=0.6 * 10.0**-digits), (dt, max_step)


def test_a_divided_step_is_as_many_steps_along_the_same_line(scenario, exact):
    """By the state's own pressures: in parts of the finest step it is the reference, to rounding."""
    numpy.testing.assert_allclose(moved(scenario, 0.01, FINEST), at_steps(exact, 0.01), rtol=1e-9)
    # A limit that is longer than the step leaves it as it is, to the bit.
    numpy.testing.assert_array_equal(moved(scenario, 2e-3, 1.0), moved(scenario, 2e-3))


def test_many_are_divided_as_one_is(scenario):
    one, many = mckibben.Actuator(scenario), mckibben.Actuators(scenario, 200)
    state, tension, pressure = one.start(), numpy.zeros(200), numpy.zeros(200)
    duty = numpy.linspace(0.0, 1.0, 200)
    for length in LENGTHS:
        velocity = numpy.full(200, -0.01)
        many.step(numpy.full(200, length), velocity, duty, 0.01, tension, absolute_pressure=pressure, max_step=MAX_STEP)
        state, pull, _ = one.step(state, length, -0.01, duty[77], 0.01, max_step=MAX_STEP)
        assert (pull, state.absolute_pressure) == (tension[77], pressure[77])


def hang(scenario: mckibben.Scenario, duration: float, dt: float, is_late: bool, max_step: float | None) -> numpy.ndarray:
    """Lengths of a mass of 5 lb on the taut muscle, lifted by 0.1 mm at first, by a host that steps as the
    simplest do; where it is late, `step` receives the ends as they were before the host's step."""
    muscle = mckibben.Actuator(scenario)
    state, velocity, mass = muscle.start(), 0.0, 5 * 0.45359237
    length, tension = state.length - 1e-4, muscle.respond(state).tension
    lengths = []
    for _ in range(round(duration / dt)):
        before = length, velocity
        velocity += (9.80665 - tension / mass) * dt
        length += velocity * dt
        there = before if is_late else (length, velocity)
        state, tension, _ = muscle.step(state, *there, "exhaust", dt, max_step=max_step)
        lengths.append(length)
    return numpy.array(lengths)


@pytest.mark.parametrize("dt, swing", [(1e-3, 3e-3), (2e-3, 20e-3)])
@pytest.mark.parametrize("max_step", [None, MAX_STEP])
def test_a_force_that_lags_by_a_step_is_unstable_on_the_taut_braid(dt, swing, max_step, examples):
    """What docs/python.md says of the order: in the right one a weight comes to rest, a step late it never does."""
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    right, late = hang(scenario, 1.0, dt, False, max_step), hang(scenario, 0.25, dt, True, max_step)
    assert numpy.ptp(right[right.size // 2:]) < 1e-8
    assert numpy.ptp(late) > swing


def test_a_loop_begins_with_the_tension_of_its_state(scenario):
    """The tension of the state is that of a step that goes on from there for no time to speak of."""
    full = scenario.with_values({"initial.gauge_pressure": "40 psi"})
    actuator, many = mckibben.Actuator(full), mckibben.Actuators(full, 150)
    state = actuator.start()
    response = actuator.respond(state)
    _, tension, _ = actuator.step(state, state.length, 0.0, None, 1e-12)
    assert response.tension == pytest.approx(tension, rel=1e-9) and tension > 10.0
    assert actuator.respond(state, 0.1).tension == pytest.approx(tension + 0.1 * response.per_velocity, rel=0.2)
    assert actuator.respond(state, 0.1) != response
    velocity, found, per_length, pressure = numpy.linspace(-0.1, 0.1, 150), *numpy.zeros((3, 150))
    before = many.__getstate__()
    many.respond(velocity, found, per_length=per_length, absolute_pressure=pressure)
    numpy.testing.assert_array_equal(many.__getstate__(), before)
    for row in [0, 74, 149]:
        alone = actuator.respond(state, velocity[row])
        assert (alone.tension, alone.per_length, state.absolute_pressure) == (found[row], per_length[row], pressure[row])


@pytest.mark.parametrize("example", ["paper/fig-12", "laws/bladder", "laws/map", "laws/tondu-lopez", "laws/polynomial"])
@pytest.mark.parametrize("gauge_pressure", [5e4, 2e5, 4e5])
def test_at_its_rest_length_it_pulls_nothing_and_beyond_it_pulls(example, gauge_pressure, examples):
    """By the curves of the same actuator, which know nothing of rest lengths."""
    scenario = mckibben.Scenario.from_file(examples / f"{example}.toml")
    rest = mckibben.Actuator(scenario, pulse_frequency=25.0).rest_length(gauge_pressure)
    curves = mckibben.curves(scenario, f"{gauge_pressure} Pa")
    length, force = curves["length_m"][0], curves["force_n"][0]
    assert length[0] - 1e-12 <= rest <= length[-1]
    # Below it the law pushes, which a tendon cannot; above it the law pulls. At the shortest length it may pull already.
    assert (force[length < rest - 1e-6] <= 1e-6).all() and (force[length > rest + 1e-4] > 0.0).all()


def test_the_rest_length_of_a_braid_is_where_its_angle_neither_pulls_nor_pushes(scenario):
    """At `thread / sqrt(3)`, unless its shortest length is longer."""
    numbers = {key: float(text.split()[0]) for key, text in scenario.to_dict()["actuator"].items() if key.endswith("_length")}
    thread, longest = numbers["thread_length"], numbers["max_length"]
    shorter = mckibben.Actuator(scenario.with_values({"actuator.min_length": f"{0.9 * thread / 3**0.5!r} m"}))
    assert shorter.rest_length(3e5) == pytest.approx(thread / 3**0.5, rel=1e-9)
    actuator = mckibben.Actuator(scenario)
    assert actuator.rest_length(3e5) == numbers["min_length"] > thread / 3**0.5
    assert actuator.rest_length(0.0) == pytest.approx(longest, rel=1e-9), "without air nothing pulls until it is taut"
    with pytest.raises(mckibben.InputError, match="vacuum|atmosphere|pressure"):
        actuator.rest_length(-2e5)


def test_the_loop_of_the_documentation_runs(examples, monkeypatch):
    """Word for word, on the scenario that the page begins with."""
    monkeypatch.chdir(ROOT)
    page = (ROOT / "docs" / "python.md").read_text()
    blocks = [block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "Actuator" in block]
    assert len(blocks) == 2
    names = {"mckibben": mckibben, "numpy": numpy, "scenario": mckibben.Scenario.from_file(examples / "paper/fig-12.toml")}
    for block in blocks:
        exec(block, names)
    # The mass hangs in the middle of what the muscle can reach, and has not flown off.
    assert 0.06 < names["length"][0] < 0.11 and names["tension"].shape == (4096,)
