"""The work of all solvers, the reference solution, and the physics of the peers.

The numbers are read and the truth is computed by the independent model of `validation/`: SciPy, restarted at every
event, at 1e-12. No part of the package has a hand in either.

The peers' right-hand side is one function of plain numbers, textbook form, that SciPy calls as it is and Numba
compiles; `rates_of_arrays` says the same without branches, for JAX. Both take sgn(v), slack and taut of the state at
each evaluation.
"""

from __future__ import annotations

import dataclasses
import math
import pathlib
import sys
import typing

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "validation"))

from reference_model.integration import Integration  # noqa: E402
from reference_model.plant import Actuator  # noqa: E402
from reference_model.scenario import load_scenario  # noqa: E402

#: The paper's hanging mass under pulses: 100 psi, 25 Hz, 5 lb, two seconds, a sample every 2 ms.
FILE = ROOT / "validation" / "reference" / "pwm-25hz-5lb.toml"
#: Tolerance of the truth.
EXACT = 1e-12


class Muscle(typing.NamedTuple):
    """The numbers of `rates`, in SI."""

    square_thread: float
    per_turns: float  # 1/(4 pi n^2)
    min_length: float
    max_length: float
    external_volume: float
    viscous: float
    coulomb_width: float
    stiffness: float
    damping: float
    gamma: float
    gas_constant: float
    atmosphere: float
    supply: float
    per_temperature: float
    throat: float  # A sqrt(2 gamma/(R (gamma - 1)))
    choked: float  # A C_m of choked flow
    critical_ratio: float
    laminar_ratio: float
    laminar_slope: float
    gravity: float


@dataclasses.dataclass(frozen=True)
class Work:
    """One run: numbers, the instants at which the valve changes over, samples, and the truth at them."""

    muscle: Muscle
    mass: float
    start: np.ndarray
    #: (from, until, whether the supply is open) of each span between two motions of the poppet.
    spans: list[tuple[float, float, bool]]
    samples: np.ndarray
    #: Length in m and pressure in Pa at the samples, of shape (2, samples).
    truth: np.ndarray

    def error(self, answer: np.ndarray) -> float:
        """The largest difference of length or pressure from the truth, each over its range."""
        ranges = np.ptp(self.truth, axis=1, keepdims=True)
        return float(np.max(np.abs(answer - self.truth) / ranges))


def muscle_of(actuator: Actuator, gravity: float) -> Muscle:
    braid, air, flow = actuator.muscle.braid, actuator.air, actuator.supply_law
    gamma = air.gamma
    throat = flow.area * math.sqrt(2 * gamma / (air.gas_constant * (gamma - 1)))
    return Muscle(
        square_thread=braid.thread_length**2,
        per_turns=1 / braid.four_pi_n2,
        min_length=braid.min_length,
        max_length=braid.max_length,
        external_volume=braid.external_volume,
        viscous=actuator.muscle.viscous,
        coulomb_width=actuator.muscle.dry.width,
        stiffness=actuator.muscle.limit.stiffness,
        damping=actuator.muscle.limit.damping,
        gamma=gamma,
        gas_constant=air.gas_constant,
        atmosphere=air.atmosphere,
        supply=actuator.supply.pressure,
        per_temperature=1 / actuator.supply.temperature,
        throat=throat,
        choked=flow.throat(flow.critical_ratio),
        critical_ratio=flow.critical_ratio,
        laminar_ratio=flow.laminar_ratio,
        laminar_slope=flow.throat(flow.laminar_ratio) / (1 - flow.laminar_ratio),
        gravity=gravity,
    )


def load() -> Work:
    """The work with its truth, which takes some seconds."""
    experiment = load_scenario(FILE)
    integration = Integration(experiment, EXACT)
    plant, end = integration.plant, experiment.duration
    run = integration.simulate()
    # One coil: its poppet is shut at first and changes over at each edge.
    edges = [0.0, *(time for time, name in run.events if name == "valve edge" and 0 < time < end), end]
    spans = [(a, b, index % 2 == 1) for index, (a, b) in enumerate(zip(edges, edges[1:]))]
    return Work(
        muscle=muscle_of(plant.actuators[0], plant.mechanism.pull / plant.mechanism.mass),
        mass=plant.mechanism.mass,
        start=plant.start[:4],
        spans=spans,
        samples=np.array([row[0] for row in run.rows]),
        truth=np.array([[row[1] for row in run.rows], [row[3] for row in run.rows]]),
    )


