"""Plants that are compared state by state: their numbers stand here and, again, in `crates/mckibben/tests/plant_reference.rs`.

python plants.py FOLDER [NAME ...] [--rtol 1e-12] [--events]

Writes FOLDER/NAME.csv for each plant, or the named ones: the time, coordinates and rates of the mechanism, then pressure and
air mass of each actuator, and the pressure of the reservoir where there is one.
"""

import argparse
import csv
import functools
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from reference_model.actuator import Dry, Muscle
from reference_model.integration import Integration
from reference_model.lines import Hose, Reservoir
from reference_model.mechanism import Chain, Joint, Masses, Pulley
from reference_model.physics import Air, Braid, Effectiveness, Iso6358Flow, Limit, NozzleFlow
from reference_model.plant import Actuator, Plant, Supply
from reference_model.valves import SeatValve

INCH, PSI, ROOM, GRAVITY, POUND = 0.0254, 4.4482216152605 / 0.0254**2, 293.15, 9.80665, 0.45359237
AIR = Air("isentropic", 1.4, 286.99, 1.4, 101325.0, 0.0, ROOM)
PAPER_FLOW = NozzleFlow(0.85 * 1.8e-5 * 0.3048**2, 1.4, 286.99, 0.999)
REST = 3.3 * INCH


def muscle(thread=4.3218 * INCH, turns=2.5, longest=3.85 * INCH, viscous=0.02 * 4.4482216152605 / INCH, width=0.0044 * INCH):
    """The paper's muscle, unless said otherwise."""
    braid = Braid(thread, turns, longest, thread / 3**0.5, 3e-6)
    return Muscle(braid, Effectiveness.constant(1.0), viscous, Dry(width), None, Limit(1.75e5, 100.0))


def supply(psi):
    return Supply(101325.0 + psi * PSI, ROOM)


def actuator(its, source, psi, kind="fill-hold-exhaust", flow=PAPER_FLOW, hose=None, **more):
    valve = SeatValve(kind, 4e-3, 1e-3, 0.0, 0.0, hose.delay if hose else 0.0)
    pressure = 101325.0 + psi * PSI
    return Actuator(its, AIR, source, pressure, ROOM, valve, flow, flow, hose=hose, **more)


def hose(length, diameter, index, cells):
    return Hose(length, diameter, 1.82e-5, index, cells, 286.99, 1.4, ROOM)


def pwm(frequency, duty, duration):
    steps = []
    for k in range(int(duration * frequency) + 1):
        steps += [(k / frequency, "fill"), ((k + duty) / frequency, "exhaust")]
    return steps


def limb():
    pulleys = [Pulley(0.015), Pulley(0.015)]
    return Joint(pulleys, [REST, REST], 0.5, GRAVITY, 0.1, 1e-3, 0.0, 0.0, 0.02, (None, None, 500.0, 1.0))


COMMANDS = [
    [(0.0, "fill"), (0.05, "hold"), (0.15, "exhaust"), (0.18, "hold")],
    [(0.0, "hold"), (0.15, "fill"), (0.19, "hold")],
]


class Experiment:
    """What `Integration` asks for."""

    controller = None
    knots = ()

    def __init__(self, build, steps, duration, interval=1e-3):
        self.build, self.steps, self.duration, self.sample_interval = build, steps, duration, interval

    def plant(self, rtol):
        actuators, mechanism, start = self.build()
        self.header = ["time_s"]
        for k in range(mechanism.coordinates):
            self.header += [f"position_{k}", f"rate_{k}"]
        for k in range(len(actuators)):
            self.header += [f"pressure_{k}", f"air_mass_{k}"]
        if actuators[0].supply.reservoir:
            self.header.append("reservoir")
        return Plant(actuators, mechanism, start, rtol)

    def commands(self):
        return [list(steps) for steps in self.steps]

    def row(self, time, plant, seen, state, mode):
        n = plant.n
        row = [time]
        for k in range(n):
            row += [float(state[k]), float(state[n + k])]
        for item in seen:
            row += [item["pressure"], item["mass"]]
        source = plant.actuators[0].supply
        return row + ([float(source.outlet(state))] if source.reservoir else [])


