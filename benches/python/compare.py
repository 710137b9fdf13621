"""Times of equal work at equal error: mckibben in Python, SciPy, Numba and diffrax.

    python compare.py            # everything, some minutes
    python compare.py --quick    # one accuracy, fewer rows: to see that it runs

The work is defined in `work.py`, the solvers in `peers.py`. A peer's setting is the loosest of its list at which
its error is not above ours, and the table stops with a failure where a time would be quoted for a larger one. Errors
are against the independent model of `validation/` at 1e-12. Times are the least of rounds in which all take turns,
compiling left out. The load of the machine stands in the first line: with other work on it the ratios hold better than
the times.
"""

from __future__ import annotations

import argparse
import collections.abc
import concurrent.futures
import dataclasses
import functools
import importlib.metadata
import multiprocessing
import os
import pathlib
import tempfile
import time

# JAX has a device for each core, and learns so when it is imported.
CORES = len(os.sched_getaffinity(0))
os.environ.setdefault("XLA_FLAGS", f"--xla_force_host_platform_device_count={CORES}")
os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax  # noqa: E402
import numpy as np  # noqa: E402
import peers  # noqa: E402
import work  # noqa: E402
from reference_model.integration import Integration  # noqa: E402
from reference_model.scenario import Load, load_scenario  # noqa: E402

import mckibben  # noqa: E402

#: Rows whose answers are compared with the truth.
CHECKED = 8
MASSES = (5 * 0.45359237, 15 * 0.45359237)


def least(runs: dict[str, collections.abc.Callable[[], object]], rounds: int) -> dict[str, float]:
    """The shortest time of each in s, all taking turns; the first, in which things are compiled, does not count."""
    times = dict.fromkeys(runs, float("inf"))
    for run in runs.values():
        run()
    for _ in range(rounds):
        for name, run in runs.items():
            # What is short is repeated, so that a clock can see it.
            began, count = time.perf_counter(), 0
            while count == 0 or time.perf_counter() - began < 0.05:
                once = time.perf_counter()
                run()
                times[name] = min(times[name], time.perf_counter() - once)
                count += 1
    return times


def loosest(peer: peers.Peer, error_of: collections.abc.Callable[[float], float], most: float) -> float | None:
    """The loosest of the peer's settings with an error of at most `most`; none where the tightest has more."""
    last = len(peer.settings) - 1
    # The tighter, the dearer: strides from the loose end, then back.
    strides = [*range(0, last, 4), last]
    reached = next((place for place in strides if error_of(peer.settings[place]) <= most), None)
    if reached is None:
        return None
    while reached > 0 and error_of(peer.settings[reached - 1]) <= most:
        reached -= 1
    return peer.settings[reached]


def table(lines: list[tuple[str, str, float, float]], ours: str) -> None:
    base = next(seconds for name, _, _, seconds in lines if name == ours)
    print(f"{'':54s}{'setting':>10s}{'error':>10s}{'ms':>12s}{'ratio':>9s}")
    for name, setting, error, seconds in lines:
        print(f"{name:54s}{setting:>10s}{error:10.1e}{1e3 * seconds:12.3f}{seconds / base:9.3g}")
    print()


def one_run(of: work.Work, tolerance: float, rounds: int) -> None:
    """A trajectory with its samples."""
    ours = mckibben.Scenario.from_file(work.FILE).with_values({"run.relative_tolerance": tolerance})

    def simulate() -> np.ndarray:
        run = mckibben.simulate(ours)
        return np.array([run.length, run.absolute_pressure])

    classical, adaptive, compiled, _ = peers.numba_peers(of)
    solvers = {
        "SciPy DOP853, events located": peers.scipy_with_events(of, "DOP853"),
        "SciPy DOP853 between the valve's instants": peers.scipy_between_instants(of, "DOP853", peers.plain(of)),
        "SciPy DOP853, right-hand side by Numba": peers.scipy_between_instants(of, "DOP853", compiled),
        "SciPy LSODA, right-hand side by Numba": peers.scipy_between_instants(of, "LSODA", compiled),
        "SciPy Radau, right-hand side by Numba": peers.scipy_between_instants(of, "Radau", compiled),
        "Numba, Runge-Kutta 4 at a fixed step": classical,
        "Numba, Dormand-Prince 5(4)": adaptive,
        "diffrax, Dormand-Prince 5(4), jitted": peers.diffrax_peer(of),
    }
    name = f"mckibben.simulate at {tolerance:.0e}"
    error = of.error(simulate())
    print(f"one run of {of.spans[-1][1]:g} s, {len(of.samples)} samples, our relative tolerance {tolerance:.0e}")
    runs, measured = {name: simulate}, [(name, f"{tolerance:.0e}", error)]
    for other, peer in solvers.items():
        setting = loosest(peer, lambda value, peer=peer: of.error(peer.run(value)), error)
        if setting is None:
            print(
                f"{other}: not as near as ours at {peer.settings[-1]:.1e}: {of.error(peer.run(peer.settings[-1])):.1e}"
            )
            continue
        found = of.error(peer.run(setting))
        assert found <= error, (other, found)
        runs[other] = lambda peer=peer, setting=setting: peer.run(setting)
        measured.append((other, f"{setting:.1e}", found))
    times = least(runs, rounds)
    table([(who, setting, error, times[who]) for who, setting, error in measured], name)


