"""As a guest in a Python program: threads, and the stubs. What memory takes is tested in `test_memory.py`, Ctrl-C in `test_threads.py`."""

from __future__ import annotations

import concurrent.futures
import pathlib
import subprocess
import sys

import mckibben
from conftest import ROOT, same

PACKAGE = pathlib.Path(mckibben.__file__).parent


def test_runs_on_threads_are_those_of_one(swing):
    scenarios = [swing.with_values({"load.mass": f"{mass} lb"}) for mass in range(4, 12)]
    alone = [mckibben.simulate(scenario) for scenario in scenarios]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for run, other in zip(alone, pool.map(mckibben.simulate, scenarios)):
            same(run, other)


def test_types_are_checked_by_mypy():
    command = [sys.executable, "-m", "mypy", "--strict", str(PACKAGE)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_doctest_of_the_package_holds():
    import doctest

    outcome = doctest.testmod(mckibben)
    assert outcome.attempted >= 4 and outcome.failed == 0
