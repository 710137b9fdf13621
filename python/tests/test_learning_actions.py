"""Environments: every action matters, and where it cannot the observation says so."""

from typing import Any

import gymnasium
import numpy as np
import pytest

import mckibben
from mckibben import learning

STEPS = 12
SPOOL = {
    "valve.kind": "proportional-spool",
    "valve.spool": {"natural_frequency": "100 Hz", "damping_ratio": 0.5, "supply_overlap": 0.0, "exhaust_overlap": 0.0},
    "command": {"kind": "positions", "time": ["0 s"], "position": [0.0]},
}
REGULATOR = {
    "valve.kind": "pressure-regulator",
    "valve.time_constant": "30 ms",
    "valve.dead_time": "6 ms",
    # So fast that the regulator never goes at its limit, where set points make no difference.
    "valve.rate_limit": "1000 bar/s",
    "command": {"kind": "set-points", "time": ["0 s"], "gauge_pressure": ["2 bar"]},
}


def with_valve(valve: dict[str, Any]) -> mckibben.Scenario:
    """The task's muscle with another valve, at the scenario's own flow."""
    sections = learning.task("HangingMass").scenario.to_dict()
    sections["valve"] = {"flow_area": "1.8e-5 ft^2", "efficiency": 0.85}
    for path, value in valve.items():
        section, _, key = path.partition(".")
        if key:
            sections[section][key] = value
        else:
            sections[section] = value
    return mckibben.Scenario.from_dict(sections)


def kinds() -> list[Any]:
    """Tasks with the kinds of actions that they have."""
    three = learning.task("HangingMass").scenario.with_values({"valve.kind": "fill-hold-exhaust"})
    slow = learning.task("HangingMass").scenario.with_values({"valve.opening_delay": "12 ms", "command.frequency": "20 Hz"})
    names = ["HangingMass", "Joint", "Leg", "Arm"]
    alike = [pytest.param(name, {"action_mode": mode}, id=f"{name}-{mode}") for name in names for mode in ("duty", "request")]
    return alike + [
        pytest.param("HangingMass", {"action_mode": "request", "scenario": three}, id="three-requests"),
        pytest.param("HangingMass", {"action_mode": "request", "scenario": slow}, id="slow-valve-request"),
        pytest.param("HangingMass", {"action_mode": "duty", "scenario": slow}, id="slow-valve-duty"),
        pytest.param("HangingMass", {"action_mode": "position", "scenario": with_valve(SPOOL)}, id="position"),
        pytest.param("HangingMass", {"action_mode": "set-point", "scenario": with_valve(REGULATOR)}, id="set-point"),
        pytest.param("HangingMass", {"action_mode": "duty", "pulse_frequency": 50.0}, id="faster-pulses"),
    ]


@pytest.mark.parametrize("mode", ["duty", "request"])
def test_actions_may_have_any_layout(mode: str) -> None:
    """Those of an array in Fortran's order are those of the same rows in C's."""
    one, other = (gymnasium.make_vec("mckibben/Joint-v0", num_envs=3, action_mode=mode) for _ in range(2))
    for many in (one, other):
        many.reset(seed=4)
    one.action_space.seed(4)
    for _ in range(3):
        actions = one.action_space.sample()
        assert actions.shape == (3, 2)
        expected = one.step(actions)[0]
        np.testing.assert_array_equal(other.step(np.asfortranarray(actions))[0], expected)


def action_sequences(
    space: gymnasium.Space[Any], mode: str, steps: int, pulses: tuple[float, float] = (0.3, 0.8)
) -> tuple[np.ndarray, np.ndarray]:
    """Actions of one plant over some steps, and another for each of its valves in each: an array of (steps, valves) each."""
    random = np.random.default_rng(1)
    if mode == "request":
        choices = int(space.n) if isinstance(space, gymnasium.spaces.Discrete) else int(space.nvec[0])
        valves = 1 if isinstance(space, gymnasium.spaces.Discrete) else len(space.nvec)
        taken = random.integers(choices, size=(steps, valves))
        return taken, np.where(taken == choices - 1, 0, choices - 1)
    # What a valve's delays leave of a pulse: from 12 ms of 50 ms, or 4 ms of 20 ms, to 1 ms before its end.
    low, high = (-0.9, 0.9) if mode == "position" else pulses
    taken = random.uniform(low, high, size=(steps, *space.shape))
    other = 0.3 * (high - low)
    return taken, taken + np.where(taken > 0.5 * (low + high), -other, other)


