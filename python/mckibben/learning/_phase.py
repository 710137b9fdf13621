"""Phase of pulses, for controllers that are faster than the pulses or out of step with them."""

import numpy as np
from numpy.typing import NDArray

from mckibben._mckibben import VectorPlant
from mckibben.learning._draws import Numbers, Places

# Relative rounding within which a time is the begin of a pulse.
ROUNDING = 16 * np.finfo(np.float64).eps
# Share of a pulse within which a control period is a whole number of pulses.
WHOLE = 1e-9


class Phase:
    """Phase of the pulses of each plant, and the duty cycles in effect.

    Period p begins at p / f and takes up the duty cycle that is commanded then. It is zero before the first pulse.
    """

    def __init__(self, plants: VectorPlant, frequency: float) -> None:
        self._plants, self._frequency = plants, frequency
        self._under_way = np.zeros((len(plants), plants.valves))
        self._begun = np.zeros(len(plants))

    @classmethod
    def of(cls, plants: VectorPlant, period: float) -> "Phase | None":
        """Return that of plants with a control period in s, or none where it would always be zero."""
        if plants.pulses is None:
            return None
        pulses = period * plants.pulses
        return None if pulses > 0.5 and abs(pulses - round(pulses)) <= WHOLE * pulses else cls(plants, plants.pulses)

    @property
    def size(self) -> int:
        """Number of its entries in an observation."""
        return 2 + self._plants.valves

    def begin(self, places: Places) -> None:
        """Begin an episode of some plants: none of their pulses has begun."""
        self._under_way[places] = 0.0
        self._begun[places] = self._count()[places]

    def step(self, commands: Numbers) -> None:
        """Record a step of plants with these duty cycles."""
        begun = self._count()
        latched = begun > self._begun
        self._under_way[latched] = commands[latched]
        self._begun = begun

    def observed(self, places: Places | slice) -> Numbers:
        """Return cosine and sine of the phase, and the duty cycle in effect of each valve."""
        angle = 2.0 * np.pi * np.modf(self._plants.time[places] * self._frequency)[0]
        return np.column_stack([np.cos(angle), np.sin(angle), self._under_way[places]])

    def _count(self) -> NDArray[np.float64]:
        """Return the number of pulses that have begun before now, without one that begins now."""
        pulses = self._plants.time * self._frequency
        counted: Numbers = np.ceil(pulses * (1.0 - ROUNDING))
        return counted
