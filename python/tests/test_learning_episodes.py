"""Environments: how episodes begin and end, what ending costs, and what options and resets say of them."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded

import mckibben
from mckibben import learning

IDS = ["mckibben/HangingMass-v0", "mckibben/Joint-v0", "mckibben/Leg-v0", "mckibben/Arm-v0"]
MASS = "mckibben/HangingMass-v0"
# Steps of the engine as long as these make a muscle diverge that has little volume in addition to its own, in m³.
COARSE, FRAGILE, STURDY = {"run.step": "100 ms"}, 1e-6, 1e-2
FILL, EXHAUST = 1, 0


def fragile(volume: Any = FRAGILE, **options: Any) -> dict[str, Any]:
    """Options of an environment in which fragile muscles diverge."""
    scenario = learning.task("HangingMass").scenario.with_values(COARSE)
    # Those that begin again are fragile ones.
    volumes = {"actuator.external_volume": lambda _, count: volume if np.size(volume) == count else FRAGILE}
    return {"scenario": scenario, "action_mode": "request", "control_period": 0.1, "duration": 2.0, "randomize": volumes, **options}


def returns(many: Any, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What each plant earns from each step on by these actions, a row for each step, and the step in which it diverged."""
    # Without a seed one call draws for all plants.
    many.reset(options={"targets": {"length_m": 0.08}})
    steps, count = many.unwrapped._episodes.periods, many.num_envs
    earned, ended = np.zeros((steps, count)), np.full(count, steps)
    for step in range(steps):
        _, rewards, terminated, truncated, info = many.step(actions)
        going = ended == steps
        earned[step, going] = rewards[going]
        assert (terminated[going] == info.get("final_info", info)["diverged"][going]).all()
        assert not (terminated & truncated).any()
        ended[terminated & going] = step
    return np.cumsum(earned[::-1], axis=0)[::-1], ended


@pytest.mark.parametrize("mode", ["next-step", "same-step"])
def test_ending_early_never_pays(mode: str) -> None:
    """Whatever a plant that goes on does with the time that is left, it has lost less than one that diverges."""
    volume = np.tile([FRAGILE, STURDY], 4)
    many = gymnasium.make_vec(MASS, num_envs=8, autoreset_mode=mode, **fragile(volume))
    actions = np.repeat([FILL, EXHAUST], 4)
    worth, ended = returns(many, actions)
    steps = many.unwrapped._episodes.periods
    diverged = ended < steps
    assert (diverged == (volume == FRAGILE)).all(), "the fragile muscles diverge, and no others"
    limit = many.unwrapped._episodes.options.distance_limit
    for plant in np.flatnonzero(diverged):
        # From the step in which it diverges on: against those that go on, and against the worst that could.
        left = steps - ended[plant]
        assert worth[ended[plant], plant] <= -limit * left
        assert (worth[ended[plant], plant] <= worth[ended[plant], ~diverged]).all()
        for discount in (0.5, 0.9, 1.0):
            assert worth[ended[plant], plant] <= -limit * sum(discount**step for step in range(left))
    assert (worth[:, ~diverged] >= -limit * (steps - np.arange(steps))[:, None]).all()


def test_a_penalty_that_is_given_takes_the_place_of_the_derived_one() -> None:
    lost = {}
    for penalty in (0.0, 7.0, None):
        many = gymnasium.make_vec(MASS, num_envs=1, **fragile(terminal_penalty=penalty))
        worth, ended = returns(many, np.array([FILL]))
        lost[penalty] = worth[ended[0], 0]
        assert ended[0] < 20
    assert lost[7.0] == pytest.approx(lost[0.0] - 7.0, rel=1e-12)
    assert lost[None] == pytest.approx(lost[0.0] - 2.0 * (20 - ended[0]), rel=1e-12)
    assert -2.0 <= lost[0.0] <= 0.0, "without a penalty a crash ends a series of losses"


def test_a_distance_counts_as_the_limit_at_most() -> None:
    far = gymnasium.make(MASS, targets={"length_m": (0.070, 0.0701)}).unwrapped
    near = gymnasium.make(MASS, targets={"length_m": (0.070, 0.0701)}, distance_limit=1e3).unwrapped
    for environment in (far, near):
        environment.reset(seed=3)
    assert far.step(np.zeros(1, dtype=np.float32))[1] == -2.0 > near.step(np.zeros(1, dtype=np.float32))[1]