@pytest.mark.parametrize("name, options", kinds())
def test_every_action_changes_the_next_observation(name: str, options: dict[str, Any]) -> None:
    """One plant for each step and valve, which differs in that one action from the first plant."""
    alone = gymnasium.make(f"mckibben/{name}-v0", **options)
    taken, another = action_sequences(alone.action_space, options["action_mode"], STEPS)
    valves = taken.shape[1]
    many = gymnasium.make_vec(f"mckibben/{name}-v0", num_envs=1 + STEPS * valves, **options)
    many.reset(seed=1)
    for step in range(STEPS):
        actions = np.repeat(taken[step][np.newaxis], many.num_envs, axis=0)
        for valve in range(valves):
            actions[1 + step * valves + valve, valve] = another[step, valve]
        observed, *_ = many.step(actions.reshape(many.action_space.shape).astype(many.action_space.dtype))
        seen, shown = observed[:, : len(many.unwrapped._episodes.task.seen)], many.unwrapped.observations
        differ = 1 + step * valves + np.arange(valves)
        assert (seen[differ] != seen[0]).any(axis=1).all(), f"step {step}"
        later = np.arange(1 + (step + 1) * valves, many.num_envs)
        assert (shown[later] == shown[0]).all(), "plants with equal actions are equal"


@pytest.mark.parametrize("mode", ["duty", "request"])
def test_every_action_matters_in_the_single_form(mode: str) -> None:
    alone = gymnasium.make("mckibben/HangingMass-v0", action_mode=mode).unwrapped
    taken, another = action_sequences(alone.action_space, mode, STEPS)

    def after(actions: np.ndarray) -> np.ndarray:
        alone.reset(seed=1)
        for action in actions:
            alone.step(int(action[0]) if mode == "request" else action.astype(np.float32))
        return alone.observations.copy()

    for step in range(STEPS):
        changed = taken[: step + 1].copy()
        changed[step] = another[step]
        assert (after(changed) != after(taken[: step + 1])).any(), f"step {step}"


@pytest.mark.parametrize("name", ["HangingMass", "Joint", "Leg"])
def test_where_control_is_faster_the_phase_says_whether_an_action_matters(name: str) -> None:
    """Pulses of 40 ms, control of 10 ms, and episodes of 50 ms, so that the second begins within a pulse: one plant goes on."""
    options = {"control_period": 0.01, "duration": 0.5}
    alone = gymnasium.make(f"mckibben/{name}-v0", **options)
    steps = 18
    # Pulses that are over within a control period, 1 ms for the poppet included: what they change, they change at once.
    taken, another = action_sequences(alone.action_space, "duty", steps, (0.13, 0.22))
    valves = taken.shape[1]
    phase = slice(len(alone.unwrapped._episodes.task.seen), len(alone.unwrapped._episodes.task.seen) + 2)
    under_way = slice(phase.stop, phase.stop + valves)
    assert alone.observation_space.shape == (under_way.stop + len(alone.unwrapped._episodes.task.targets),)
    many = gymnasium.make_vec(f"mckibben/{name}-v0", num_envs=2 + steps * valves, **options)
    observed, _ = many.reset(seed=1)
    mask = np.arange(many.num_envs) < many.num_envs - 1
    np.testing.assert_array_equal(observed[:, phase], np.tile([1.0, 0.0], (many.num_envs, 1)))
    expected, mattered, clock = np.zeros(valves), 0, 0
    for step in range(steps):
        if step % 6 == 5:
            observed, _ = many.reset(options={"reset_mask": mask})
            expected = np.zeros(valves)
            continue
        actions = np.repeat(taken[step][np.newaxis], many.num_envs, axis=0)
        differ = 1 + step * valves + np.arange(valves)
        actions[differ, np.arange(valves)] = another[step]
        at_begin = observed[0, phase][0] > 1.0 - 1e-6
        observed, *_ = many.step(actions.astype(np.float32))
        clock += 1
        angle = 2.0 * np.pi * clock / 4.0
        np.testing.assert_allclose(observed[:, phase], [[np.cos(angle), np.sin(angle)]] * many.num_envs, atol=1e-6)
        if at_begin:
            expected = taken[step]
            mattered += 1
        np.testing.assert_allclose(observed[0, under_way], expected, rtol=1e-6)
        changed = (many.unwrapped.observations[differ] != many.unwrapped.observations[0]).any(axis=1)
        assert (changed == at_begin).all(), f"step {step}"
    assert mattered >= 4


