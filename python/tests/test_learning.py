"""Environments: what Gymnasium requires, that a plant in them is the plant of a run, and that options do what they say."""

import pickle
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import mckibben
from mckibben import learning
from mckibben._mckibben import VectorPlant

IDS = ["mckibben/HangingMass-v0", "mckibben/Joint-v0", "mckibben/Leg-v0", "mckibben/Arm-v0"]
SHORT = {"control_period": 0.04, "duration": 0.8}


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("mode", ["duty", "request"])
@pytest.mark.parametrize("options", [{}, {"control_period": 1e-3, "duration": 0.02}])
def test_gymnasiums_own_check_passes(name: str, mode: str, options: dict[str, float]) -> None:
    environment = gymnasium.make(name, action_mode=mode, **options)
    with warnings.catch_warnings():
        # That a box has no bounds is all that it may complain of.
        warnings.filterwarnings("error")
        warnings.filterwarnings("ignore", message=".*infinity. This is probably too")
        warnings.filterwarnings("ignore", message=".*alternative to `make`")
        check_env(environment.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", IDS)
def test_many_keep_to_their_spaces_and_end_together(name: str) -> None:
    many = gymnasium.make_vec(name, num_envs=5, **SHORT)
    observed, _ = many.reset(seed=3)
    assert observed in many.observation_space
    for count in range(1, 45):
        observed, rewards, terminated, truncated, _ = many.step(many.action_space.sample())
        assert observed in many.observation_space
        assert np.isfinite(observed).all()
        assert rewards.shape == (5,)
        assert (rewards <= 0.0).all()
        assert not terminated.any()
        # Twenty steps, and one that begins the next episode.
        assert truncated.all() == (count % 21 == 20)
        assert not rewards.any() == (count % 21 == 0)


def test_a_plant_is_that_of_a_run() -> None:
    """To rounding: runs of fixed steps of one actuator add the same terms in another order."""
    text = learning._named.HANGING_MASS + '[command]\nkind = "table"\ntime = ["0 ms", "12 ms", "20 ms"]\n'
    text = text.replace('[command]\nkind = "pwm"\nfrequency = "25 Hz"\nduty = 0.5\n', "")
    text += 'state = ["fill", "exhaust", "fill"]\n'
    scenario = mckibben.Scenario(text).with_values({"run.duration": "40 ms", "run.sample_interval": "1 ms"})
    run = mckibben.simulate(scenario)
    options = {"action_mode": "request", "control_period": 1e-3, "scenario": scenario}
    many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=3, **options)
    many.reset(seed=0)
    for count in range(40):
        many.step(np.full(3, int(not 12 <= count < 20)))
        shown = dict(zip(many.unwrapped.columns, many.unwrapped.observations.T, strict=True))
        np.testing.assert_allclose(shown["length_m"], run.length[count + 1], rtol=1e-12)
        np.testing.assert_allclose(shown["absolute_pressure_pa"], run.absolute_pressure[count + 1], rtol=1e-12)


def lengths(many: Any, steps: int, duty: float = 0.5) -> np.ndarray:
    """The lengths of all muscles after each step under a duty cycle."""
    actions = np.full(many.action_space.shape, duty, dtype=np.float32)
    shown = []
    for _ in range(steps):
        many.step(actions)
        shown.append(many.unwrapped.observations[:, 0].copy())
    return np.array(shown)


def made(count: int = 4, **options: Any) -> Any:
    return gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=count, **options)


def test_the_same_seed_is_the_same_run_and_another_is_another() -> None:
    options = {"noise": {"length_m": 1e-4}, "randomize": {"load.mass": (1.0, 3.0)}}
    many = made(**options)
    runs = []
    for seed in (5, 5, 6):
        seen = [many.reset(seed=seed)[0]]
        for _ in range(30):
            seen.append(many.step(np.full((4, 1), 0.5, dtype=np.float32))[0])
        runs.append(np.array(seen))
    assert (runs[0] == runs[1]).all()
    assert (runs[0] != runs[2]).any()


