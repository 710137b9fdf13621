"""Through time: SciPy's steppers, restarted at every sample, valve edge and event.

SciPy's `solve_ivp` is a loop around its stepper classes; the loop is written here instead, since an
event must be located by integration and not on the interpolant, which is of lower order:

1. a step is taken with the branches of the mode frozen; it may overshoot the end of the mode;
2. the guards are looked at on the interpolant; the first zero gives an estimate of the instant;
3. the integration is repeated from the beginning of the step so as to end on that instant, and the
   instant is corrected by the secant method until the guard of the integrated state vanishes;
4. the mode after the event is entered there. What was computed beyond the instant is thrown away.

Samples and valve edges are ends of steps as well, so nothing that is written is interpolated.
"""

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau
from scipy.optimize import brentq

from .modes import Model
from .solenoid import SAME_INSTANT, port_movements

METHODS = {"DOP853": DOP853, "Radau": Radau, "LSODA": LSODA}
STATE_SCALE = np.array([1e-2, 1e-1, 1e4, 1e-6])  # atol = rtol × this: m, m/s, Pa, kg
PORTS = ("supply", "exhaust")
LOOKS = np.linspace(0.0, 1.0, 9)[1:]  # where in a step the guards are looked at
COLUMNS = (
    "time_s,length_m,velocity_m_s,pressure_pa,air_mass_kg,temperature_k,"
    "volume_m3,tension_n,mass_flow_kg_s,valve"
).split(",")


@dataclass
class Run:
    """What an integration gives: rows of `COLUMNS`, and the events as (instant, name)."""

    rows: list = field(default_factory=list)
    events: list = field(default_factory=list)
    evaluations: int = 0

    def counts(self):
        return Counter(name for _, name in self.events)