@pytest.mark.parametrize("name", IDS)
def test_success_is_a_plant_near_all_of_its_targets(name: str) -> None:
    one = gymnasium.make(name, success_tolerance=0.1).unwrapped
    targets = one._episodes.task.targets
    _, info = one.reset(seed=1)
    here = {column: float(np.clip(info[column], *ends)) for column, ends in targets.items()}
    assert one.reset(seed=1, options={"targets": here})[1]["is_success"] is True
    for column, (low, high) in targets.items():
        for share, succeeds in [(0.09, True), (0.11, False)]:
            # Away from the plant, towards whichever end of the range is farther.
            sign = 1.0 if here[column] < 0.5 * (low + high) else -1.0
            aim = {**here, column: here[column] + sign * share * (high - low)}
            _, info = one.reset(seed=1, options={"targets": aim})
            assert info["is_success"] is succeeds and info["diverged"] is False
    # After a step it is of where the plant is then.
    observed, _, _, _, info = one.step(one.action_space.sample())
    seen, aims = observed[: len(targets)], observed[-len(targets) :]
    assert info["is_success"] == bool((np.abs(seen - aims) <= 0.1).all())


def test_the_single_form_reports_divergence() -> None:
    alone = gymnasium.make(MASS, **fragile()).unwrapped
    alone.reset(seed=2)
    for _ in range(20):
        observed, reward, terminated, truncated, info = alone.step(FILL)
        assert terminated == info["diverged"] and np.isfinite(observed).all() and np.isfinite(reward)
        if terminated:
            break
    assert terminated and not truncated and not info["is_success"]
    assert reward < -2.0 * (20 - alone._episodes.elapsed[0])


def test_a_seed_is_for_each_plant_and_counts_up_from_one_number() -> None:
    many = gymnasium.make_vec(MASS, num_envs=3, noise={"length_m": 1e-4})
    apart = many.reset(seed=[1, 2, 3])[0]
    assert (many.reset(seed=[1, 2, 3])[0] == apart).all()
    swapped = many.reset(seed=[3, 2, 1])[0]
    assert (swapped[::-1] == apart).all()
    # None goes on with the generator that the plant has.
    again = many.reset(seed=[1, None, 3])[0]
    assert (again[[0, 2]] == apart[[0, 2]]).all() and (again[1] != apart[1]).any()
    for first in (1, np.int64(1), np.array([1, 2, 3])):
        assert (many.reset(seed=first)[0] == apart).all()
    assert (many.reset(seed=2)[0][:2] == apart[1:]).all()
    for wrong in ([1, 2], 1.5, "one"):
        with pytest.raises(mckibben.InputError, match="a list of 3, one or None for each plant"):
            many.reset(seed=wrong)


@pytest.mark.parametrize("name", IDS)
def test_targets_that_are_given_are_those_of_the_episode(name: str) -> None:
    one, many = gymnasium.make(name).unwrapped, gymnasium.make_vec(name, num_envs=3)
    targets = one._episodes.task.targets
    count = len(targets)
    given = {column: low + 0.25 * (high - low) for column, (low, high) in targets.items()}
    np.testing.assert_allclose(one.reset(seed=1, options={"targets": given})[0][-count:], 0.25, rtol=1e-6)
    np.testing.assert_allclose(many.reset(seed=1, options={"targets": given})[0][:, -count:], 0.25, rtol=1e-6)
    column, (low, high) = next(iter(targets.items()))
    each = {column: np.linspace(low, high, 3)}
    observed, _ = many.reset(seed=1, options={"targets": each})
    drawn, _ = many.reset(seed=1)
    np.testing.assert_allclose(observed[:, -count], [0.0, 0.5, 1.0], atol=1e-6)
    assert (observed[:, -count + 1 :] == drawn[:, -count + 1 :]).all() or count == 1
    for options, words in [
        ({"targets": {column: high + 1e-3}}, "beyond the range of targets"),
        ({"targets": {column: np.nan}}, "beyond the range of targets"),
        ({"targets": {"colour": 1.0}}, "is not controlled here"),
        ({"targets": 0.5}, "give a dictionary"),
        ({"target": {}}, "no option of reset"),
    ]:
        for form in (one, many):
            with pytest.raises(mckibben.InputError, match=words):
                form.reset(options=options)
    with pytest.raises(mckibben.InputError, match="one for each of 3"):
        many.reset(options={"targets": {column: [low, high]}})


