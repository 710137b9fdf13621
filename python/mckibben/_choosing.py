"""Muscles for a load and a stroke, and the values of keys that do something best."""

from __future__ import annotations

import collections.abc
import dataclasses
import sys
import typing
import warnings

import numpy
from numpy.typing import NDArray

from mckibben._arguments import whole_of
from mckibben._listed import listed
from mckibben._mckibben import Scenario, _design, _Sizes
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import pandas

#: Is called with the number of runs that are done, and of all at most.
Progress = typing.Callable[[int, int], object]

#: Braid angles at rest of the braids that are made to measure.
ANGLES = ("15 deg", "20 deg", "25 deg", "30 deg", "35 deg")


@dataclasses.dataclass(frozen=True)
class SizedMuscle:
    """Muscles that lift a load over a stroke.

    Attributes
    ----------
    name : str
        Such as "braid of 25°", or the name of a preset.
    count : int
        Number of muscles side by side.
    length : float
        Length at rest in m.
    diameter : float
        Diameter of the braid at rest in m.
    thread_length : float
        Length of a thread in m.
    turns : float
        Turns of a thread round the muscle.
    contraction : float
        Contraction under the load at the whole pressure, over the length at rest.
    needed_gauge_pressure : float
        Gauge pressure in Pa at which the stroke is done.
    force_at_rest : float
        Force in N of all muscles at their length at rest and the whole pressure.
    air : float
        Mass in kg of the air that a stroke takes at a temperature of 293.15 K, all muscles together: from the length at rest without
        pressure to the end of the stroke. A fill of `scenario` takes less (`air.used`) where its air is warmed: that of the isentropic
        process, the default, is at the end of the stroke warmer than the room.
    sonic_conductance : float or None
        Least sonic conductance in m³/(s·Pa) of the valve of each muscle; `None` without a time, or where none is enough.
    pwm_frequency : float or None
        Least frequency in Hz at which pulses of that valve keep the middle of the stroke within the ripple; `None` without one, or
        where no pulses do.
    pwm_duty : float or None
        Duty cycle that holds the load there.
    scenario : Scenario
        One of the muscles with its share of the load, and the valve where there is a time; under its pulses where there is a ripple.
    """

    name: str
    count: int
    length: float
    diameter: float
    thread_length: float
    turns: float
    contraction: float
    needed_gauge_pressure: float
    force_at_rest: float
    air: float
    sonic_conductance: float | None
    pwm_frequency: float | None
    pwm_duty: float | None
    scenario: Scenario


class Sizes(collections.abc.Sequence[SizedMuscle]):
    """Muscles that lift a load over a stroke, those that take the least air first.

    `size` returns it.
    """

    def __init__(self, arguments: tuple[typing.Any, ...]) -> None:
        self._arguments = arguments
        self._of = of = _Sizes(*arguments)
        names = [field.name for field in dataclasses.fields(SizedMuscle)][2:-4]
        self._muscles = [
            SizedMuscle(
                name,
                count,
                **dict(zip(names, numbers)),
                sonic_conductance=conductance,
                pwm_frequency=None if pulses is None else pulses[0],
                pwm_duty=None if pulses is None else pulses[1],
                scenario=Scenario(of.scenario(place), f"{name}.toml"),
            )
            for place, (name, count, numbers, conductance, pulses) in enumerate(of.candidates())
        ]

    def __reduce__(self) -> tuple[type[Sizes], tuple[tuple[typing.Any, ...]]]:
        return Sizes, (self._arguments,)

    @typing.overload
    def __getitem__(self, place: int) -> SizedMuscle: ...

    @typing.overload
    def __getitem__(self, place: slice) -> list[SizedMuscle]: ...

    def __getitem__(self, place: int | slice) -> SizedMuscle | list[SizedMuscle]:
        return self._muscles[place]

    def __len__(self) -> int:
        return len(self._muscles)

    def __repr__(self) -> str:
        return f"<mckibben.Sizes, {len(self)} muscles: {', '.join(muscle.name for muscle in self)}>"

    @property
    def left_out(self) -> list[str]:
        """What does not do it, each with the reason."""
        return self._of.left_out()

    def valves(self, place: int = 0) -> dict[str, float | None]:
        """Return how quick valves that can be bought are.

        Parameters
        ----------
        place : int, optional
            Index of the muscle, from 0.

        Returns
        -------
        dict of str to float or None
            Time in s of nine tenths of the stroke by the names of presets, the quickest first; `None` where it takes more than ten
            times as long as was requested.

        Raises
        ------
        InputError
            No time was requested, or there is no such muscle.
        """
        return dict(self._of.valves(self._counted(place)))

    def hoses(self, length: float | str, place: int = 0) -> dict[float, float | None]:
        """Return what hoses between valve and muscle require of the valve.

        Parameters
        ----------
        length : float or str
            Length of the hose in m, or text with a unit.
        place : int, optional
            Index of the muscle, from 0.

        Returns
        -------
        dict of float to float or None
            Least sonic conductance of the valve in m³/(s·Pa) by the inner diameter of the hose in m; `None` where no valve is enough.

        Raises
        ------
        InputError
            No time was requested, the length is not above zero, or there is no such muscle.
        """
        return dict(self._of.hoses(self._counted(place), length))

    def to_pandas(self) -> pandas.DataFrame:
        """Return the muscles as a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each muscle, in SI, without its scenario.
        """
        import pandas

        names = [field.name for field in dataclasses.fields(SizedMuscle) if field.name != "scenario"]
        return pandas.DataFrame([{name: getattr(muscle, name) for name in names} for muscle in self], columns=names)

    def _counted(self, place: int) -> int:
        """Return the index of a muscle."""
        return whole_of("place", place, 0, len(self) - 1, f"there are {len(self)} muscles; give 0 for the first")


