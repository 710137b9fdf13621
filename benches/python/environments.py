"""How many environment steps a second the vector environments take on all cores, where every action matters.

    python benches/python/environments.py [--muscles 4096] [--seconds 2] [--runs 7]

Needs the package as `pip install ".[learning]"` builds it. An action holds as long as it does by default: a duty cycle for a
pulse of 40 ms, a request for 5 ms, another at each step. Printed are medians over the runs with the least and the greatest,
how many seconds of its plants' time that is in a second, what one core spends on a step, and which share of that is the
engine's, `VectorPlant.step` alone on actions drawn in the same way. Runs of all environments alternate, so that a change of the
machine's load meets all; the load is printed at the end. Episodes end and begin again meanwhile. It asserts that the muscles
do what they are for: those that are filled shorten. What error a run.step leaves is in docs/accuracy.md.
"""

import argparse
import os
import statistics
import time
from typing import NamedTuple

import gymnasium
import numpy as np

import mckibben.learning  # noqa: F401


class Rate(NamedTuple):
    """What a run took: steps a second, seconds of a core for one, and the share of the engine in that."""

    steps: float
    core: float
    engine: float


class Bench:
    """One vector environment under random actions."""

    def __init__(self, name: str, count: int, step: str | None, mode: str) -> None:
        scenario = gymnasium.make(f"mckibben/{name}-v0").unwrapped._episodes.task.scenario
        if step is not None:
            scenario = scenario.with_values({"run.step": step})
        self.name, self.count, self.mode, self.step = name, count, mode, str(scenario.to_dict()["run"]["step"])
        self.many = gymnasium.make_vec(f"mckibben/{name}-v0", num_envs=count, scenario=scenario, action_mode=mode)
        self.many.reset(seed=1)
        self.period = self.many.unwrapped.dt
        self.random = np.random.default_rng(2)
        self.actions = [self.many.action_space.sample() for _ in range(8)]
        self.commands = [self.many.unwrapped._episodes._commands(action) for action in self.actions]

    def run(self, seconds: float) -> Rate:
        """Steps the environment, and the engine alone, in turn."""
        episodes = self.many.unwrapped._episodes
        wall, core, engine, steps = 0.0, 0.0, 0.0, 0
        began = time.perf_counter()
        while time.perf_counter() - began < seconds:
            one, another = self.random.integers(8, size=2)
            before = time.perf_counter(), time.process_time()
            self.many.step(self.actions[one])
            wall, core = wall + time.perf_counter() - before[0], core + time.process_time() - before[1]
            before_engine = time.process_time()
            episodes.plants.step(self.commands[another], self.period, episodes.observations, episodes.stopped)
            engine += time.process_time() - before_engine
            steps += self.count
        return Rate(steps / wall, core / steps, engine / core)


def shortens() -> None:
    """Muscles that are filled lift their mass, and those that are let go lower it."""
    many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=2, action_mode="request")
    many.reset(seed=0)
    for _ in range(100):
        many.step(np.array([1, 0]))
    filled, let_go = many.unwrapped.observations[:, 0]
    assert filled < 0.075 < 0.09 < let_go, (filled, let_go)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--muscles", type=int, default=4096)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--runs", type=int, default=7)
    arguments = parser.parse_args()
    shortens()
    plants = [("HangingMass", arguments.muscles, None), ("HangingMass", arguments.muscles, "1 ms"), ("Joint", 1024, None)]
    plants += [("Joint", 4096, None), ("Leg", 256, None), ("Arm", 256, None)]
    benches = [Bench(*plant, mode) for plant in plants for mode in ("duty", "request")]
    load = [os.getloadavg()[0]]
    runs: list[list[Rate]] = [[] for _ in benches]
    for _ in range(arguments.runs):
        for bench, rates in zip(benches, runs, strict=True):
            rates.append(bench.run(arguments.seconds))
        load.append(os.getloadavg()[0])
    print(f"{'environment':<13}{'run.step':<10}{'action':<9}{'period':>8}{'plants':>8}"
          f"{'steps/s':>11}{'least':>10}{'greatest':>10}{'s/s':>10}{'core':>11}{'engine':>8}")
    for bench, rates in zip(benches, runs, strict=True):
        steps = [rate.steps for rate in rates]
        middle = statistics.median(steps)
        core, engine = (statistics.median(getattr(rate, name) for rate in rates) for name in ("core", "engine"))
        print(f"{bench.name:<13}{bench.step:<10}{bench.mode:<9}{bench.period * 1e3:>5.3g} ms{bench.count:>8}"
              f"{middle:>11.3g}{min(steps):>10.3g}{max(steps):>10.3g}{middle * bench.period:>10.3g}"
              f"{core * 1e6:>8.3g} µs{engine:>8.0%}")
    print(f"{os.cpu_count()} cores, load {min(load):.1f} to {max(load):.1f}, median of {arguments.runs} runs")


if __name__ == "__main__":
    main()
