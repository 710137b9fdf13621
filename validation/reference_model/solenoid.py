"""Section 6: from the command to the instants at which the seats move.

A coil is energised on intervals of time. Its seat opens `t_open` after the coil is energised and
shuts `t_close` after it is released; a change of the coil cancels a movement that is still pending.
Before t = 0 every coil has been released for long.
"""

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


def seat_movements(coil, opening_delay, closing_delay):
    """(instant, open) for a coil given as (instant, energised); the seat is shut at first."""
    movements = []
    energised, seat_open = False, False
    pending = None
    for instant, wanted in [*coil, (math.inf, None)]:
        if pending is not None and pending <= instant + SAME_INSTANT and pending < math.inf:
            seat_open = energised
            movements.append((pending, seat_open))
            pending = None
        if wanted is None or wanted == energised:
            continue
        energised = wanted
        pending = None
        if energised != seat_open:
            pending = instant + (opening_delay if energised else closing_delay)
    return movements


def port_movements(kind, command, opening_delay, closing_delay, duration):
    """(instant, (supply open, exhaust open)) in order of time; the first entry is that before 0."""
    steps = command.until(duration)
    if kind == "three-way":
        if any(state == "hold" for _, state in steps):
            raise ValueError("a three-way valve cannot hold")
        coil = [(t, state == "fill") for t, state in steps]
        seats = seat_movements(coil, opening_delay, closing_delay)
        return [(-math.inf, (False, True))] + [(t, (up, not up)) for t, up in seats]
    if kind != "fill-hold-exhaust":
        raise ValueError(f"the reference has no valve {kind!r}")
    movements = []
    for port, name in enumerate(("fill", "exhaust")):
        coil = [(t, state == name) for t, state in steps]
        seats = seat_movements(coil, opening_delay, closing_delay)
        movements += [(t, port, is_open) for t, is_open in seats]
    ports = [False, False]
    result = [(-math.inf, (False, False))]
    for instant, port, is_open in sorted(movements):
        ports[port] = is_open
        result.append((instant, tuple(ports)))
    return result