def rates(length, velocity, pressure, air, mass, filling, k):
    """d[L, v, P, m]/dt with the supply open or the exhaust; `k` is a `Muscle`."""
    slack = length < k.min_length
    braid = k.min_length if slack else length
    slope = (k.square_thread - 3.0 * braid * braid) * k.per_turns
    volume = braid * (k.square_thread - braid * braid) * k.per_turns + k.external_volume
    gauge = pressure - k.atmosphere
    tension = 0.0
    volume_rate = 0.0
    if not slack:
        volume_rate = slope * velocity
        tension = k.viscous * velocity - gauge * slope
        if length > k.max_length:
            tension += max(k.stiffness * (length - k.max_length) + k.damping * velocity, 0.0)
        if gauge > 0.0:
            friction = k.coulomb_width * 3.0 * gauge * (braid + k.min_length) * k.per_turns
            if velocity > 0.0:
                tension += friction
            elif velocity < 0.0:
                tension -= friction
        tension = max(tension, 0.0)

    beyond = k.supply if filling else k.atmosphere
    inwards = pressure < beyond
    high = beyond if inwards else pressure
    ratio = pressure / beyond if inwards else beyond / pressure
    if ratio <= k.critical_ratio:
        drive = k.choked
    elif ratio <= k.laminar_ratio:
        power = ratio ** (1.0 / k.gamma)
        drive = k.throat * math.sqrt(power * (power - ratio))
    else:
        drive = k.laminar_slope * (1.0 - ratio)
    per_temperature = k.per_temperature if inwards else air * k.gas_constant / (pressure * volume)
    flow = drive * high * math.sqrt(per_temperature)
    if not inwards:
        flow = -flow
    pressure_rate = k.gamma * pressure * (flow / air - volume_rate / volume)
    return velocity, k.gravity - tension / mass, pressure_rate, flow


def rates_of_arrays(xp, state, mass, filling, k):
    """Return the rates, with selects in place of branches, for arrays of the module `xp`."""
    length, velocity, pressure, air = state[0], state[1], state[2], state[3]
    slack = length < k.min_length
    braid = xp.maximum(length, k.min_length)
    slope = (k.square_thread - 3 * braid * braid) * k.per_turns
    volume = braid * (k.square_thread - braid * braid) * k.per_turns + k.external_volume
    gauge = pressure - k.atmosphere
    taut = xp.maximum(k.stiffness * (length - k.max_length) + k.damping * velocity, 0)
    friction = k.coulomb_width * 3 * xp.maximum(gauge, 0) * (braid + k.min_length) * k.per_turns
    force = k.viscous * velocity - gauge * slope + friction * xp.sign(velocity)
    force = xp.maximum(force + xp.where(length > k.max_length, taut, 0), 0)
    tension = xp.where(slack, 0, force)
    volume_rate = xp.where(slack, 0, slope * velocity)

    beyond = xp.where(filling, k.supply, k.atmosphere)
    inwards = pressure < beyond
    high = xp.maximum(pressure, beyond)
    ratio = xp.minimum(pressure, beyond) / high
    kept = xp.clip(ratio, k.critical_ratio, k.laminar_ratio)
    power = kept ** (1 / k.gamma)
    drive = xp.where(ratio > k.laminar_ratio, k.laminar_slope * (1 - ratio), k.throat * xp.sqrt(power * (power - kept)))
    per_temperature = xp.where(inwards, k.per_temperature, air * k.gas_constant / (pressure * volume))
    flow = drive * high * xp.sqrt(per_temperature) * xp.where(inwards, 1, -1)
    pressure_rate = k.gamma * pressure * (flow / air - volume_rate / volume)
    return xp.stack([velocity, k.gravity - tension / mass, pressure_rate, flow])
