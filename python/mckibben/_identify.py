"""Estimates of parameters from measured data: from a study file, or from arrays and data frames."""

from __future__ import annotations

import collections.abc
import dataclasses
import functools
import numbers
import operator
import os
import typing
import warnings

import numpy
from numpy.typing import NDArray

from mckibben._axes import axes_for, label
from mckibben._mckibben import Scenario, _identify, _identify_file
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.figure
    import pandas

StudyKind = typing.Literal[
    "force-map", "hysteresis", "ring-down", "trajectories", "flow-curve", "steady-flow", "tank", "pulse-train"
]
Quantity = float | str
Progress = collections.abc.Callable[[int, None], object]

#: Keys of a column that are quantities; a number among them is in SI.
_OF_COLUMN = ("slack", "saturates", "deviation", "offset", "drift", "shift", "lag", "hold")
#: Keys of `flow`, `tank` and `pulses` that are plain numbers.
_PLAIN = ("windows", "threshold")


def _text(value: typing.Any) -> typing.Any:
    """A number as the text in which a study has quantities; the rest as it is."""
    is_number = isinstance(value, numbers.Real) and not isinstance(value, (bool, numpy.bool_))
    return repr(float(value)) if is_number else value


@dataclasses.dataclass(frozen=True)
class Run:
    """The measurements of one run.

    Parameters
    ----------
    data : mapping of arrays, pandas or Polars data frame, or a sequence of them
        Columns by their names. Columns that were read at other times stand in another table of the sequence, with a column of
        its own times.
    name : str, optional
        Name of the run in results; `run-1`, `run-2` and so on unless given.
    set : mapping, optional
        Keys of the scenario that differ in this run, such as `{"load.mass": 3.6}`. A number is in SI.
    held : mapping, optional
        Quantities that were held and have no column, such as `{"length": 0.25}`.
    session : str, optional
        Session that the run belongs to. Parameters with `per_session` in `fit` have one value for each.
    """

    data: typing.Any
    name: str | None = None
    set: collections.abc.Mapping[str, typing.Any] = dataclasses.field(default_factory=dict)
    held: collections.abc.Mapping[str, Quantity] = dataclasses.field(default_factory=dict)
    session: str | None = None

    def tables(self) -> list[typing.Any]:
        """The tables, one or more."""
        return [self.data] if _is_table(self.data) else list(self.data)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Study:
    """Measurements in arrays or data frames, and the parameters to be estimated from them.

    Parameters
    ----------
    kind : str
        What is estimated from what: "force-map", "hysteresis", "ring-down", "trajectories", "flow-curve", "steady-flow", "tank"
        or "pulse-train".
    scenario : Scenario
        The muscle and the rig as far as they are known. Parameters that are estimated start at its values.
    runs : sequence of Run, mapping or data frame
        The measurements, a table or a `Run` for each run; of a single run also without a sequence. Cells that are NaN or masked
        are missing; infinite ones are refused.
    columns : mapping
        For each quantity, such as "length" or "gauge_pressure" (of a part of a plant "elbow.angle"), the column that measures it:
        its name, where it is in SI; its name and unit, such as `("P", "bar")`; or a mapping with `name`, and if wanted `unit`,
        `deviation`, `offset`, `zero`, `slack`, `saturates`, `drop_outliers`.
    fit : mapping, optional
        For each parameter that is estimated its bounds `(low, high)`, or a mapping with `start`, `from`, `to`, `prior` (a
        mapping with `mean` and `deviation`) and `per_run`. A number is in SI.
    input : str, optional
        "gauge-pressure" drives trajectories by the measured pressure in place of the valve.
    more_starts : int, optional
        Searches from this many more starts, spread over the bounds. Trajectories are searched from the best 2 of 16 unless given;
        0 for the start of the scenario alone.
    robust : float, optional
        Residuals beyond so many standard deviations count less (Huber).
    horizon : sequence of float, optional
        Beginnings of trajectories that are fitted first, in s.
    segments : float, optional
        Length in s of segments that are fitted and must join.
    most_steps : int, optional
        Steps after which a search ends with the best values so far; 500 unless given.
    time_limit : float, optional
        Time in s after which the search ends with the best values so far.
    flow, tank, pulses : mapping, optional
        The sections of a study of a valve.
    """

    kind: StudyKind
    scenario: Scenario
    runs: typing.Any
    columns: collections.abc.Mapping[str, typing.Any]
    fit: collections.abc.Mapping[str, typing.Any] = dataclasses.field(default_factory=dict)
    input: typing.Literal["scenario", "gauge-pressure"] = "scenario"
    more_starts: int | None = None
    robust: float | None = None
    horizon: collections.abc.Sequence[Quantity] | None = None
    segments: Quantity | None = None
    most_steps: int | None = None
    time_limit: Quantity | None = None
    flow: collections.abc.Mapping[str, typing.Any] | None = None
    tank: collections.abc.Mapping[str, typing.Any] | None = None
    pulses: collections.abc.Mapping[str, typing.Any] | None = None

    def _columns(self) -> dict[str, dict[str, typing.Any]]:
        if not isinstance(self.columns, collections.abc.Mapping):
            raise InputError(f'columns is {self.columns!r}; give a dictionary of quantities, such as {{"time": "t", "length": ("L", "mm")}}')
        columns = {}
        for quantity, column in self.columns.items():
            if isinstance(column, str):
                columns[quantity] = {"name": column}
            elif isinstance(column, collections.abc.Mapping):
                entry = {key: _text(value) if key in _OF_COLUMN else value for key, value in column.items()}
                if "zero" in entry:
                    entry["zero"] = [{key: _text(value) for key, value in span.items()} for span in entry["zero"]]
                columns[quantity] = entry
            else:
                try:
                    name, unit = column
                except (TypeError, ValueError):
                    raise InputError(
                        f"columns: `{quantity}` is {column!r}; give the name of a column, its name and unit, or a dictionary"
                    ) from None
                columns[quantity] = {"name": name, "unit": unit}
        return columns

    def _fit(self) -> dict[str, dict[str, typing.Any]]:
        if not isinstance(self.fit, collections.abc.Mapping):
            raise InputError(f'fit is {self.fit!r}; give a dictionary of parameters, such as {{"load.mass": (1.0, 5.0)}}')
        fit = {}
        for path, wanted in self.fit.items():
            if isinstance(wanted, collections.abc.Mapping):
                fit[path] = dict(wanted)
                continue
            try:
                low, high = wanted
            except (TypeError, ValueError):
                raise InputError(f"fit: `{path}` is {wanted!r}; give its bounds as (low, high), or a dictionary") from None
            fit[path] = {"from": low, "to": high}
        return fit

    def _sections(self) -> tuple[dict[str, typing.Any], list[tuple[str, list[tuple[str, NDArray[numpy.float64]]]]]]:
        """The study as a file would have it, and its tables."""
        if not isinstance(self.scenario, Scenario):
            raise InputError(f"scenario is {self.scenario!r}; give a mckibben.Scenario")
        if self.kind not in typing.get_args(StudyKind):
            raise InputError(f"kind is {self.kind!r}; give one of {', '.join(typing.get_args(StudyKind))}")
        columns, tables, runs = self._columns(), [], []
        wanted = {entry["name"] for entry in columns.values() if "name" in entry}
        is_one = isinstance(self.runs, Run) or _is_table(self.runs)
        for place, given in enumerate([self.runs] if is_one else self.runs, 1):
            run = given if isinstance(given, Run) else Run(given)
            name = run.name or f"run-{place}"
            files = []
            heads = [str(key) for table in run.tables() for key in getattr(table, "columns", table)]
            for missing in sorted(wanted - set(heads)):
                raise InputError(f"no table of the run `{name}` has a column `{missing}`; they have: {', '.join(heads) or 'none'}")
            for number, table in enumerate(run.tables(), 1):
                file = f"table {number} of {name}"
                tables.append((file, [(str(key), _numbers(key, table[key], name)) for key in getattr(table, "columns", table) if key in wanted]))
                files.append(file)
            for part in ("held", "set"):
                if not isinstance(getattr(run, part), collections.abc.Mapping):
                    raise InputError(f"{part} of the run `{name}` is {getattr(run, part)!r}; give a dictionary of numbers or texts")
            held = {quantity: _text(value) for quantity, value in run.held.items()}
            session = {} if run.session is None else {"session": run.session}
            runs.append({"name": name, "files": files, "held": held, "set": dict(run.set), **session})
        if not runs:
            raise InputError("runs is empty; give a table, a mckibben.Run, or several")
        search: dict[str, typing.Any] = {}
        for name in ("more_starts", "most_steps"):
            count = getattr(self, name)
            if count is not None:
                search[name] = _count(name, count)
        if self.robust is not None:
            search["robust"] = float(self.robust)
        if self.horizon is not None:
            search["horizon"] = [_text(end) for end in self.horizon]
        for name in ("segments", "time_limit"):
            if getattr(self, name) is not None:
                search[name] = _text(getattr(self, name))
        head = {"kind": self.kind, "scenario": self.scenario.name, "input": self.input}
        sections = {"study": head, "columns": columns, "run": runs, "fit": self._fit(), "search": search}
        for section in ("flow", "tank", "pulses"):
            values = getattr(self, section)
            if values is not None:
                if not isinstance(values, collections.abc.Mapping):
                    raise InputError(f"{section} is {values!r}; give a dictionary of the keys of a study's section [{section}]")
                sections[section] = {key: value if key in _PLAIN else _text(value) for key, value in values.items()}
        return sections, tables


