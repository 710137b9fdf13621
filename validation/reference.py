"""Integrate scenario files with the independent reference and write the columns of their runs.

python reference.py FILE.toml --output run.csv [--rtol 1e-12] [--method DOP853] [--events]
python reference.py FILE.toml ... --folder FOLDER          # FOLDER/FILE.csv of each
"""

import argparse
import csv
import functools
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from reference_model.integration import METHODS, Integration
from reference_model.scenario import load_scenario


def write(scenario, options):
    """Integrates a scenario and writes its columns."""
    run = Integration(load_scenario(scenario), options.rtol, options.method).simulate()
    with open(options.output or options.folder / f"{scenario.stem}.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(run.header)
        writer.writerows([x if isinstance(x, str) else repr(x) for x in row] for row in run.rows)
    if options.events:
        for instant, name in run.events:
            print(f"{instant:.15g} {name}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenarios", metavar="FILE.toml", nargs="+", type=Path)
    target = parser.add_mutually_exclusive_group(required=True)
    target.add_argument("--output", metavar="CSV", type=Path, help="of a single scenario")
    target.add_argument("--folder", metavar="FOLDER", type=Path)
    parser.add_argument("--rtol", type=float, default=1e-12)
    parser.add_argument("--method", choices=sorted(METHODS), default="DOP853")
    parser.add_argument("--events", action="store_true", help="list the events on standard error")
    options = parser.parse_args()
    if options.output and len(options.scenarios) > 1:
        parser.error("--output takes one scenario: use --folder for several")
    with ProcessPoolExecutor() as pool:
        list(pool.map(functools.partial(write, options=options), options.scenarios))


if __name__ == "__main__":
    main()
