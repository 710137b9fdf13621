"""Options of an environment, checked at its construction."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from numbers import Integral, Real
from typing import Any, Literal

import numpy as np

from mckibben._mckibben import VectorPlant, _si
from mckibben.errors import InputError

ActionMode = Literal["duty", "request", "position", "set-point"]
Precision = Literal["double", "single"]
Draw = tuple[float, float] | Callable[[np.random.Generator, int], Any]

# Options that may be text with a unit.
QUANTITIES = ("control_period", "duration", "pulse_frequency", "max_pressure", "sensor_delay", "action_delay")
# Gauge pressure in Pa of a set point of 1 by default.
MAX_PRESSURE = 6e5
# Least control period in s by default, where actions are no duty cycles.
REQUEST_PERIOD = 5e-3


@dataclass(frozen=True)
class Options:
    """Options of an environment in addition to its task.

    `action_mode` is the meaning of an action for each valve: "duty" (a duty cycle, 0 to 1), "request" (the number of exhaust, hold or
    fill among those that the valve takes), "position" of a proportional spool (-1 to 1) or "set-point" of a pressure
    regulator (0 to 1 of `max_pressure` in Pa gauge, 6e5 by default, at most what feeds it). A number beyond these bounds counts as the bound; one that is not
    finite, and a request that the valve does not take, is an `InputError`.

    `control_period` is the duration of an action in s. By default every action takes effect within it: a duty cycle holds for
    one period of its pulses, 1 / `pulse_frequency`; anything else for the shortest multiple of 5 ms that is longer than the delays
    of the scenario's valves. A duty cycle takes effect when a pulse begins, and holds for that pulse. Where the control period
    is no whole number of pulses, the observation therefore has the phase of the pulse and the duty cycle under way.

    An episode lasts `duration` in s, a whole number of control periods, or `max_episode_steps` of them; by default the number
    nearest to the scenario's run.duration.

    The reward of a step is minus the sum of the distances from the targets, each as a share of the range that it is drawn
    from and counted as `distance_limit` at most. An episode ends early only if its plant diverges: the state is no longer
    physical. Then `terminal_penalty` is subtracted too. By default it is the largest cost that the step and all remaining steps
    could have, so that to end early never pays. `info["is_success"]` says whether all targets are within
    `success_tolerance` of their ranges after a step, `info["diverged"]` whether the plant has diverged.

    `noise` are standard deviations of the observation in SI, by columns; none by default. Observations are `sensor_delay` in s old, and actions
    take effect `action_delay` in s late, whole numbers of control periods; the phase and the duty cycle under way are the
    controller's own, and have neither noise nor delay. `randomize` are paths of parameters of the plant that are drawn for
    each episode: uniformly between two ends in SI, or by a function of a generator and the number of values. All random
    numbers come from the generator, or generators, that `reset(seed=...)` seeds.

    `precision` is that of `mckibben.VectorPlant`: "double" or "single".

    Durations, delays, `pulse_frequency` and `max_pressure` are numbers in SI or text with a unit: "40 ms", "50 Hz", "4 bar".
    """

    action_mode: ActionMode = "duty"
    control_period: float | str | None = None
    duration: float | str | None = None
    max_episode_steps: int | None = None
    pulse_frequency: float | str | None = None
    max_pressure: float | str | None = None
    distance_limit: float = 2.0
    terminal_penalty: float | None = None
    success_tolerance: float = 0.05
    noise: Mapping[str, float] | None = field(default_factory=dict)
    sensor_delay: float | str = 0.0
    action_delay: float | str = 0.0
    randomize: Mapping[str, Draw] | None = field(default_factory=dict)
    precision: Precision = "double"

    def __post_init__(self) -> None:
        for name in ("control_period", "duration", "pulse_frequency", "max_pressure", "distance_limit"):
            self._check(name, above_zero=True)
        for name in ("terminal_penalty", "success_tolerance", "sensor_delay", "action_delay"):
            self._check(name, above_zero=False)
        steps = self.max_episode_steps
        if steps is not None and not (isinstance(steps, Integral) and steps >= 1):
            raise InputError(f"max_episode_steps = {steps!r} is no number of steps; give a whole number of 1 or more")
        if self.max_pressure is not None and self.action_mode != "set-point":
            raise InputError(
                f'max_pressure = {self.max_pressure!r} has no effect with action_mode="{self.action_mode}"; leave it out, or give '
                'action_mode="set-point"'
            )
        for name, example in (("noise", '{"length_m": 1e-4}'), ("randomize", '{"load.mass": (1.5, 3.0)}')):
            given = getattr(self, name)
            if given is None:
                object.__setattr__(self, name, {})
            elif not isinstance(given, Mapping):
                raise InputError(f"{name} is no dictionary but {given!r}; give one by names, as {example}")
        for column, deviation in self.deviations.items():
            if not (is_number(deviation) and deviation >= 0.0):
                raise InputError(f"noise: `{column}` = {deviation!r} is no standard deviation; give zero or more, in SI")

    def _check(self, name: str, *, above_zero: bool) -> None:
        """Refuse an option that is no finite number of zero or more; text with a unit becomes its number in SI."""
        number = getattr(self, name)
        if isinstance(number, str) and name in QUANTITIES:
            number = _si(name, number)
            object.__setattr__(self, name, number)
        if number is None and self.__dataclass_fields__[name].default is None:
            return
        if not (is_number(number) and (number > 0.0 or number == 0.0 and not above_zero)):
            range_ = "above zero" if above_zero else "of zero or more"
            fault = "out of range" if is_number(number) else "no finite number"
            raise InputError(f"{name} = {number!r} is {fault}; give a finite number {range_}")

    @property
    def deviations(self) -> Mapping[str, float]:
        """Standard deviations of the observation in SI, by columns."""
        return self.noise or {}

    @property
    def drawn(self) -> Mapping[str, Draw]:
        """Parameters that are drawn for each episode, by their paths."""
        return self.randomize or {}

    def period(self, plants: VectorPlant) -> float:
        """Return the duration in s of an action of these plants."""
        if self.control_period is not None:
            return float(self.control_period)
        if plants.pulses is not None:
            return 1.0 / plants.pulses
        return REQUEST_PERIOD * (math.floor(plants.valve_delay / REQUEST_PERIOD * (1.0 + 1e-9)) + 1)

    def steps(self, plants: VectorPlant, period: float) -> int:
        """Return the number of steps of an episode of these plants."""
        steps = self.max_episode_steps
        if self.duration is not None:
            given = max(1, periods("duration", float(self.duration), period))
            if steps not in (None, given):
                raise InputError(f"duration = {self.duration} s is {given} steps, but max_episode_steps = {steps}; give one of them")
            return given
        if steps is not None:
            return int(steps)
        return max(1, round(plants.duration / period))


def periods(name: str, time: float, period: float) -> int:
    """Return the number of control periods of a time, both in s."""
    count = round(time / period)
    if abs(time - count * period) > 1e-9 * max(time, period):
        near = max(1, count) * period
        raise InputError(
            f"{name} = {time:g} s is no multiple of control_period = {period:g} s; give a whole number of them, such as "
            f"{near:g} s, or another control_period"
        )
    return count


def is_number(value: Any) -> bool:
    """Return whether this is a finite number."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
