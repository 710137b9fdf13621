"""Run functional mock-up units in fmi-sim, and compare their lengths with those of the program's own runs.

    python fmi_sim.py PROGRAM FMI_SIM

fmi-sim 0.7 takes no FMI 3.0 description in which a variable has a unit, or a unit has kelvins: `unit` and `K` are attributes
that the standard has and its reader has not. They are taken out of the descriptions here, which changes nothing of the run.

Co-simulation must be the fixed-step engine to rounding. fmi-sim integrates model exchange by Euler's method: its error must fall with
the step.
"""

from __future__ import annotations

import csv
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

import numpy

SCENARIO = """\
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.8
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
length = "90 mm"
gauge_pressure = "40 psi"
[run]
duration = "0.5 s"
relative_tolerance = 1e-10
"""
FIXED = ["--set", "run.engine=fixed-step", "--set", "run.step=0.5 ms"]
# Steps of model exchange in s, and the largest error of the length in m that the shortest may leave.
STEPS = (1e-3, 1e-4, 1e-5)
LEAST = 3e-4


def columns(path: pathlib.Path, *names: str) -> list[numpy.ndarray]:
    with path.open() as file:
        rows = list(csv.reader(file))
    return [numpy.array([float(row[rows[0].index(name)]) for row in rows[1:]]) for name in names]


def without_units(path: pathlib.Path) -> pathlib.Path:
    """A copy of a unit, without the attributes that fmi-sim does not know."""
    plain = path.with_name("plain-" + path.name)
    with zipfile.ZipFile(path) as unit, zipfile.ZipFile(plain, "w") as copy:
        for entry in unit.infolist():
            data = unit.read(entry)
            if entry.filename == "modelDescription.xml":
                data = re.sub(rb' (K|unit|displayUnit|derivative)="[^"]*"', b"", data)
            copy.writestr(entry, data)
    return plain


def main(program: str, fmi_sim: str) -> None:
    folder = pathlib.Path(tempfile.mkdtemp())
    (folder / "muscle.toml").write_text(SCENARIO)

    def call(*arguments: str) -> None:
        subprocess.run([*arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL)

    def simulated(*options: str) -> list[numpy.ndarray]:
        call(program, "simulate", "muscle.toml", "--quiet", "--output", "run.csv", *options)
        return columns(folder / "run.csv", "time_s", "length_m")

    def unit(version: str) -> pathlib.Path:
        call(program, "fmu", "muscle.toml", "--output", f"unit-{version}.fmu", "--fmi", version, "--motion", "scenario", *FIXED)
        path = folder / f"unit-{version}.fmu"
        return without_units(path) if version == "3" else path

    def imported(path: pathlib.Path, kind: str, *options: str) -> list[numpy.ndarray]:
        call(fmi_sim, "--output-file", "out.csv", "--model", str(path), kind, "-s", "0", "-f", "0.5",
             "--init-values", "actuator.duty=0.8", *options)  # fmt: skip
        return columns(folder / "out.csv", "time", "actuator.length")

    fixed, located = simulated(*FIXED), simulated()
    for version in ("2", "3"):
        path = unit(version)
        time, length = imported(path, "co-simulation", "--output-interval", "1e-3")
        error = numpy.abs(numpy.interp(time, *fixed) - length).max()
        print(f"FMI {version}.0, co-simulation: {error:.1e} m from the fixed-step engine")
        assert len(time) == 501 and error < 1e-9
        errors = []
        for step in STEPS:
            time, length = imported(path, "model-exchange", "--output-interval", f"{step}")
            errors.append(numpy.abs(numpy.interp(time, *located) - length).max())
            print(f"FMI {version}.0, model exchange by Euler's steps of {step} s: {errors[-1]:.1e} m")
        assert errors[0] > 3 * errors[1] > 9 * errors[2] and errors[2] < LEAST


if __name__ == "__main__":
    main(*sys.argv[1:])
