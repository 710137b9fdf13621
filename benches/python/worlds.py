"""Plants of many worlds: stepped together in vector lanes, and one after the other.

    python worlds.py [--counts 64 1024] [--rounds 9]
    python worlds.py --counts 1000000 --rounds 1 --muscle

The work is a step of 1 ms with commands, the tensions before it, and the states after it equal to the bit. Both take turns, and of
each the median of rounds counts. Plants one after the other are a `HostedPlant` of three: so few are not put in lanes, and a
call from Python is shared among them. It is also printed how long it takes to make the worlds, and how much memory they keep.
"""

from __future__ import annotations

import argparse
import os
import pathlib
import statistics
import time

import numpy as np

import mckibben

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEP, STEPS, FEW = 1e-3, 40, 3

MUSCLE = {
    "supply": {"gauge_pressure": "100 psi"},
    "valve": {"preset": "matrix-eight-channel"},
    "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
    "load": {"kind": "isometric"},
    "initial": {"length": "90 mm", "gauge_pressure": "40 psi"},
    "run": {"duration": "1 s"},
}


class Worlds:
    """Plants whose ends go to and fro, under duty cycles that hold for a period of the pulses."""

    def __init__(self, scenario: mckibben.Scenario, count: int) -> None:
        kept, began = memory(), time.perf_counter()
        self.plant = mckibben.HostedPlant(scenario, count, command_mode="duty", pulse_frequency=25.0)
        self.made, self.kept = (time.perf_counter() - began) / count, (memory() - kept) / count
        self.begin = self.plant.distances
        self.still = np.zeros_like(self.begin)
        self.commands = np.random.default_rng(1).uniform(0.3, 0.7, (FEW, len(self.plant.commands)))
        self.commands = np.resize(self.commands, (count, len(self.plant.commands)))
        self.count, self.step = count, 0

    def go(self) -> float:
        """ns for a plant's step."""
        began = time.perf_counter()
        for _ in range(STEPS):
            self.step += 1
            distances = self.begin - 1e-5 * (self.step % 2)
            self.plant.compute(distances, self.still)
            self.plant.step(distances, self.commands, STEP)
        return 1e9 * (time.perf_counter() - began) / (STEPS * self.count)


def memory() -> int:
    """Bytes that this process has in memory."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--counts", type=int, nargs="+", default=[64, 1024], help="how many worlds")
    parser.add_argument("--rounds", type=int, default=9, help="rounds of which the median counts")
    parser.add_argument("--muscle", action="store_true", help="the muscle alone, without the arm")
    arguments = parser.parse_args()
    scenarios = {"a muscle": mckibben.Scenario.from_dict(MUSCLE)}
    if not arguments.muscle:
        scenarios["an arm of six muscles"] = mckibben.Scenario.from_file(ROOT / "examples" / "plant" / "arm.toml")
    for name, scenario in scenarios.items():
        counts = [FEW, *arguments.counts]
        worlds = {count: Worlds(scenario, count) for count in counts}
        times: dict[int, list[float]] = {count: [] for count in counts}
        for _ in range(arguments.rounds):
            for count in counts:
                times[count].append(worlds[count].go())
        few = worlds[FEW].plant.save()
        for count in counts:
            assert (worlds[count].plant.save()[:FEW] == few).all()
        medians = {count: statistics.median(of) for count, of in times.items()}
        for count in counts[1:]:
            ratio = medians[FEW] / medians[count]
            print(
                f"{name}, {count} worlds: {medians[count] / 1e3:.2f} us of wall time for a step of one; one after the other "
                f"{medians[FEW] / 1e3:.2f} us, {ratio:.1f} times as long; load {os.getloadavg()[0]:.1f}; "
                f"made in {1e6 * worlds[count].made:.1f} us each, of {worlds[count].kept / 1e3:.1f} kB"
            )


if __name__ == "__main__":
    main()
