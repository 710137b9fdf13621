"""One plant as an environment of Gymnasium."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from mckibben.learning._episodes import Episodes, Observations
from mckibben.learning._tasks import Task
from mckibben.learning._vector import told


class Environment(gymnasium.Env[Observations, Any], EzPickle):
    """One muscle, joint or leg that is to reach a target in each episode; made by `gymnasium.make`.

    Options are those of `VectorEnvironment`, of which this is one plant; without `autoreset_mode`. What comes out of a pickle
    is made anew with the same options: reset it.
    """

    metadata = {"render_modes": []}

    def __init__(self, task: str | Task = "HangingMass", *, render_mode: None = None, **options: Any) -> None:
        EzPickle.__init__(self, task, render_mode=render_mode, **options)
        self._episodes = Episodes(*told(task, 1, options))
        self.render_mode = render_mode
        self.action_space = self._episodes.action_space()
        self.observation_space = self._episodes.observation_space()
        # A step takes one control period.
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self._episodes.options.control_period)}

    @property
    def dt(self) -> float:
        """Time in s for which an action holds."""
        return self._episodes.options.control_period

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode at t = 0."""
        super().reset(seed=seed, options=options)
        return self._episodes.begin(self.np_random)[0], self._info()

    def step(self, action: Any) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Does an action for a control period."""
        actions: NDArray[Any] = np.asarray(action)[np.newaxis]
        observed, rewards = self._episodes.step(self.np_random, actions)
        stopped, finished = bool(self._episodes.stopped[0]), bool(self._episodes.finished()[0])
        return observed[0], float(rewards[0]), stopped, finished, self._info()

    def _info(self) -> dict[str, Any]:
        """What the plant shows without noise and delay, in SI, by its columns."""
        shown = self._episodes.shown[0]
        return {name: float(number) for name, number in zip(self._episodes.plants.columns, shown, strict=True)}