def _step_info(parts: tuple[typing.Any, ...] | None) -> StepInfo | None:
    return None if parts is None else StepInfo(*parts)


def _count(name: str, value: typing.Any) -> int:
    try:
        count = operator.index(value)
    except TypeError:
        raise InputError(f"{name} is {value!r}; give a whole number") from None
    if count < 0:
        raise InputError(f"{name} is {count}; give a whole number that is not below zero")
    return count


def _is_table(data: typing.Any) -> bool:
    """Return whether this is one table, not a sequence of them."""
    return isinstance(data, collections.abc.Mapping) or hasattr(data, "columns")


def _numbers(name: object, values: typing.Any, run: str) -> NDArray[numpy.float64]:
    """Return the cells of a column as numbers; NaN where a cell is missing or masked."""
    try:
        of = numpy.asarray(values).dtype
        if isinstance(values, numpy.ma.MaskedArray) and of.kind in "biuf":
            values = numpy.ma.filled(values.astype(float), numpy.nan)
        # NumPy would take times as numbers of a unit that the study does not know, and of complex numbers the real part alone.
        array = None if of.kind in "mMc" else numpy.asarray(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"the column `{name}` of the run `{run}` is no array of numbers ({error})") from None
    if of.kind == "c":
        raise InputError(
            f"the column `{name}` of the run `{run}` has complex numbers, and a study takes real ones; "
            "give their real part or magnitude, such as column.real"
        )
    if array is None:
        seconds = "(column - column[0])" if of.kind == "M" else "column"
        raise InputError(
            f"the column `{name}` of the run `{run}` is of type {of}, and a study takes numbers; "
            f'give seconds, such as {seconds} / numpy.timedelta64(1, "s")'
        )
    if array.ndim != 1:
        raise InputError(f"the column `{name}` of the run `{run}` has {array.ndim} dimensions; give one")
    for place in numpy.flatnonzero(numpy.isinf(array)):
        raise InputError(
            f"the column `{name}` of the run `{run}` is {array[place]} in row {place}; give finite numbers, and NaN where there is no reading"
        )
    return array