def size(
    *,
    load: float | str,
    stroke: float | str,
    gauge_pressure: float | str,
    braid_angles: collections.abc.Sequence[float | str] = ANGLES,
    effectiveness: float | str = 1.0,
    most_length: float | str | None = None,
    most_diameter: float | str | None = None,
    time: float | str | None = None,
    ripple: float | str | None = None,
) -> Sizes:
    """Look for muscles that lift a load over a stroke at a pressure, as `mckibben size` does.

    A muscle hangs under the load at rest: at its greatest length, without pressure. Its stroke is how much shorter it is where it
    holds the load at the whole pressure. Friction is left out.

    Parameters
    ----------
    load : float or str
        Force in N; or text, such as "5 kg" of a mass that hangs, or "80 N".
    stroke : float or str
        Stroke in m, or text with a unit.
    gauge_pressure : float or str
        Gauge pressure of the supply in Pa, or text with a unit.
    braid_angles : sequence of float or str, optional
        Braid angles at rest, in rad or as text, of the braids that are made to measure; 15° to 35° by default.
    effectiveness : float or str, optional
        Force of a real braid over that of the ideal one, 0.8 or "80 %", for the braids that are made to measure.
    most_length : float or str, optional
        Greatest length at rest in m, or text with a unit.
    most_diameter : float or str, optional
        Greatest diameter at rest in m, or text with a unit.
    time : float or str, optional
        Time in s within which nine tenths of the stroke are to be done: the conductances of valves follow.
    ripple : float or str, optional
        Peak to peak swing of the length in m that pulses may leave in the middle of the stroke: their frequency follows. Only with
        `time`.

    Returns
    -------
    Sizes
        The muscles, those that take the least air first; empty where none does it.

    Raises
    ------
    InputError
        A number is outside its range, or has another unit.

    Examples
    --------
    >>> import mckibben
    >>> sizes = mckibben.size(load="5 kg", stroke="30 mm", gauge_pressure="4 bar", braid_angles=["25 deg"])
    >>> braid = next(muscle for muscle in sizes if muscle.name == "braid of 25°")
    >>> round(1e3 * braid.length, 1), round(1e3 * braid.diameter, 1)
    (176.2, 6.3)
    """
    angles = tuple(listed("braid_angles", braid_angles))
    return Sizes((load, stroke, gauge_pressure, angles, effectiveness, most_length, most_diameter, time, ripple))


@dataclasses.dataclass(frozen=True)
class Constrained:
    """A constraint of a search, at the values found.

    Attributes
    ----------
    text : str
        As it was given, such as "length.final<=80 mm".
    value : float
        The number in SI.
    margin : float
        Distance from the bound in SI, below zero where it is broken; a millionth of the bound may be.
    active : bool
        Whether the number is at its bound, to a ten-thousandth.
    """

    text: str
    value: float
    margin: float
    active: bool


@dataclasses.dataclass(frozen=True)
class DesignResult:
    """The values of keys that make a number of a run least or greatest.

    Attributes
    ----------
    values : dict of str to float
        Values found by their keys, in SI.
    ends : dict of str to str
        Keys whose value is at an end of its range, with "low" or "high": the range bounds the result, not the model.
    objective : str
        Name of the number.
    value : float
        The number at the values found, in SI.
    unit : str
        Its unit; empty for a pure number.
    constraints : list of Constrained
        Constraints at the values found.
    scenario : Scenario
        The scenario with the values found.
    converged : bool
        Whether the search came to its smallest steps before its evaluations were used up.
    interrupted : bool
        Whether Ctrl-C has ended the search.
    warnings : list of str
        Warnings of the run with the values found, as `Trajectory.warnings` has them.
    points : dict of str to numpy.ndarray
        Every run in the order of the search: values of the keys and numbers by their names, NaN where a run failed, and "feasible".
    """

    values: dict[str, float]
    ends: dict[str, str]
    objective: str
    value: float
    unit: str
    constraints: list[Constrained]
    scenario: Scenario
    converged: bool
    interrupted: bool
    warnings: list[str]
    points: dict[str, NDArray[typing.Any]]

    @property
    def evaluations(self) -> int:
        """Number of runs."""
        return len(self.points["feasible"])

    def to_pandas(self) -> pandas.DataFrame:
        """Return every run as a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each run, in the order of the search.
        """
        import pandas

        return pandas.DataFrame(self.points)


