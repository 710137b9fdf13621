"""Environments: the vector form is Gymnasium's vector of single forms, bit for bit, with its `info`."""

from typing import Any

import gymnasium
import numpy as np
import pytest

import mckibben.learning  # noqa: F401  registers the environments

IDS = ["mckibben/HangingMass-v0", "mckibben/Joint-v0", "mckibben/Leg-v0", "mckibben/Arm-v0"]
MODES = {"next-step": "NextStep", "same-step": "SameStep", "disabled": "Disabled"}
COUNT = 3


def both(name: str, mode: str, **options: Any) -> tuple[Any, Any]:
    """The vector form, and Gymnasium's vector of single forms."""
    many = gymnasium.make_vec(name, num_envs=COUNT, autoreset_mode=mode, **options)
    kwargs = {"autoreset_mode": MODES[mode]}
    return many, gymnasium.make_vec(name, num_envs=COUNT, vectorization_mode="sync", vector_kwargs=kwargs, **options)


def assert_same(one: Any, other: Any, what: str) -> None:
    """Equal keys, types, shapes and bits."""
    if isinstance(one, dict):
        assert set(one) == set(other), what
        for key in one:
            assert_same(one[key], other[key], f"{what}: {key}")
    elif isinstance(one, np.ndarray) and one.dtype == object:
        assert other.dtype == object and one.shape == other.shape, what
        for place, (entry, its) in enumerate(zip(one, other, strict=True)):
            assert_same(entry, its, f"{what}[{place}]")
    elif one is None:
        assert other is None, what
    else:
        assert one.dtype == other.dtype and one.shape == other.shape, what
        np.testing.assert_array_equal(one, other, err_msg=what)


def hard(name: str) -> dict[str, Any]:
    """Noise, delays and drawn parameters, with episodes of a few steps."""
    path = "actuator.friction.viscous"
    drawn = {path: lambda random, count: random.uniform(2, 5, count)}
    if name.endswith("HangingMass-v0"):
        drawn["load.mass"] = (1.5, 3.0)
    noise = {column: 1e-3 for column in gymnasium.make(name).unwrapped.columns if column.endswith(("length_m", "angle_rad"))}
    return {"noise": noise, "randomize": drawn, "control_period": 0.012, "sensor_delay": 0.012, "max_episode_steps": 4}


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", [7, [5, 11, 2]])
def test_it_is_gymnasiums_vector_of_single_ones_bit_for_bit(name: str, mode: str, seed: Any) -> None:
    """Over several episodes; control is out of step with the pulses, so that the clock counts."""
    forms = both(name, mode, **hard(name))
    (one, info), (other, its) = (form.reset(seed=seed) for form in forms)
    assert len({row.tobytes() for row in one}) == COUNT
    forms[0].action_space.seed(1)
    ends = 0
    for _ in range(14):
        assert_same(one, other, "observations")
        assert_same(info, its, "info")
        actions = forms[0].action_space.sample()
        (one, *rest, info), (other, *of_other, its) = (form.step(actions) for form in forms)
        for what, ours, theirs in zip(("rewards", "terminated", "truncated"), rest, of_other, strict=True):
            assert_same(ours, theirs, what)
        if rest[2].any():
            ends += 1
            assert ("final_info" in info) == (mode == "same-step")
            if mode == "disabled":
                (one, info), (other, its) = (form.reset() for form in forms)
    assert ends >= 2


def test_info_of_some_plants_that_begin_has_their_flags() -> None:
    forms = both(IDS[0], "disabled")
    for form in forms:
        form.reset(seed=1)
        form.step(np.full((COUNT, 1), 0.5, dtype=np.float32))
    mask = np.array([False, True, False])
    (_, info), (_, its) = (form.reset(seed=[4, 5, 6], options={"reset_mask": mask.copy()}) for form in forms)
    assert_same(info, its, "info")
    assert (info["_length_m"] == mask).all()


def test_final_info_has_the_flags_of_those_that_ended() -> None:
    """One plant begins two steps after the others, and so do its later episodes."""
    many = gymnasium.make_vec(IDS[0], num_envs=COUNT, autoreset_mode="same-step", max_episode_steps=4)
    many.reset(seed=1)
    late = np.array([False, True, False])
    actions = np.full((COUNT, 1), 0.5, dtype=np.float32)
    for _ in range(2):
        many.step(actions)
    many.reset(options={"reset_mask": late})
    ended = []
    for _ in range(4):
        observed, _, _, truncated, info = many.step(actions)
        if "final_info" not in info:
            assert not truncated.any()
            continue
        ended.append(truncated)
        for flags in (info["_final_obs"], info["_final_info"], info["final_info"]["_length_m"]):
            assert (flags == truncated).all()
        for place in range(COUNT):
            assert (info["final_obs"][place] is not None) == truncated[place]
            assert (info["final_info"]["length_m"][place] != 0.0) == truncated[place]
        assert info["_length_m"].all() and (info["length_m"] > 0.0).all()
        assert (many.unwrapped.observations[truncated, 1] == 0.0).all(), "they have begun again"
    assert [flags.tolist() for flags in ended] == [(~late).tolist(), late.tolist()]
