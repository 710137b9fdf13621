"""Plants of many worlds: stepped together in vector lanes, and one after the other.

    python worlds.py

The work is a step of 1 ms with commands, the tensions before it, and the states after it equal to the bit. Both take turns, and of
each the median of rounds counts. Plants one after the other are a `HostedPlant` of three: so few are not put in lanes, and a
call from Python is shared among them.
"""

from __future__ import annotations

import os
import pathlib
import statistics
import time

import numpy as np

import mckibben

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEP, STEPS, ROUNDS, FEW = 1e-3, 40, 9, 3

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
        self.plant = mckibben.HostedPlant(scenario, count, command_mode="duty", pulse_frequency=25.0)
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


def main() -> None:
    scenarios = {
        "a muscle": mckibben.Scenario.from_dict(MUSCLE),
        "an arm of six muscles": mckibben.Scenario.from_file(ROOT / "examples" / "plant" / "arm.toml"),
    }
    for name, scenario in scenarios.items():
        counts = [FEW, 64, 1024]
        worlds = {count: Worlds(scenario, count) for count in counts}
        times: dict[int, list[float]] = {count: [] for count in counts}
        for _ in range(ROUNDS):
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
                f"{medians[FEW] / 1e3:.2f} us, {ratio:.1f} times as long; load {os.getloadavg()[0]:.1f}"
            )


if __name__ == "__main__":
    main()
