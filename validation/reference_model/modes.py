"""Which branch of each law holds, when it ends, and what follows.

A `Mode` names every branch, so the right-hand side is smooth while the mode lasts. Each mode has
guards: functions that are positive inside it, whose first zero ends it. The sign that a guard must
keep is part of the mode and never read off the state, so a guard that starts at exactly zero does
not fire unless the solution really leaves.

Motions, for a state (L, v, P, m):

| motion        | meaning                                                                       |
|---------------|-------------------------------------------------------------------------------|
| `lengthening` | v > 0, the friction is + Q k_sec                                              |
| `shortening`  | v < 0, the friction is − Q k_sec                                              |
| `gliding`     | Q = 0: no Coulomb friction, the direction does not matter                     |
| `stuck`       | v = 0, the load is within ± Q k_sec of the rest of the tension                |
| `slack`       | L < L_min, no tension, the air rests at V(L_min)                              |
| `short-stop`  | v = 0 at L_min, pulled against it: shortens if taut, falls back if slack      |
| `fixed`       | isometric                                                                     |
"""

from dataclasses import dataclass, replace
from itertools import pairwise

from scipy.optimize import brentq

from .physics import CHOKED, LAMINAR

# A guard that begins at zero or below fires only below −tolerance. All of these are far below the
# accuracy sought and above rounding.
LENGTH_TOLERANCE = 1e-16  # m
VELOCITY_TOLERANCE = 1e-13  # m/s
FORCE_TOLERANCE = 1e-11  # N
# Near an equilibrium of pressure an explicit stepper hovers within a few rtol × P around it: that
# is no crossing. The law is continuous there, so what is ignored is of the order of the tolerance.
PRESSURE_TOLERANCE = 3e7  # Pa, times rtol
# A catch at L_min slower than this ends the (geometric, endless) series of bounces on L_min: the
# arcs of length would be shorter than 1e-15 m.
REST_VELOCITY = 1e-7  # m/s


@dataclass(frozen=True)
class Mode:
    """Every branch. `piece` counts the breakpoints below P; `ports` is (supply, exhaust)."""

    motion: str
    limit: str  # free | taut | rebound (taut, but its force clamped at 0)
    pulling: bool  # False: the total tension is clamped at 0
    piece: int
    ports: tuple

    @property
    def moving(self):
        return self.motion in ("lengthening", "shortening", "gliding")


class Piece:
    """The branches that hold between two neighbouring pressure breakpoints."""

    def __init__(self, scenario, inside):
        gauge = inside - scenario.air.atmosphere
        self.effectiveness = scenario.effectiveness.piece(gauge)
        self.rubs = gauge * self.effectiveness(gauge) > 0  # k_sec > 0
        self.regimes = []  # (inward, regime) of the supply and the exhaust
        if scenario.valve:
            for outside in (scenario.supply_pressure, scenario.air.atmosphere):
                ratio = min(inside / outside, outside / inside)
                self.regimes.append((inside < outside, scenario.valve.flow.regime(ratio)))


