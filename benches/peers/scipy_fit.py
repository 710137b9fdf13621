"""The fit in SciPy: `least_squares` around the simulation of `scipy_peer.py`, which is `solve_ivp` with events.

    python scipy_fit.py METHOD TOLERANCE PROCESSES < task

The task is JSON: the problems' texts, every how many samples were measured, the measurements as [length, pressure] with their scales, and
for the six unknowns start and bounds. Prints `seconds evaluations cost`, then the values. Seconds hold the fit only, not the start of
Python. Derivatives are differences, as `least_squares` takes them; the runs of an evaluation go side by side in processes.
"""

import io
import json
import sys
from math import pi
from multiprocessing import Pool
from time import perf_counter

import numpy as np
import scipy_peer
from scipy.optimize import least_squares

NAMES = ["viscous", "coulomb_width", "area", "external_volume", "mass", "thread_length"]


def volume(k):
    return k.length * (k.thread_length**2 - k.length**2) / (4 * pi * k.turns**2) + k.external_volume


def with_values(text, values):
    """The problem with other values; the air at the start has the same pressure and temperature in another volume."""
    k = scipy_peer.read(io.StringIO(text))
    before, gravity = volume(k), k.pull / k.mass
    for name, value in zip(NAMES, values):
        setattr(k, name, value)
    k.air_mass *= volume(k) / before
    k.pull = k.mass * gravity
    lines = "".join(f"{name} {getattr(k, name)!r}\n" for name in (line.split()[0] for line in text.splitlines()[: count(text)]))
    return scipy_peer.read(io.StringIO(lines + "\n".join(text.splitlines()[count(text) :])))


def count(text):
    return next(n for n, line in enumerate(text.splitlines()) if line.startswith("edges")) + 1


def residuals_of(task):
    text, values, measured, every, scales, method, tolerance = task
    rows, *_ = scipy_peer.simulate(with_values(text, values), method, tolerance)
    simulated = np.array(rows)[every::every]
    return ((simulated - np.array(measured)) / np.array(scales)).ravel()


def main():
    method, tolerance, processes = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
    task = json.load(sys.stdin)
    sizes = np.abs(np.array(task["start"]))
    evaluations = 0
    with Pool(processes) as pool:

        def residuals(x):
            nonlocal evaluations
            evaluations += 1
            runs = zip(task["problems"], task["measured"])
            jobs = [(text, (x * sizes).tolist(), rows, task["every"], task["scales"], method, tolerance) for text, rows in runs]
            return np.concatenate(pool.map(residuals_of, jobs, chunksize=1))

        residuals(np.ones(len(sizes)))  # starts the processes
        evaluations = 0
        before = perf_counter()
        bounds = tuple(np.array(task[name]) / sizes for name in ("least", "largest"))
        # Differences must be wider than the error of a run.
        fit = least_squares(residuals, np.ones(len(sizes)), bounds=bounds, diff_step=1e-5, ftol=1e-10, xtol=1e-10, gtol=1e-12)
        seconds = perf_counter() - before
    print(f"{seconds:.9g} {evaluations} {float(fit.cost)!r}")
    for value in fit.x * sizes:
        print(repr(float(value)))


if __name__ == "__main__":
    main()
