"""The arguments of both forms of an environment."""

from collections.abc import Mapping
from copy import copy
from pathlib import Path
from typing import Any

from gymnasium.envs.registration import EnvSpec

from mckibben._mckibben import Scenario
from mckibben.errors import InputError
from mckibben.learning._options import Options
from mckibben.learning._tasks import Task
from mckibben.learning._tasks import task as named


def made_of(task: str | Task, count: int, options: Mapping[str, Any]) -> tuple[Task, int, Options]:
    """The task, the number of plants and the options, from what an environment is made with."""
    rest = dict(options)
    of_task = {name: rest.pop(name) for name in ("scenario", "targets") if rest.get(name) is not None}
    if isinstance(of_task.get("scenario"), (str, Path)):
        of_task["scenario"] = Scenario.load(of_task["scenario"])
    if not isinstance(of_task.get("scenario", None), (Scenario, type(None))):
        raise InputError(f"scenario = {of_task['scenario']!r}: give a mckibben.Scenario or the path of a scenario file")
    if not isinstance(task, Task):
        task = named(task, **of_task)
    elif of_task:
        raise InputError("scenario, targets: a Task has its own; give them to the task")
    known = Options.__dataclass_fields__
    for name in rest:
        if name not in known:
            raise InputError(f"`{name}` is no option of an environment; name one of {', '.join(known)}")
    return task, count, Options(**rest)


def reset_options(options: Mapping[str, Any] | None, *known: str) -> dict[str, Any]:
    """The options of `reset` by their names."""
    for name in options or {}:
        if name not in known:
            raise InputError(f"options: `{name}` is no option of reset; name one of {', '.join(known)}")
    return dict(options or {})


def with_steps(spec: EnvSpec | None, steps: int) -> EnvSpec | None:
    """A specification with the number of steps of an episode."""
    if spec is None:
        return None
    spec = copy(spec)
    spec.max_episode_steps = steps
    return spec
