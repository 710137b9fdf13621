"""As a guest in a Python program: threads, memory, and the stubs."""

from __future__ import annotations

import concurrent.futures
import gc
import pathlib
import resource
import subprocess
import sys

import pytest

import mckibben
from conftest import ROOT, same

PACKAGE = pathlib.Path(mckibben.__file__).parent


def test_runs_on_threads_are_those_of_one(swing):
    scenarios = [swing.with_values({"load.mass": f"{mass} lb"}) for mass in range(4, 12)]
    alone = [mckibben.simulate(scenario) for scenario in scenarios]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for run, other in zip(alone, pool.map(mckibben.simulate, scenarios)):
            same(run, other)


def test_other_threads_go_on_during_a_run(swing):
    """A thread that only counts gets on while another simulates."""
    long = swing.with_values({"run.duration": "5 s", "run.engine": "fixed-step", "run.step": "20 us"})
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        run, counted = pool.submit(mckibben.simulate, long), 0
        while not run.done():
            counted += 1
        assert run.result().t[-1] == 5.0
    assert counted > 100


def test_the_largest_amount_of_memory_does_not_grow(swing):
    def peak() -> int:
        gc.collect()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    def work(count: int) -> None:
        for _ in range(count):
            run = mckibben.simulate(swing.with_values({"run.sample_interval": "2 us"}))
            run.at(0.01), run.events, run.to_dict(), run.at_times(run.t[:100])
            with pytest.raises(mckibben.InputError):
                run.at(-1.0)

    work(5)
    before = peak()
    work(20)
    # One run's columns are 4 MB.
    assert peak() - before < 20_000, "kB"


def test_types_are_checked_by_mypy():
    command = [sys.executable, "-m", "mypy", "--strict", str(PACKAGE)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_doctest_of_the_package_holds():
    import doctest

    outcome = doctest.testmod(mckibben)
    assert outcome.attempted >= 4 and outcome.failed == 0