def test_a_mask_begins_episodes_of_some_plants_and_leaves_the_others() -> None:
    many = gymnasium.make_vec(MASS, num_envs=3, autoreset_mode="disabled", noise={"length_m": 1e-4})
    mask = np.array([True, False, True])
    with pytest.raises(ResetNeeded, match="without a mask first"):
        many.reset(options={"reset_mask": mask})
    many.reset(seed=1)
    for _ in range(3):
        last = many.step(np.full((3, 1), 0.4, dtype=np.float32))[0]
    observed, info = many.reset(options={"reset_mask": mask, "targets": {"length_m": 0.08}})
    assert (observed[1] == last[1]).all(), "a plant that waits keeps its last observation"
    np.testing.assert_allclose(observed[mask, 3], 0.5, rtol=1e-6)
    assert (info["_length_m"] == mask).all() and (info["length_m"][mask] > 0.07).all() and info["length_m"][1] == 0.0
    assert many.unwrapped.observations[0, 1] == 0.0 != many.unwrapped.observations[1, 1], "velocities"
    for wrong in (np.zeros(3, dtype=bool), np.ones(2, dtype=bool), np.array([0, 1, 2])):
        with pytest.raises(mckibben.InputError, match="reset_mask"):
            many.reset(options={"reset_mask": wrong})


@pytest.mark.parametrize("name", IDS)
def test_steps_in_the_wrong_order_are_refused(name: str) -> None:
    options = {"control_period": 0.04, "duration": 0.12}
    one = gymnasium.make(name, **options).unwrapped
    action = one.action_space.sample()
    with pytest.raises(ResetNeeded, match="no episode has begun: call reset"):
        one.step(action)
    for _ in range(2):
        one.reset(seed=1)
        ends = [one.step(action)[3] for _ in range(3)]
        assert ends == [False, False, True]
        with pytest.raises(ResetNeeded, match="the episode has ended: call reset"):
            one.step(action)
    for mode in ("next-step", "same-step", "disabled"):
        many = gymnasium.make_vec(name, num_envs=2, autoreset_mode=mode, **options).unwrapped
        actions = many.action_space.sample()
        with pytest.raises(ResetNeeded, match="no episode has begun"):
            many.step(actions)
        many.reset(seed=1)
        for _ in range(3):
            truncated = many.step(actions)[3]
        assert truncated.all()
        if mode == "disabled":
            with pytest.raises(ResetNeeded, match="plants 0, 1 have ended"):
                many.step(actions)
            many.reset(options={"reset_mask": np.array([True, False])})
            with pytest.raises(ResetNeeded, match="plants 1 have ended"):
                many.step(actions)
            many.reset(options={"reset_mask": np.array([False, True])})
        many.step(actions)


@pytest.mark.parametrize("name", IDS)
def test_the_specification_has_the_steps_of_an_episode(name: str) -> None:
    for options, steps in [({}, 50), ({"action_mode": "request"}, 400), ({"duration": 8.0}, 200), ({"control_period": 0.5}, 4)]:
        one = gymnasium.make(name, **options)
        many = gymnasium.make_vec(name, num_envs=2, **options)
        assert one.spec.max_episode_steps == many.spec.max_episode_steps == steps
        again = [gymnasium.make(one.spec), gymnasium.make_vec(many.spec)]
        assert [form.spec.max_episode_steps for form in again] == [steps, steps]
    # The truncation comes in that step.
    one = gymnasium.make(name, duration=0.2)
    one.reset(seed=1)
    ends = [one.step(one.action_space.sample())[3] for _ in range(one.spec.max_episode_steps)]
    assert ends == [False] * 4 + [True]
    # Gymnasium's own argument, in both forms.
    for form in (gymnasium.make(name, max_episode_steps=3), gymnasium.make_vec(name, num_envs=2, max_episode_steps=3)):
        form.reset(seed=1)
        ends = [bool(np.all(form.step(form.action_space.sample())[3])) for _ in range(3)]
        assert ends == [False, False, True]
        assert form.spec.max_episode_steps == 3
    with pytest.raises(mckibben.InputError, match="give one of them"):
        gymnasium.make_vec(name, num_envs=1, duration=0.2, max_episode_steps=3)


