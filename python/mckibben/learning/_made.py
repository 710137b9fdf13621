"""Arguments of both forms of an environment."""

from collections.abc import Mapping
from copy import copy
from numbers import Integral
from pathlib import Path
from typing import Any, TypeGuard

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import DependencyNotInstalled, ResetNeeded
from numpy.typing import NDArray

from mckibben._mckibben import Scenario
from mckibben.errors import InputError
from mckibben.learning._episodes import Episodes
from mckibben.learning._options import Options
from mckibben.learning._tasks import Task
from mckibben.learning._tasks import task as named


def made_of(
    task: str | Task, count: int, options: Mapping[str, Any], also: tuple[str, ...] = ("render_mode",)
) -> tuple[Task, int, Options]:
    """Return the task, the number of plants and the options from the arguments of an environment.

    `also` are the names of its other arguments, for messages.
    """
    rest = dict(options)
    of_task = {name: value for name in ("scenario", "targets") if (value := rest.pop(name, None)) is not None}
    if isinstance(of_task.get("scenario"), (str, Path)):
        of_task["scenario"] = Scenario.from_file(of_task["scenario"])
    if not isinstance(of_task.get("scenario", None), (Scenario, type(None))):
        raise InputError(f"scenario = {of_task['scenario']!r}: give a mckibben.Scenario or the path of a scenario file")
    if not isinstance(task, Task):
        task = named(task, **of_task)
    elif of_task:
        raise InputError("scenario, targets: a Task has its own; give them to the task")
    known = Options.__dataclass_fields__
    for name in rest:
        if name not in known:
            names = ", ".join(["scenario", "targets", *known, *also])
            raise InputError(f"`{name}` is no option of an environment; name one of {names}")
    return task, count, Options(**rest)


class Frames:
    """Pictures of the plants of an environment, as `render` returns them.

    Raises `InputError` for an unknown render mode, and `gymnasium.error.DependencyNotInstalled` without Pillow.
    """

    def __init__(self, render_mode: str | None, episodes: Episodes) -> None:
        self._episodes, self._renderer = episodes, None
        if render_mode is None:
            return
        if render_mode != "rgb_array":
            raise InputError(f'render_mode = {render_mode!r}: give "rgb_array" or None')
        try:
            from mckibben.learning._render import Renderer
        except ImportError as error:
            raise DependencyNotInstalled('render_mode: Pillow is missing; pip install "mckibben[learning]"') from error
        self._renderer = Renderer(episodes.task.scenario, episodes.plants.columns, list(episodes.task.targets))

    def __call__(self, begun: bool) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a frame of each plant, of shape (height, width, 3); None with a warning where there is no render mode."""
        if self._renderer is None:
            gymnasium.logger.warn('render() returns nothing: make the environment with render_mode="rgb_array"')
            return None
        if not begun:
            raise ResetNeeded("no episode has begun: call reset() before render()")
        episodes = self._episodes
        times = episodes.elapsed * episodes.period
        return tuple(
            self._renderer.frame(observed, episodes.targets(place), time)
            for place, (observed, time) in enumerate(zip(episodes.observations, times, strict=True))
        )


def is_whole(given: Any) -> TypeGuard[int]:
    """Return whether this is a whole number and no truth value."""
    return isinstance(given, Integral) and not isinstance(given, bool)


def reset_options(options: Mapping[str, Any] | None, *known: str) -> dict[str, Any]:
    """Return the options of `reset` by their names."""
    for name in options or {}:
        if name not in known:
            raise InputError(f"options: `{name}` is no option of reset; name one of {', '.join(known)}")
    return dict(options or {})


def with_steps(spec: EnvSpec | None, steps: int) -> EnvSpec | None:
    """Return a specification with the number of steps of an episode."""
    if spec is None:
        return None
    spec = copy(spec)
    spec.max_episode_steps = steps
    return spec
