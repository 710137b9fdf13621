"""Many plants as one environment of Gymnasium."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from mckibben._mckibben import Scenario
from mckibben.errors import InputError
from mckibben.learning._episodes import Episodes, Observations, Options
from mckibben.learning._tasks import TASKS, Task


class VectorEnvironment(VectorEnv[Observations, Any, Any], EzPickle):
    """Muscles, joints or legs, each of which is to reach a target in each episode; made by `gymnasium.make_vec`.

    All are stepped together on all cores, each through its own valve delays, friction and air. Options:

    - `scenario`: another plant than the task's own, as a `Scenario` or the path of a file; of a leg, that of its muscles;
    - `targets`: ranges in SI from which targets are drawn, by the columns that are to reach them;
    - `leg`: numbers of the leg other than assumed, `{"leg.thigh.mass": 0.5}`;
    - `asked`, `pulse_frequency`, `most_pressure`: what an action is;
    - `control_period`, `duration`: how long an action and an episode last, in s;
    - `noise`, `sensor_delay`, `action_delay`, `randomize`: what makes it hard, see `mckibben.learning.Options`.

    An observation has what the task sees of the plant and then the targets, all of the order of one; a reward is minus the
    distance from the targets as a share of their ranges, summed. An episode is truncated after its duration; it is
    terminated only if its plant leaves the physics. What comes out of a pickle is made anew with the same options: reset it.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        task: str | Task = "HangingMass",
        num_envs: int = 1,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: None = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(self, task, num_envs, autoreset_mode=autoreset_mode, render_mode=render_mode, **options)
        self._episodes = Episodes(*told(task, num_envs, options))
        self.num_envs, self.render_mode = num_envs, render_mode
        self.autoreset_mode = mode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode}
        self.single_action_space = self._episodes.action_space()
        self.single_observation_space = self._episodes.observation_space()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._done = np.zeros(num_envs, dtype=bool)

    @property
    def dt(self) -> float:
        """Time in s for which an action holds."""
        return self._episodes.options.control_period

    @property
    def columns(self) -> list[str]:
        """What `shown` has of each plant."""
        return self._episodes.plants.columns

    @property
    def shown(self) -> NDArray[np.float64]:
        """What the plants show without noise and delay, in SI: a row for each, by `columns`."""
        return self._episodes.shown

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode of every plant at t = 0, or, with the option `reset_mask`, of some while the others wait."""
        if isinstance(seed, list):
            raise InputError("seed: all plants draw from one generator; give one number")
        super().reset(seed=seed)
        mask = (options or {}).get("reset_mask")
        if mask is None:
            self._done[:] = False
            return self._episodes.begin(self.np_random), {}
        self._done &= ~mask
        return self._episodes.begin_again(self.np_random, np.flatnonzero(mask)), {}

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[Observations, Any, Any, Any, dict[str, Any]]:
        """Does an action of each plant for a control period: observations, rewards, which episodes were terminated and which
        truncated (an array each), and what there is to tell."""
        episodes = self._episodes
        observed, rewards = episodes.step(self.np_random, actions)
        terminated, truncated = episodes.stopped.copy(), episodes.finished()
        info: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.NEXT_STEP:
            again, self._done = self._done, terminated | truncated
            if again.any():
                rows = np.flatnonzero(again)
                observed[rows] = episodes.begin_again(self.np_random, rows)[rows]
                rewards[rows] = 0.0
                terminated[rows] = truncated[rows] = self._done[rows] = False
        elif self.autoreset_mode is AutoresetMode.SAME_STEP:
            done = terminated | truncated
            if done.any():
                rows = np.flatnonzero(done)
                info = {"final_obs": observed.copy(), "_final_obs": done, "final_info": {}, "_final_info": done}
                observed[rows] = episodes.begin_again(self.np_random, rows)[rows]
        return observed, rewards, terminated, truncated, info


def mode(named: AutoresetMode | str) -> AutoresetMode:
    """How episodes begin again, by its name as Gymnasium has it, "SameStep", or "same-step"."""
    for known in AutoresetMode:
        if named in (known, known.value, known.name.lower().replace("_", "-")):
            return known
    raise InputError(f'autoreset_mode: there is no `{named}`; say "next-step", "same-step" or "disabled"')


def told(task: str | Task, count: int, options: Mapping[str, Any]) -> tuple[Task, int, Options]:
    """The task, the number of plants and the options, from what an environment is made with."""
    rest = dict(options)
    of_task = {name: rest.pop(name) for name in ("scenario", "targets") if rest.get(name) is not None}
    numbers = rest.pop("leg", None)
    if isinstance(of_task.get("scenario"), (str, Path)):
        of_task["scenario"] = Scenario.load(of_task["scenario"])
    if not isinstance(task, Task):
        if task not in TASKS:
            raise InputError(f"task: there is no `{task}`; name one of {', '.join(TASKS)}, or give a Task")
        if numbers is not None:
            if task != "Leg":
                raise InputError("leg: this environment has none; leave it out")
            of_task["numbers"] = numbers
        task = TASKS[task](**of_task)
    elif of_task or numbers is not None:
        raise InputError("scenario, targets, leg: a Task has its own; give them to the task")
    known = Options.__dataclass_fields__
    for name in rest:
        if name not in known:
            raise InputError(f"`{name}` is no option of an environment; name one of {', '.join(known)}")
    return task, count, Options(**rest)
