"""How many environment steps a second the vector environments take, at 1 kHz control on all cores.

    python benches/python/environments.py [--muscles 4096] [--seconds 5]

Needs the package as `pip install ".[learning]"` builds it. Of each step it tells what share is the engine's, `Plants.step`
alone on actions drawn in the same way. Episodes end and begin anew meanwhile. It asserts that the muscles do what they are
for: those that are filled shorten. What error a run.step leaves is in docs/accuracy.md.
"""

import argparse
import time

import gymnasium
import numpy as np

import mckibben.learning  # noqa: F401


def rate(name: str, count: int, seconds: float, **options: object) -> tuple[float, float, float]:
    """Environment steps a second, the nanoseconds of one and those of its engine."""
    many = gymnasium.make_vec(name, num_envs=count, duration=1.0, **options)
    many.reset(seed=1)
    random = np.random.default_rng(2)
    actions = [many.action_space.sample() for _ in range(8)]
    asked = [many.unwrapped._episodes._number(action) for action in actions]
    plants, episodes = many.unwrapped._episodes.plants, many.unwrapped._episodes
    spent, in_engine, steps = 0.0, 0.0, 0
    while spent + in_engine < seconds:
        one, another = random.integers(8, size=2)
        begun = time.perf_counter()
        many.step(actions[one])
        spent += time.perf_counter() - begun
        begun = time.perf_counter()
        plants.step(1e-3, asked[another], episodes.shown, episodes.stopped)
        in_engine += time.perf_counter() - begun
        steps += 1
    per_step = spent / steps
    return count / per_step, per_step / count * 1e9, in_engine / steps / count * 1e9


def shortens() -> None:
    """Muscles that are filled lift their mass, and those that are let go lower it."""
    many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=2, asked="request")
    many.reset(seed=0)
    for _ in range(500):
        many.step(np.array([1, 0]))
    filled, let_go = many.unwrapped.shown[:, 0]
    assert filled < 0.075 < 0.09 < let_go, (filled, let_go)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--muscles", type=int, default=4096)
    parser.add_argument("--seconds", type=float, default=5.0)
    arguments = parser.parse_args()
    shortens()
    print(f"{'environment':<28}{'run.step':<10}{'action':<10}{'plants':>8}{'steps/s':>12}{'ns/step':>10}{'engine':>9}")
    for name, count, step in [
        ("HangingMass", arguments.muscles, None),
        ("HangingMass", arguments.muscles, "1 ms"),
        ("Joint", 1024, None),
        ("Leg", 256, None),
    ]:
        scenario = gymnasium.make(f"mckibben/{name}-v0").unwrapped._episodes.task.scenario
        if step is not None:
            scenario = scenario.with_values({"run.step": step})
        step = scenario.to_dict()["run"]["step"]
        for asked in ("duty", "request"):
            steps, cost, engine = rate(f"mckibben/{name}-v0", count, arguments.seconds, asked=asked, scenario=scenario)
            print(f"{name:<28}{step:<10}{asked:<10}{count:>8}{steps:>12.3g}{cost:>10.0f}{engine / cost:>9.0%}")


if __name__ == "__main__":
    main()
