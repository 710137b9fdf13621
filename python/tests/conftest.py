"""What the tests share: the program to compare with, the examples, and a scenario that takes no time."""

from __future__ import annotations

import os
import pathlib
import subprocess

import numpy
import pytest

import mckibben

ROOT = pathlib.Path(__file__).parents[2]

#: A muscle that swings under a weight and then sticks.
SWING = """\
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "60 psi"
length = "85 mm"
[run]
duration = "0.1 s"
"""


@pytest.fixture(scope="session")
def examples() -> pathlib.Path:
    return ROOT / "examples"


@pytest.fixture(scope="session")
def program():
    """Runs the command line in a folder; nothing is compared with anything else."""
    path = pathlib.Path(os.environ.get("MCKIBBEN_PROGRAM", ROOT / "target/debug/mckibben")).resolve()
    assert path.exists(), f"{path} is not there: build the program, or name it by MCKIBBEN_PROGRAM"

    def run(folder: pathlib.Path, *arguments: str, code: int = 0) -> subprocess.CompletedProcess[str]:
        done = subprocess.run([path, *arguments], cwd=folder, capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        return done

    return run


@pytest.fixture(scope="session")
def swing() -> mckibben.Scenario:
    return mckibben.Scenario(SWING, "swing.toml")


def same(one: mckibben.Trajectory, other: mckibben.Trajectory) -> None:
    """Fails unless both runs are the same."""
    assert one.columns == other.columns and one.units == other.units and one.events == other.events
    for name in one.columns:
        numpy.testing.assert_array_equal(one[name], other[name])
