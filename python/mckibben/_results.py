"""Figures of runs and properties of linear models, as mappings and data classes."""

from __future__ import annotations

import collections.abc
import dataclasses
import html
import math
import typing

if typing.TYPE_CHECKING:
    import pandas

    from mckibben import LinearModel, Scenario, Trajectory


@dataclasses.dataclass(frozen=True, eq=False)
class Summary(collections.abc.Mapping[str, float]):
    """Figures of a run: numbers by their names, such as `summary["length.final"]` or `summary["air.used"]`.

    A name is that of a reduction of a sweep where there is one. Extremes, such as `tension.max`, are those of the run between
    its samples too; those of a sweep are of the samples at `run.sample_interval` alone, and may miss a peak. Of several actuators with names it begins with that of the
    part, as in `flexor.tension.max`. Energies and exergies are in J. `print` writes a table.

    Attributes
    ----------
    numbers : dict of str to float
        Numbers by their names, in SI.
    units : dict of str to str
        Units of the numbers; empty for a pure number.
    events : dict of str to int
        Counts of events by their kinds.
    assumed : dict of str to str
        Values that no source states and the scenario does not set, by their keys.
    """

    numbers: dict[str, float]
    units: dict[str, str]
    events: dict[str, int]
    assumed: dict[str, str]

    def __getitem__(self, name: str) -> float:
        if name not in self.numbers:
            raise KeyError(f"there is no `{name}` but {', '.join(self.numbers)}")
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
        """Return the numbers as a data frame.

        Returns
        -------
        pandas.DataFrame
            A row for each name, with the columns `value` and `unit`.
        """
        import pandas

        return pandas.DataFrame({"value": self.numbers, "unit": self.units})


def summary(run: Trajectory) -> Summary:
    """Return the figures of a run."""
    numbers, events, assumed = run._figures()
    return Summary(
        {name: value for name, value, _ in numbers},
        {name: unit for name, _, unit in numbers},
        dict(events),
        dict(assumed),
    )


@dataclasses.dataclass(frozen=True)
class Settling:
    """A column of a run over a period of its orbit.

    Attributes
    ----------
    mean : float
        Mean over the period, in the unit.
    ripple : float
        Greatest less least value; zero where that is no more than the search leaves.
    min : float
        Least value.
    max : float
        Greatest value.
    unit : str
        Unit in SI.
    """

    mean: float
    ripple: float
    min: float
    max: float
    unit: str


@dataclasses.dataclass(frozen=True, eq=False)
class Settled(collections.abc.Mapping[str, Settling]):
    """What a run settles to: columns by their names without units, such as `settled["length"].ripple`.

    Of several actuators with names each name begins with that of the part, as in `flexor.gauge_pressure`. Empty where the run
    has not settled. `print` writes a table.

    Attributes
    ----------
    settled : bool
        Whether the states return after a period, within the error of the engine.
    period : float
        Period in s that all pulses have in common; without pulses the interval at which the run was looked at.
    periods : int
        Count of periods that were simulated behind the end of the run.
    guesses : int
        Count of those that began at a guess; zero where the run went there without one.
    columns : dict of str to Settling
        Columns by their names.
    """

    settled: bool
    period: float
    periods: int
    guesses: int
    columns: dict[str, Settling]

    def __getitem__(self, name: str) -> Settling:
        if name not in self.columns:
            known = ", ".join(self.columns) or "none, as the run has not settled"
            raise KeyError(f"there is no `{name}` but {known}")
        return self.columns[name]

    def __iter__(self) -> collections.abc.Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __str__(self) -> str:
        width = max(map(len, self.columns), default=0)
        rows = [f"{'':<{width}}{'mean':>14}{'ripple':>14}{'min':>14}{'max':>14}"]
        for name, of in self.columns.items():
            rows.append(f"{name:<{width}}{of.mean:>14.6g}{of.ripple:>14.6g}{of.min:>14.6g}{of.max:>14.6g} {of.unit}")
        return "\n".join(rows)


def settled(scenario: Scenario) -> Settled:
    """Return what a run of a scenario settles to."""
    is_settled, period, periods, guesses, columns = scenario._settled()
    found = {}
    for name, unit, (mean, ripple, least, greatest) in columns:
        found[name] = Settling(mean, ripple, least, greatest, unit)
    return Settled(is_settled, period, periods, guesses, found)


def events_to_pandas(run: Trajectory) -> pandas.DataFrame:
    """Return the log of events as a data frame: `time_s`, `event`, and the discrete state after each."""
    import pandas

    return pandas.DataFrame([{"time_s": event.time, "event": event.kind, **event.after} for event in run.events])


@dataclasses.dataclass(frozen=True)
class Mode:
    """Mode of a linear model, which evolves as `exp(pole * t)`.

    Attributes
    ----------
    pole : complex
        Pole in 1/s; of a conjugate pair the one above the real axis.
    natural_frequency : float
        Natural frequency in rad/s.
    damping_ratio : float
        Damping ratio, below zero for a mode that grows; NaN for an integrator.
    time_constant : float
        Time in s of a decay to 1/e; infinite for a mode that neither decays nor grows, below zero for one that grows.
    """

    pole: complex
    natural_frequency: float
    damping_ratio: float
    time_constant: float