def joint_with_hoses():
    """A joint; a lumped hose leads to one muscle, a distributed one to the other."""
    first = actuator(muscle(), supply(60), 20, hose=hose(1.0, 2.5e-3, 1.0, 0))
    second = actuator(muscle(), supply(60), 20, hose=hose(1.5, 3e-3, 1.2, 2))
    return [first, second], limb(), ((0.0,), (0.0,))


def unlike_on_a_bottle():
    """Three unlike muscles with unlike loads and valves on one bottle of 80 mL."""
    start = 101325.0 + 90 * PSI
    bottle = Supply(start, ROOM, Reservoir(80e-6, 1.2, start, 0.0, 0.0, 0.0, 0.0))
    iso = Iso6358Flow(3e-9, 0.3, 0.999)
    actuators = [
        actuator(muscle(), bottle, 20, "three-way"),
        actuator(muscle(turns=2.2, viscous=5.0, width=5e-5), bottle, 25, "three-way", iso),
        actuator(muscle(0.2, 4.0, 0.18, 8.0, 1e-4), bottle, 30),
    ]
    masses = [5 * POUND, 3.0, 4.0]
    return actuators, Masses(masses, [m * GRAVITY for m in masses]), ((0.09, 0.088, 0.16), (0.0, 0.0, 0.0))


def chain_that_sticks():
    """Two joints: two muscles about the first, one about the second, one over both; strong dry friction."""
    arms = [[-0.015, 0.0], [0.015, 0.0], [0.0, -0.012], [0.010, 0.012]]
    chain = Chain((1.0, 0.6), (0.3, 0.25), (0.15, 0.12), (0.01, 0.004), (0.02, 0.01), GRAVITY, [REST] * 4, arms)
    pressures = (40, 35, 40, 30)
    actuators = [actuator(muscle(viscous=3.0, width=8e-3), supply(80), p) for p in pressures]
    return actuators, chain, ((0.1, -0.2), (0.0, 0.0))


def tendon_on_a_joint():
    """A joint; one of its muscles pulls by an elastic tendon of 12 kN/m and 40 mm."""
    first = actuator(muscle(), supply(60), 20, tendon=(12e3, 0.04), length=0.0825)
    second = actuator(muscle(), supply(60), 20)
    joint = limb()
    joint.rest_lengths = [REST + 0.04, REST]
    return [first, second], joint, ((0.0,), (0.0,))


PLANTS = {
    "joint-with-hoses": Experiment(joint_with_hoses, COMMANDS, 0.25),
    "unlike-on-a-bottle": Experiment(
        unlike_on_a_bottle,
        [pwm(25, 0.5, 0.3), pwm(10, 0.4, 0.3), [(0.0, "hold"), (0.02, "fill"), (0.1, "hold"), (0.2, "exhaust")]],
        0.3,
    ),
    "chain-that-sticks": Experiment(
        chain_that_sticks,
        [
            [(0.0, "hold"), (0.05, "fill"), (0.09, "hold"), (0.35, "exhaust"), (0.37, "hold")],
            [(0.0, "hold"), (0.3, "fill"), (0.33, "hold")],
            [(0.0, "hold"), (0.05, "exhaust"), (0.1, "hold"), (0.4, "fill"), (0.41, "hold")],
            [(0.0, "hold"), (0.45, "fill"), (0.48, "hold")],
        ],
        0.6,
    ),
    "tendon-on-a-joint": Experiment(tendon_on_a_joint, COMMANDS, 0.25),
}


def write(name, options):
    """Integrates a plant and writes its columns."""
    run = Integration(PLANTS[name], options.rtol).simulate()
    with open(options.folder / f"{name}.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(run.header)
        writer.writerows([repr(x) for x in row] for row in run.rows)
    if options.events:
        for instant, label in run.events:
            print(f"{instant:.15g} {label}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="FOLDER", type=Path)
    parser.add_argument("names", metavar="NAME", nargs="*")
    parser.add_argument("--rtol", type=float, default=1e-12)
    parser.add_argument("--events", action="store_true", help="list the events on standard error")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor() as pool:
        list(pool.map(functools.partial(write, options=options), options.names or PLANTS))


if __name__ == "__main__":
    main()
