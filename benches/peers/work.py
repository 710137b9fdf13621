"""The work as the Python peers read it, the constants that follow from it, and how they answer.

    PEER THREADS REPEATS CHECKED < work
"""

import json
import math
import os
import sys
import time
from types import SimpleNamespace

import numpy as np

TERMS = 13  # g to 1e-12


def arguments():
    """Threads, repeats and rows to print; one thread is kept to one core, whatever the libraries start."""
    threads, repeats, checked = map(int, sys.argv[1:])
    if threads == 1:
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    return threads, repeats, checked


def read():
    """Shared numbers, parts of the steps (time, step, filling), and rows (mass, supply, then the four states)."""
    words = sys.stdin.read().split()
    numbers = {}
    while words[2 * len(numbers)] != "parts":
        place = 2 * len(numbers)
        numbers[words[place]] = float(words[place + 1])
    place = 2 * len(numbers) + 1
    count = int(words[place])
    parts = np.array(words[place + 1 : place + 1 + 3 * count], dtype=float).reshape(-1, 3)
    rows = np.array(words[place + 3 + 3 * count :], dtype=float).reshape(-1, 6)
    return constants(numbers), parts, rows


def constants(number):
    """The shared numbers, and the flow law ψ = √(1−r) g(r) with g a polynomial in t = scale·r + offset."""
    m = SimpleNamespace(**number)
    m.per_turns = 1 / (4 * math.pi * m.turns**2)
    m.square_thread = m.thread_length**2
    gamma = m.gamma
    base = 2 / (gamma + 1)
    choked = base ** ((gamma + 1) / (gamma - 1))
    m.critical_ratio = base ** (gamma / (gamma - 1))
    m.conductance = m.area * math.sqrt(gamma / m.gas_constant * choked)

    def psi(r):
        powers = r ** (2 / gamma) * -np.expm1((gamma - 1) / gamma * np.log(r))
        return np.sqrt(2 / ((gamma - 1) * choked) * powers)

    m.laminar_slope = float(psi(m.laminar_ratio)) / (1 - m.laminar_ratio)
    middle, half = (m.laminar_ratio + m.critical_ratio) / 2, (m.laminar_ratio - m.critical_ratio) / 2
    m.scale, m.offset = 1 / half, -middle / half
    chebyshev = np.polynomial.chebyshev
    fit = chebyshev.chebinterpolate(lambda t: psi(middle + half * t) / np.sqrt(1 - middle - half * t), TERMS - 1)
    m.g = tuple(float(c) for c in chebyshev.cheb2poly(fit))
    return m


def answer(run, repeats, checked):
    """Runs once to compile, then takes the shortest time; `run` gives the last states, one row each."""
    run()
    best = math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        states = run()
        best = min(best, time.perf_counter() - start)
    print(json.dumps({"seconds": best, "states": np.asarray(states)[:checked].tolist()}))