class Modes(list[Mode]):
    """Modes of a linear model, the slowest first; `print` writes a table."""

    def __str__(self) -> str:
        rows = [f"{'pole (1/s)':>24}{'frequency (Hz)':>16}{'damping':>10}{'time constant (s)':>19}"]
        for mode in self:
            hertz = mode.natural_frequency / math.tau
            rows.append(f"{mode.pole:>24.4g}{hertz:>16.4g}{mode.damping_ratio:>10.4g}{mode.time_constant:>19.4g}")
        return "\n".join(rows)


def modes(model: LinearModel) -> Modes:
    """Return the modes of a linear model; a pair of conjugate poles is one mode."""

    def mode(pole: dict[str, typing.Any]) -> Mode:
        known = [pole["natural_frequency_rad_s"], pole["damping_ratio"], pole["time_constant_s"]]
        frequency, damping, time = (other if one is None else one for one, other in zip(known, [0.0, math.nan, math.inf]))
        return Mode(complex(pole["real_1_s"], pole["imaginary_rad_s"]), frequency, damping, time)

    poles = [pole for pole in model.details["poles"] if pole["imaginary_rad_s"] >= 0]
    return Modes(sorted(map(mode, poles), key=lambda one: one.natural_frequency))


@dataclasses.dataclass(frozen=True)
class Controllability:
    """Controllability of a linear model from one input.

    Attributes
    ----------
    input : str
        Name of the input.
    rank : int
        The number of states that the input can move independently.
    condition : float or None
        Ratio of the largest to the least singular value of that matrix; `None` where the least cannot be distinguished from zero.
    singular_values : list of float
        Singular values of that matrix, the largest first.
    """

    input: str
    rank: int
    condition: float | None
    singular_values: list[float]


@dataclasses.dataclass(frozen=True)
class Pulses:
    """Validity of the mean flow of a valve under PWM.

    Attributes
    ----------
    valve : str
        Name of the actuator or the supply whose valve it is, of a joint `agonist` or `antagonist`; empty for one actuator.
    frequency : float
        Frequency of the pulses in Hz.
    supply_share : float
        Mean opening of the port to the supply over a period, 0 to 1.
    exhaust_share : float
        Mean opening of the port to the exhaust over a period, 0 to 1.
    duty_range : tuple of float
        Lowest and highest duty cycle at which the poppets follow the coil. None follows where the first is the greater.
    seats_follow : bool
        Whether they follow at this duty cycle. If not, the valve is in its dead zone and its gain is zero.
    pressure_ripple : float
        Peak-to-peak ripple in Pa, within a period at a fixed length, of the pressure that the valve opens into: with a hose, of the
        hose at the valve.
    pressure_margin : float
        Distance in Pa of the pressure from the nearest pressure beyond a port, such as that of the supply.
    ripple_is_small : bool
        Whether the ripple is smaller than the margin.
    frequency_over_fastest_pole : float or None
        Ratio of the frequency of the pulses to that of the fastest pole; `None` for several actuators with names.
    """

    valve: str
    frequency: float
    supply_share: float
    exhaust_share: float
    duty_range: tuple[float, float]
    seats_follow: bool
    pressure_ripple: float
    pressure_margin: float
    ripple_is_small: bool
    frequency_over_fastest_pole: float | None


@dataclasses.dataclass(frozen=True)
class Validity:
    """Validity of a linear model.

    Attributes
    ----------
    taut : bool or None
        Whether the braid is taut at the operating point; `None` for a joint or several actuators with names.
    controllability : list of Controllability
        Controllability from each input.
    pulses : list of Pulses
        Validity of the mean flow of each valve under PWM; empty where valves are held shut.
    warnings : list of str
        Reasons to doubt the model, in sentences. `linearize` raises each as a `UserWarning` too.
    """

    taut: bool | None
    controllability: list[Controllability]
    pulses: list[Pulses]
    warnings: list[str]


def validity(model: LinearModel) -> Validity:
    """Return the validity of a linear model."""

    def pulses(of: dict[str, typing.Any]) -> Pulses:
        holds = of["validity"]
        return Pulses(
            valve=of["of"],
            frequency=of["frequency_hz"],
            supply_share=of["supply_share"],
            exhaust_share=of["exhaust_share"],
            duty_range=(holds["duty_from"], holds["duty_to"]),
            seats_follow=holds["seats_follow"],
            pressure_ripple=holds["pressure_ripple_pa"],
            pressure_margin=holds["pressure_margin_pa"],
            ripple_is_small=holds["ripple_is_small"],
            frequency_over_fastest_pole=holds.get("frequency_over_fastest_pole"),
        )

    details = model.details
    under_pwm = details.get("pwm") or []
    return Validity(
        taut=details.get("taut"),
        controllability=[Controllability(**of) for of in details.get("controllability", [])],
        pulses=[pulses(of) for of in (under_pwm if isinstance(under_pwm, list) else [under_pwm])],
        warnings=model.warnings,
    )
