"""Many plants as one environment of Gymnasium."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import ResetNeeded
from gymnasium.utils import EzPickle
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from mckibben.errors import InputError
from mckibben.learning._draws import Places, Source
from mckibben.learning._episodes import Episodes, Observations
from mckibben.learning._made import Frames, is_whole, made_of, reset_options, with_steps
from mckibben.learning._tasks import Task


class VectorEnvironment(VectorEnv[Observations, Any, Any], EzPickle):
    """Environment of many plants, each with a target in each episode; `gymnasium.make_vec` makes it.

    All are stepped together on all cores, each with its own valve delays, friction and air. Options:

    - `scenario`: plant in place of that of the task, as a `Scenario` or the path of a file;
    - `targets`: ranges in SI from which targets are drawn, by their columns;
    - `action_mode`, `pulse_frequency`, `max_pressure`: meaning of an action;
    - `control_period`, `duration`, `max_episode_steps`: durations of an action and of an episode;
    - `distance_limit`, `terminal_penalty`, `success_tolerance`: rewards, and the condition of success;
    - `noise`, `sensor_delay`, `action_delay`, `randomize`: disturbances and random parameters;
    - `render_mode`: "rgb_array" for pictures, as `render` returns them.

    See `mckibben.learning.Options` for their meanings and defaults. An observation has the sensed columns of the plant, the
    phase of the pulses and the duty cycles in effect where control is not in step with the pulses, and the targets, all of
    the order of one. `info` has, for each plant, its columns without noise and delay, `is_success` and `diverged`. An
    environment from a pickle has its options, and must be reset.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}
    _spec: EnvSpec | None = None

    def __init__(
        self,
        task: str | Task = "HangingMass",
        num_envs: int = 1,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        **options: Any,
    ) -> None:
        EzPickle.__init__(self, task, num_envs, autoreset_mode=autoreset_mode, render_mode=render_mode, **options)
        if not is_whole(num_envs) or num_envs < 1:
            raise InputError(f"num_envs = {num_envs} is no number of plants; give 1 or more")
        self._episodes = Episodes(*made_of(task, num_envs, options, ("render_mode", "autoreset_mode")))
        self.num_envs, self.render_mode = num_envs, render_mode
        self.autoreset_mode = mode(autoreset_mode)
        self._frames = Frames(render_mode, self._episodes)
        fps = round(1.0 / self._episodes.period)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode, "render_fps": fps}
        self.single_action_space = self._episodes.action_space()
        self.single_observation_space = self._episodes.observation_space()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        # One generator for each plant, where `reset` was given a seed for each.
        self._own: list[np.random.Generator] = []
        self._last = np.zeros((0, 0), dtype=np.float32)
        self._everyone = np.ones(num_envs, dtype=bool)
        self._everyone.flags.writeable = False

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
        """Names of the columns of `observations`."""
        return self._episodes.plants.columns

    @property
    def observations(self) -> NDArray[np.float64]:
        """Columns of the plants in SI without noise and delay: a row for each plant, in the order of `columns`."""
        return self._episodes.observations

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode of every plant at t = 0.

        Parameters
        ----------
        seed
            A list with a seed for each plant, or a number for `[seed, seed + 1, …]`. Each plant then draws from a generator
            of its own, and is bit for bit the single form with its seed; None in a list goes on with the generator that the
            plant has. Until a seed is given, all plants draw from one generator, which is faster where there is noise.
        options
            `reset_mask`: an array of flags of the plants that begin, while the others wait. `targets`: targets in SI of
            these episodes, `{"length_m": 0.08}`, instead of drawn ones, a number for all plants or one for each.

        Returns
        -------
        observations, info
            Of the plants that wait, the last observations; in `info` their flags are False.

        Raises
        ------
        InputError
            For another option, for another number of seeds or flags than there are plants, and for a target beyond the range
            that targets are drawn from.
        gymnasium.error.ResetNeeded
            For a mask before all plants have begun once.
        """
        targets = reset_options(options, "reset_mask", "targets")
        places = self._masked(targets.pop("reset_mask", None))
        self._seed(seed, places)
        if len(places) == self.num_envs:
            self._last = self._episodes.start(self._source(), **targets)
        else:
            self._last[places] = self._episodes.restart(self._source(), places, **targets)
        having = self._everyone
        if len(places) < self.num_envs:
            having = np.zeros(self.num_envs, dtype=bool)
            having[places] = True
        return self._last.copy(), self._info(having)

    def _masked(self, mask: Any) -> Places:
        """Return the indices of the plants in a mask."""
        if mask is None:
            return np.arange(self.num_envs)
        mask = np.asarray(mask)
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise InputError(f"reset_mask: give an array of {self.num_envs} flags, one at least of which is True")
        if not (mask.all() or len(self._last)):
            raise ResetNeeded("no episode has begun: call reset() without a mask first")
        places: Places = np.flatnonzero(mask)
        return places

    def _seed(self, seed: int | Sequence[int | None] | None, places: Places) -> None:
        """Seed the generators of these plants."""
        if seed is None:
            return
        seeds: Any = range(int(seed), int(seed) + self.num_envs) if is_whole(seed) else seed
        listed = isinstance(seeds, (Sequence, np.ndarray)) and len(seeds) == self.num_envs
        if not listed or not all(of_one is None or is_whole(of_one) for of_one in seeds):
            raise InputError(f"seed = {seed!r}: give a whole number, or a list of {self.num_envs}, one or None for each plant")
        self._own = self._own or self.np_random.spawn(self.num_envs)
        for place in places:
            if seeds[place] is not None:
                self._own[place], _ = np_random(int(seeds[place]))

    def _source(self) -> Source:
        return Source(self._own or [self.np_random])

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[Observations, Any, Any, Any, dict[str, Any]]:
        """Does an action of each plant for a control period: observations, rewards, which episodes were terminated and which
        truncated (an array each), and the columns of the plants.

        Raises `gymnasium.error.ResetNeeded` before the first `reset`, and with autoreset disabled when an episode has ended;
        `InputError` for actions of another shape, a number that is not finite and a request that is not there.
        """
        episodes = self._episodes
        if not len(self._last):
            raise ResetNeeded("no episode has begun: call reset() before step()")
        if self.autoreset_mode is AutoresetMode.DISABLED and episodes.over.any():
            ended = ", ".join(str(place) for place in np.flatnonzero(episodes.over)[:8])
            raise ResetNeeded(f'the episodes of plants {ended} have ended: call reset(options={{"reset_mask": …}}) first')
        observed, rewards, terminated, truncated = episodes.step(self._source(), actions, episodes.over)
        info: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP and episodes.over.any():
            done = episodes.over.copy()
            places = np.flatnonzero(done)
            # As in Gymnasium, the observations of ended episodes are objects in an array, with None for all others.
            last = np.full(self.num_envs, None, dtype=object)
            for place in places:
                last[place] = observed[place].copy()
            info = {"final_obs": last, "_final_obs": done, "final_info": self._info(done), "_final_info": done}
            observed[places] = episodes.restart(self._source(), places)
        self._last = observed.copy()
        return observed, rewards, terminated, truncated, {**self._info(self._everyone), **info}

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return pictures of the plants in their present state, as those of the single form.

        Returns
        -------
        frames
            An array of shape (480, 640, 3) for each plant; None with a warning unless the environment was made with
            `render_mode="rgb_array"`.

        Raises
        ------
        gymnasium.error.ResetNeeded
            Before the first `reset`.
        """
        return self._frames(len(self._last) > 0)

    def _info(self, having: NDArray[np.bool_]) -> dict[str, Any]:
        """Return `info` of the flagged plants in Gymnasium's form: zeros elsewhere, and the flags."""
        info = self._episodes.info()
        if having is not self._everyone:
            info = {name: np.where(having, values, np.zeros_like(values)) for name, values in info.items()}
        return {**info, **{f"_{name}": having for name in info}}


def mode(named: AutoresetMode | str) -> AutoresetMode:
    """Return the autoreset mode of a name as in Gymnasium, "SameStep", or "same-step"."""
    for known in AutoresetMode:
        if named in (known, known.value, known.name.lower().replace("_", "-")):
            return known
    raise InputError(f'autoreset_mode: there is no `{named}`; say "next-step", "same-step" or "disabled"')