@dataclasses.dataclass(frozen=True)
class Estimate:
    """An estimated parameter."""

    #: The path of its key in a scenario, with the run behind it where each run has its own.
    name: str
    #: The unit of its values, in SI; empty for a pure number.
    unit: str
    #: The value that fits best.
    value: float
    #: Its standard error; `None` where the data do not identify it, it rests on a bound, or the search did not end at a minimum.
    standard_error: float | None
    #: Its 95 % confidence interval, likewise.
    confidence_interval: tuple[float, float] | None
    #: Whether it rests on one of its bounds.
    on_bound: bool


@dataclasses.dataclass(frozen=True)
class OtherMinimum:
    """Another end of a search from several starts."""

    #: The values of the parameters there, by their names.
    values: dict[str, float]
    #: Root mean square of the weighted residuals there, over that of the estimates.
    error_ratio: float
    #: How many searches ended there.
    searches: int
    #: Whether it is a minimum; else a kink, or the search was not done.
    is_minimum: bool


@dataclasses.dataclass(frozen=True)
class StepInfo:
    """Properties of a time series that goes from one level to another and comes to rest."""

    #: From the first level to the last, in the unit of the series.
    stroke: float
    #: How far the first extreme lies beyond the last level, in parts of the stroke; 0 where none does.
    overshoot: float
    #: When that extreme is, in s; `None` where there is none.
    first_peak: float | None
    #: The frequency of the oscillation about the last level, in Hz; `None` where there is none.
    frequency: float | None
    #: When the series last leaves the band of 5 % of the stroke about its last level, in s.
    settling: float
    #: The root mean square error of a prediction, in parts of the measured stroke; `None` for readings.
    error: float | None