class Model:
    """The four-state system [L, v, P, m] of section 3.1 of the paper, mode by mode."""

    def __init__(self, scenario, rtol):
        self.s = scenario
        self.pressure_tolerance = PRESSURE_TOLERANCE * rtol
        self.pressures = [scenario.supply_pressure, scenario.air.atmosphere]
        gauges = [0.0, *scenario.effectiveness.breakpoints]
        self.force_breakpoints = {scenario.air.atmosphere + gauge for gauge in gauges}
        points = set(self.force_breakpoints)
        if scenario.valve:
            for outside in self.pressures:
                for ratio in scenario.valve.flow.ratios():
                    points |= {outside * ratio, outside / ratio}
        self.breakpoints = []
        for point in sorted(p for p in points if p > 0):
            if not self.breakpoints or point - self.breakpoints[-1] > 10 * self.pressure_tolerance:
                self.breakpoints.append(point)
        ends = [self.breakpoints[0] / 2, *self.breakpoints, self.breakpoints[-1] * 2]
        self.pieces = [Piece(scenario, (a + b) / 2) for a, b in pairwise(ends)]

    # --- forces -------------------------------------------------------------------------------

    def static_force(self, mode, length, pressure):
        """F_s = Eff(Pg) Pg (3L² − b²)/(4πn²), N (3)(9)."""
        gauge = pressure - self.s.air.atmosphere
        braid = self.s.braid
        ideal = gauge * (3 * length**2 - braid.thread_length**2) / braid.four_pi_n2
        return self.pieces[mode.piece].effectiveness(gauge) * ideal

    def friction_bound(self, mode, length, pressure):
        """Q max(k_sec, 0) with k_sec = 3 Pg Eff (L + L_min)/(4πn²), N (13)."""
        piece = self.pieces[mode.piece]
        if not piece.rubs:
            return 0.0
        gauge = pressure - self.s.air.atmosphere
        braid = self.s.braid
        secant = 3 * gauge * piece.effectiveness(gauge) * (length + braid.min_length)
        return self.s.friction.coulomb_width * secant / braid.four_pi_n2

    def limit_sum(self, length, velocity):
        """K_braid (L − L_max) + C_braid v, before its clamp, N (14)."""
        limit = self.s.limit
        return limit.stiffness * (length - self.s.braid.max_length) + limit.damping * velocity

    def unclamped_tension(self, mode, length, velocity, pressure):
        """F of (12) while moving, before the clamp of the total at 0."""
        force = self.static_force(mode, length, pressure) + self.s.friction.viscous * velocity
        if mode.limit == "taut":
            force += self.limit_sum(length, velocity)
        if mode.motion == "lengthening":
            force += self.friction_bound(mode, length, pressure)
        elif mode.motion == "shortening":
            force -= self.friction_bound(mode, length, pressure)
        return force

    def rest_band(self, mode, length, pressure):
        """The least and the greatest tension at v = 0: the set value of (12)."""
        force = self.static_force(mode, length, pressure)
        force += max(0.0, self.limit_sum(length, 0.0)) if length > self.s.braid.max_length else 0.0
        bound = self.friction_bound(mode, length, pressure)
        return max(0.0, force - bound), max(0.0, force + bound)

    def tension(self, mode, length, velocity, pressure):
        """The tension of the state, N: that of the load where the motion is held at rest."""
        if mode.motion == "slack":
            return 0.0
        if mode.motion in ("stuck", "short-stop"):
            return self.s.load.pull
        if mode.motion == "fixed":
            slack = length < self.s.braid.min_length
            force = self.static_force(mode, length, pressure)
            if length > self.s.braid.max_length:
                force += self.limit_sum(length, 0.0)
            return 0.0 if slack else max(0.0, force)
        if not mode.pulling:
            return 0.0
        return self.unclamped_tension(mode, length, velocity, pressure)

    # --- air ----------------------------------------------------------------------------------

    def air_length(self, mode, length):
        """The length of the braid: L, or L_min while slack."""
        shortest = self.s.braid.min_length
        if mode.motion == "slack":
            return shortest
        return max(length, shortest) if mode.motion == "fixed" else length

    def volume(self, mode, length):
        return self.s.braid.volume(self.air_length(mode, length))

    def flows(self, mode, length, pressure, mass):
        """Mass flows of the open ports, kg/s, positive into the actuator."""
        flows = []
        if not any(mode.ports):
            return flows
        own = pressure * self.volume(mode, length) / (mass * self.s.air.gas_constant)
        valve, ambient = self.s.valve, self.s.supply_temperature
        for port in (0, 1):
            if not mode.ports[port]:
                continue
            outside = self.pressures[port]
            inward, regime = self.pieces[mode.piece].regimes[port]
            if inward:
                flows.append(valve.flow.flow(outside, pressure, ambient, regime))
            else:
                upstream = ambient if valve.exhaust_is_ambient else own
                flows.append(-valve.flow.flow(pressure, outside, upstream, regime))
        return flows

    # --- the system ---------------------------------------------------------------------------

    def rates(self, mode):
        """The right-hand side d[L, v, P, m]/dt of a mode: (15), (16), (19) to (21)."""
        load, braid, air = self.s.load, self.s.braid, self.s.air

        def derivative(_time, state):
            length, velocity, pressure, mass = state.tolist()
            flows = self.flows(mode, length, pressure, mass)
            moves = mode.moving or mode.motion == "slack"
            rate = braid.volume_slope(length) * velocity if mode.moving else 0.0
            volume = self.volume(mode, length)
            pressure_rate = air.pressure_rate(
                pressure, mass, volume, rate, flows, self.s.supply_temperature
            )
            if not moves:
                return 0.0, 0.0, pressure_rate, sum(flows)
            tension = self.tension(mode, length, velocity, pressure)
            return velocity, (load.pull - tension) / load.mass, pressure_rate, sum(flows)

        return derivative

    def guards(self, mode):
        """(name, tolerance, function of the state) of each way in which the mode can end."""
        braid, load = self.s.braid, self.s.load
        guards = []
        if mode.piece > 0:
            low = self.breakpoints[mode.piece - 1]
            guards.append(("pressure-down", self.pressure_tolerance, lambda y: y[2] - low))
        if mode.piece < len(self.breakpoints):
            high = self.breakpoints[mode.piece]
            guards.append(("pressure-up", self.pressure_tolerance, lambda y: high - y[2]))
        if mode.motion == "slack":
            guards.append(("catch", LENGTH_TOLERANCE, lambda y: braid.min_length - y[0]))
        elif mode.motion == "stuck":

            def reserve(y):
                least, greatest = self.rest_band(mode, y[0], y[2])
                return min(greatest - load.pull, load.pull - least)

            guards.append(("break-away", FORCE_TOLERANCE, reserve))
        elif mode.motion == "short-stop":
            guards.append(
                (
                    "leave-short-stop",
                    FORCE_TOLERANCE,
                    lambda y: self.rest_band(mode, y[0], y[2])[0] - load.pull,
                )
            )
        if not mode.moving:
            return guards
        if mode.motion == "lengthening":
            guards.append(("rest", VELOCITY_TOLERANCE, lambda y: y[1]))
        elif mode.motion == "shortening":
            guards.append(("rest", VELOCITY_TOLERANCE, lambda y: -y[1]))
        guards.append(("slack", LENGTH_TOLERANCE, lambda y: y[0] - braid.min_length))
        if mode.limit == "free":
            guards.append(("taut", LENGTH_TOLERANCE, lambda y: braid.max_length - y[0]))
        elif mode.limit == "taut" and self.s.limit.damping > 0:
            guards.append(("rebound", FORCE_TOLERANCE, lambda y: self.limit_sum(y[0], y[1])))
        else:
            guards.append(("untaut", LENGTH_TOLERANCE, lambda y: y[0] - braid.max_length))
        if mode.limit == "rebound":
            guards.append(("re-taut", FORCE_TOLERANCE, lambda y: -self.limit_sum(y[0], y[1])))
        sign = 1.0 if mode.pulling else -1.0
        guards.append(
            (
                "clamp" if mode.pulling else "unclamp",
                FORCE_TOLERANCE,
                lambda y: sign * self.unclamped_tension(mode, y[0], y[1], y[2]),
            )
        )
        return guards

    def after(self, event, mode, state):
        """The mode and the state that follow an event, and what to call it in a count of events."""
        braid = self.s.braid
        if event in ("pressure-up", "pressure-down"):
            following = replace(mode, piece=mode.piece + (1 if event == "pressure-up" else -1))
            return following, state, self.name_of_crossing(mode, following)
        if event in ("clamp", "unclamp"):
            return replace(mode, pulling=event == "unclamp"), state, event
        if event == "rest":
            following, state = self.settle(mode, state)
            return following, state, "stick" if following.motion == "stuck" else "reversal"
        if event == "break-away":
            return self.with_clamp(self.break_away(mode, state), state), state, event
        if event == "leave-short-stop":
            following, state = self.settle(mode, state)
            return following, state, event
        if event == "slack":
            state[0] = braid.min_length
            return replace(mode, motion="slack", limit="free", pulling=True), state, event
        if event == "catch":
            state[0] = braid.min_length
            if state[1] > REST_VELOCITY:
                motion = "lengthening" if self.s.friction.coulomb_width > 0 else "gliding"
                return self.with_clamp(replace(mode, motion=motion), state), state, event
            following, state = self.settle(mode, state)
            return following, state, following.motion
        limit = {"taut": "taut", "re-taut": "taut", "rebound": "rebound", "untaut": "free"}[event]
        if event in ("taut", "untaut"):
            state[0] = braid.max_length
        return self.with_clamp(replace(mode, limit=limit), state), state, event

    def name_of_crossing(self, before, after):
        """What changes at a pressure breakpoint: a flow regime of an open port, or a force law."""
        names = []
        for port, name in ((0, "supply"), (1, "exhaust")):
            if not before.ports[port]:
                continue
            old, new = (self.pieces[mode.piece].regimes[port] for mode in (before, after))
            if old[1] == LAMINAR and new[1] == LAMINAR and old[0] != new[0]:
                names.append(f"{name} flow reverses")
            elif old != new:
                kinds = {old[1], new[1]}
                names.append(f"{name} {'critical' if CHOKED in kinds else 'laminar'} ratio")
        if self.breakpoints[max(before.piece, after.piece) - 1] in self.force_breakpoints:
            names.append("force law piece")
        return " + ".join(names)

    def break_away(self, mode, state):
        """The motion out of `stuck`, towards the side on which the load leaves the band."""
        length, pull = float(state[0]), self.s.load.pull
        least, greatest = self.rest_band(mode, length, float(state[2]))
        if greatest - pull < pull - least:
            return replace(mode, motion="lengthening")
        at_short_end = length <= self.s.braid.min_length + LENGTH_TOLERANCE
        return replace(mode, motion="short-stop" if at_short_end else "shortening")

    def settle(self, mode, state):
        """What follows v = 0 at L ≥ L_min: stick if the load is inside the band, or move."""
        state[1] = 0.0
        length, pressure = float(state[0]), float(state[2])
        limit = "taut" if length > self.s.braid.max_length else "free"
        mode = replace(mode, limit=limit, pulling=True)
        least, greatest = self.rest_band(mode, length, pressure)
        pull = self.s.load.pull
        at_short_end = length <= self.s.braid.min_length + LENGTH_TOLERANCE
        if at_short_end and pull < least - FORCE_TOLERANCE:
            motion = "short-stop" if pull >= 0 else "slack"
        elif self.s.friction.coulomb_width == 0:
            motion = "gliding"
        elif pull > greatest + FORCE_TOLERANCE:
            motion = "lengthening"
        elif pull < least - FORCE_TOLERANCE:
            motion = "shortening"
        else:
            motion = "stuck"
        return self.with_clamp(replace(mode, motion=motion), state), state

    def with_clamp(self, mode, state):
        """The mode with the clamp of the total tension as the state has it."""
        if not mode.moving:
            return replace(mode, pulling=True)
        length, velocity, pressure, _ = state.tolist()
        return replace(mode, pulling=self.unclamped_tension(mode, length, velocity, pressure) >= 0)

    # --- the start ----------------------------------------------------------------------------

    def piece_at(self, pressure):
        return sum(pressure > point for point in self.breakpoints)

    def equilibrium(self, pressure):
        """The L at which F_s + K_braid (L − L_max)⁺ is the load, or L_min if it is held there."""
        braid, pull = self.s.braid, self.s.load.pull
        mode = Mode("gliding", "free", True, self.piece_at(pressure), (False, False))

        def excess(length):
            stretch = max(0.0, length - braid.max_length)
            return (
                self.static_force(mode, length, pressure) + self.s.limit.stiffness * stretch - pull
            )

        if excess(braid.min_length) >= 0:
            return braid.min_length
        longest = braid.max_length
        while excess(longest) < 0:
            longest += 1e-3
        return brentq(excess, braid.min_length, longest, xtol=1e-18, rtol=1e-15)

    def start(self, ports):
        """The mode and the state at t = 0."""
        s = self.s
        pressure, velocity = s.initial_pressure, s.initial_velocity
        length = s.initial_length
        if length is None:
            length = self.equilibrium(pressure)
        mode = Mode("gliding", "free", True, self.piece_at(pressure), ports)
        if s.load.mass == float("inf"):
            mode = replace(mode, motion="fixed")
        elif length < s.braid.min_length or (length == s.braid.min_length and velocity < 0):
            mode = replace(mode, motion="slack")
        mass = pressure * self.volume(mode, length) / (s.air.gas_constant * s.initial_temperature)
        return mode, [length, velocity, pressure, mass]

    def start_motion(self, mode, state):
        """The branches of the motion at t = 0."""
        length, velocity = float(state[0]), float(state[1])
        if mode.motion in ("fixed", "slack"):
            return mode, state
        if velocity == 0:
            return self.settle(mode, state)
        if self.s.friction.coulomb_width > 0:
            mode = replace(mode, motion="lengthening" if velocity > 0 else "shortening")
        longest = self.s.braid.max_length
        if length > longest or (length == longest and velocity > 0):
            pulls = self.limit_sum(length, velocity) >= 0
            mode = replace(mode, limit="taut" if pulls else "rebound")
        return self.with_clamp(mode, state), state
