"""Many plants in episodes of their own: what both forms of an environment are made of."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mckibben._mckibben import Plants
from mckibben.errors import InputError
from mckibben.learning._tasks import Task

Numbers = NDArray[np.float64]
Observations = NDArray[np.float32]
Draw = tuple[float, float] | Callable[[np.random.Generator, int], Any]

@dataclass(frozen=True)
class Options:
    """What an environment is told beside its task.

    `asked` is what an action means to each valve: "duty" (a duty cycle, 0 to 1), "request" (a number for exhaust, hold or
    fill, as far as the valve can), "position" of a proportional spool (-1 to 1) or "set-point" of a pressure regulator (0 to
    1 of `most_pressure`). An action holds for `control_period` in s, and an episode lasts `duration` in s, that of the
    scenario unless given.

    `noise` is the standard deviation in SI of what is seen of a column; what is seen is `sensor_delay` in s old, and an
    action is done `action_delay` in s late. `randomize` are paths of numbers of the plant that are drawn anew for each
    episode: uniformly between two ends in SI, or by a function of a generator and how many are wanted. Everything random is
    drawn from the generator that `reset(seed=...)` seeds.
    """

    asked: str = "duty"
    control_period: float = 1e-3
    duration: float | None = None
    pulse_frequency: float | None = None
    most_pressure: float = 6e5
    noise: Mapping[str, float] = field(default_factory=dict)
    sensor_delay: float = 0.0
    action_delay: float = 0.0
    randomize: Mapping[str, Draw] = field(default_factory=dict)

    def periods(self, name: str, time: float) -> int:
        """How many control periods a time is."""
        count = round(time / self.control_period)
        if not (time >= 0.0 and abs(time - count * self.control_period) <= 1e-9 * max(time, self.control_period)):
            period = self.control_period
            raise InputError(f"{name} = {time} s is no multiple of control_period = {period} s; give one, or zero")
        return count


class Episodes:
    """Plants that are told what to do, observed and rewarded."""

    def __init__(self, task: Task, count: int, options: Options) -> None:
        if not options.control_period > 0.0:
            raise InputError(f"control_period = {options.control_period} s is no period; give one above zero")
        self.task, self.count, self.options = task, count, options
        self.plants = Plants(
            task.scenario,
            count,
            by=list(options.randomize),
            asked=options.asked,
            pulse_frequency=options.pulse_frequency,
            leg=None if task.leg is None else dict(task.leg),
        )
        duration = self.plants.duration if options.duration is None else options.duration
        self.periods = max(1, options.periods("duration", duration))
        columns = {name: place for place, name in enumerate(self.plants.columns)}
        known = ", ".join(columns)
        for name in (*options.noise, *task.targets, *(seen.column for seen in task.seen)):
            if name not in columns:
                raise InputError(f"`{name}` is nothing that is seen of this plant; name one of {known}")
        # Column by column: NumPy is slow along rows of a few numbers.
        self._seen = [(columns[seen.column], seen.zero, 1.0 / seen.unit) for seen in task.seen]
        noise = np.array([options.noise.get(seen.column, 0.0) / seen.unit for seen in task.seen])
        self._noise = noise if noise.any() else None
        self._aimed = [(columns[name], low, 1.0 / (high - low)) for name, (low, high) in task.targets.items()]
        self._requests = np.array(self.plants.requests) if options.asked == "request" else None
        width, valves = len(columns), self.plants.valves
        self.shown = np.zeros((count, width))
        self.stopped = np.zeros(count, dtype=bool)
        self.aims = np.zeros((count, len(self._aimed)))
        self.elapsed = np.zeros(count, dtype=np.int64)
        self._asked = np.zeros((count, valves))
        self._late = [np.zeros((count, valves)) for _ in range(options.periods("action_delay", options.action_delay))]
        self._old = [
            np.zeros((count, len(task.seen)), dtype=np.float32) for _ in range(options.periods("sensor_delay", options.sensor_delay))
        ]
        self._clock = 0

    def action_space(self) -> gymnasium.Space[Any]:
        """The actions of one plant."""
        valves = self.plants.valves
        if self._requests is not None:
            choices = len(self._requests)
            return gymnasium.spaces.Discrete(choices) if valves == 1 else gymnasium.spaces.MultiDiscrete([choices] * valves)
        low = -1.0 if self.options.asked == "position" else 0.0
        return gymnasium.spaces.Box(low, 1.0, (valves,), np.float32)

    def observation_space(self) -> gymnasium.Space[Any]:
        """The observations of one plant."""
        size = len(self.task.seen) + len(self.task.targets)
        return gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)

    def rest(self) -> float:
        """What is asked of a valve by nobody: the least there is."""
        return -1.0 if self.options.asked in ("request", "position") else 0.0

    def begin(self, random: np.random.Generator) -> Observations:
        """All begin an episode at t = 0."""
        self.plants.start(self._drawn(random, self.count))
        everyone = np.arange(self.count)
        return self._enter(random, everyone)[everyone]

    def begin_again(self, random: np.random.Generator, rows: NDArray[np.int64]) -> Observations:
        """Some begin another episode; what all of them see then."""
        self.plants.restart(rows, self._drawn(random, len(rows)))
        return self._enter(random, rows)

    def _drawn(self, random: np.random.Generator, count: int) -> Numbers:
        """Numbers of plants, a row for each."""
        randomize = self.options.randomize
        drawn = np.empty((count, len(randomize)))
        for place, draw in enumerate(randomize.values()):
            drawn[:, place] = draw(random, count) if callable(draw) else random.uniform(*draw, size=count)
        return drawn

    def _enter(self, random: np.random.Generator, rows: NDArray[np.int64]) -> Observations:
        # As shares of their ranges.
        self.aims[rows] = random.random((len(rows), len(self._aimed)))
        self.elapsed[rows] = 0
        self.stopped[rows] = False
        self.plants.show(rows, self.shown)
        for late in self._late:
            late[rows] = self.rest()
        for old in self._old:
            self._sense(old, rows)
        return self._observed(random, None)

    def _sense(self, into: Observations, rows: NDArray[np.int64] | slice = slice(None)) -> None:
        """Writes what the task sees of some plants now."""
        for place, (column, zero, per_unit) in enumerate(self._seen):
            into[rows, place] = (self.shown[rows, column] - zero) * per_unit

    def _observed(self, random: np.random.Generator, old: Observations | None) -> Observations:
        """What is seen now, or what was seen as long ago as the sensors take."""
        seen = len(self._seen)
        observed = np.empty((self.count, seen + len(self._aimed)), dtype=np.float32)
        if old is None:
            self._sense(observed[:, :seen])
        else:
            observed[:, :seen] = old
        if self._noise is not None:
            observed[:, :seen] += self._noise * random.standard_normal((self.count, seen), dtype=np.float32)
        observed[:, seen:] = self.aims
        return observed

    def _rewards(self) -> Numbers:
        """Minus the distance from the targets, as a share of their ranges."""
        rewards = np.zeros(self.count)
        for place, (column, low, per_span) in enumerate(self._aimed):
            rewards -= np.abs((self.shown[:, column] - low) * per_span - self.aims[:, place])
        return rewards

    def step(self, random: np.random.Generator, actions: NDArray[Any]) -> tuple[Observations, Numbers]:
        """Does the actions, one row for each, for a control period: what is seen then, and the rewards."""
        asked = self._number(actions)
        if self._late:
            place = self._clock % len(self._late)
            late = self._late[place]
            asked, self._late[place] = late, asked
        self.plants.step(self.options.control_period, asked, self.shown, self.stopped)
        old = self._old[self._clock % len(self._old)] if self._old else None
        observed = self._observed(random, old)
        if old is not None:
            self._sense(old)
        self._clock += 1
        self.elapsed += 1
        return observed, self._rewards()

    def _number(self, actions: NDArray[Any]) -> Numbers:
        """Actions as the numbers that plants take. Those beyond the bounds count as the bound."""
        shape = (self.count, self.plants.valves)
        if self._requests is not None:
            return self._requests[np.asarray(actions, dtype=np.int64).reshape(shape)]
        low = -1.0 if self.options.asked == "position" else 0.0
        numbers = np.clip(np.asarray(actions, dtype=np.float64).reshape(shape), low, 1.0)
        return numbers * self.options.most_pressure if self.options.asked == "set-point" else numbers

    def finished(self) -> NDArray[np.bool_]:
        """Which episodes have lasted their time."""
        lasted: NDArray[np.bool_] = self.elapsed >= self.periods
        return lasted
