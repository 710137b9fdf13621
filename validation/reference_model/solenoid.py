"""Commands that are known beforehand: the states of a valve, and when."""

import math
from dataclasses import dataclass
from itertools import pairwise

SAME_INSTANT = 1e-12  # s


@dataclass(frozen=True)
class Command:
    """Commanded states, (instant in s, state), for as long as `until` is asked."""

    frequency: float  # Hz; 0 for a table
    duty: float
    steps: tuple

    @staticmethod
    def pwm(frequency, duty):
        return Command(frequency, duty, ())

    @staticmethod
    def table(times, states):
        if times[0] != 0 or any(b <= a for a, b in pairwise(times)):
            raise ValueError("a command's times must start at 0 s and increase")
        return Command(0.0, math.nan, tuple(zip(times, states, strict=True)))

    def until(self, duration):
        """The states commanded from 0 to `duration`."""
        if self.steps:
            return list(self.steps)
        steps = []
        for period in range(int(duration * self.frequency) + 2):
            steps.append((period / self.frequency, "fill"))
            steps.append(((period + self.duty) / self.frequency, "exhaust"))
        if self.duty <= 0:
            return [(0.0, "exhaust")]
        return [(0.0, "fill")] if self.duty >= 1 else steps