@pytest.mark.parametrize("name", IDS)
def test_both_forms_show_what_their_plants_are(name: str) -> None:
    one, many = gymnasium.make(name).unwrapped, gymnasium.make_vec(name, num_envs=2).unwrapped
    _, info = one.reset(seed=1)
    many.reset(seed=1)
    for _ in range(3):
        assert one.columns == many.columns and one.observations.shape == (len(one.columns),)
        assert dict(zip(one.columns, one.observations, strict=True)) == {column: info[column] for column in one.columns}
        action = one.action_space.sample()
        *_, info = one.step(action)
        many.step(np.array([action, action]))
        np.testing.assert_allclose(many.observations[1], one.observations, rtol=1e-9, atol=1e-12)


def test_observations_are_bounded_where_the_plant_is() -> None:
    space = gymnasium.make(MASS).observation_space
    assert (space.low[3], space.high[3]) == (0.0, 1.0), "a target"
    assert space.low[2] == np.float32(-101325.0 / 5e5), "an absolute pressure"
    noisy = gymnasium.make(MASS, noise={"absolute_pressure_pa": 1e3}).observation_space
    assert noisy.low[2] == -np.inf
    faster = gymnasium.make("mckibben/Joint-v0", control_period=0.01).observation_space
    assert list(faster.low[4:]) == [-1.0, -1.0, 0.0, 0.0, 0.0] and list(faster.high[4:]) == [1.0] * 5


@pytest.mark.parametrize(
    "name, path, draw, words",
    [
        (MASS, "load.mass", (3.0, 1.5), "give the lower end first"),
        (MASS, "load.mass", (2.0, 2.0), "give the lower end first"),
        (MASS, "load.mass", (-1.0, 2.0), "load.mass = -1 kg is outside its range"),
        (MASS, "load.mass", ("1 kg", "2 kg"), "give two finite numbers in SI"),
        (MASS, "load.mass", (1.0, np.inf), "give two finite numbers in SI"),
        (MASS, "load.mass", (1.0, 2.0, 3.0), "give two finite numbers in SI"),
        (MASS, "load.mass", 2.0, "give two finite numbers in SI"),
        (MASS, "load.maas", (1.0, 2.0), "did you mean `load.mass`"),
        (MASS, "load.mass", lambda random, count: np.full(count, "heavy"), "return an array of 2 finite numbers"),
        (MASS, "load.mass", lambda random, count: np.ones(count + 1), "return an array of 2 finite numbers"),
        (MASS, "load.mass", lambda random, count: np.full(count, np.nan), "return an array of 2 finite numbers"),
        (MASS, "load.mass", lambda random, count: np.full(count, -1.0), "load.mass = -1 kg is outside its range"),
        (MASS, "command.duty", (0.1, 0.9), "changes nothing of this plant"),
        (MASS, "command.duty", lambda random, count: np.full(count, 0.5), "changes nothing of this plant"),
        (MASS, "run.duration", (1.0, 2.0), "changes nothing of this plant"),
        (MASS, "run.step", (1e-4, 2e-4), "changes nothing of this plant"),
        ("mckibben/Joint-v0", "command.frequency", (20.0, 30.0), "changes nothing of this plant"),
        ("mckibben/Joint-v0", "load.mass", (-1.0, 1.0), "load.mass = -1 kg is outside its range"),
        ("mckibben/Leg-v0", "command.duty", (0.1, 0.9), "changes nothing of this plant"),
        ("mckibben/Leg-v0", "mechanism.joints.hip.mass", (-1.0, 1.0), "-1 kg is outside its range"),
        ("mckibben/Leg-v0", "mechanism.joints.hip.colour", (0.0, 1.0), "is no key of a plant"),
        ("mckibben/Arm-v0", "actuators.biceps.colour", (0.0, 1.0), "is no key of a plant"),
    ],
)
def test_a_range_that_cannot_be_is_refused(name: str, path: str, draw: Any, words: str) -> None:
    with pytest.raises(mckibben.InputError, match=words):
        many = gymnasium.make_vec(name, num_envs=2, randomize={path: draw})
        # What a function draws is known only then.
        assert callable(draw)
        many.reset()