def test_the_phase_is_observed_only_where_control_is_out_of_step_with_the_pulses() -> None:
    def size(**options: Any) -> int:
        return gymnasium.make("mckibben/HangingMass-v0", **options).observation_space.shape[0]

    assert size() == size(control_period=0.08) == size(pulse_frequency=30.0, duration=1.0) == 4
    assert size(action_mode="request", control_period=1e-3) == 4
    assert size(control_period=0.02) == size(control_period=0.05) == 7


def test_the_period_of_an_action_is_that_of_the_pulses_or_longer_than_the_delays() -> None:
    def period(**options: Any) -> float:
        return gymnasium.make("mckibben/HangingMass-v0", **options).unwrapped.dt

    assert period() == 0.04 and period(pulse_frequency=50.0) == 0.02
    assert period(action_mode="request") == 0.005
    for delay, least in [("5 ms", 0.01), ("12 ms", 0.015)]:
        scenario = learning.task("HangingMass").scenario.with_values({"valve.closing_delay": delay})
        assert period(action_mode="request", scenario=scenario) == pytest.approx(least, rel=1e-12)
    assert period(action_mode="set-point", scenario=with_valve(REGULATOR)) == pytest.approx(0.01, rel=1e-12)


def test_a_set_point_ends_at_what_feeds_the_regulator() -> None:
    """An action of 1 is `max_pressure`, or the supply where that is less. Plants and actuators refuse what is above."""
    scenario = with_valve(REGULATOR).with_values({"command.gauge_pressure": ["1 bar"]})
    for feed, most, reached in [("2 bar", 3e5, 2e5), ("4 bar", 3e5, 3e5)]:
        options = {"scenario": scenario.with_values({"supply.gauge_pressure": feed}), "max_pressure": most}
        alone = gymnasium.make("mckibben/HangingMass-v0", action_mode="set-point", duration=4.0, **options).unwrapped
        alone.reset(seed=1)
        for _ in range(150):
            alone.step(np.ones(1, dtype=np.float32))
        absolute = alone.observations[alone.columns.index("absolute_pressure_pa")]
        assert absolute - 101_325.0 == pytest.approx(reached, rel=1e-3)

    plants = mckibben.VectorPlant(scenario, 2, parameters=["supply.gauge_pressure"], action_mode="set-point")
    plants.start(np.array([[2e5], [4e5]]))
    np.testing.assert_array_equal(plants.command_range, [[[0.0], [0.0]], [[2e5], [4e5]]])
    shown, stopped = np.zeros((2, len(plants.columns))), np.zeros(2, dtype=bool)
    plants.step(np.array([[2e5], [4e5]]), 0.01, shown, stopped)
    with pytest.raises(mckibben.InputError, match="cannot give more than feeds it"):
        plants.step(np.array([[2.1e5], [4e5]]), 0.01, shown, stopped)
    actuator = mckibben.Actuator(scenario.with_values({"supply.gauge_pressure": "2 bar"}))
    with pytest.raises(mckibben.InputError, match="cannot give more than feeds it"):
        actuator.step(actuator.start(), 0.09, 0.0, 2.1e5, 1e-3)


def test_what_a_valve_does_not_take_is_refused_when_the_environment_is_made() -> None:
    for name in ("HangingMass", "Joint", "Leg"):
        for mode in ("position", "set-point"):
            with pytest.raises(mckibben.InputError, match=f'action_mode="{mode}" .*valve with seats(.|\n)*action_mode="request"'):
                gymnasium.make(f"mckibben/{name}-v0", action_mode=mode)
    for mode, valve in [("duty", SPOOL), ("request", SPOOL), ("set-point", SPOOL), ("position", REGULATOR)]:
        with pytest.raises(mckibben.InputError, match=f'action_mode="{mode}" is nothing'):
            gymnasium.make("mckibben/HangingMass-v0", action_mode=mode, scenario=with_valve(valve), pulse_frequency=25.0)
    # Between pulses that no PWM of the scenario describes the valve is to exhaust, which a two-way valve cannot.
    two = learning.task("HangingMass").scenario.with_values({"valve.kind": "two-way"})
    gymnasium.make("mckibben/HangingMass-v0", scenario=two)
    table = two.with_values({"command": {"kind": "table", "time": ["0 s"], "state": ["fill"]}})
    with pytest.raises(mckibben.InputError, match="two-way"):
        gymnasium.make("mckibben/HangingMass-v0", scenario=table, pulse_frequency=25.0)
    sealed = {key: value for key, value in learning.task("HangingMass").scenario.to_dict().items()
              if key not in ("supply", "valve", "command")}
    with pytest.raises(mckibben.InputError, match="no valve"):
        gymnasium.make("mckibben/HangingMass-v0", scenario=mckibben.Scenario.from_dict(sealed), action_mode="request")


