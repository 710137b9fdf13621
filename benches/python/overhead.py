"""What a call from Python costs in addition to the work that it starts, and how far many actuators are from the Rust loop.

    python overhead.py [--modular PROGRAM]      # else ../target/release/modular, which is built if it is not there

The work is that of `../src/modular.rs`, which steps the same actuators of the same file under the same duty cycles
along the same lengths. Both take turns, and of each the shortest time counts. Aims: a microsecond a call, and a tenth.
"""

from __future__ import annotations

import argparse
import json
import os
import pathlib
import subprocess
import time

import numpy as np

import mckibben

BENCHES = pathlib.Path(__file__).resolve().parents[1]
FILE = BENCHES.parent / "examples" / "paper" / "fig-12.toml"
STEP = 1e-3  # s
ROUNDS = 5


def rows_of(count: int) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """The duty cycle, the two lengths and the two velocities of each row: `Row` in `../src/modular.rs`."""
    place = np.arange(count)
    duty = 0.2 + 0.6 * (place % 97) / 96.0
    short = 0.075 + 0.015 * (place % 61) / 60.0
    lengths = [short, short + 2e-5]
    velocities = [(lengths[0] - lengths[1]) / STEP, (lengths[1] - lengths[0]) / STEP]
    return duty, lengths, velocities


def in_rust(program: pathlib.Path, count: int, steps: int) -> dict[str, float]:
    """ns for a row's step in Rust."""
    done = subprocess.run([program, FILE, str(count), str(steps)], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def together(scenario: mckibben.Scenario, count: int, steps: int) -> float:
    """ns for a row's step of `Actuators`."""
    duty, lengths, velocities = rows_of(count)
    tension = np.zeros(count)
    muscles = mckibben.Actuators(scenario, count)
    began = time.perf_counter()
    for step in range(steps):
        muscles.step(lengths[step % 2], velocities[step % 2], duty, STEP, tension)
    return 1e9 * (time.perf_counter() - began) / (count * steps)


def alone(scenario: mckibben.Scenario, steps: int) -> float:
    """ns for a step of `Actuator`."""
    duty, lengths, velocities = (np.ravel(values).tolist() for values in rows_of(1))
    [duty] = duty
    muscle = mckibben.Actuator(scenario)
    state = muscle.start()
    began = time.perf_counter()
    for step in range(steps):
        state, _, _ = muscle.step(state, lengths[step % 2], velocities[step % 2], duty, STEP)
    return 1e9 * (time.perf_counter() - began) / steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--modular", type=pathlib.Path, default=BENCHES / "target" / "release" / "modular")
    options = parser.parse_args()
    if not options.modular.exists():
        subprocess.run(["cargo", "build", "--release", "--bin", "modular"], cwd=BENCHES, check=True)
    scenario = mckibben.Scenario.from_file(FILE)
    cores = os.environ.get("RAYON_NUM_THREADS") or len(os.sched_getaffinity(0))
    print(f"{FILE.name}, steps of {1e3 * STEP:g} ms, {cores} threads, load {os.getloadavg()[0]:.1f}; ns for a step\n")

    steps = 20_000
    step, many, plain, kept = (float("inf"),) * 4
    for _ in range(ROUNDS):
        step, many = min(step, alone(scenario, steps)), min(many, together(scenario, 1, steps))
        rust = in_rust(options.modular, 1, steps)
        plain, kept = min(plain, rust["ns"]), min(kept, rust["ns_with_snapshots"])
    print(f"{'one row':38s}{'Python':>9s}{'Rust':>9s}{'a call':>9s}")
    print(f"{'Actuator.step, state kept by the caller':38s}{step:9.0f}{kept:9.0f}{step - kept:9.0f}")
    print(f"{'Actuators(1).step':38s}{many:9.0f}{plain:9.0f}{many - plain:9.0f}\n")

    print(f"{'rows':38s}{'Python':>9s}{'Rust':>9s}{'ratio':>9s}{'each alone':>12s}")
    for count in (64, 1024, 4096, 65536):
        steps = max(20, 2_000_000 // count // 4)
        ours, rust, alone_in_rust = (float("inf"),) * 3
        for _ in range(ROUNDS):
            ours = min(ours, together(scenario, count, steps))
            of_rust = in_rust(options.modular, count, steps)
            rust, alone_in_rust = min(rust, of_rust["ns_in_lanes"]), min(alone_in_rust, of_rust["ns"])
        numbers = f"{ours:9.1f}{rust:9.1f}{ours / rust:9.3f}{alone_in_rust:12.1f}"
        print(f"{f'Actuators({count}).step':38s}{numbers}")


if __name__ == "__main__":
    main()
