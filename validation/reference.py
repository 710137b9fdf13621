"""Integrate a scenario file with the independent reference and write the columns of a run.

python reference.py FILE.toml --output run.csv [--rtol 1e-12] [--method DOP853] [--events]
"""

import argparse
import csv
import sys

from reference_model.integration import METHODS, Integration
from reference_model.scenario import load_scenario


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenario", metavar="FILE.toml")
    parser.add_argument("--output", metavar="CSV", required=True)
    parser.add_argument("--rtol", type=float, default=1e-12)
    parser.add_argument("--method", choices=sorted(METHODS), default="DOP853")
    parser.add_argument("--events", action="store_true", help="list the events on standard error")
    options = parser.parse_args()

    run = Integration(load_scenario(options.scenario), options.rtol, options.method).simulate()
    with open(options.output, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(run.header)
        writer.writerows([x if isinstance(x, str) else repr(x) for x in row] for row in run.rows)
    if options.events:
        for instant, name in run.events:
            print(f"{instant:.15g} {name}", file=sys.stderr)


if __name__ == "__main__":
    main()