@pytest.mark.parametrize("name", IDS)
def test_what_comes_out_of_a_pickle_is_the_same_environment(name: str) -> None:
    alone = gymnasium.make(name, action_mode="request", noise={}, sensor_delay=0.08, **SHORT).unwrapped
    many = gymnasium.make_vec(name, num_envs=3, autoreset_mode="same-step", action_delay=0.04, **SHORT).unwrapped
    for environment in (alone, many):
        copied = pickle.loads(pickle.dumps(environment))
        assert copied.metadata == environment.metadata and copied.dt == environment.dt
        environment.action_space.seed(1)
        for which in (environment, copied):
            which.reset(seed=7)
        # Only the vector form resets automatically.
        for _ in range(20 if environment is alone else 25):
            action = environment.action_space.sample()
            for one, other in zip(environment.step(action)[:4], copied.step(action)[:4], strict=True):
                np.testing.assert_array_equal(one, other)


def test_numbers_that_are_drawn_are_those_of_the_plant() -> None:
    masses = np.array([1.0, 1.5, 2.0, 2.5])
    many = made(randomize={"load.mass": lambda _, count: masses[:count]})
    # Without a seed one call draws for all plants.
    many.reset()
    drawn = lengths(many, 50)
    for row, mass in enumerate(masses):
        alone = made(1, scenario=many.unwrapped._episodes.task.scenario.with_values({"load.mass": f"{mass} kg"}))
        alone.reset(seed=0)
        assert (lengths(alone, 50)[:, 0] == drawn[:, row]).all()


def test_noise_has_its_standard_deviation_and_acts_on_observations_only() -> None:
    many = made(4000, noise={"length_m": 2e-4})
    observed, _ = many.reset(seed=2)
    low, high = many.unwrapped._episodes.task.targets["length_m"]
    seen = low + (high - low) * observed[:, 0].astype(float)
    error = seen - many.unwrapped.observations[:, 0]
    # Four standard errors of the mean and of the standard deviation of 4000 draws.
    assert abs(error.mean()) < 4 * 2e-4 / np.sqrt(4000)
    assert abs(error.std() / 2e-4 - 1.0) < 4 / np.sqrt(8000)
    assert len(set(many.unwrapped.observations[:, 0])) == 1


def test_what_is_seen_is_as_old_and_what_is_done_as_late_as_was_said() -> None:
    fast = {"control_period": 1e-3}
    plain, old, late = made(2, **fast), made(2, sensor_delay=3e-3, **fast), made(2, action_delay=3e-3, **fast)
    for many in (plain, old, late):
        many.reset(seed=4)
    actions = np.full((2, 1), 0.5, dtype=np.float32)
    seen = {many: [many.step(actions)[0] for _ in range(60)] for many in (plain, old)}
    for count in range(3, 60):
        # Length, velocity and pressure; the controller knows its own pulses.
        assert (seen[old][count][:, :3] == seen[plain][count - 3][:, :3]).all()
        assert (seen[old][count][:, 3:] == seen[plain][count][:, 3:]).all()
    # For three steps a muscle without a command does the same as one whose command is exhaust.
    rest = made(2, **fast)
    rest.reset(seed=4)
    reference = np.concatenate([lengths(rest, 3, 0.0), lengths(rest, 30)])
    assert (lengths(late, 33) == reference).all()
    with pytest.raises(mckibben.InputError, match="multiple of control_period"):
        made(1, sensor_delay=1.5e-3)


def test_both_ways_of_beginning_again_and_none() -> None:
    same = made(2, autoreset_mode="same-step", **SHORT)
    disabled = made(2, autoreset_mode="disabled", **SHORT)
    for many in (same, disabled):
        first, _ = many.reset(seed=9)
        for _ in range(20):
            observed, _, _, truncated, info = many.step(np.zeros((2, 1), dtype=np.float32))
        assert truncated.all()
        if many is same:
            assert (np.stack(info["final_obs"])[:, 0] != first[:, 0]).all()
            assert (observed[:, :3] == first[:, :3]).all()
        else:
            observed, _ = many.reset(options={"reset_mask": np.array([True, False])})
            assert (observed[0, :3] == first[0, :3]).all()
            assert (observed[1, :3] != first[1, :3]).all()


