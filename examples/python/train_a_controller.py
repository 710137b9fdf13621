# %% [markdown]
# # Train a controller
#
# A muscle of the paper hangs with a mass of 2 to 3 kg, drawn for each episode, and is to bring it to a length
# that is drawn too. The controller sees length, velocity, pressure and target, each with noise, and requests every 5 ms
# that its valve fills, holds or exhausts; the valve takes 4 ms to open. It is a small network of 37
# numbers, and the standard library [cma](https://pypi.org/project/cma) looks for them: CMA-ES tries many networks at
# once, each on some muscles of one vector environment.

# %%
import cma
import gymnasium
import matplotlib.pyplot as plt
import numpy as np
import pictures

import mckibben.learning

GENERATIONS = 60
NETWORKS, MUSCLES = 16, 16  # networks in a generation, and muscles that each is tried on
PERIOD, STEPS = 0.005, 160
EXHAUST, HOLD, FILL = 0, 1, 2
OPTIONS = {
    "scenario": mckibben.learning.task("HangingMass").scenario.with_values({"valve.kind": "fill-hold-exhaust"}),
    "action_mode": "request",
    "control_period": PERIOD,
    "duration": STEPS * PERIOD,
    "autoreset_mode": "disabled",
    "noise": {"length_m": 1e-4, "velocity_m_s": 5e-3, "absolute_pressure_pa": 1e3},
    "randomize": {"load.mass": (2.0, 3.0)},
}

# %% [markdown]
# ## A network
#
# The error of the length, the velocity, the pressure and the target go in, six neurons stand between, and a number
# comes out: above a half it fills, below minus a half it exhausts. All networks of a generation are calculated at
# once, each for its own muscles.

# %%
HIDDEN = 6
SIZES = [(4, HIDDEN), (HIDDEN,), (HIDDEN,), ()]
COUNT = sum(int(np.prod(size)) for size in SIZES)


def requests(networks: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """What networks, a row of numbers for each, answer to the observations of their muscles."""
    parts = np.split(networks, np.cumsum([int(np.prod(size)) for size in SIZES])[:-1], axis=1)
    weights, offsets, readout, offset = (part.reshape(-1, *size) for part, size in zip(parts, SIZES, strict=True))
    length, velocity, pressure, target = observed.reshape(len(networks), -1, 4).transpose(2, 0, 1)
    seen = np.stack([4.0 * (length - target), velocity, pressure, target], axis=-1)
    hidden = np.tanh(np.einsum("nmi,nih->nmh", seen, weights) + offsets[:, None, :])
    answer = np.einsum("nmh,nh->nm", hidden, readout) + offset[:, None]
    return np.select([answer > 0.5, answer < -0.5], [FILL, EXHAUST], HOLD).ravel()


# %% [markdown]
# ## Trying
#
# What a network is worth is its mean reward in a step: minus the distance from the target as a share of the 20 mm
# that targets are drawn from.

# %%
many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=NETWORKS * MUSCLES, **OPTIONS)


def worth(networks: np.ndarray, seed: int) -> np.ndarray:
    """The mean reward of each network on its muscles; the same seed draws the same muscles."""
    # Each muscle has a seed of its own, counted up from this one.
    observed, _ = many.reset(seed=seed * many.num_envs)
    total = np.zeros(len(networks))
    for _ in range(STEPS):
        observed, rewards, *_ = many.step(requests(networks, observed))
        total += rewards.reshape(len(networks), -1).mean(axis=1)
    return total / STEPS


# %% [markdown]
# ## Training

# %%
search = cma.CMAEvolutionStrategy(np.zeros(COUNT), 0.8, {"popsize": NETWORKS, "seed": 1, "verbose": -9})
rewards_over = []
for generation in range(GENERATIONS):
    networks = np.array(search.ask())
    rewards = worth(networks, seed=generation)
    search.tell(list(networks), list(-rewards))
    rewards_over.append((rewards.max(), np.median(rewards)))
trained = search.result.xfavorite
many.close()

# %% [markdown]
# ## Does it work?
#
# On muscles that it has not seen, beside what anybody would write by hand: fill where the muscle will be more than a
# millimetre too long in 60 ms, exhaust where it will be too short, and else hold. Without looking ahead the mass
# would be thrown up and down.

# %%
many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=256, **OPTIONS)


def trajectory_of(control) -> tuple[np.ndarray, np.ndarray, float]:
    """Lengths and targets in m over time, and the mean reward, under what `control` answers to observations."""
    observed, _ = many.reset(seed=1_000_000)
    lengths, total = [many.unwrapped.observations[:, 0].copy()], 0.0
    low, high = 0.070, 0.090
    targets = low + (high - low) * observed[:, 3].astype(float)
    for _ in range(STEPS):
        observed, rewards, *_ = many.step(control(observed))
        lengths.append(many.unwrapped.observations[:, 0].copy())
        total += rewards.mean() / STEPS
    return np.array(lengths), targets, total


def by_hand(observed: np.ndarray) -> np.ndarray:
    """Lengths are in ranges of 20 mm, velocities in such ranges per 0.1 s."""
    too_long = observed[:, 0] + 0.6 * observed[:, 1] - observed[:, 3]
    return np.select([too_long > 0.05, too_long < -0.05], [FILL, EXHAUST], HOLD)


_, _, first = trajectory_of(by_hand)
lengths, targets, reward = trajectory_of(lambda observed: requests(trained[None, :], observed))
late = np.abs(lengths[-40:] - targets).mean(axis=0)
print(f"mean reward: trained {reward:.3f}, by hand {first:.3f}")
print(f"distance from the target in the last 0.2 s: median {np.median(late) * 1e3:.2f} mm of 20 mm")
assert reward > 0.6 * first, "the trained controller is not much better than that by hand"

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.2))
for values, label in zip(np.transpose(rewards_over), ["best of a generation", "median"], strict=True):
    left.plot(values, label=label)
left.axhline(first, color="0.6", linestyle="--", label="by hand")
left.set(xlabel="generation", ylabel="mean reward", title="Training")
left.legend()
time = np.arange(STEPS + 1) * PERIOD
for colour, row in zip(pictures.COLOURS, np.argsort(targets)[16::56], strict=False):
    right.plot(time, lengths[:, row] * 1e3, color=colour)
    right.axhline(targets[row] * 1e3, color=colour, linestyle=":", linewidth=1)
right.set(xlabel="time in s", ylabel="length in mm", title="Muscles it has not seen, and their targets")
pictures.save(figure, "train-a-controller")
