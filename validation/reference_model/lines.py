"""What lies between a source of air and the actuator: `docs/air-line.md`. Laws only; states are the plant's."""

import math
from dataclasses import dataclass

LAMINAR_END, TURBULENT_START = 2300.0, 4000.0
DRIVE_LAMINAR = 32 * LAMINAR_END
DRIVE_TURBULENT = 0.1582 * TURBULENT_START**1.75


WIDENING = (TURBULENT_START - LAMINAR_END) / (DRIVE_TURBULENT - DRIVE_LAMINAR)
# du/dt at both ends, from dσ/dRe of the laws there
END_SLOPES = (32 * WIDENING, 0.1582 * 1.75 * TURBULENT_START**0.75 * WIDENING)


def between(t):
    """u(t): from the end of the laminar law to the start of the turbulent one, with the slopes of both."""
    a, e = END_SLOPES
    return t * (t + a * (1 - t)) / (1 + (a + e - 2) * t * (1 - t))


def drive_of_reynolds(branches, key, reynolds):
    """σ = f Re²/2 of Re ≥ 0."""
    if not branches.positive(("laminar end", key), reynolds - LAMINAR_END, 1e-7):
        return 32 * reynolds
    if branches.positive(("turbulent start", key), reynolds - TURBULENT_START, 1e-7):
        return 0.1582 * reynolds**1.75 if reynolds > 0 else math.nan
    t = (reynolds - LAMINAR_END) / (TURBULENT_START - LAMINAR_END)
    return DRIVE_LAMINAR + (DRIVE_TURBULENT - DRIVE_LAMINAR) * between(t)


def reynolds_of_drive(branches, key, drive):
    """Re of σ ≥ 0."""
    if not branches.positive(("laminar end", key), drive - DRIVE_LAMINAR, 1e-5):
        return drive / 32
    if branches.positive(("turbulent start", key), drive - DRIVE_TURBULENT, 1e-5):
        return (drive / 0.1582) ** (4 / 7) if drive > 0 else math.nan
    u = (drive - DRIVE_LAMINAR) / (DRIVE_TURBULENT - DRIVE_LAMINAR)
    a, e = END_SLOPES  # u (1 + (a + e − 2) t (1 − t)) = t (t + a (1 − t)) as a quadratic in t
    square, linear = 1 - a + u * (a + e - 2), a - u * (a + e - 2)
    root = linear**2 + 4 * square * u
    if root < 0:
        return math.nan
    t = 2 * u / (linear + math.sqrt(root))
    return LAMINAR_END + (TURBULENT_START - LAMINAR_END) * t


@dataclass(frozen=True)
class Hose:
    """Length, bore and gas; `cells` is 0 for the lumped hose."""

    length: float
    diameter: float
    viscosity: float
    index: float  # κ
    cells: int
    gas_constant: float
    gamma: float
    temperature: float  # of wall and air

    @property
    def area(self):
        return math.pi * self.diameter**2 / 4

    @property
    def volume(self):
        return self.area * self.length

    @property
    def delay(self):
        """L/c where the valve's seats take effect late."""
        if self.cells:
            return 0.0
        return self.length / math.sqrt(self.index * self.gas_constant * self.temperature)

    def flow(self, branches, key, first, second, tolerance):
        """ṁ from the pressure `first` to `second` of the whole length, kg/s (lumped)."""
        forwards = branches.positive(("hose flow", key), first - second, tolerance)
        up, down = (first, second) if forwards else (second, first)
        rt = self.gas_constant * self.temperature
        drive = (up**2 - down**2) / (2 * rt) * self.diameter**3 / (self.viscosity**2 * self.length)
        reynolds = reynolds_of_drive(branches, key, drive)
        rubbed = math.pi * self.diameter * self.viscosity / 4 * reynolds
        g = self.gamma
        sonic = self.area * up * math.sqrt(g / rt) * (2 / (g + 1)) ** ((g + 1) / (2 * (g - 1)))
        flow = rubbed / math.sqrt(1 + (rubbed / sonic) ** 2)
        return flow if forwards else -flow

    def loss(self, branches, key, flow, pressure):
        """Δp of one cell that carries `flow`, at the density of `pressure`."""
        forwards = branches.positive(("hose flow", key), flow, 1e-15)
        size = flow if forwards else -flow
        reynolds = 4 * size / (math.pi * self.diameter * self.viscosity)
        drive = drive_of_reynolds(branches, key, reynolds)
        density = pressure / (self.gas_constant * self.temperature)
        dx = self.length / self.cells
        loss = drive * self.viscosity**2 * dx / (self.diameter**3 * density)
        return loss if forwards else -loss


@dataclass(frozen=True)
class Reservoir:
    volume: float
    index: float
    pressure: float  # at the start
    displacement: float  # 0: a bottle
    clearance: float
    cut_in: float
    cut_out: float

    def compressor_flow(self, pressure, atmosphere, gamma, density):
        efficiency = 1 - self.clearance * ((pressure / atmosphere) ** (1 / gamma) - 1)
        return self.displacement * density * max(0.0, efficiency)


@dataclass(frozen=True)
class LineRegulator:
    """τ dP/dt = Z(min(P_set − D ṁ, P_reservoir) − P)."""

    set_pressure: float
    lag: float
    droop: float
    dead_band: float

    def rate(self, branches, key, pressure, flow, reservoir, tolerance):
        target = self.set_pressure - self.droop * flow
        if reservoir is not None and not branches.positive(
            ("regulator limited", key), reservoir - target, tolerance
        ):
            target = reservoir
        error = target - pressure
        band = self.dead_band
        if band == 0:
            return error / self.lag
        if branches.positive(("regulator opens", key), error - band, tolerance):
            return (error - band) / self.lag
        if branches.positive(("regulator vents", key), -error - band, tolerance):
            return (error + band) / self.lag
        return 0.0