class Integration:
    """One scenario, one tolerance."""

    def __init__(self, scenario, rtol=1e-12, method="DOP853"):
        self.model = Model(scenario, rtol)
        self.scenario = scenario
        self.rtol, self.method = rtol, METHODS[method]
        self.proposed_step = None
        self.run = Run()

    def solver(self, mode, time, state, end):
        options = {"rtol": self.rtol, "atol": self.rtol * STATE_SCALE}
        if self.proposed_step:
            options["first_step"] = min(self.proposed_step, end - time)
        return self.method(self.model.rates(mode), time, state, end, **options)

    def integrate(self, mode, time, state, end):
        """The state at `end` in a frozen mode; only over the span of a step already accepted."""
        if end <= time:
            return state.copy()
        saved, self.proposed_step = self.proposed_step, end - time
        solver = self.solver(mode, time, state, end)
        self.proposed_step = saved
        while solver.status == "running":
            self.step(solver)
        self.run.evaluations += solver.nfev
        return solver.y

    @staticmethod
    def step(solver):
        message = solver.step()
        if solver.status == "failed":
            raise RuntimeError(f"at t = {solver.t} s: {message}")

    def first_event(self, guards, solver, before):
        """(estimate of the instant, name, function) of the first guard that fires, or None.

        The function is the guard, lowered by its tolerance if the guard was never above zero.
        """
        looks = [solver.t_old + look * (solver.t - solver.t_old) for look in LOOKS]
        dense = None
        states = [solver.y.tolist()]
        earliest = None
        for name, tolerance, guard in guards:
            left, offset = solver.t_old, 0.0 if guard(before.tolist()) > 0 else tolerance
            for index, right in enumerate(looks):
                if dense is None:
                    dense = solver.dense_output()
                    states = [*(dense(look).tolist() for look in looks[:-1]), *states]
                value = guard(states[index])
                if value < -tolerance:
                    estimate, offset = self.crossing(guard, offset, dense, left, right)
                    if earliest is None or estimate < earliest[0]:
                        earliest = (estimate, name, lambda y, g=guard, o=offset: g(y.tolist()) + o)
                    break
                if value + (0.0 if value > 0 else offset) > 0:
                    left = right
                    offset = 0.0 if value > 0 else offset
        return earliest

    @staticmethod
    def crossing(guard, offset, dense, left, right):
        """The zero of guard + offset on the interpolant; the offset is dropped if not needed."""

        def along(t):
            return guard(dense(t).tolist()) + offset

        if offset > 0:  # began at zero: did it rise before it fell?
            for halving in range(1, 40):
                inside = left + (right - left) * 0.5**halving
                if guard(dense(inside).tolist()) > 0:
                    left, offset = inside, 0.0
                    break
        if along(left) <= 0:
            return left, offset
        if along(right) >= 0:
            return right, offset
        return brentq(along, left, right, xtol=1e-16, rtol=1e-15), offset

    def land(self, mode, time, state, estimate, guard, latest):
        """The instant and the state at which the guard of the integrated state vanishes."""
        instant = min(max(estimate, time), latest)
        landed = self.integrate(mode, time, state, instant)
        value = guard(landed)
        other = max(time, instant - 1e-3 * (latest - time))
        if other == instant:
            return instant, landed
        other_value = guard(self.integrate(mode, time, state, other))
        for _ in range(4):
            if value == other_value or value == 0:
                break
            corrected = instant - value * (instant - other) / (value - other_value)
            corrected = min(max(corrected, time), latest)
            if abs(corrected - instant) < 2 * np.spacing(instant):
                break
            candidate = self.integrate(mode, time, state, corrected)
            candidate_value = guard(candidate)
            if abs(candidate_value) >= abs(value):
                break
            other, other_value = instant, value
            instant, landed, value = corrected, candidate, candidate_value
        return instant, landed

    def advance(self, mode, time, state, end):
        """The mode and the state at `end`, through all events before it."""
        without_progress = 0
        while end - time > SAME_INSTANT / 100:
            guards = self.model.guards(mode)
            solver = self.solver(mode, time, state, end)
            event = None
            while solver.status == "running" and event is None:
                before = solver.y.copy()
                self.step(solver)
                event = self.first_event(guards, solver, before)
                if event is None:
                    self.proposed_step = getattr(solver, "h_abs", None)
            self.run.evaluations += solver.nfev
            if event is None:
                return mode, solver.y
            estimate, name, guard = event
            instant, state = self.land(mode, solver.t_old, before, estimate, guard, solver.t)
            without_progress = without_progress + 1 if instant - time < 1e-15 else 0
            if without_progress > 20:
                raise RuntimeError(f"no progress at t = {time} s in {mode} ({name})")
            time = instant
            mode, state, label = self.model.after(name, mode, state)
            if label:
                self.run.events.append((time, label))
            self.proposed_step = None
        return mode, state

    def record(self, time, mode, state):
        """One row, with the values after everything that happens at this instant."""
        length, velocity, pressure, mass = state.tolist()
        model = self.model
        volume = model.volume(mode, length)
        ports = [name for name, is_open in zip(PORTS, mode.ports, strict=True) if is_open]
        self.run.rows.append(
            (
                time,
                length,
                velocity,
                pressure,
                mass,
                pressure * volume / (mass * self.scenario.air.gas_constant),
                volume,
                model.tension(mode, length, velocity, pressure),
                float(sum(model.flows(mode, length, pressure, mass))),
                "+".join(ports) or "closed",
            )
        )

    def sample_instants(self):
        interval, duration = self.scenario.sample_interval, self.scenario.duration
        count = int(duration / interval * (1 + 1e-12))
        samples = [k * interval for k in range(count + 1)]
        if duration - samples[-1] > SAME_INSTANT:
            samples.append(duration)
        return samples

    def simulate(self):
        """The whole run."""
        valve = self.scenario.valve
        movements = [(-np.inf, (False, False))]
        if valve:
            movements = port_movements(
                valve.kind,
                self.scenario.command,
                valve.opening_delay,
                valve.closing_delay,
                self.scenario.duration,
            )
        mode, state = self.model.start(movements[0][1])
        state = np.array(state, dtype=float)
        mode, state = self.model.start_motion(mode, state)
        movements = movements[1:]
        time = 0.0
        for sample in self.sample_instants():
            while movements and movements[0][0] <= sample + SAME_INSTANT:
                edge, ports = movements.pop(0)
                mode, state = self.advance(mode, time, state, edge)
                time = max(time, edge)
                self.run.events.append((edge, "valve edge"))
                mode = replace(mode, ports=ports)
            mode, state = self.advance(mode, time, state, sample)
            time = max(time, sample)
            self.record(sample, mode, state)
        return self.run