def design(
    scenario: Scenario,
    vary: collections.abc.Mapping[str, str | tuple[float | str, float | str]],
    *,
    minimize: str | None = None,
    maximize: str | None = None,
    subject_to: collections.abc.Sequence[str] = (),
    settle: bool = False,
    evaluations: int = 200,
    progress: Progress | None = None,
) -> DesignResult:
    """Search the values of keys that make a number of a run least or greatest under constraints, as `mckibben design` does.

    The search is deterministic, uses all cores, and finds a local optimum.

    Parameters
    ----------
    scenario : Scenario
        Scenario of any kind.
    vary : mapping of str to tuple or str
        Range of each key: two numbers in SI, two texts with units, or one text such as "3..7 bar". An entry of a list is
        "command.time[1]".
    minimize, maximize : str, optional
        Name of the number that is made least or greatest, one of the two: a reduction such as "air.used", or a number of
        `Trajectory.summary`. Extremes are those of a run between its samples too, unlike those of a sweep.
    subject_to : sequence of str, optional
        Bounds on numbers, such as "length.final<=80 mm" or "tension.max>=100 N".
    settle : bool, optional
        Whether each run goes on to its periodic orbit or equilibrium, for numbers such as "settled.length.ripple".
    evaluations : int, optional
        Runs at most; 200 by default.
    progress : callable, optional
        Called now and then with the number of runs so far, and at most. What it raises ends the search and is raised;
        `KeyboardInterrupt` ends it as Ctrl-C does.

    Returns
    -------
    DesignResult
        The values found. Ctrl-C ends a search with the best values so far, where some meet the constraints: `interrupted` is true then.

    Raises
    ------
    InputError
        A key, a range, a name or a constraint is wrong.
    SimulationError
        Nothing meets the constraints, or no run comes to its end.

    Warns
    -----
    UserWarning
        The search was interrupted. Each of the result's `warnings`.

    Examples
    --------
    >>> import mckibben
    >>> rig = mckibben.Scenario.from_dict({
    ...     "supply": {"gauge_pressure": "6 bar"},
    ...     "valve": {"kind": "three-way", "flow_area": "3 mm^2"},
    ...     "command": {"kind": "fill"},
    ...     "load": {"kind": "isometric"},
    ...     "initial": {"length": "90 mm"},
    ...     "run": {"duration": "0.5 s"},
    ... })
    >>> found = mckibben.design(
    ...     rig, {"supply.gauge_pressure": (1e5, 6e5)}, minimize="gauge_pressure.final", subject_to=["tension.final>=40 N"],
    ...     evaluations=60,
    ... )
    >>> abs(found.constraints[0].value - 40.0) < 0.01
    True
    """
    names = [(name, True) for name in (minimize,) if name is not None]
    names += [(name, False) for name in (maximize,) if name is not None]
    if len(names) != 1:
        raise InputError("one number is made least or greatest; give `minimize` or `maximize`, and only one of them")
    ((objective, least),) = names
    if not isinstance(vary, collections.abc.Mapping):
        raise InputError(f'`vary` is of type {type(vary).__name__}; give a dictionary of keys, such as {{"load.mass": (2.0, 3.0)}}')
    ranges = [(key, *_ends(key, ends)) for key, ends in vary.items()]
    evaluations = whole_of("evaluations", evaluations, 1, sys.maxsize, "give a whole number of runs from 1 on, such as 200")
    found = _design(scenario, ranges, least, objective, subject_to, settle, evaluations, progress)
    name, (value, unit) = found["objective"]
    result = DesignResult(
        values={key: value for key, value, _ in found["values"]},
        ends={key: end for key, _, end in found["values"] if end is not None},
        objective=name,
        value=value,
        unit=unit,
        constraints=[Constrained(*parts) for parts in found["constraints"]],
        scenario=Scenario(found["scenario"], "best.toml"),
        converged=found["converged"],
        interrupted=found["interrupted"],
        warnings=found["warnings"],
        points={name: numpy.asarray(values) for name, values in found["points"].items()},
    )
    if result.interrupted:
        warnings.warn("the search was interrupted: these are the best values so far", stacklevel=2)
    for words in result.warnings:
        warnings.warn(f"{objective} = {value:.4g} {unit}: {words}", stacklevel=2)
    return result


def _ends(key: str, ends: str | tuple[float | str, float | str]) -> tuple[float | str, float | str]:
    """Return the ends of a range."""
    if isinstance(ends, str):
        least, dots, most = ends.partition("..")
        if not dots:
            raise InputError(f'`vary`: the range of {key} is {ends!r}; write it as in "3..7 bar"')
        return least.strip(), most.strip()
    try:
        low, high = ends
    except (TypeError, ValueError):
        raise InputError(f"`vary`: the range of {key} is {ends!r}; give its two ends, the lower and the upper one") from None
    return low, high
