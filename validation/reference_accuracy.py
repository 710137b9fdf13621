"""How far two runs of the reference differ: two tolerances, or two methods.

python reference_accuracy.py [FILE.toml ...] [--rtol 1e-12] [--other-rtol 1e-13]
                             [--method DOP853] [--other-method DOP853]

Prints, per scenario, the two columns that differ most relative to their range (to their size where they are
constant), whether the valve columns and the sequences of events agree, and the processor time of the first run.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from reference_model.integration import METHODS, Integration
from reference_model.scenario import load_scenario


def numbers(run):
    """(names, values) of the columns that hold numbers, without the time."""
    columns = [i for i, name in enumerate(run.header) if i and not name.endswith("valve")]
    return [run.header[i] for i in columns], np.array([[row[i] for i in columns] for row in run.rows])


def valves(run):
    columns = [i for i, name in enumerate(run.header) if name.endswith("valve")]
    return [[row[i] for i in columns] for row in run.rows]


def differences(one, other):
    """[(largest difference relative to the column's range, column)], the worst first."""
    names, a = numbers(one)
    _, b = numbers(other)
    span = np.ptp(b, axis=0)
    scale = np.where(span > 1e-9 * np.abs(b).max(axis=0), span, np.abs(b).max(axis=0))
    worst = np.abs(a - b).max(axis=0) / np.where(scale > 0, scale, 1.0)
    return sorted(zip(worst.tolist(), names, strict=True), reverse=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenarios", metavar="FILE.toml", nargs="*", type=Path)
    parser.add_argument("--rtol", type=float, default=1e-12)
    parser.add_argument("--other-rtol", type=float, default=1e-13)
    parser.add_argument("--method", choices=sorted(METHODS), default="DOP853")
    parser.add_argument("--other-method", choices=sorted(METHODS), default="DOP853")
    options = parser.parse_args()
    files = options.scenarios or sorted((Path(__file__).parent / "reference").glob("*.toml"))

    print(f"{'scenario':26}{'worst':>9} {'column':26}{'next':>9} {'column':26} valve events      s")
    for file in files:
        begin = time.process_time()
        one = Integration(load_scenario(file), options.rtol, options.method).simulate()
        elapsed = time.process_time() - begin
        other = Integration(load_scenario(file), options.other_rtol, options.other_method).simulate()
        valve = valves(one) == valves(other)
        names = [[name for _, name in run.events] for run in (one, other)]
        same = "same" if names[0] == names[1] else f"{len(names[0])}/{len(names[1])}"
        cells = "".join(f"{d:9.1e} {name:26}" for d, name in differences(one, other)[:2])
        print(f"{file.stem:26}{cells} {'same' if valve else 'DIFF'}  {same:>8} {elapsed:5.1f}", flush=True)


if __name__ == "__main__":
    main()