@dataclasses.dataclass(frozen=True)
class StepResponse:
    """The response of one quantity in one step-like run, measured and predicted."""

    #: The name of the run.
    run: str
    #: What was measured, in words.
    quantity: str
    #: Its SI unit.
    unit: str
    #: That of the readings.
    measured: StepInfo
    #: That of the fitted model.
    predicted: StepInfo | None
    #: That of the model fitted to all other runs; `None` where there are none.
    held_out: StepInfo | None


@dataclasses.dataclass(frozen=True, eq=False)
class Prediction:
    """The readings of one quantity in one run, with the predictions of the fitted model."""

    #: The name of the run; empty where the readings of all runs are taken together.
    run: str
    #: What was measured, in words: of pulse trains "opening delay" and "closing delay", each from an edge of the coil to the onset
    #: of the pressure that followed.
    quantity: str
    #: The SI unit of the readings; empty for a pure number.
    unit: str
    #: At what each reading was taken, by names such as `time_s`, `length_m`, `pressure_ratio` or `edge_s`.
    coordinates: dict[str, NDArray[numpy.float64]]
    #: The readings.
    measured: NDArray[numpy.float64]
    #: The predictions.
    predicted: NDArray[numpy.float64]

    @property
    def residuals(self) -> NDArray[numpy.float64]:
        """The predictions less the readings."""
        return self.predicted - self.measured


