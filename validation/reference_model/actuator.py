"""The actuator: force, friction and the elements that remember. Model sections 1 to 3, `docs/friction.md`.

`Hysteresis` classes hold no state: deflections are entries of the plant's state, modes are in the plant's mode.
"""

import math
from dataclasses import dataclass

from .physics import Braid, Effectiveness, Limit

LENGTH_TOLERANCE = 1e-16  # m
VELOCITY_TOLERANCE = 1e-13  # m/s
FORCE_TOLERANCE = 1e-11  # N


@dataclass(frozen=True)
class Dry:
    """F_dry = F_c s(v) sgn v, F_c = Q k_sec⁺ + F₀ + A P_g⁺, s = 1 + (ρ − 1) exp(−(v/v_s)²)."""

    width: float  # Q, m
    force: float = 0.0  # F₀, N
    per_pressure: float = 0.0  # A, m²
    static_ratio: float = 1.0  # ρ
    velocity: float = 0.01  # v_s, m/s

    @property
    def present(self):
        return self.width > 0 or self.force > 0 or self.per_pressure > 0

    def scale(self, velocity):
        return 1 + (self.static_ratio - 1) * math.exp(-((velocity / self.velocity) ** 2))


class MaxwellSlip:
    """F_h = k_sec⁺ Σ wᵢ zᵢ; dzᵢ/dL = 1 while |zᵢ| < rᵢ, 0 while it slips."""

    def __init__(self, reach, stiffness_ratio):
        self.reach, self.ratio = reach, stiffness_ratio
        self.count = len(reach)

    def rates(self, branches, key, modes, velocity, z):
        rates = []
        for i, (mode, reach) in enumerate(zip(modes, self.reach, strict=True)):
            if mode == 0:
                branches.guard(("element", key, i, 1), reach - z[i], 1e-15)
                branches.guard(("element", key, i, -1), reach + z[i], 1e-15)
                rates.append(velocity)
            else:
                branches.guard(("element", key, i, 0), mode * velocity, VELOCITY_TOLERANCE)
                rates.append(0.0)
        return rates

    def force(self, secant, velocity, z, rates):
        return secant * sum(w * d for w, d in zip(self.ratio, z, strict=True))


class BoucWen:
    """F_h = k_sec⁺ W (β + γ) z; dz/dt = v − β |v| z − γ v |z|."""

    count = 1

    def __init__(self, width, beta, gamma):
        self.width, self.beta, self.gamma = width, beta, gamma

    def rates(self, branches, key, modes, velocity, z):
        forwards = branches.positive(("forwards", key), velocity, VELOCITY_TOLERANCE)
        bent = branches.positive(("bent", key), z[0], 1e-15)
        speed = velocity if forwards else -velocity
        size = z[0] if bent else -z[0]
        return [velocity - self.beta * speed * z[0] - self.gamma * velocity * size]

    def force(self, secant, velocity, z, rates):
        return secant * self.width * (self.beta + self.gamma) * z[0]


class LuGre:
    """F_h = k_sec⁺ (W/r)(z + τ e(v) ż); dz/dt = v − |v| z/r(v)."""

    count = 1

    def __init__(self, width, reach, static_ratio, velocity, damping_time):
        self.width, self.reach, self.static_ratio = width, reach, static_ratio
        self.velocity, self.damping_time = velocity, damping_time

    def rates(self, branches, key, modes, velocity, z):
        forwards = branches.positive(("forwards", key), velocity, VELOCITY_TOLERANCE)
        speed = velocity if forwards else -velocity
        falling = math.exp(-((velocity / self.velocity) ** 2))
        reach = self.reach * (1 + (self.static_ratio - 1) * falling)
        return [velocity - speed * z[0] / reach]

    def force(self, secant, velocity, z, rates):
        falling = math.exp(-((velocity / self.velocity) ** 2))
        bristles = z[0] + self.damping_time * falling * rates[0]
        return secant * self.width / self.reach * bristles


@dataclass(frozen=True)
class Viscoelastic:
    """F_b = Σ (kᵢ + wᵢ k_sec⁺)(L − zᵢ); dzᵢ/dt = (L − zᵢ)/τᵢ. The relaxed lengths zᵢ are states."""

    relaxation_time: tuple = ()  # τ, s
    stiffness: tuple = ()  # k, N/m
    stiffness_ratio: tuple = ()  # w

    @property
    def count(self):
        return len(self.relaxation_time)

    def rates(self, length, relaxed):
        return [(length - z) / tau for tau, z in zip(self.relaxation_time, relaxed, strict=True)]

    def force(self, secant, length, relaxed):
        springs = zip(self.stiffness, self.stiffness_ratio, relaxed, strict=True)
        return sum((k + w * secant) * (length - z) for k, w, z in springs)


@dataclass(frozen=True)
class Muscle:
    """What makes the tension. `pressure_tolerance` is that of its branches, Pa."""

    braid: Braid
    effectiveness: Effectiveness
    viscous: float  # c, N·s/m
    dry: Dry
    hysteresis: object
    limit: Limit
    structural: float = 0.0  # τ_c, s
    viscoelastic: Viscoelastic = Viscoelastic()

    def damping(self, secant):
        """c + τ_c k_sec⁺, N·s/m."""
        return self.viscous + self.structural * secant

    def static(self, branches, key, length, gauge, tolerance):
        """(F_s, k_sec⁺, P_g⁺): (3), (9), (13)."""
        knots = self.effectiveness.breakpoints
        inside = 0
        for i, knot in enumerate(knots):
            inside += branches.positive(("force law", key, i), gauge - knot, tolerance)
        middle = 1.0
        if knots:
            ends = [2 * knots[0] - knots[-1] - 1.0, *knots, 2 * knots[-1] - knots[0] + 1.0]
            middle = (ends[inside] + ends[inside + 1]) / 2
        law = self.effectiveness.piece(middle)
        eff = law(gauge)
        pressed = branches.positive(("gauge", key), gauge, tolerance)
        braid = self.braid
        force = eff * gauge * (3 * length**2 - braid.thread_length**2) / braid.four_pi_n2
        secant = 3 * gauge * eff * (length + braid.min_length) / braid.four_pi_n2
        slides = pressed == (law(middle) > 0)
        return force, secant if slides else 0.0, gauge if pressed else 0.0

    def limit_force(self, branches, key, length, velocity, at_rest):
        """The braid's limit (14), its two clamps included."""
        if not branches.positive(("taut", key), length - self.braid.max_length, LENGTH_TOLERANCE):
            return 0.0
        stretch = self.limit.stiffness * (length - self.braid.max_length)
        if at_rest:
            return stretch
        pull = stretch + self.limit.damping * velocity
        if self.limit.damping > 0 and not branches.positive(("limit pulls", key), pull, FORCE_TOLERANCE):
            return 0.0
        return pull
