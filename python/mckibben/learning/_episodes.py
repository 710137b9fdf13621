"""Episodes of many plants: the common part of both forms of an environment."""

from collections.abc import Iterator, Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from mckibben._mckibben import VectorPlant
from mckibben.errors import InputError
from mckibben.learning._draws import Numbers, Places, Source, check, drawn
from mckibben.learning._options import MAX_PRESSURE, Options, periods
from mckibben.learning._phase import Phase
from mckibben.learning._tasks import Task

Observations = NDArray[np.float32]


class Episodes:
    """Plants with commands, observations and rewards, each in an episode."""

    def __init__(self, task: Task, count: int, options: Options) -> None:
        self.task, self.count, self.options = task, count, options
        try:
            self.plants = VectorPlant(
                task.scenario,
                count,
                parameters=list(options.drawn),
                action_mode=options.action_mode,
                pulse_frequency=options.pulse_frequency,
                precision=options.precision,
            )
        except InputError as error:
            # The message names the argument that the caller gave.
            raise InputError(str(error).replace("`parameters`", "`randomize`")) from None
        check(options.drawn, self.plants)
        self.period = options.period(self.plants)
        self.periods = options.steps(self.plants, self.period)
        columns = {name: place for place, name in enumerate(self.plants.columns)}
        known = ", ".join(columns)
        for name in (*options.deviations, *task.targets, *(seen.column for seen in task.seen)):
            if name not in columns:
                raise InputError(f"`{name}` is no column of this plant; name one of {known}")
        # Column by column: NumPy is slow along rows of a few numbers.
        self._seen = [(columns[seen.column], seen.zero, 1.0 / seen.unit) for seen in task.seen]
        noise = np.array([options.deviations.get(seen.column, 0.0) / seen.unit for seen in task.seen])
        self._noise = noise if noise.any() else None
        self._aimed = [(columns[name], low, 1.0 / (high - low)) for name, (low, high) in task.targets.items()]
        self._requests = np.array(self.plants.requests) if options.action_mode == "request" else None
        width, valves = len(columns), self.plants.valves
        self._phase = Phase.of(self.plants, self.period)
        self._all = np.arange(count)
        self.observations = np.zeros((count, width))
        self.stopped = np.zeros(count, dtype=bool)
        self.succeeded = np.zeros(count, dtype=bool)
        self.aims = np.zeros((count, len(self._aimed)))
        self.elapsed = np.zeros(count, dtype=np.int64)
        # Plants whose episode has not begun, or has ended.
        self.over = np.ones(count, dtype=bool)
        late = periods("action_delay", float(options.action_delay), self.period)
        self._late = [np.zeros((count, valves)) for _ in range(late)]
        old = periods("sensor_delay", float(options.sensor_delay), self.period)
        self._old = [np.zeros((count, len(task.seen)), dtype=np.float32) for _ in range(old)]
        self._clock = 0

    def action_space(self) -> gymnasium.Space[Any]:
        """Return the space of the actions of one plant."""
        valves = self.plants.valves
        if self._requests is not None:
            choices = len(self._requests)
            return gymnasium.spaces.Discrete(choices) if valves == 1 else gymnasium.spaces.MultiDiscrete([choices] * valves)
        return gymnasium.spaces.Box(self._lowest(), 1.0, (valves,), np.float32)

    def observation_space(self) -> gymnasium.Space[Any]:
        """Return the space of the observations of one plant; bounded where the plant is and has no noise."""
        seen = [
            (seen.least - seen.zero) / seen.unit if self.options.deviations.get(seen.column, 0.0) == 0.0 else -np.inf
            for seen in self.task.seen
        ]
        phase = 0 if self._phase is None else self._phase.size - 2
        low = [*seen, *([] if self._phase is None else [-1.0, -1.0]), *[0.0] * (phase + len(self._aimed))]
        high = [np.inf] * len(seen) + [1.0] * (len(low) - len(seen))
        return gymnasium.spaces.Box(np.array(low, dtype=np.float32), np.array(high, dtype=np.float32))

    def _lowest(self) -> float:
        """Return the lowest number of an action."""
        return -1.0 if self.options.action_mode == "position" else 0.0

    def _rest(self) -> float:
        """Return the command of a valve before the first action."""
        return -1.0 if self._requests is not None else self._lowest()

    def start(self, source: Source, targets: Any = None) -> Observations:
        """Begin an episode of every plant and reset their clock. Returns the observations."""
        aims = self._targets(targets, self._all)
        self.plants.start(drawn(self.options.drawn, source, self._all))
        return self._begin(source, self._all, aims)

    def restart(self, source: Source, places: Places, targets: Any = None) -> Observations:
        """Begin another episode of some plants while the others go on, or of all with their clock. Returns their observations."""
        if len(places) == self.count:
            return self.start(source, targets)
        aims = self._targets(targets, places)
        self.plants.restart(places, drawn(self.options.drawn, source, places))
        return self._begin(source, places, aims)

    def _begin(self, source: Source, places: Places, aims: Mapping[int, Numbers]) -> Observations:
        # As shares of their ranges; a target that is given takes the place of the one that is drawn.
        self.aims[places] = source.draw(places, lambda random, count: random.random((count, len(self._aimed))))
        for place, share in aims.items():
            self.aims[places, place] = share
        self.elapsed[places] = 0
        self.stopped[places] = self.over[places] = False
        self.plants.observe(places, self.observations)
        self._judge(places)
        for late in self._late:
            late[places] = self._rest()
        seen = self._sensed(places)
        for old in self._old:
            old[places] = seen
        if self._phase is not None:
            self._phase.begin(places)
        return self._observed(source, places, seen)

    def _targets(self, targets: Any, places: Places) -> dict[int, Numbers]:
        """Return targets given in SI by their columns as shares of their ranges, by their indices among the targets."""
        if targets is None:
            return {}
        if not isinstance(targets, Mapping):
            raise InputError(f"targets = {targets!r}: give a dictionary of targets in SI by their columns")
        names, shares = list(self.task.targets), {}
        for name, given in targets.items():
            if name not in names:
                raise InputError(f"targets: `{name}` is not controlled here; name one of {', '.join(names)}")
            low, high = self.task.targets[name]
            try:
                values = np.broadcast_to(np.asarray(given, dtype=np.float64), (self.count,))[places]
            except (TypeError, ValueError):
                raise InputError(f"targets: {name} = {given!r}; give a number, or one for each of {self.count} plants") from None
            if not ((values >= low) & (values <= high)).all():
                remedy = "make the environment with another range in `targets`"
                raise InputError(f"targets: {name} = {given!r} is beyond the range of targets, {low} to {high}; {remedy}")
            shares[names.index(name)] = (values - low) / (high - low)
        return shares

    def _sensed(self, places: Places | slice) -> Observations:
        """Return the sensed columns of some plants now, a row for each."""
        observed = self.observations[places]
        sensed = np.empty((len(observed), len(self._seen)), dtype=np.float32)
        for place, (column, zero, per_unit) in enumerate(self._seen):
            sensed[:, place] = (observed[:, column] - zero) * per_unit
        return sensed

    def _observed(self, source: Source, places: Places, seen: Observations) -> Observations:
        """Return the observations of some plants, a row for each, from their sensed columns."""
        every = len(places) == self.count
        parts: list[NDArray[Any]] = [seen]
        if self._noise is not None:
            normal = source.draw(places, lambda random, count: random.standard_normal((count, seen.shape[1]), dtype=np.float32))
            parts = [seen + self._noise * normal]
        if self._phase is not None:
            parts.append(self._phase.observed(slice(None) if every else places))
        parts.append(self.aims if every else self.aims[places])
        return np.concatenate(parts, axis=1, dtype=np.float32, casting="same_kind")

    def _distances(self, places: Places | slice) -> Iterator[Numbers]:
        """Yield the distances of the columns from their targets, as shares of their ranges."""
        for place, (column, low, per_span) in enumerate(self._aimed):
            yield np.abs((self.observations[places, column] - low) * per_span - self.aims[places, place])

    def _judge(self, places: Places | slice) -> Numbers:
        """Return the rewards of some plants in their present state, and whether they have succeeded."""
        succeeded = ~self.stopped[places]
        rewards = np.zeros(len(succeeded))
        for distance in self._distances(places):
            succeeded &= distance <= self.options.success_tolerance
            rewards -= np.minimum(distance, self.options.distance_limit)
        self.succeeded[places] = succeeded
        return rewards

    def step(
        self, source: Source, actions: Any, again: NDArray[np.bool_] | None = None
    ) -> tuple[Observations, Numbers, NDArray[np.bool_], NDArray[np.bool_]]:
        """Apply the actions, one row for each plant, for a control period. Returns observations, rewards, and flags of the episodes
        that are terminated and truncated. Plants in `again` begin an episode: they return their first observation."""
        commands = self._commands(actions)
        if self._late:
            place = self._clock % len(self._late)
            late = self._late[place]
            commands, self._late[place] = late, commands
        self.plants.step(commands, self.period, self.observations, self.stopped)
        seen = self._sensed(slice(None))
        if self._old:
            place = self._clock % len(self._old)
            seen, self._old[place] = self._old[place], seen
        if self._phase is not None:
            self._phase.step(commands)
        self._clock += 1
        self.elapsed += 1
        rewards = self._judge(slice(None))
        terminated, truncated = self.stopped.copy(), self.elapsed >= self.periods
        truncated &= ~terminated
        if terminated.any():
            rewards[terminated] -= self._penalties(self.elapsed[terminated])
        self.over = terminated | truncated
        if again is None or not again.any():
            return self._observed(source, self._all, seen), rewards, terminated, truncated
        observed = np.empty((self.count, seen.shape[1] + self._others()), dtype=np.float32)
        going, beginning = np.flatnonzero(~again), np.flatnonzero(again)
        if len(going):
            observed[going] = self._observed(source, going, seen[going])
        observed[beginning] = self.restart(source, beginning)
        rewards[again] = 0.0
        terminated[again] = truncated[again] = False
        return observed, rewards, terminated, truncated

    def _others(self) -> int:
        """Return the number of entries of an observation in addition to the sensed columns."""
        return len(self._aimed) + (0 if self._phase is None else self._phase.size)

    def _penalties(self, elapsed: NDArray[np.int64]) -> Numbers:
        """Return the penalties of plants that diverge in the last of so many steps."""
        if self.options.terminal_penalty is not None:
            return np.full(len(elapsed), self.options.terminal_penalty)
        # What this step and all that were to follow could have cost.
        most = self.options.distance_limit * len(self._aimed)
        return np.asarray(most * (self.periods - elapsed + 1), dtype=np.float64)

    def _commands(self, actions: Any) -> Numbers:
        """Return actions as commands of the plants. A number beyond the bounds counts as the bound."""
        shape = (self.count,) if self._requests is not None and self.plants.valves == 1 else (self.count, self.plants.valves)
        given = unmasked(actions)
        if given.shape != shape:
            raise InputError(f"actions have the shape {given.shape[1:] if self.count == 1 else given.shape}; "
                             f"give {shape[1:] if self.count == 1 else shape}, as the action space has it")
        if self._requests is not None:
            choices = len(self._requests)
            _check_kind(given, f"whole numbers from 0 to {choices - 1}")
            known = (given >= 0) & (given < choices) if given.dtype.kind in "iu" else np.zeros(shape, dtype=bool)
            if not known.all():
                raise InputError(f"actions: {first(given, ~known)} is no request; give whole numbers from 0 to {choices - 1}")
            return np.ascontiguousarray(self._requests[given.astype(np.int64)].reshape(self.count, -1))
        _check_kind(given, f"floats from {self._lowest():g} to 1")
        finite = np.isfinite(given)
        if not finite.all():
            raise InputError(f"actions: {first(given, ~finite)} is no finite number; give {self._lowest():g} to 1")
        # The plants read them in place, whatever the layout of what was given.
        commands = np.clip(np.ascontiguousarray(given, dtype=np.float64), self._lowest(), 1.0)
        if self.options.action_mode != "set-point":
            return commands
        highest: Numbers = self.plants.command_range[1]
        wanted: Numbers = np.minimum(commands * float(self.options.max_pressure or MAX_PRESSURE), highest)
        return wanted

    def targets(self, place: int) -> dict[str, float]:
        """Return the targets of the episode of a plant in SI, by their columns."""
        aims = zip(self.task.targets.items(), self.aims[place], strict=True)
        return {name: float(low + share * (high - low)) for (name, (low, high)), share in aims}

    def info(self) -> dict[str, NDArray[Any]]:
        """Return the columns of the plants in SI without noise and delay, with `is_success` and `diverged`, an array for each."""
        columns = {name: self.observations[:, place].copy() for place, name in enumerate(self.plants.columns)}
        return {**columns, "is_success": self.succeeded.copy(), "diverged": self.stopped.copy()}


def unmasked(actions: Any) -> NDArray[Any]:
    """Return actions as an array; entries that a mask hides are refused."""
    if np.ma.is_masked(actions):
        raise InputError("actions are a masked array whose mask hides entries; give actions.filled(…), with numbers in their place")
    return np.asarray(actions)


def _check_kind(given: NDArray[Any], due: str) -> None:
    """Refuse an array of anything but integers and floats: truth values, texts and objects are no numbers."""
    if given.dtype.kind not in "iuf":
        raise InputError(f"actions are of dtype {given.dtype}; give {due}")


def first(given: NDArray[Any], wrong: NDArray[np.bool_]) -> str:
    """Return the first wrong entry of an array with its index."""
    place = tuple(int(index) for index in np.argwhere(wrong)[0])
    return f"{given[place]} at {list(place)}" if len(given) > 1 else str(given[place])
