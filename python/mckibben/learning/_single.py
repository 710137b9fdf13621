"""One plant as an environment of Gymnasium."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import ResetNeeded
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from mckibben.errors import InputError
from mckibben.learning._draws import Source
from mckibben.learning._episodes import Episodes, Observations, unmasked
from mckibben.learning._made import Frames, is_whole, made_of, reset_options, with_steps
from mckibben.learning._tasks import Task


class Environment(gymnasium.Env[Observations, Any], EzPickle):
    """Environment of one plant with a target in each episode; `gymnasium.make` makes it.

    Options are those of `VectorEnvironment` without `autoreset_mode`. An environment from a pickle has its options, and must be
    reset.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}
    _spec: EnvSpec | None = None

    def __init__(self, task: str | Task = "HangingMass", *, render_mode: str | None = None, **options: Any) -> None:
        EzPickle.__init__(self, task, render_mode=render_mode, **options)
        self._episodes = Episodes(*made_of(task, 1, options))
        self.render_mode = render_mode
        self._frames = Frames(render_mode, self._episodes)
        self.action_space = self._episodes.action_space()
        self.observation_space = self._episodes.observation_space()
        # A step takes one control period.
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self._episodes.period)}

    @property
    def spec(self) -> EnvSpec | None:
        """Specification of the environment, with the number of steps of its episodes."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        self._spec = with_steps(spec, self._episodes.periods)

    @property
    def dt(self) -> float:
        """Time in s for which an action holds."""
        return self._episodes.period

    @property
    def columns(self) -> list[str]:
        """Names of the entries of `observations`."""
        return self._episodes.plants.columns

    @property
    def observations(self) -> NDArray[np.float64]:
        """Columns of the plant in SI without noise and delay, in the order of `columns`."""
        observations: NDArray[np.float64] = self._episodes.observations[0]
        return observations

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode at t = 0.

        Parameters
        ----------
        seed
            Of the generator that everything random of the episodes comes from; it goes on unless given.
        options
            `targets`: targets in SI of this episode, `{"length_m": 0.08}`, instead of drawn ones.

        Returns
        -------
        observation, info

        Raises
        ------
        InputError
            For another option, for a seed that is no number, and for a target beyond the range that targets are drawn from.
        """
        targets = reset_options(options, "targets")
        if not (seed is None or is_whole(seed)):
            raise InputError(f"seed = {seed!r}: give a whole number of zero or more, or None")
        super().reset(seed=seed)
        return self._episodes.start(Source([self.np_random]), **targets)[0], self._info()

    def step(self, action: Any) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Does an action for a control period.

        Raises `gymnasium.error.ResetNeeded` before the first `reset` and after the end of an episode, and `InputError` for
        an action of another shape, a number that is not finite and a request that is not there.
        """
        episodes = self._episodes
        if episodes.over[0]:
            has = "the episode has ended" if episodes.elapsed[0] else "no episode has begun"
            raise ResetNeeded(f"{has}: call reset() before step()")
        actions: NDArray[Any] = unmasked(action)[np.newaxis]
        observed, rewards, terminated, truncated = episodes.step(Source([self.np_random]), actions)
        return observed[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), self._info()

    def render(self) -> NDArray[np.uint8] | None:
        """A picture of the plant where it is, with its targets, muscles coloured by their gauge pressure.

        Returns
        -------
        frame
            An array of shape (480, 640, 3); None with a warning unless the environment was made with
            `render_mode="rgb_array"`.

        Raises
        ------
        gymnasium.error.ResetNeeded
            Before the first `reset`.
        """
        frames = self._frames(bool(self._episodes.elapsed[0]) or not self._episodes.over[0])
        return None if frames is None else frames[0]

    def _info(self) -> dict[str, Any]:
        return {name: values[0].item() for name, values in self._episodes.info().items()}
