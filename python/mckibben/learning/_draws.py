"""Random numbers of episodes: their generators, and the ranges from which parameters of plants are drawn."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mckibben._mckibben import VectorPlant
from mckibben.errors import InputError
from mckibben.learning._options import Draw, is_number

Numbers = NDArray[np.float64]
Places = NDArray[np.int64]

# A parameter that a function draws is moved by this share to see whether it changes the plant.
NUDGE = 1e-3


class Source:
    """Random numbers of plants, from one generator for all or from one for each."""

    def __init__(self, generators: Sequence[np.random.Generator]) -> None:
        self._generators = generators

    def draw(self, places: Places, draw: Callable[[np.random.Generator, int], NDArray[Any]]) -> NDArray[Any]:
        """Return the result of a function of a generator and a count for these plants, a row for each."""
        if len(self._generators) == 1:
            return draw(self._generators[0], len(places))
        return np.concatenate([draw(self._generators[place], 1) for place in places])


def check(randomize: Mapping[str, Draw], plants: VectorPlant) -> None:
    """Refuse ranges that are not valid, whose ends the plants cannot have, or that have no effect on them."""
    given = plants.defaults.copy()
    for place, (path, draw) in enumerate(randomize.items()):
        if callable(draw):
            matters = _nudged(plants, given, place)
        else:
            low, high = _ends(path, draw)
            one, other = given.copy(), given.copy()
            one[place], other[place] = low, high
            try:
                matters = plants.differ(one, other)
            except InputError as error:
                raise InputError(f"randomize: `{path}` cannot be drawn from {low} to {high}: {error}") from None
        if not matters:
            raise InputError(f"randomize: `{path}` changes nothing of this plant; leave it out")


def _ends(path: str, draw: Any) -> tuple[float, float]:
    """Return the two ends of a range."""
    if not (isinstance(draw, (tuple, list)) and len(draw) == 2 and all(is_number(end) for end in draw)):
        raise InputError(
            f"randomize: `{path}` = {draw!r} is no range; give two finite numbers in SI, the lower first, "
            "or a function of a generator and a count"
        )
    low, high = float(draw[0]), float(draw[1])
    if not low < high:
        raise InputError(f"randomize: `{path}` from {low} to {high} is no range; give the lower end first, in SI")
    return low, high


def _nudged(plants: VectorPlant, given: Numbers, place: int) -> bool:
    """Return whether another value of a parameter changes the plants, or no value near its default is possible."""
    for share in (NUDGE, -NUDGE):
        nudged = given.copy()
        nudged[place] += share * (abs(given[place]) or 1.0)
        try:
            return plants.differ(given, nudged)
        except InputError:
            continue
    return True


def drawn(randomize: Mapping[str, Draw], source: Source, places: Places) -> Numbers:
    """Return values of the parameters for these plants, a row for each."""

    def draw_all(generator: np.random.Generator, count: int) -> Numbers:
        values = np.empty((count, len(randomize)))
        for place, (path, draw) in enumerate(randomize.items()):
            if callable(draw):
                values[:, place] = _called(path, draw, generator, count)
            else:
                values[:, place] = generator.uniform(*draw, size=count)
        return values

    return source.draw(places, draw_all)


def _called(path: str, draw: Callable[[np.random.Generator, int], Any], generator: np.random.Generator, count: int) -> Numbers:
    """Return the values that a function draws, checked."""
    returned = draw(generator, count)
    try:
        values = np.asarray(returned, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape not in ((count,), ()) or not np.isfinite(values).all():
        raise InputError(
            f"randomize: the function of `{path}` returned {returned!r}; return an array of {count} finite numbers in SI"
        )
    return values
