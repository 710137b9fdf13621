"""The laws of sections 1 to 5, transcribed literally: powers stay powers.

Each law that has branches takes the branch as an argument (`regime`, a piece of the effectiveness),
so that an integration step never changes branch by itself. A law evaluated beyond its branch, as
the trial stages of a step may do, continues smoothly or gives NaN, which makes the step shorter.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

LAMINAR, SUBSONIC, CHOKED = "laminar", "subsonic", "choked"


@dataclass(frozen=True)
class Braid:
    """Section 1: the geometry (2), (20)."""

    thread_length: float  # b, m
    turns: float  # n
    max_length: float  # L_max, m
    min_length: float  # L_min, m
    external_volume: float  # V_ext, m³

    @property
    def four_pi_n2(self):
        return 4 * math.pi * self.turns**2

    def volume(self, length):
        """V = L(b² − L²)/(4πn²) + V_ext, m³."""
        b = self.thread_length
        return length * (b**2 - length**2) / self.four_pi_n2 + self.external_volume

    def volume_slope(self, length):
        """dV/dL = (b² − 3L²)/(4πn²), m² (20)."""
        return (self.thread_length**2 - 3 * length**2) / self.four_pi_n2


class Effectiveness:
    """Eff(Pg) of (9): pieces of polynomials between the gauge pressures `breakpoints`."""

    def __init__(self, breakpoints, piece):
        self.breakpoints = breakpoints  # Pa, gauge
        self.piece = piece  # gauge pressure inside a piece -> the function Eff(Pg) of that piece

    @staticmethod
    def constant(value):
        return Effectiveness([], lambda inside: lambda gauge: value)

    @staticmethod
    def polynomial(coefficients, unit):
        """Σ eᵢ (Pg/unit)ⁱ. Its zeros are breakpoints, since the friction k_sec stops there."""

        def value(gauge):
            total = 0.0
            for coefficient in reversed(coefficients):
                total = total * (gauge / unit) + coefficient
            return total

        roots = np.roots(list(reversed(coefficients)))
        zeros = [float(r.real) * unit for r in roots if r.imag == 0]
        return Effectiveness(zeros, lambda inside: value)

    @staticmethod
    def table(pressures, values):
        """Monotone piecewise cubic (Fritsch-Carlson), constant outside its ends."""
        cubic = PchipInterpolator(pressures, values)

        def piece(inside):
            if inside <= pressures[0]:
                return lambda gauge: values[0]
            if inside >= pressures[-1]:
                return lambda gauge: values[-1]
            index = int(np.searchsorted(pressures, inside)) - 1
            left = pressures[index]
            c3, c2, c1, c0 = (float(c) for c in cubic.c[:, index])

            def value(gauge):
                d = gauge - left
                return ((c3 * d + c2) * d + c1) * d + c0

            return value

        return Effectiveness(list(pressures), piece)


@dataclass(frozen=True)
class Friction:
    """The last two terms of (12)."""

    viscous: float  # c, N·s/m
    coulomb_width: float  # Q, m


@dataclass(frozen=True)
class Limit:
    """The taut braid (14)."""

    stiffness: float  # K_braid, N/m
    damping: float  # C_braid, N·s/m


@dataclass(frozen=True)
class Air:
    """Section 4: the gas and its process."""

    process: str
    index: float  # κ of the polytropic family; unused by the energy balance
    gas_constant: float  # R, J/(kg·K)
    gamma: float
    atmosphere: float  # Pa
    heat_transfer: float  # h A, W/K
    wall_temperature: float  # K

    def pressure_rate(self, pressure, mass, volume, volume_rate, flows, inlet_temperature):
        """dP/dt, Pa/s. `flows` are the mass flows of the open ports, kg/s, positive inwards."""
        if self.process != "energy-balance":
            return self.index * pressure * (sum(flows) / mass - volume_rate / volume)
        temperature = pressure * volume / (mass * self.gas_constant)
        inward = sum(f for f in flows if f > 0)
        outward = -sum(f for f in flows if f < 0)
        g = self.gamma
        enthalpy = g * self.gas_constant * (inlet_temperature * inward - temperature * outward)
        heat = (g - 1) * self.heat_transfer * (self.wall_temperature - temperature)
        return (enthalpy - g * pressure * volume_rate + heat) / volume


class FlowLaw:
    """Section 5: mass flow of a seat, kg/s; subclasses give `throat`, the flow over P_up/√T_up."""

    critical_ratio: float
    laminar_ratio: float

    def throat(self, ratio):
        """Flow divided by P_up/√T_up, between the critical ratio and 1."""
        raise NotImplementedError

    def ratios(self):
        """The pressure ratios at which the law changes branch."""
        return [self.critical_ratio, self.laminar_ratio, 1.0]

    def regime(self, ratio):
        if ratio <= self.critical_ratio:
            return CHOKED
        return SUBSONIC if ratio <= self.laminar_ratio else LAMINAR

    def flow(self, upstream, downstream, temperature, regime):
        """ṁ ≥ 0 inside its regime; absolute pressures in Pa, upstream temperature in K."""
        if temperature <= 0:
            return math.nan
        ratio = downstream / upstream
        if regime == CHOKED:
            parameter = self.throat(self.critical_ratio)
        elif regime == SUBSONIC:
            parameter = self.throat(ratio)
        else:
            lam = self.laminar_ratio
            parameter = self.throat(lam) * (1 - ratio) / (1 - lam)
        return parameter * upstream / math.sqrt(temperature)


class NozzleFlow(FlowLaw):
    """(21) and (23), with η A_p C_q as the area."""

    def __init__(self, area, gamma, gas_constant, laminar_ratio):
        self.area, self.gamma, self.gas_constant = area, gamma, gas_constant
        self.laminar_ratio = laminar_ratio
        self.critical_ratio = (2 / (gamma + 1)) ** (gamma / (gamma - 1))

    def throat(self, ratio):
        g = self.gamma
        if ratio <= 0:
            return math.nan
        if ratio == self.critical_ratio:
            power = (2 / (g + 1)) ** ((g + 1) / (g - 1))
            return self.area * math.sqrt(g / self.gas_constant * power)
        under = ratio ** (2 / g) - ratio ** ((g + 1) / g)
        if under < 0:
            return math.nan
        return self.area * math.sqrt(2 * g / (self.gas_constant * (g - 1)) * under)


class Iso6358Flow(FlowLaw):
    """ISO 6358-1: ṁ = C ρ₀ P_up √(T₀/T_up) · √(1 − ((r − b)/(1 − b))²)."""

    DENSITY = 1.185  # ρ₀ of the standard reference atmosphere, kg/m³
    TEMPERATURE = 293.15  # T₀, K

    def __init__(self, conductance, critical_ratio, laminar_ratio):
        self.conductance = conductance  # η C, m³/(s·Pa)
        self.critical_ratio, self.laminar_ratio = critical_ratio, laminar_ratio

    def throat(self, ratio):
        under = 1 - ((ratio - self.critical_ratio) / (1 - self.critical_ratio)) ** 2
        if under < 0:
            return math.nan
        return self.conductance * self.DENSITY * math.sqrt(self.TEMPERATURE * under)


class Iec60534Flow(FlowLaw):
    """IEC 60534-2-1: ṁ = Kv √(ρ_w/Δp₀) Y √(x P_up ρ_up), x = 1 − r, Y = 1 − x/(3 x_c), choked at x_c = (γ/1.4) x_T."""

    WATER = 999.1  # kg/m³
    DROP = 1e5  # Δp₀, Pa

    def __init__(self, kv, pressure_drop_ratio, gamma, gas_constant, laminar_ratio):
        self.kv, self.gas_constant = kv, gas_constant  # η Kv, m³/s
        self.choked_drop = gamma / 1.4 * pressure_drop_ratio
        self.critical_ratio, self.laminar_ratio = 1 - self.choked_drop, laminar_ratio

    def throat(self, ratio):
        x = 1 - ratio
        if x < 0:
            return math.nan
        expansion = 1 - x / (3 * self.choked_drop)
        return self.kv * math.sqrt(self.WATER / self.DROP) * expansion * math.sqrt(x / self.gas_constant)
