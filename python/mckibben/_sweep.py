"""Sweeps on this machine's cores, on any executor, on Ray: the same files whoever computes them."""

from __future__ import annotations

import collections
import collections.abc
import concurrent.futures
import dataclasses
import os
import pathlib
import tempfile
import typing
import warnings

from mckibben._mckibben import Scenario, Sweep
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import pandas
    import polars

#: Parts that are computed or wait to be, where nobody says how many workers there are.
_AHEAD = 64

#: Called with the parts that are finished and all there are.
Progress = collections.abc.Callable[[int, int], object]


@dataclasses.dataclass(frozen=True)
class SweepResult:
    """A finished sweep: its folder of Parquet parts, one line for each run."""

    #: The folder, which holds nothing but the parts and `sweep.json`.
    folder: pathlib.Path
    #: How many runs there are.
    rows: int
    #: How many of them failed; each says why in the column `error`.
    failed: int
    #: The units of the columns of numbers by their names, in SI.
    units: dict[str, str]

    @property
    def parts(self) -> list[pathlib.Path]:
        """The files, in the order of their runs."""
        return sorted(self.folder.glob("part-*.parquet"))

    def to_polars(self) -> polars.DataFrame:
        """All runs as a data frame of Polars, in their order."""
        import polars

        return polars.concat([polars.read_parquet(part) for part in self.parts])

    def to_pandas(self) -> pandas.DataFrame:
        """All runs as a data frame of pandas, in their order, with the units in `attrs`. It needs pyarrow."""
        import pandas

        frame = pandas.concat([pandas.read_parquet(part) for part in self.parts], ignore_index=True)
        frame.attrs["units"] = self.units
        return frame


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
    """Does the runs of a scenario's section `[sweep]`, into a folder of Parquet parts: what `mckibben sweep` does.

    Without a `folder` the runs are a data frame of pandas with a row for each, its units in `attrs`; it needs pyarrow. `vary`
    takes the place of the section `[sweep.vary]`: `{"load.mass": ["4 lb", "8 lb"], "command.duty": [0.3, 0.5]}`; `reductions` that
    of the key `sweep.reductions`, such as `["length.final", "air.used"]`.

    Without an `executor` they go on `jobs` threads of this process, one for each core unless given. An executor is anything
    with the interface of `concurrent.futures` (processes, threads, `Client.get_executor()` of Dask), or "ray": the cluster
    that Ray is connected to, or one that it starts. Each of its workers computes a part at a time, and the parts come back
    to this process, which alone writes; the files have the same bytes whoever computes them.

    A part whose worker dies is computed again: by Ray and Dask on another worker; where an executor of `concurrent.futures`
    breaks, by this process, with a `RuntimeWarning`. Parts that are finished in the folder are kept, so a sweep that was
    stopped goes on with what is missing.

    `progress(done, parts)` is called with the parts that are finished and all there are: by an executor after each part, by
    the threads of this process after each few. An exception that it raises ends the sweep between parts.

    Raises `InputError` for a scenario without a sweep and for a folder of another one. Runs that fail do not stop the
    others: they have their reason in the column `error`.
    """
    given = {"sweep.vary": None if vary is None else dict(vary), "sweep.reductions": reductions and list(reductions)}
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
        raise InputError("`jobs` are threads of this process; an executor has workers of its own: leave `jobs` out")
    elif executor == "ray":
        _on_ray(todo, missing, put)
    elif isinstance(executor, str):
        raise InputError(f'there is no executor "{executor}"; give "ray", or one with the interface of concurrent.futures')
    else:
        _on_executor(executor, todo, missing, put)
    missing, failed = todo.missing(folder)
    assert not missing, missing
    return SweepResult(folder, todo.rows, failed, todo.units)


Put = collections.abc.Callable[[int, bytes], None]


def _part(todo: Sweep, part: int) -> bytes:
    """What a worker does."""
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
                # Whether it is the executor's fault or the part's shows when this process computes the part.
                reason, broken = error, broken or isinstance(error, concurrent.futures.BrokenExecutor)
                lost.append(part)
            else:
                put(part, data)
    if lost:
        told = f"the executor failed ({reason}); this process computes the {len(lost)} parts that are missing"
        warnings.warn(told, RuntimeWarning, stacklevel=3)
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