@pytest.mark.parametrize("name", ["HangingMass", "Joint"])
def test_actions_beyond_the_bounds_count_as_the_bound(name: str) -> None:
    many = gymnasium.make_vec(f"mckibben/{name}-v0", num_envs=4)
    many.reset(seed=1)
    actions = np.zeros(many.action_space.shape)
    actions[0], actions[1], actions[2] = -3.0, 7.0, 1.0
    many.step(actions)
    shown = many.unwrapped.observations
    assert (shown[0] == shown[3]).all() and (shown[1] == shown[2]).all() and (shown[0] != shown[1]).any()


@pytest.mark.parametrize(
    "options, actions, words",
    [
        ({}, [[0.5], [np.nan]], r"actions: nan at \[1, 0\] is no finite number"),
        ({}, [[0.5], [np.inf]], r"actions: inf at \[1, 0\] is no finite number"),
        ({}, [["0.5"], ["fill"]], "of dtype <U4; give floats from 0 to 1"),
        ({}, [0.5, 0.5], r"shape \(2,\); give \(2, 1\)"),
        ({}, [[0.5]], r"shape \(1, 1\); give \(2, 1\)"),
        ({"action_mode": "request"}, [0, 2], r"actions: 2 at \[1\] is no request; give whole numbers from 0 to 1"),
        ({"action_mode": "request"}, [-1, 0], r"actions: -1 at \[0\] is no request"),
        ({"action_mode": "request"}, [0.4, 0.0], "is no request"),
        ({"action_mode": "request"}, [[0], [1]], r"shape \(2, 1\); give \(2,\)"),
    ],
)
def test_actions_that_are_none_are_refused_before_anything_moves(options: Any, actions: Any, words: str) -> None:
    many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=2, **options)
    many.reset(seed=1)
    before = many.unwrapped.observations.copy()
    with pytest.raises(mckibben.InputError, match=words):
        many.step(np.array(actions))
    assert (many.unwrapped.observations == before).all()
    assert (many.unwrapped._episodes.elapsed == 0).all()


@pytest.mark.parametrize(
    ("action", "words"),
    [
        (np.ones(1, dtype=bool), "of dtype bool; give floats from 0 to 1"),
        (np.array([0.1], dtype=object), "of dtype object; give floats"),
        (np.array(["0.1"]), "of dtype <U3; give floats"),
        (np.array([0.1 + 1j]), "of dtype complex128; give floats"),
        (np.ma.masked_array([0.3], [True]), "mask hides entries"),
    ],
)
def test_what_is_no_number_is_no_action(action: np.ndarray, words: str) -> None:
    one, many = gymnasium.make("mckibben/HangingMass-v0").unwrapped, gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=1)
    for form, given in ((one, action), (many, action[np.newaxis])):
        form.reset(seed=1)
        with pytest.raises(mckibben.InputError, match=words):
            form.step(given)
        # A mask that hides nothing does no harm.
        form.step(np.ma.masked_array(np.full(given.shape, 0.3), np.zeros(given.shape, dtype=bool)))
    requests = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=2, action_mode="request")
    requests.reset(seed=1)
    with pytest.raises(mckibben.InputError, match="of dtype bool; give whole numbers from 0 to"):
        requests.step(np.array([True, False]))


def test_a_truth_value_is_no_seed_and_no_number_of_plants() -> None:
    one, many = gymnasium.make("mckibben/HangingMass-v0"), gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=2)
    for form, seed in ((one, True), (many, True), (many, [1, False])):
        with pytest.raises(mckibben.InputError, match="seed = "):
            form.unwrapped.reset(seed=seed)
    with pytest.raises(mckibben.InputError, match="num_envs = True"):
        mckibben.learning.VectorEnvironment("HangingMass", True)
