"""How far two runs of the reference differ: two tolerances, or two methods.

python reference_accuracy.py [FILE.toml ...] [--rtol 1e-12] [--other-rtol 1e-13]
                             [--method DOP853] [--other-method DOP853]

Prints, per scenario, the largest difference of each column relative to the column's range (to its
size where it is constant), whether the valve column and the sequence of events agree, and the time.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from reference_model.integration import COLUMNS, METHODS, Integration
from reference_model.scenario import load_scenario

SHORT = ["L", "v", "P", "m", "T", "V", "F", "mdot"]


def differences(one, other):
    """Largest difference per column (without time and valve), relative to its range."""
    a = np.array([row[1:-1] for row in one.rows])
    b = np.array([row[1:-1] for row in other.rows])
    span = np.ptp(b, axis=0)
    scale = np.where(span > 1e-9 * np.abs(b).max(axis=0), span, np.abs(b).max(axis=0))
    return np.abs(a - b).max(axis=0) / np.where(scale > 0, scale, 1.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenarios", metavar="FILE.toml", nargs="*", type=Path)
    parser.add_argument("--rtol", type=float, default=1e-12)
    parser.add_argument("--other-rtol", type=float, default=1e-13)
    parser.add_argument("--method", choices=sorted(METHODS), default="DOP853")
    parser.add_argument("--other-method", choices=sorted(METHODS), default="DOP853")
    options = parser.parse_args()
    files = options.scenarios or sorted((Path(__file__).parent / "reference").glob("*.toml"))

    assert len(SHORT) == len(COLUMNS) - 2
    print(f"{'scenario':26}" + "".join(f"{name:>9}" for name in SHORT) + "  valve events    s")
    for file in files:
        scenario = load_scenario(file)
        begin = time.perf_counter()
        one = Integration(scenario, options.rtol, options.method).simulate()
        elapsed = time.perf_counter() - begin
        other = Integration(scenario, options.other_rtol, options.other_method).simulate()
        valve = all(a[-1] == b[-1] for a, b in zip(one.rows, other.rows, strict=True))
        names = [[name for _, name in run.events] for run in (one, other)]
        same = "same" if names[0] == names[1] else f"{len(names[0])}/{len(names[1])}"
        cells = "".join(f"{d:9.1e}" for d in differences(one, other))
        print(f"{file.stem:26}{cells}  {'same' if valve else 'DIFF'}  {same:>8} {elapsed:5.1f}")


if __name__ == "__main__":
    main()