@dataclasses.dataclass(frozen=True, eq=False)
class Identification(collections.abc.Mapping[str, Estimate]):
    """Parameters estimated from measured data: `found["actuator.friction.viscous"].value`."""

    #: The estimates in their order; of ring-downs those of the waveform, or of all velocity reversals where there is none.
    estimates: list[Estimate]
    #: Where other searches from several starts ended, the nearest to the measurements first.
    other_minima: list[OtherMinimum]
    #: Overshoot, first peak, frequency and settling of step-like runs of trajectories, measured and predicted.
    step_responses: list[StepResponse]
    #: Whether the search was interrupted or its time was over, so that the values are the best so far.
    interrupted: bool
    #: Correlations of the estimates, row by row in their order; `None` where they do not come from one fit, or it is not at a minimum.
    correlations: NDArray[numpy.float64] | None
    #: The readings with the predictions of the fitted model; empty of a tank that is fitted window by window.
    predictions: list[Prediction]
    #: What was done, in a few sentences.
    notes: list[str]
    #: What casts doubt on the estimates. `identify` raises each as a `UserWarning` too.
    warnings: list[str]
    #: What was found in the data in addition.
    remarks: list[str]
    #: The scenarios with the estimated values, by the names of their files.
    scenarios: dict[str, Scenario]
    #: The figures of the report as SVG, by their names.
    figures: dict[str, str]

    def __getitem__(self, name: str) -> Estimate:
        for estimate in self.estimates:
            if estimate.name == name:
                return estimate
        raise KeyError(f"there is no `{name}` but {', '.join(self)}")

    def __iter__(self) -> collections.abc.Iterator[str]:
        return (estimate.name for estimate in self.estimates)

    def __len__(self) -> int:
        return len(self.estimates)

    def __repr__(self) -> str:
        return f"<mckibben.Identification of {', '.join(self)}>"

    @functools.cached_property
    def covariance(self) -> NDArray[numpy.float64] | None:
        """Covariance of the estimates, row by row in their order; NaN where an estimate has no standard error, and `None`
        where they do not come from one fit."""
        if self.correlations is None:
            return None
        errors = numpy.array([numpy.nan if one.standard_error is None else one.standard_error for one in self.estimates])
        return self.correlations * numpy.outer(errors, errors)

    def to_pandas(self) -> pandas.DataFrame:
        """The estimates as a data frame, a row for each: `value`, `standard_error`, `low` and `high` of the 95 % confidence
        interval, `unit`, `on_bound`."""
        import pandas

        rows = {
            one.name: {
                "value": one.value,
                "standard_error": numpy.nan if one.standard_error is None else one.standard_error,
                "low": numpy.nan if one.confidence_interval is None else one.confidence_interval[0],
                "high": numpy.nan if one.confidence_interval is None else one.confidence_interval[1],
                "unit": one.unit,
                "on_bound": one.on_bound,
            }
            for one in self.estimates
        }
        return pandas.DataFrame.from_dict(rows, orient="index")

    def predictions_to_pandas(self) -> pandas.DataFrame:
        """Every reading as a row: `run`, `quantity`, `unit`, its coordinates, `measured`, `predicted`, `residual`."""
        import pandas

        frames = [
            pandas.DataFrame(
                {
                    "run": one.run,
                    "quantity": one.quantity,
                    "unit": one.unit,
                    **one.coordinates,
                    "measured": one.measured,
                    "predicted": one.predicted,
                    "residual": one.residuals,
                }
            )
            for one in self.predictions
        ]
        return pandas.concat(frames, ignore_index=True) if frames else pandas.DataFrame()

    def plot(self, run: str | None = None, ax: typing.Any = None) -> matplotlib.figure.Figure:
        """Readings and predictions with their residuals, two panels for each quantity.

        Parameters
        ----------
        run : str, optional
            The run to draw; the first unless given.
        ax : sequence of matplotlib.axes.Axes, optional
            Axes to draw into, two for each quantity.

        Returns
        -------
        matplotlib.figure.Figure
        """
        if not self.predictions:
            raise InputError("the study has no predictions to draw; `figures` has the figures of its report")
        wanted = self.predictions[0].run if run is None else run
        drawn = [one for one in self.predictions if one.run == wanted]
        if not drawn:
            known = ", ".join(dict.fromkeys(one.run for one in self.predictions))
            raise InputError(f"there is no run `{wanted}`; name one of {known}")
        count = 2 * len(drawn)
        options = {"gridspec_kw": {"height_ratios": [3, 1] * len(drawn)}, "figsize": (6.4, 4 * len(drawn))}
        axes, figure = axes_for(ax, count, f"; give {count}, two for each quantity", **options)
        for one, (upper, lower) in zip(drawn, zip(axes[::2], axes[1::2])):
            name, at = next(iter(one.coordinates.items()))
            line = "-" if name == "time_s" else "."
            upper.plot(at, one.measured, ".", color="0.6", markersize=3, label="measured")
            upper.plot(at, one.predicted, line, label="predicted")
            upper.set_ylabel(label(one.quantity, one.unit))
            lower.plot(at, one.residuals, ".", markersize=3)
            lower.axhline(0.0, color="0.6", linewidth=0.8)
            lower.set_ylabel("residual")
            lower.set_xlabel(name)
        axes[0].legend()
        return figure