def truth_of(mass: float) -> np.ndarray:
    """Length and pressure at the end, of the row with that mass, by the independent model."""
    scenario = load_scenario(work.FILE)
    gravity = scenario.load.pull / scenario.load.mass
    scenario = dataclasses.replace(scenario, load=Load(mass * gravity, mass), sample_interval=scenario.duration)
    integration = Integration(scenario, work.EXACT)
    row = integration.simulate().rows[-1]
    return np.array([row[1], row[3]])


def start_of(mass: float) -> np.ndarray:
    scenario = load_scenario(work.FILE)
    gravity = scenario.load.pull / scenario.load.mass
    scenario = dataclasses.replace(scenario, load=Load(mass * gravity, mass))
    _, start = Integration(scenario).model.start((False, True))
    return np.array(start, dtype=float)


def many_runs(of: work.Work, rows: int, tolerance: float, rounds: int) -> None:
    """Rows of one scenario over the mass, their lengths and pressures at the end.

    A setting is looked for on the rows whose truth is known; they are among all, and each row is for itself.
    """
    masses = np.linspace(*MASSES, rows)
    starts = np.array([start_of(mass) for mass in masses])
    checked = np.linspace(0, rows - 1, CHECKED).round().astype(int)
    with concurrent.futures.ProcessPoolExecutor(CORES, multiprocessing.get_context("spawn")) as pool:
        truth = np.array(list(pool.map(truth_of, masses[checked])))
    ranges = np.ptp(of.truth, axis=1)
    scenario = mckibben.Scenario.from_file(work.FILE).with_values({"sweep.reductions": ["length.final", "absolute_pressure.final"]})

    def error_of(ends: np.ndarray) -> float:
        return float(np.max(np.abs(ends - truth) / ranges))

    def swept(chosen: np.ndarray, **run: object) -> np.ndarray:
        """By the package, Parquet files and all."""
        vary = {"load.mass": [f"{mass!r} kg" for mass in masses[chosen].tolist()]}
        values = {f"run.{key}": value for key, value in run.items()} | {"sweep.vary": vary}
        values["sweep.part_rows"] = max(len(chosen) // (8 * CORES), 1)
        with tempfile.TemporaryDirectory() as folder:
            frame = mckibben.sweep(scenario.with_values(values), pathlib.Path(folder)).to_polars()
        return frame.select("length_final_m", "absolute_pressure_final_pa").to_numpy()

    *_, of_many = peers.numba_peers(of)
    solve = jax.jit(jax.vmap(peers.diffrax_solver(of, np.array([of.spans[-1][1]])), in_axes=(0, 0, None)))

    def vmapped(chosen: np.ndarray, rtol: float) -> np.ndarray:
        """Each core steps separate rows: in one loop over all it would wait for the other at every step."""
        shares = zip(jax.devices(), np.array_split(chosen, CORES), strict=True)
        begun = [solve(*jax.device_put((masses[share], starts[share], rtol), core)) for core, share in shares]
        return np.concatenate(begun)[:, 0][:, [0, 2]]

    name = f"mckibben.sweep, events located, {tolerance:.0e}"
    solvers = {
        name: (lambda chosen, rtol: swept(chosen, relative_tolerance=rtol), [tolerance]),
        "mckibben.sweep, fixed steps, RK4": (
            lambda chosen, step: swept(chosen, engine="fixed-step", method="rk4", step=f"{step!r} s"),
            [2e-4 / 2**half for half in range(8)],
        ),
        "Numba, Dormand-Prince 5(4), prange": (
            lambda chosen, rtol: of_many(starts[chosen], masses[chosen], rtol)[:, [0, 2]],
            peers.TOLERANCES,
        ),
        "diffrax, Dormand-Prince 5(4), jitted, vmapped": (vmapped, peers.TOLERANCES),
    }
    runs, measured, most = {}, [], float("inf")
    for who, (run, settings) in solvers.items():
        peer = peers.Peer(who, functools.partial(run, checked), settings)
        setting = loosest(peer, lambda value, peer=peer: error_of(peer.run(value)), most)
        if setting is None:
            print(f"{who}: not as near as ours at {settings[-1]:.1e}: {error_of(peer.run(settings[-1])):.1e}")
            continue
        runs[who] = functools.partial(run, np.arange(rows), setting)
        # Of all rows, as they are timed.
        found = error_of(runs[who]()[checked])
        assert found <= most, (who, found)
        most = found if who == name else most
        measured.append((who, f"{setting:.1e}", found))
    print(
        f"{rows} runs of {of.spans[-1][1]:g} s over the mass, {MASSES[0]:.2f} to {MASSES[1]:.2f} kg, on {CORES} cores"
    )
    times = least(runs, rounds)
    table([(who, setting, error, times[who]) for who, setting, error in measured], name)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one accuracy and few rows")
    parser.add_argument("--rows", type=int, default=1000)
    options = parser.parse_args()
    versions = ", ".join(f"{of} {importlib.metadata.version(of)}" for of in ("scipy", "numba", "jax", "diffrax"))
    print(f"{versions}; {CORES} cores, load {os.getloadavg()[0]:.1f}\n")
    of = work.load()
    for tolerance in (1e-6,) if options.quick else (1e-4, 1e-8):
        one_run(of, tolerance, rounds=3 if options.quick else 7)
    many_runs(of, 64 if options.quick else options.rows, 1e-6, rounds=2 if options.quick else 3)


if __name__ == "__main__":
    main()
