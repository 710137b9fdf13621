"""Sweeps on the cores of this machine, on any executor, or on Ray. The files are bit-identical."""

from __future__ import annotations

import collections
import collections.abc
import concurrent.futures
import dataclasses
import numbers
import os
import pathlib
import tempfile
import typing
import warnings

from mckibben._arguments import check_progress, check_scenario, is_number
from mckibben._axes import axes_for, label
from mckibben._listed import listed
from mckibben._mckibben import Scenario, Sweep
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import pandas
    import polars

#: Parts that are computed or wait to be, where the number of workers is not known.
_AHEAD = 64

#: Called with the parts that are finished and all there are.
Progress = collections.abc.Callable[[int, int], object]


@dataclasses.dataclass(frozen=True)
class SweepWarning:
    """Warning of runs of a sweep.

    Attributes
    ----------
    code : str
        Short name of the warning, such as `thrown`; the column `warnings` has those of each run.
    runs : int
        Number of runs with it.
    first : int
        Index of the first of them.
    text : str
        What it says of that run: the quantity, its value, the limit, and what to change.
    """

    code: str
    runs: int
    first: int
    text: str


@dataclasses.dataclass(frozen=True)
class SweepResult:
    """Finished sweep: a folder of Parquet parts, with a row for each run.

    Attributes
    ----------
    folder : pathlib.Path
        Folder with the parts and `sweep.json`.
    rows : int
        Number of runs.
    failed : int
        Number of runs that failed; the column `error` of each has the reason.
    units : dict of str to str
        Units of the columns of numbers by their names, in SI.
    logarithmic : tuple of str
        Names of the columns of varied keys whose values are spaced or distributed evenly in their logarithm.
    left_out : tuple of str
        Keys that runs left out, since they have no meaning under a word of another key that varies: a sentence each.
    warnings : tuple of SweepWarning
        Warnings of the runs by their codes: how many runs have each, and what the first says.

    Examples
    --------
    >>> import mckibben, tempfile
    >>> scenario = mckibben.Scenario.from_dict({
    ...     "load": {"kind": "hanging-mass"},
    ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
    ...     "run": {"duration": "20 ms"},
    ...     "sweep": {"reductions": ["length.final"], "vary": {"load.mass": ["4 lb", "8 lb"]}},
    ... })
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     result = mckibben.sweep(scenario, folder)
    ...     result.rows, result.failed, [part.name for part in result.parts]
    (2, 0, ['part-00000.parquet'])
    """

    folder: pathlib.Path
    rows: int
    failed: int
    units: dict[str, str]
    logarithmic: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    warnings: tuple[SweepWarning, ...] = ()

    @property
    def parts(self) -> list[pathlib.Path]:
        """Paths of the Parquet files, in the order of their runs."""
        return sorted(self.folder.glob("part-*.parquet"))

    def to_polars(self) -> polars.DataFrame:
        """Return all runs as a data frame of Polars, in their order.

        Returns
        -------
        polars.DataFrame
            A row for each run.
        """
        import polars

        return polars.concat([polars.read_parquet(part) for part in self.parts])

    def to_pandas(self) -> pandas.DataFrame:
        """Return all runs as a data frame of pandas, in their order. It needs pyarrow.

        Returns
        -------
        pandas.DataFrame
            A row for each run, with the units in `attrs["units"]` and the warnings in `attrs["warnings"]`.
        """
        import pandas

        frame = pandas.concat([pandas.read_parquet(part) for part in self.parts], ignore_index=True)
        frame.attrs["units"] = self.units
        frame.attrs["warnings"] = self.warnings
        return frame

    def plot(
        self,
        columns: collections.abc.Sequence[str] | None = None,
        over: str | None = None,
        ax: collections.abc.Sequence[matplotlib.axes.Axes] | None = None,
    ) -> matplotlib.figure.Figure:
        """Draw columns of numbers over another, a point for each run and a panel for each column.

        A column in `logarithmic` has a logarithmic axis.

        Parameters
        ----------
        columns : sequence of str, optional
            Names of columns; by default all that are not constant, without `over`.
        over : str, optional
            Name of the column on the horizontal axis; by default the first that varies.
        ax : sequence of matplotlib.axes.Axes, optional
            Axes to draw into, one for each column.

        Returns
        -------
        matplotlib.figure.Figure
            Figure with the panels.

        Raises
        ------
        InputError
            A name is that of no column of numbers, or `ax` has another number of axes.
        """
        frame = self.to_pandas()
        columns = None if columns is None else listed("columns", columns)
        for name in [*(columns or []), *([] if over is None else [over])]:
            if name not in self.units:
                raise InputError(f"`{name}` is no column of numbers of the sweep; name one of {', '.join(self.units)}")
        varying = [name for name in self.units if frame[name].nunique() > 1]
        across = over if over is not None else next(iter(varying), next(iter(self.units)))
        drawn = list(columns) if columns is not None else [name for name in varying if name != across]
        if not drawn:
            raise InputError("no column of the sweep varies; name those to draw in `columns`")
        axes, figure = axes_for(ax, len(drawn), f" for {len(drawn)} columns; give one for each")
        for axis, name in zip(axes, drawn):
            axis.plot(frame[across], frame[name], ".")
            axis.set_ylabel(label(name, self.units[name]))
            if name in self.logarithmic:
                axis.set_yscale("log")
            if across in self.logarithmic:
                axis.set_xscale("log")
        axes[-1].set_xlabel(label(across, self.units[across]))
        return figure