def test_what_a_range_draws_lies_in_it_and_every_kind_of_parameter_may_be_drawn() -> None:
    ranges = {"load.mass": (1.5, 3.0), "initial.gauge_pressure": (1e5, 2e5), "valve.opening_delay": (1e-3, 4e-3)}
    many = gymnasium.make_vec(MASS, num_envs=500, randomize={**ranges, "supply.gauge_pressure": (5e5, 7e5)})
    many.reset(seed=1)
    gauge = many.unwrapped.observations[:, 2] - 101325.0
    assert (gauge >= 1e5).all() and (gauge <= 2e5).all()
    # Four standard errors of the mean of a uniform distribution.
    assert abs(gauge.mean() - 1.5e5) < 4 * 1e5 / np.sqrt(12 * 500)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"control_period": 0.0}, "control_period = 0.0"),
        ({"control_period": float("nan")}, "control_period = nan"),
        ({"duration": -1.0}, "duration = -1.0"),
        ({"duration": 0.05}, "no multiple of control_period"),
        ({"sensor_delay": 2e-3}, "no multiple of control_period"),
        ({"pulse_frequency": 0.0}, "pulse_frequency = 0.0"),
        ({"max_pressure": "6 kg"}, "`max_pressure`: "),
        ({"control_period": "40"}, "`control_period`: "),
        ({"sensor_delay": "-40 ms"}, "sensor_delay = -0.04 is out of range"),
        ({"distance_limit": "2"}, "distance_limit = '2' is no finite number"),
        ({"terminal_penalty": -1.0}, "terminal_penalty = -1.0"),
        ({"success_tolerance": float("inf")}, "success_tolerance = inf"),
        ({"distance_limit": 0.0}, "distance_limit = 0.0"),
        ({"noise": {"length_m": -1e-3}}, "is no standard deviation"),
        ({"noise": 1e-3}, "noise is no dictionary"),
        ({"randomize": ["load.mass"]}, "randomize is no dictionary"),
        ({"max_episode_steps": 0}, "max_episode_steps = 0"),
        ({"max_episode_steps": 2.5}, "max_episode_steps = 2.5"),
    ],
)
def test_an_option_out_of_its_range_is_refused(options: dict[str, Any], words: str) -> None:
    with pytest.raises(mckibben.InputError, match=words):
        gymnasium.make_vec(MASS, num_envs=1, **options)


def test_options_that_are_quantities_may_be_text_with_a_unit() -> None:
    texts = {"control_period": "40 ms", "duration": "0.8 s", "pulse_frequency": "50 Hz", "sensor_delay": "40 ms", "action_delay": "80 ms"}
    numbers = {"control_period": 0.04, "duration": 0.8, "pulse_frequency": 50.0, "sensor_delay": 0.04, "action_delay": 0.08}
    one, other = (gymnasium.make(MASS, **options) for options in (texts, numbers))
    assert one.unwrapped.dt == other.unwrapped.dt == 0.04 and one.unwrapped._episodes.periods == 20
    np.testing.assert_array_equal(one.reset(seed=3)[0], other.reset(seed=3)[0])
    for _ in range(5):
        np.testing.assert_array_equal(one.step(np.array([0.4]))[0], other.step(np.array([0.4]))[0])
    assert learning.Options(action_mode="set-point", max_pressure="4 bar").max_pressure == 4e5


def test_a_scenario_whose_duration_is_no_whole_number_of_steps_gets_the_nearest() -> None:
    one = gymnasium.make(MASS, pulse_frequency=30.4).unwrapped
    assert one.dt == 1.0 / 30.4 and one._episodes.periods == 61


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"noise": 1e-3}, 'noise is no dictionary but 0.001.*"length_m"'),
        ({"max_pressure": 3e5}, 'max_pressure = 300000.0 has no effect with action_mode="duty"'),
        ({"targets": {"length_m": (0.2, 0.3)}}, "beyond the thread"),
        ({"targets": {"length_m": (-0.2, 0.08)}}, "not above zero"),
        ({"targets": {"absolute_pressure_pa": (-2e5, -1e5)}}, "not above zero"),
    ],
)
def test_what_has_no_effect_or_no_meaning_is_refused(options, words) -> None:
    with pytest.raises(mckibben.InputError, match=words):
        gymnasium.make("mckibben/HangingMass-v0", **options)


def test_no_noise_and_nothing_drawn_may_be_none() -> None:
    one = gymnasium.make("mckibben/HangingMass-v0", noise=None, randomize=None)
    other = gymnasium.make("mckibben/HangingMass-v0")
    np.testing.assert_array_equal(one.reset(seed=3)[0], other.reset(seed=3)[0])
