"""What runs and linear models come to, as mappings and data classes."""

from __future__ import annotations

import collections.abc
import dataclasses
import html
import math
import typing

if typing.TYPE_CHECKING:
    import pandas

    from mckibben import LinearModel, Trajectory


@dataclasses.dataclass(frozen=True, eq=False)
class Summary(collections.abc.Mapping[str, float]):
    """What a run came to: numbers by their names, such as `summary["length.final"]` or `summary["air.used"]`.

    A name is that of a reduction of a sweep where there is one; of a plant it begins with the part that it is of, as in
    `flexor.tension.max`. Energies and exergies are in J.
    """

    #: The numbers by their names, in SI.
    numbers: dict[str, float]
    #: Their units; empty for a pure number.
    units: dict[str, str]
    #: How many events of each kind there were.
    events: dict[str, int]
    #: Values that no source states and the scenario does not set, by their keys.
    assumed: dict[str, str]

    def __getitem__(self, name: str) -> float:
        return self.numbers[name]

    def __iter__(self) -> collections.abc.Iterator[str]:
        return iter(self.numbers)

    def __len__(self) -> int:
        return len(self.numbers)

    def _rows(self) -> list[tuple[str, str, str]]:
        rows = [(name, f"{value:.6g}", self.units[name]) for name, value in self.numbers.items()]
        rows += [(f"events.{kind}", str(count), "") for kind, count in self.events.items()]
        return rows + [(f"assumed: {key}", text, "") for key, text in self.assumed.items()]

    def __str__(self) -> str:
        rows = self._rows()
        name, value = (max((len(row[place]) for row in rows), default=0) for place in (0, 1))
        return "\n".join(f"{row[0]:<{name}}  {row[1]:>{value}} {row[2]}".rstrip() for row in rows)

    def _repr_html_(self) -> str:
        cells = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in self._rows())
        return "<table>" + "".join(f"<tr>{row}</tr>" for row in cells) + "</table>"

    def to_pandas(self) -> pandas.DataFrame:
        """The numbers as a data frame with the columns `value` and `unit`, a row for each name."""
        import pandas

        return pandas.DataFrame({"value": self.numbers, "unit": self.units})


def summary(run: Trajectory) -> Summary:
    """What a run came to."""
    numbers, events, assumed = run._figures()
    return Summary(
        {name: value for name, value, _ in numbers},
        {name: unit for name, _, unit in numbers},
        dict(events),
        dict(assumed),
    )


def events_to_pandas(run: Trajectory) -> pandas.DataFrame:
    """The log of events as a data frame: `time_s`, `event`, and what holds from then on."""
    import pandas

    return pandas.DataFrame([{"time_s": event.time, "event": event.kind, **event.after} for event in run.events])


@dataclasses.dataclass(frozen=True)
class Mode:
    """A motion of a linear model that decays, swings or grows as `exp(pole * t)`."""

    #: The pole in 1/s.
    pole: complex
    #: Natural frequency in rad/s.
    natural_frequency: float
    #: Damping ratio, below zero where it grows; NaN of an integrator.
    damping_ratio: float
    #: Time in s in which it falls to 1/e; infinite where it stays, below zero where it grows.
    time_constant: float


class Modes(list[Mode]):
    """The modes of a linear model, the slowest first."""

    def __str__(self) -> str:
        rows = [f"{'pole (1/s)':>24}{'frequency (Hz)':>16}{'damping':>10}{'time constant (s)':>19}"]
        for mode in self:
            hertz = mode.natural_frequency / math.tau
            rows.append(f"{mode.pole:>24.4g}{hertz:>16.4g}{mode.damping_ratio:>10.4g}{mode.time_constant:>19.4g}")
        return "\n".join(rows)


def modes(model: LinearModel) -> Modes:
    """The modes of a linear model; of a pair of conjugate poles the one above the real axis."""

    def mode(pole: dict[str, typing.Any]) -> Mode:
        known = [pole["natural_frequency_rad_s"], pole["damping_ratio"], pole["time_constant_s"]]
        frequency, damping, time = (other if one is None else one for one, other in zip(known, [0.0, math.nan, math.inf]))
        return Mode(complex(pole["real_1_s"], pole["imaginary_rad_s"]), frequency, damping, time)

    poles = [pole for pole in model.details["poles"] if pole["imaginary_rad_s"] >= 0]
    return Modes(sorted(map(mode, poles), key=lambda one: one.natural_frequency))