@typing.overload
def sweep(
    scenario: Scenario,
    folder: str | os.PathLike[str],
    *,
    vary: collections.abc.Mapping[str, typing.Any] | None = None,
    reductions: collections.abc.Sequence[str] | None = None,
    executor: concurrent.futures.Executor | typing.Literal["ray"] | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> SweepResult: ...


@typing.overload
def sweep(
    scenario: Scenario,
    folder: None = None,
    *,
    vary: collections.abc.Mapping[str, typing.Any] | None = None,
    reductions: collections.abc.Sequence[str] | None = None,
    executor: concurrent.futures.Executor | typing.Literal["ray"] | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> pandas.DataFrame: ...


def sweep(
    scenario: Scenario,
    folder: str | os.PathLike[str] | None = None,
    *,
    vary: collections.abc.Mapping[str, typing.Any] | None = None,
    reductions: collections.abc.Sequence[str] | None = None,
    executor: concurrent.futures.Executor | typing.Literal["ray"] | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> SweepResult | pandas.DataFrame:
    """Simulate the runs of a parameter sweep, into a folder of Parquet parts or a data frame.

    The runs are those of the scenario's section `[sweep]`, bit-identical to those of `mckibben sweep`.

    Parameters
    ----------
    scenario : Scenario
        Scenario with a section `[sweep]`, unless `vary` and `reductions` give it.
    folder : str or path, optional
        Folder of the Parquet parts. Parts that are finished in it are kept, so that a sweep that was stopped continues with the
        missing ones. By default the runs are returned as a data frame, which needs pyarrow.
    vary : mapping, optional
        Values by the paths of keys, in place of the section `[sweep.vary]`:
        `{"load.mass": ["4 lb", "8 lb"], "command.duty": [0.3, 0.5]}`. A number is in SI.
    reductions : sequence of str, optional
        Names of reductions, in place of the key `sweep.reductions`, such as `["length.final", "air.used"]`. They are taken over the
        samples at `run.sample_interval`: an extreme may miss a peak between two samples, which `Trajectory.summary` has.
    executor : concurrent.futures.Executor or "ray", optional
        Executor of processes or threads, or of Dask by `Client.get_executor()`. "ray" is the cluster to which Ray is connected,
        or one that it starts. By default the runs take place on threads of this process.
    jobs : int, optional
        Number of threads, from 1 to 4096; one for each core by default. Not together with `executor`.
    progress : callable, optional
        Called as `progress(done, parts)` with the number of finished parts and of all: after each part with an executor, else
        after every few parts. An exception that it raises ends the sweep between parts; Ctrl-C ends the runs in progress.

    Returns
    -------
    SweepResult or pandas.DataFrame
        With a `folder` the result in it. Else a data frame with a row for each run, the units in `attrs["units"]` and the warnings
        of the runs in `attrs["warnings"]`.

    Raises
    ------
    InputError
        The scenario has no sweep, the folder holds another one, or `jobs` or `executor` is not valid.
    OutputError
        A file cannot be written.

    Warns
    -----
    RuntimeWarning
        An executor of `concurrent.futures` failed; this process computes the missing parts.

    Notes
    -----
    A run that fails does not stop the others: it has its reason in the column `error`. Workers of an executor compute one part
    at a time and return it to this process, which writes it. Ray and Dask compute a part whose worker died on another worker.

    Examples
    --------
    >>> import mckibben
    >>> scenario = mckibben.Scenario.from_dict({
    ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
    ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
    ...     "run": {"duration": "20 ms"},
    ... })
    >>> runs = mckibben.sweep(scenario, vary={"load.mass": [2.0, 3.0]}, reductions=["length.final"])
    >>> list(runs["load_mass_kg"]), runs.attrs["units"]["length_final_m"]
    ([2.0, 3.0], 'm')
    """
    check_scenario(scenario)
    check_progress(progress)
    if jobs is not None and not (is_number(jobs) and isinstance(jobs, numbers.Integral) and jobs >= 1):
        raise InputError(f"`jobs` = {jobs!r} is no number of threads; give a whole number from 1 to 4096, or leave it out")
    if not (executor is None or isinstance(executor, str) or callable(getattr(executor, "submit", None))):
        raise InputError(
            f'`executor` is of type {type(executor).__name__}; give "ray", or one with the interface of concurrent.futures, such as '
            "concurrent.futures.ProcessPoolExecutor()"
        )
    if not (vary is None or isinstance(vary, collections.abc.Mapping)):
        raise InputError(f'`vary` is of type {type(vary).__name__}; give a dictionary of keys, such as {{"load.mass": [2.0, 3.0]}}')
    given = {
        "sweep.vary": None if vary is None else dict(vary),
        "sweep.reductions": None if reductions is None else listed("reductions", reductions),
    }
    given = {key: value for key, value in given.items() if value is not None}
    if given:
        scenario = scenario.with_values(given)
    if folder is None:
        with tempfile.TemporaryDirectory(prefix="mckibben-sweep-") as kept:
            runs = pathlib.Path(kept) / "runs"
            return sweep(scenario, runs, executor=executor, jobs=jobs, progress=progress).to_pandas()
    todo = Sweep(scenario)
    folder = pathlib.Path(folder)
    missing, _ = todo.missing(folder)
    done = todo.parts - len(missing)

    def put(part: int, data: bytes) -> None:
        nonlocal done
        todo.put(folder, part, data)
        done += 1
        if progress is not None:
            progress(done, todo.parts)

    if executor is None:
        todo.run(folder, jobs, progress)
    elif jobs is not None:
        raise InputError("`jobs` are threads of this process; an executor has its own workers: leave `jobs` out")
    elif executor == "ray":
        _on_ray(todo, missing, put)
    elif isinstance(executor, str):
        raise InputError(f'there is no executor "{executor}"; give "ray", or one with the interface of concurrent.futures')
    else:
        _on_executor(executor, todo, missing, put)
    missing, failed = todo.missing(folder)
    assert not missing, missing
    found = tuple(SweepWarning(*warning) for warning in todo.warnings(folder))
    return SweepResult(folder, todo.rows, failed, todo.units, tuple(todo.logarithmic), tuple(todo.left_out), found)


Put = collections.abc.Callable[[int, bytes], None]


def _part(todo: Sweep, part: int) -> bytes:
    """Compute a part: the task of a worker."""
    return todo.part(part)


def _on_executor(executor: concurrent.futures.Executor, todo: Sweep, missing: list[int], put: Put) -> None:
    waiting = collections.deque(missing)
    under_way: dict[concurrent.futures.Future[bytes], int] = {}
    lost: list[int] = []
    reason: Exception | None = None
    broken = False
    while waiting or under_way:
        try:
            while waiting and len(under_way) < _AHEAD and not broken:
                under_way[executor.submit(_part, todo, waiting[0])] = waiting[0]
                waiting.popleft()
        except concurrent.futures.BrokenExecutor as error:
            reason, broken = error, True
        if broken:
            lost.extend(waiting)
            waiting.clear()
        for future in concurrent.futures.wait(under_way, return_when=concurrent.futures.FIRST_COMPLETED).done:
            part = under_way.pop(future)
            try:
                data = future.result()
            except Exception as error:
                # Whether the executor or the part is at fault appears when this process computes the part.
                reason, broken = error, broken or isinstance(error, concurrent.futures.BrokenExecutor)
                lost.append(part)
            else:
                put(part, data)
    if lost:
        message = f"the executor failed ({reason}); this process computes the {len(lost)} parts that are missing"
        warnings.warn(message, RuntimeWarning, stacklevel=3)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for part, data in zip(lost, pool.map(todo.part, lost)):
                put(part, data)


def _on_ray(todo: Sweep, missing: list[int], put: Put) -> None:
    import ray

    if not ray.is_initialized():
        ray.init()
    # What kills a worker is the machine's fault or the scheduler's: a part is tried until it is there.
    compute = ray.remote(max_retries=-1, num_cpus=1)(_part)
    everywhere = ray.put(todo)
    ahead = max(4, 4 * int(ray.cluster_resources().get("CPU", 1)))
    waiting = collections.deque(missing)
    under_way: dict[typing.Any, int] = {}
    while waiting or under_way:
        while waiting and len(under_way) < ahead:
            part = waiting.popleft()
            under_way[compute.remote(everywhere, part)] = part
        [reference], _ = ray.wait(list(under_way), num_returns=1)
        put(under_way.pop(reference), ray.get(reference))
