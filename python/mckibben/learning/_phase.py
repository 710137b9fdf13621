"""The phase of pulses, for controllers that are faster than the pulses or out of step with them."""

import numpy as np
from numpy.typing import NDArray

from mckibben._mckibben import VectorPlant
from mckibben.learning._draws import Numbers, Places

# Roundings, relative, by which a time may miss the begin of a pulse that it is.
ROUNDING = 16 * np.finfo(np.float64).eps
# Share of a pulse by which a control period may miss a whole number of pulses.
WHOLE = 1e-9


class Phase:
    """The phase of each plant's pulses, and the duty cycles of the pulses that are under way.

    Period p begins at p / f and takes up the duty cycle that is commanded then. It is zero before the first pulse.
    """

    def __init__(self, plants: VectorPlant, frequency: float) -> None:
        self._plants, self._frequency = plants, frequency
        self._under_way = np.zeros((len(plants), plants.valves))
        self._begun = np.zeros(len(plants))

    @classmethod
    def of(cls, plants: VectorPlant, period: float) -> "Phase | None":
        """That of plants with a control period in s, or none where it would always be zero."""
        if plants.pulses is None:
            return None
        pulses = period * plants.pulses
        return None if pulses > 0.5 and abs(pulses - round(pulses)) <= WHOLE * pulses else cls(plants, plants.pulses)

    @property
    def size(self) -> int:
        """How many entries it has in an observation."""
        return 2 + self._plants.valves

    def begin(self, places: Places) -> None:
        """Some plants begin an episode: none of their pulses has begun."""
        self._under_way[places] = 0.0
        self._begun[places] = self._count()[places]

    def step(self, commands: Numbers) -> None:
        """Plants have done a step with these duty cycles."""
        begun = self._count()
        latched = begun > self._begun
        self._under_way[latched] = commands[latched]
        self._begun = begun

    def observed(self, places: Places | slice) -> Numbers:
        """Cosine and sine of the phase, and the duty cycle under way of each valve."""
        angle = 2.0 * np.pi * np.modf(self._plants.time[places] * self._frequency)[0]
        return np.column_stack([np.cos(angle), np.sin(angle), self._under_way[places]])

    def _count(self) -> NDArray[np.float64]:
        """How many pulses have begun before now; one that begins now has not."""
        pulses = self._plants.time * self._frequency
        counted: Numbers = np.ceil(pulses * (1.0 - ROUNDING))
        return counted