def test_requests_are_those_that_the_valve_can() -> None:
    three = made(1, action_mode="request")
    assert three.single_action_space.n == 2
    held = three.unwrapped._episodes.task.scenario.with_values({"valve.kind": "fill-hold-exhaust"})
    assert made(1, action_mode="request", scenario=held).single_action_space.n == 3
    # A five-way valve that fills or exhausts its outputs at rest does so on a request to hold.
    outputs = three.unwrapped._episodes.task.scenario.with_values({"valve.kind": "five-way-exhausted"})
    assert made(1, action_mode="request", scenario=outputs).single_action_space.n == 3
    joint = gymnasium.make("mckibben/Joint-v0", action_mode="request")
    assert list(joint.action_space.nvec) == [2, 2]


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(mckibben.InputError, match="no option.*scenario, targets, .*noise, .*render_mode, autoreset_mode"):
        made(1, nois={})
    with pytest.raises(mckibben.InputError, match="`target` is no option.*scenario, targets, .*render_mode$"):
        learning.Environment("HangingMass", target={"length_m": (0.07, 0.08)})
    with pytest.raises(mckibben.InputError, match="(?s)foo.*`randomize`"):
        made(1, randomize={"foo": (1.0, 2.0)})
    with pytest.raises(mckibben.InputError, match="(?s)load.mas.*`parameters`"):
        VectorPlant(learning.task("HangingMass").scenario, 2, parameters=["load.mas"])
    with pytest.raises(mckibben.InputError, match="is no column of this plant; name one of length_m"):
        made(1, targets={"angle_rad": (0.0, 1.0)})
    with pytest.raises(mckibben.InputError, match="is no column of this plant"):
        made(1, noise={"length": 1e-3})
    with pytest.raises(mckibben.InputError, match="did you mean `load.mass`"):
        made(1, randomize={"load.maas": (1.0, 2.0)})
    with pytest.raises(mckibben.InputError, match="no action_mode"):
        made(1, action_mode="dutty")
    plants = VectorPlant(learning.task("HangingMass").scenario, 2)
    shown, stopped = np.zeros((2, 4)), np.zeros(2, dtype=bool)
    with pytest.raises(mckibben.InputError, match="command.duty"):
        plants.step(np.array([[0.5], [1.5]]), 1e-3, shown, stopped)
    with pytest.raises(mckibben.InputError, match="another shape"):
        plants.step(np.zeros((3, 1)), 1e-3, shown, stopped)
    with pytest.raises(mckibben.InputError, match="no step in time"):
        plants.step(np.zeros((2, 1)), -1e-3, shown, stopped)
    for wrong in (2, -1):
        for call in (plants.restart, lambda rows: plants.observe(rows, shown)):
            with pytest.raises(mckibben.InputError, match=rf"(?s)rows\[1\] = {wrong} is the index of no instance.*from 0 to 1"):
                call(np.array([0, wrong]))
    with pytest.raises(mckibben.InputError, match=r"rows\[2\] = 1 is the instance of rows\[0\] again"):
        plants.restart(np.array([1, 0, 1]))
    assert not shown.any()


def test_a_non_physical_state_ends_only_the_episode_of_its_plant() -> None:
    # A step as long as this leaves the physics for the fast one of them.
    scenario = learning.task("HangingMass").scenario.with_values({"run.step": "100 ms"})
    volumes = [1e-2, 1e-6]
    many = made(
        2,
        scenario=scenario,
        control_period=0.1,
        action_mode="request",
        randomize={"actuator.external_volume": lambda _, count: np.array(volumes[:count])},
    )
    many.reset()
    ended = np.zeros(2, dtype=int)
    for _ in range(20):
        observed, _, terminated, _, _ = many.step(np.ones(2, dtype=int))
        ended += terminated
        assert np.isfinite(observed).all()
    assert ended[0] == 0
    assert ended[1] > 0
