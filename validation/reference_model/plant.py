"""A plant: actuators, what feeds them, and what they move, as one system of equations.

The state is one list of numbers; every part has its own entries in it (`State` hands them out). The discrete
state is a `Mode`: the branches of all laws, which way each actuator's dry friction acts, which elements slip,
which compressors run. `Plant.rates` is smooth while the mode lasts; `Plant.guards` says how long it lasts;
`Plant.after` says what follows.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from .actuator import FORCE_TOLERANCE, LENGTH_TOLERANCE, VELOCITY_TOLERANCE, MaxwellSlip, Muscle
from .branches import Branches
from .lines import Hose, LineRegulator, Reservoir
from .mechanism import Held, Joint, Mass, box_problem, gauge, shares
from .physics import CHOKED, LAMINAR, SUBSONIC, Air, FlowLaw
from .valves import RegulatorValve, SeatValve, Spool

# Near an equilibrium of pressure an explicit stepper hovers within a few rtol × P around it: that
# is no crossing. The laws are continuous there, so what is ignored is of the order of the tolerance.
PRESSURE_TOLERANCE = 3e7  # Pa, times rtol
# A catch at L_min slower than this ends the (geometric, endless) series of bounces on L_min.
REST_VELOCITY = 1e-7  # m/s
GAUGE_TOLERANCE = 1e-12


class State:
    """Entries of the state vector, by name of the part."""

    def __init__(self):
        self.scales, self.start = [], []

    def entry(self, scale, start):
        self.scales.append(scale)
        self.start.append(start)
        return len(self.start) - 1


@dataclass
class Supply:
    """What feeds valves: constant, a reservoir, a regulator, or both; each serves `alike` actuators of each kind."""

    pressure: float
    temperature: float
    reservoir: Reservoir | None = None
    regulator: LineRegulator | None = None
    alike: float = 1.0

    def allocate(self, state):
        self.i_reservoir = state.entry(1e4, self.reservoir.pressure) if self.reservoir else None
        self.i_outlet = state.entry(1e4, self.pressure) if self.regulator else None

    def outlet(self, y):
        if self.regulator:
            return y[self.i_outlet]
        return y[self.i_reservoir] if self.reservoir else self.pressure


@dataclass
class Actuator:
    """One muscle with its air, its line and its valve."""

    muscle: Muscle
    air: Air
    supply: Supply
    pressure: float  # at the start, Pa absolute
    temperature: float  # at the start, K
    valve: object = None
    supply_law: FlowLaw | None = None
    exhaust_law: FlowLaw | None = None
    exhaust_is_ambient: bool = False
    hose: Hose | None = None
    leak: float = 0.0  # k, m³/(s·Pa)
    tendon: tuple | None = None  # (stiffness, rest length)
    given: object = None  # time -> (pressure, rate) in place of valve and line
    length: float = math.nan  # of the muscle at the start, where a tendon is in series
    deflections: list = field(default_factory=list)

    def allocate(self, state, length):
        self.i_pressure = None if self.given else state.entry(1e4, self.pressure)
        volume = self.muscle.braid.volume(max(length, self.muscle.braid.min_length))
        mass = self.pressure * volume / (self.air.gas_constant * self.temperature)
        self.i_mass = state.entry(1e-6, mass)
        count = self.muscle.hysteresis.count if self.muscle.hysteresis else 0
        self.i_elements = [state.entry(1e-5, 0.0) for _ in range(count)]
        relaxed = max(length, self.muscle.braid.min_length)
        self.i_relaxed = [state.entry(1e-2, relaxed) for _ in range(self.muscle.viscoelastic.count)]
        self.i_length = state.entry(1e-2, length) if self.tendon else None
        self.i_hose, self.i_flow = [], []
        if self.hose:
            self.i_hose = [state.entry(1e4, self.pressure) for _ in range(max(1, self.hose.cells))]
            self.i_flow = [state.entry(1e-4, 0.0) for _ in range(self.hose.cells)]
        self.i_valve = []
        if isinstance(self.valve, Spool):
            self.i_valve = [state.entry(1.0, 0.0), state.entry(1e2, 0.0)]
        elif isinstance(self.valve, RegulatorValve):
            self.i_valve = [state.entry(1e4, self.pressure)]


@dataclass
class Mode:
    """Everything discrete. `sliding`: ±1, 0 where it sticks, None without dry friction."""

    branches: Branches
    sliding: list
    elements: list
    running: list  # compressors
    held_short: list  # at rest on L_min

    def copy(self):
        return Mode(
            self.branches.copy(),
            list(self.sliding),
            [list(e) for e in self.elements],
            list(self.running),
            list(self.held_short),
        )


def solve(matrix, right):
    if len(right) == 1:
        return [right[0] / matrix[0][0]]
    if len(right) > 2:
        return np.linalg.solve(matrix, right).tolist()
    (a, b), (c, d) = matrix
    determinant = a * d - b * c
    return [(d * right[0] - b * right[1]) / determinant, (a * right[1] - c * right[0]) / determinant]


class Plant:
    """The whole. `start` is (q, q̇) of the mechanism."""

    def __init__(self, actuators, mechanism, start, rtol):
        self.actuators, self.mechanism = actuators, mechanism
        self.tolerance = PRESSURE_TOLERANCE * rtol
        self.supplies = []
        for actuator in actuators:
            if not any(actuator.supply is other for other in self.supplies):
                self.supplies.append(actuator.supply)
        n = mechanism.coordinates
        self.n = n
        state = State()
        if n:
            for k in range(n):
                state.entry(mechanism.scales[0], start[0][k])
            for k in range(n):
                state.entry(mechanism.scales[1], start[1][k])
            lengths = self.lengths_at(list(start[0]))
        else:
            lengths = [mechanism.motion(0.0)[0]]
        for actuator, length in zip(actuators, lengths, strict=True):
            actuator.allocate(state, actuator.length if actuator.tendon else length)
        for supply in self.supplies:
            supply.allocate(state)
        self.scales = np.array(state.scales)
        self.start = np.array(state.start)

    def lengths_at(self, q):
        if isinstance(self.mechanism, Joint):
            self.mechanism.locate(Branches(), q)
        return self.mechanism.lengths(q)

    # --- the equations ------------------------------------------------------------------------

    def evaluate(self, t, y, mode):
        """(rates, observations of each actuator, generalised force of the actuators)."""
        branches, n = mode.branches, self.n
        rates = [0.0] * len(y)
        if n:
            q, qd = y[:n], y[n : 2 * n]
            if isinstance(self.mechanism, Joint):
                self.mechanism.locate(branches, q)
            lengths = self.mechanism.lengths(q)
            arms = self.mechanism.arms(q)
            speeds = [sum(j * w for j, w in zip(row, qd, strict=True)) for row in arms]
        else:
            length, speed = self.mechanism.motion(t)
            lengths, speeds, arms = [length], [speed], [[]]
        seen = [
            self.muscle(k, t, y, mode, lengths[k], speeds[k], rates)
            for k in range(len(self.actuators))
        ]
        drawn = [0.0] * len(self.supplies)
        for k, actuator in enumerate(self.actuators):
            index = next(i for i, s in enumerate(self.supplies) if s is actuator.supply)
            drawn[index] += self.air(k, t, y, mode, seen[k], rates)
        for index, supply in enumerate(self.supplies):
            self.feed(index, supply, y, mode, drawn[index] * supply.alike, rates)
        total = [0.0] * n
        if n:
            total = self.motion(y, mode, q, qd, arms, speeds, seen, rates)
        return rates, seen, total

    def muscle(self, k, t, y, mode, distance, speed, rates):
        """Force and length of one actuator; fills in the rates of its elements, branches and own length."""
        actuator, branches = self.actuators[k], mode.branches
        muscle = actuator.muscle
        braid = muscle.braid
        if actuator.given:
            pressure, pressure_rate = actuator.given(t)
        else:
            pressure, pressure_rate = y[actuator.i_pressure], None
        seen = {"distance": distance, "speed": speed, "pressure": pressure, "slack": False}
        seen["pressure_rate"] = pressure_rate
        length, velocity = distance, speed

        def relax(length):
            relaxed = [y[i] for i in actuator.i_relaxed]
            for index, rate in zip(actuator.i_relaxed, muscle.viscoelastic.rates(length, relaxed), strict=True):
                rates[index] = rate
            return relaxed

        if actuator.tendon:
            length = y[actuator.i_length]
        elif not mode.held_short[k]:
            on_cord = branches.positive(("slack", k), distance - braid.min_length, LENGTH_TOLERANCE)
            if not on_cord:
                relax(braid.min_length)
                seen.update(slack=True, length=braid.min_length, velocity=0.0, tension=0.0)
                seen["box"] = (0.0, 0.0)
                return seen
        sliding = mode.sliding[k]
        at_rest = sliding == 0 and not actuator.tendon
        gauge_pressure = pressure - actuator.air.atmosphere
        static, secant, pressed = muscle.static(branches, k, length, gauge_pressure, self.tolerance)
        static += muscle.viscoelastic.force(secant, length, relax(length))
        damping = muscle.damping(secant)
        dry = muscle.dry.width * secant + muscle.dry.force + muscle.dry.per_pressure * pressed
        z = [y[i] for i in actuator.i_elements]

        def memory(velocity):
            if not z:
                return 0.0, []
            z_rates = muscle.hysteresis.rates(branches, k, mode.elements[k], velocity, z)
            return muscle.hysteresis.force(secant, velocity, z, z_rates), z_rates

        if actuator.tendon:
            stiffness, rest = actuator.tendon
            tight = branches.positive(("tendon", k), distance - rest - length, LENGTH_TOLERANCE)
            tension = stiffness * (distance - rest - length) if tight else 0.0
            static += memory(0.0)[0]  # none of the laws allowed here has a force that follows the velocity
            if branches.positive(("taut", k), length - braid.max_length, LENGTH_TOLERANCE):
                static += muscle.limit.stiffness * (length - braid.max_length)
                damping += muscle.limit.damping
            if sliding == 0:
                reserve = dry - abs(tension - static)
                branches.guard(("tendon release", k), reserve, FORCE_TOLERANCE)
                velocity = 0.0
            else:
                drive = tension - static - (sliding or 0) * dry
                velocity = drive / damping
                if sliding:
                    branches.guard(("tendon stop", k), sliding * drive, FORCE_TOLERANCE)
            rates[actuator.i_length] = velocity
            z_rates = memory(velocity)[1]
            seen["net"] = tension - static
        else:
            force, z_rates = memory(0.0 if at_rest else velocity)
            rest = static + force + damping * velocity
            rest += muscle.limit_force(branches, k, length, velocity, at_rest or isinstance(self.mechanism, Held) and velocity == 0)
            if at_rest:
                bound = dry * muscle.dry.static_ratio
                low = 0.0 if mode.held_short[k] else max(0.0, rest - bound)
                seen["box"] = (low, max(0.0, rest + bound))
                tension = math.nan
            else:
                if isinstance(self.mechanism, Held) and velocity != 0 and muscle.dry.present:
                    forwards = branches.positive(("forwards", k), velocity, VELOCITY_TOLERANCE)
                    sliding = 1 if forwards else -1
                elif isinstance(self.mechanism, Held):
                    sliding = 0
                total = rest
                if sliding:
                    total += sliding * dry * muscle.dry.scale(velocity)
                tension = total if branches.positive(("pulls", k), total, FORCE_TOLERANCE) else 0.0
                bound = dry * muscle.dry.static_ratio
                short = distance <= braid.min_length + LENGTH_TOLERANCE
                still = rest - damping * velocity
                seen["box"] = (0.0 if short else max(0.0, still - bound), max(0.0, still + bound))
        for index, rate in zip(actuator.i_elements, z_rates, strict=True):
            rates[index] = rate
        seen.update(length=length, velocity=velocity, tension=tension)
        return seen

    def path_flow(self, branches, key, law, outside, inside, outside_temperature, inside_temperature):
        """Flow from outside to inside through an open flow path, kg/s."""
        inward = branches.positive((*key, "inward"), outside - inside, self.tolerance)
        up, down = (outside, inside) if inward else (inside, outside)
        temperature = outside_temperature if inward else inside_temperature
        if up <= 0:
            return math.nan
        ratio = down / up
        tolerance = self.tolerance / up
        if branches.positive((*key, "choked"), law.critical_ratio - ratio, tolerance):
            regime = CHOKED
        elif branches.positive((*key, "laminar"), ratio - law.laminar_ratio, tolerance):
            regime = LAMINAR
        else:
            regime = SUBSONIC
        flow = law.flow(up, down, temperature, regime)
        return flow if inward else -flow

    def valve_flows(self, k, t, y, mode, node, temperature, rates):
        """(from the supply, from the atmosphere) into the node behind the valve, kg/s."""
        actuator, branches, valve = self.actuators[k], mode.branches, self.actuators[k].valve
        ambient = actuator.supply.temperature
        leaving = ambient if actuator.exhaust_is_ambient else temperature
        atmosphere = actuator.air.atmosphere
        if valve is None:
            return 0.0, 0.0
        if isinstance(valve, RegulatorValve):
            (index,) = actuator.i_valve
            rates[index] = valve.rate(branches, k, y[index])
            flow = self.path_flow(branches, ("p", k), actuator.supply_law, y[index], node, ambient, leaving)
            inward = branches.sides["p", k, "inward"]
            return (flow, 0.0) if inward else (0.0, flow)
        if isinstance(valve, Spool):
            position, speed = actuator.i_valve
            rates[position], rates[speed] = valve.rates(branches, k, y[position], y[speed])
            openings = valve.uncovered(branches, k, y[position])
            open_ports = tuple(branches.sides["spool edge", k, side] for side in (1, -1))
        else:
            openings, open_ports = valve.openings(t), valve.open_ports()
        flows = [0.0, 0.0]
        outsides = (actuator.supply.outlet(y), atmosphere)
        laws = (actuator.supply_law, actuator.exhaust_law)
        for port in (0, 1):
            if open_ports[port]:
                key = (("supply", "exhaust")[port], k)
                flows[port] = openings[port] * self.path_flow(
                    branches, key, laws[port], outsides[port], node, ambient, leaving
                )
        return tuple(flows)

    def air(self, k, t, y, mode, seen, rates):
        """Air of one actuator and its line; returns what it draws from the supply, kg/s."""
        actuator, branches = self.actuators[k], mode.branches
        air, braid, hose = actuator.air, actuator.muscle.braid, actuator.hose
        length, velocity, pressure = seen["length"], seen["velocity"], seen["pressure"]
        volume = braid.volume(length)
        volume_rate = braid.volume_slope(length) * velocity
        mass = y[actuator.i_mass]
        seen["volume"] = volume
        seen["temperature"] = pressure * volume / (mass * air.gas_constant)
        seen["mass"] = mass
        if actuator.given:
            flow = mass * (seen["pressure_rate"] / (air.index * pressure) + volume_rate / volume)
            rates[actuator.i_mass] = flow
            seen["flow"] = flow
            return 0.0
        wall = actuator.supply.temperature
        if hose:
            first = y[actuator.i_hose[0]]
            supply, exhaust = self.valve_flows(k, t, y, mode, first, wall, rates)
            stiffness = hose.index * hose.gas_constant * hose.temperature
            if hose.cells:
                dx = hose.length / hose.cells
                flow = supply + exhaust
                for i in range(hose.cells):
                    here = y[actuator.i_hose[i]]
                    after = y[actuator.i_hose[i + 1]] if i + 1 < hose.cells else pressure
                    out = y[actuator.i_flow[i]]
                    rates[actuator.i_hose[i]] = stiffness / (hose.area * dx) * (flow - out)
                    loss = hose.loss(branches, (k, i), out, (here + after) / 2)
                    rates[actuator.i_flow[i]] = hose.area / dx * (here - after - loss)
                    flow = out
                flows = [flow]
            else:
                flow = hose.flow(branches, k, first, pressure, self.tolerance)
                rates[actuator.i_hose[0]] = stiffness / hose.volume * (supply + exhaust - flow)
                flows = [flow]
            seen["hose_pressure"] = first
        else:
            supply, exhaust = self.valve_flows(k, t, y, mode, pressure, seen["temperature"], rates)
            flows = [supply, exhaust]
        if actuator.leak > 0:
            outward = branches.positive(("leak", k), pressure - air.atmosphere, self.tolerance)
            density = mass / volume if outward else air.atmosphere / (air.gas_constant * wall)
            flows.append(-actuator.leak * density * (pressure**2 - air.atmosphere**2) / (2 * pressure))
        rates[actuator.i_mass] = seen["flow"] = sum(flows)
        rates[actuator.i_pressure] = air.pressure_rate(pressure, mass, volume, volume_rate, flows, wall)
        return supply

    def feed(self, index, supply, y, mode, drawn, rates):
        """What becomes of the supply while `drawn` flows out of it, kg/s."""
        air = self.actuators[0].air
        reservoir = None
        if supply.reservoir:
            tank = supply.reservoir
            reservoir = y[supply.i_reservoir]
            inward = 0.0
            if tank.displacement > 0:
                if mode.running[index]:
                    density = air.atmosphere / (air.gas_constant * supply.temperature)
                    inward = tank.compressor_flow(reservoir, air.atmosphere, air.gamma, density)
                    mode.branches.guard(("compressor stops", index), tank.cut_out - reservoir, self.tolerance)
                else:
                    mode.branches.guard(("compressor starts", index), reservoir - tank.cut_in, self.tolerance)
            stiffness = tank.index * air.gas_constant * supply.temperature / tank.volume
            rates[supply.i_reservoir] = stiffness * (inward - drawn)
        if supply.regulator:
            rates[supply.i_outlet] = supply.regulator.rate(
                mode.branches, index, y[supply.i_outlet], drawn, reservoir, self.tolerance
            )

    def motion(self, y, mode, q, qd, arms, speeds, seen, rates):
        """q̈ and the guards of sliding and sticking; fills in the tensions of what sticks."""
        branches, n = mode.branches, self.n
        force = self.mechanism.generalised_force(branches, q, qd)
        stuck = []
        for k, actuator in enumerate(self.actuators):
            if not actuator.tendon and not seen[k]["slack"]:
                if mode.sliding[k] == 0:
                    stuck.append(k)
                    continue
                if mode.sliding[k] is not None:
                    branches.guard(("rest", k), mode.sliding[k] * speeds[k], VELOCITY_TOLERANCE)
            force = [f - j * seen[k]["tension"] for f, j in zip(force, arms[k], strict=True)]
        inertia = self.mechanism.inertia(q)
        rates[:n] = qd
        if not stuck:
            rates[n : 2 * n] = solve(inertia, force)
            return force
        rows = [arms[k] for k in stuck]
        boxes = [seen[k]["box"] for k in stuck]
        if n == 1:
            acceleration = [0.0]
            rates[0] = 0.0
        else:
            bias = self.mechanism.bias(q, qd)
            acceleration = self.constrained(inertia, force, rows, [bias[k] for k in stuck])
        need = [f - sum(m * a for m, a in zip(row, acceleration, strict=True)) for f, row in zip(force, inertia, strict=True)]
        rates[n : 2 * n] = acceleration
        if any(not math.isfinite(x) for x in (*need, *(e for b in boxes for e in b))):
            rates[n : 2 * n] = [math.nan] * n
            return force
        if branches.seen is not None:
            branches.guard(("release",), gauge(rows, need, boxes)[0], GAUGE_TOLERANCE)
        if len(stuck) == 1:
            row, value = rows[0], max(range(n), key=lambda i: abs(rows[0][i]))
            tensions = [need[value] / row[value]]
        else:
            tensions = shares(rows, need, boxes)
        for k, tension in zip(stuck, tensions, strict=True):
            seen[k]["tension"] = tension
        return [f - sum(j * x for j, x in zip(column, tensions, strict=True)) for f, column in zip(force, zip(*rows, strict=True), strict=True)]

    @staticmethod
    def constrained(inertia, force, rows, bias):
        """q̈ with J q̈ = −γ for the rows."""
        M, J = np.array(inertia), np.array(rows)
        n, k = len(force), len(rows)
        A = np.zeros((n + k, n + k))
        A[:n, :n], A[n:, :n], A[:n, n:] = M, J, J.T
        right = np.concatenate([force, [-g for g in bias]])
        return np.linalg.lstsq(A, right, rcond=1e-13)[0][:n].tolist()

    def rates(self, mode):
        def derivative(t, y):
            try:
                return self.evaluate(t, y.tolist(), mode)[0]
            except (OverflowError, ZeroDivisionError, ValueError):
                return [math.nan] * len(y)

        return derivative

    def guards(self, t, y, mode):
        """key -> (value, tolerance) of everything that can end the mode."""
        mode.branches.seen = {}
        self.evaluate(t, y.tolist(), mode)
        seen, mode.branches.seen = mode.branches.seen, None
        return seen

    def refresh(self, t, y, mode):
        """Enters the branches that the state now asks for, forgets those it does not."""
        seen = self.guards(t, y, mode)
        mode.branches.sides = {k: v for k, v in mode.branches.sides.items() if k in seen}

    # --- what follows an event ----------------------------------------------------------------

    def after(self, key, t, mode, y):
        """(mode, state, name) after the guard `key` has ended the mode."""
        mode, y = mode.copy(), y.copy()
        name = key[0]
        if name == "rest" or name == "release":
            label = self.release(t, mode, y) if name == "release" else self.settle(t, mode, y)
        elif name == "element":
            _, k, i, side = key
            mode.elements[k][i] = side
            if side:
                y[self.actuators[k].i_elements[i]] = side * self.actuators[k].muscle.hysteresis.reach[i]
            label = "element slips" if side else "element sticks"
        elif name == "spool stop":
            position, speed = self.actuators[key[1]].i_valve
            y[position], y[speed] = key[2], 0.0
            label = name
        elif name.startswith("compressor"):
            mode.running[key[1]] = name == "compressor starts"
            label = name
        elif name == "tendon stop":
            k = key[1]
            self.settle_tendon(t, mode, y, k)
            label = "stick" if mode.sliding[k] == 0 else "reversal"
        elif name == "tendon release":
            self.settle_tendon(t, mode, y, key[1])
            label = "break-away"
        else:
            mode.branches.sides[key] = not mode.branches.sides[key]
            label = " ".join(str(part) for part in key)
            if name == "slack":
                label = self.catch(t, mode, y, key[1])
            if name == "taut":
                mode.branches.sides.pop(("limit pulls", key[1]), None)
                mode.branches.sides.pop(("pulls", key[1]), None)
            if name == "stop":
                mode.branches.sides.pop(("stop presses", key[1]), None)
        self.turn_elements(mode, y, t)
        self.refresh(t, y, mode)
        return mode, y, label

    def turn_elements(self, mode, y, t):
        """Elements that slipped one way stick where the motion has turned."""
        for k, actuator in enumerate(self.actuators):
            if isinstance(actuator.muscle.hysteresis, MaxwellSlip) and mode.sliding[k]:
                mode.elements[k] = [0 if e == -mode.sliding[k] else e for e in mode.elements[k]]

    def catch(self, t, mode, y, k):
        """What follows a crossing of L_min by actuator k."""
        if not mode.branches.sides["slack", k]:
            return "slack"
        dry = self.actuators[k].muscle.dry.present
        speed = self.speeds(y, mode)[k]
        if isinstance(self.mechanism, Mass) and abs(speed) <= REST_VELOCITY:
            y[0], y[1] = self.actuators[k].muscle.braid.min_length, 0.0
            return self.settle(t, mode, y)
        if dry:
            mode.sliding[k] = 1 if speed > 0 else -1
        for name in ("pulls", "limit pulls"):
            mode.branches.sides.pop((name, k), None)
        return "catch"

    def speeds(self, y, mode):
        n = self.n
        q, qd = y[:n].tolist(), y[n : 2 * n].tolist()
        if isinstance(self.mechanism, Joint):
            self.mechanism.locate(mode.branches, q)
        return [sum(j * w for j, w in zip(row, qd, strict=True)) for row in self.mechanism.arms(q)]

    def settle(self, t, mode, y):
        """What follows where actuators have come to rest: all that rest decide together."""
        n = self.n
        mode.held_short = [False] * len(self.actuators)
        speeds = self.speeds(y, mode)
        fastest = max(1e-3, max(abs(s) for s in speeds))
        arms = self.mechanism.arms(y[:n].tolist())
        resting = [
            k
            for k, a in enumerate(self.actuators)
            if mode.sliding[k] is not None and not a.tendon and abs(speeds[k]) < 1e-9 * fastest
        ]
        inertia = self.mechanism.inertia(y[:n].tolist())
        if n == 1:
            y[1] = 0.0
        elif resting:
            J, M = np.array([arms[k] for k in resting]), np.array(inertia)
            W = J @ np.linalg.solve(M, J.T)
            y[n : 2 * n] -= np.linalg.solve(M, J.T @ np.linalg.lstsq(W, J @ y[n : 2 * n], rcond=1e-13)[0])
        free = mode.copy()
        free.branches.sides = {k: v for k, v in free.branches.sides.items() if k[0] not in ("pulls", "limit pulls")}
        for k in resting:
            free.sliding[k] = 1
        _, seen, _ = self.evaluate(t, y.tolist(), free)
        q, qd = y[:n].tolist(), y[n : 2 * n].tolist()
        force = self.mechanism.generalised_force(free.branches, q, qd)
        boxes = []
        for k in range(len(self.actuators)):
            boxes.append(seen[k]["box"] if k in resting else None)
            if k not in resting:
                tension = seen[k]["tension"]
                force = [f - j * tension for f, j in zip(force, arms[k], strict=True)]
        signs, _ = box_problem(inertia, force, arms, self.mechanism.bias(q, qd), boxes)
        for k, sign in signs.items():
            short = y[0] <= self.actuators[k].muscle.braid.min_length + LENGTH_TOLERANCE
            if isinstance(self.mechanism, Mass) and sign == 0 and short:
                mode.held_short[k] = True
            mode.sliding[k] = sign
            for name in ("pulls", "limit pulls"):
                mode.branches.sides.pop((name, k), None)
        return "stick" if 0 in signs.values() else "reversal"

    def release(self, t, mode, y):
        """The sticking ones that the facet pushes out begin to slide."""
        n = self.n
        _, seen, _ = self.evaluate(t, y.tolist(), mode)
        q, qd = y[:n].tolist(), y[n : 2 * n].tolist()
        stuck = [k for k in range(len(self.actuators)) if mode.sliding[k] == 0 and not seen[k]["slack"] and not self.actuators[k].tendon]
        arms = self.mechanism.arms(q)
        force = self.mechanism.generalised_force(mode.branches, q, qd)
        for k in range(len(self.actuators)):
            if k not in stuck:
                force = [f - j * seen[k]["tension"] for f, j in zip(force, arms[k], strict=True)]
        inertia, bias = self.mechanism.inertia(q), self.mechanism.bias(q, qd)
        rows = [arms[k] for k in stuck]
        a = [0.0] if n == 1 else self.constrained(inertia, force, rows, [bias[k] for k in stuck])
        need = [f - sum(m * x for m, x in zip(row, a, strict=True)) for f, row in zip(force, inertia, strict=True)]
        _, direction = gauge(rows, need, [seen[k]["box"] for k in stuck])
        for k in stuck:
            push = float(np.dot(arms[k], direction))
            if abs(push) > 1e-9 * max(abs(x) for x in arms[k]):
                mode.sliding[k] = 1 if push > 0 else -1
                mode.held_short[k] = False
                for name in ("pulls", "limit pulls"):
                    mode.branches.sides.pop((name, k), None)
        return "break-away"

    def settle_tendon(self, t, mode, y, k):
        """Which way the massless end of actuator k goes, if any."""
        probe = mode.copy()
        probe.sliding[k] = 0
        probe.branches.seen = {}
        _, seen, _ = self.evaluate(t, y.tolist(), probe)
        reserve = probe.branches.seen["tendon release", k][0]
        if mode.sliding[k] == 0 or reserve < 0:
            mode.sliding[k] = (1 if seen[k]["net"] > 0 else -1) if mode.sliding[k] == 0 or reserve < -1e-9 else 0
        else:
            mode.sliding[k] = 0

    # --- the start ----------------------------------------------------------------------------

    def begin(self):
        """(mode, state) at t = 0."""
        y = self.start.copy()
        count = len(self.actuators)
        mode = Mode(
            Branches(),
            [None] * count,
            [[0] * len(a.i_elements) for a in self.actuators],
            [bool(s.reservoir and s.reservoir.pressure < s.reservoir.cut_out) for s in self.supplies],
            [False] * count,
        )
        for k, actuator in enumerate(self.actuators):
            if actuator.muscle.dry.present and self.n:
                mode.sliding[k] = 0 if actuator.tendon else 1
        if self.n:
            speeds = self.speeds(y, mode)
            for k, actuator in enumerate(self.actuators):
                if mode.sliding[k] == 1 and speeds[k] < 0:
                    mode.sliding[k] = -1
                if not actuator.tendon and isinstance(self.mechanism, Mass):
                    low = actuator.muscle.braid.min_length
                    mode.branches.sides["slack", k] = y[0] > low or (y[0] == low and speeds[k] >= 0)
                    if mode.branches.sides["slack", k] and speeds[k] == 0 and y[0] == low:
                        self.settle(0.0, mode, y)
            for k, actuator in enumerate(self.actuators):
                if actuator.tendon and actuator.muscle.dry.present:
                    self.settle_tendon_at_start(mode, y, k)
            if any(s == 0 for s in speeds) and any(s is not None for s in mode.sliding):
                if not all(a.tendon for a in self.actuators):
                    self.settle(0.0, mode, y)
        self.refresh(0.0, y, mode)
        return mode, y

    def settle_tendon_at_start(self, mode, y, k):
        probe = mode.copy()
        probe.branches.seen = {}
        _, seen, _ = self.evaluate(0.0, y.tolist(), probe)
        if probe.branches.seen["tendon release", k][0] < 0:
            mode.sliding[k] = 1 if seen[k]["net"] > 0 else -1


def equilibrium(muscle, gauge_pressure, pull):
    """The L at which F_s + K_braid (L − L_max)⁺ is the load, or L_min if it is held there."""
    braid = muscle.braid

    def excess(length):
        stretch = max(0.0, length - braid.max_length)
        force, _, _ = muscle.static(Branches(), 0, length, gauge_pressure, 1e-5)
        return force + muscle.limit.stiffness * stretch - pull

    if excess(braid.min_length) >= 0:
        return braid.min_length
    longest = braid.max_length
    while excess(longest) < 0:
        longest += 1e-3
    return brentq(excess, braid.min_length, longest, xtol=1e-18, rtol=1e-15)