def identify(
    study: str | os.PathLike[str] | Study,
    output: str | os.PathLike[str] | None = None,
    *,
    progress: Progress | None = None,
) -> Identification:
    """Estimates parameters of a scenario from measured data, with their confidence intervals.

    Parameters
    ----------
    study : str, path or Study
        A study file, as `mckibben identify` takes it, or a `Study` of arrays and data frames.
    output : str or path, optional
        A folder for the report, the scenarios and the values.
    progress : callable, optional
        Called now and then with the number of evaluations of the model so far, and `None`. What it raises ends the search and is
        raised; `KeyboardInterrupt` ends it as Ctrl-C does.

    Returns
    -------
    Identification
        The estimates. Where some runs of several fail, its `warnings` say which and why. Ctrl-C ends a search with the best values
        so far: `interrupted` is true then, and `warnings` say so. `KeyboardInterrupt` is raised only before there are values.

    Raises
    ------
    InputError
        The study, its data or its scenario is wrong.
    SimulationError
        No fit was found; a report is written all the same.

    Warns
    -----
    UserWarning
        Each of the result's `warnings`.

    Examples
    --------
    >>> import mckibben, numpy
    >>> time = numpy.linspace(0.0, 0.3, 301)
    >>> rig = mckibben.Scenario('''
    ... [load]
    ... kind = "hanging-mass"
    ... mass = "5 lb"
    ... [initial]
    ... gauge_pressure = "60 psi"
    ... length = "85 mm"
    ... [run]
    ... duration = "0.3 s"
    ... ''')
    >>> length = mckibben.simulate(rig.with_values({"actuator.friction.viscous": 5.0})).at_times(time)["length_m"]
    >>> found = mckibben.identify(mckibben.Study(
    ...     kind="trajectories", scenario=rig, runs=[{"t": time, "L": length}], columns={"time": "t", "length": "L"},
    ...     fit={"actuator.friction.viscous": (0.0, 50.0)},
    ... ))
    >>> round(found["actuator.friction.viscous"].value, 6)
    5.0
    """
    if isinstance(study, Study):
        sections, tables = study._sections()
        found = _identify(sections, tables, study.scenario, output, progress)
    else:
        found = _identify_file(study, output, progress)
    result = Identification(
        estimates=[Estimate(*parts) for parts in found["estimates"]],
        other_minima=[
            OtherMinimum(dict(zip((one[0] for one in found["estimates"]), values)), *others)
            for values, *others in found["other_minima"]
        ],
        step_responses=[
            StepResponse(run, quantity, unit, StepInfo(*measured), _step_info(predicted), _step_info(held_out))
            for run, quantity, unit, measured, predicted, held_out in found["step_responses"]
        ],
        interrupted=found["interrupted"],
        correlations=found["correlations"],
        predictions=[Prediction(**parts) for parts in found["predictions"]],
        notes=found["notes"],
        warnings=found["warnings"],
        remarks=found["remarks"],
        scenarios={name: Scenario(text, name) for name, text in found["scenarios"]},
        figures=dict(found["figures"]),
    )
    for words in result.warnings:
        warnings.warn(words, stacklevel=2)
    return result
