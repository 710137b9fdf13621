"""Through time: SciPy's steppers, restarted at every sample, every known instant and every event.

SciPy's `solve_ivp` is a loop around its stepper classes; the loop is written here instead, since an
event must be located by integration and not on the interpolant, which is of lower order:

1. a step is taken with the branches of the mode frozen; it may overshoot the end of the mode;
2. the guards are looked at on the interpolant; the first zero gives an estimate of the instant;
3. the integration is repeated from the beginning of the step so as to end on that instant, and the
   instant is corrected by the secant method until the guard of the integrated state vanishes;
4. the mode after the event is entered there. What was computed beyond the instant is thrown away.

Samples and known instants are ends of steps as well, so nothing that is written is interpolated.
"""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau
from scipy.optimize import brentq

from .branches import Branches
from .solenoid import SAME_INSTANT

METHODS = {"DOP853": DOP853, "Radau": Radau, "LSODA": LSODA}
LOOKS = (0.2, 0.6, 1.0)  # where in a step the guards are looked at


@dataclass
class Run:
    """What an integration gives: rows under a header, and the events as (instant, name)."""

    header: list = field(default_factory=list)
    rows: list = field(default_factory=list)
    events: list = field(default_factory=list)
    evaluations: int = 0

    def counts(self):
        return Counter(name for _, name in self.events)


class Integration:
    """One experiment, one tolerance."""

    def __init__(self, experiment, rtol=1e-12, method="DOP853"):
        self.experiment = experiment
        self.plant = experiment.plant(rtol)
        self.rtol, self.method = rtol, METHODS[method]
        self.proposed_step = None
        self.run = Run()

    def solver(self, mode, time, state, end):
        options = {"rtol": self.rtol, "atol": self.rtol * self.plant.scales}
        if self.proposed_step:
            options["first_step"] = min(self.proposed_step, end - time)
        return self.method(self.plant.rates(mode), time, state, end, **options)

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

    def first_event(self, mode, solver, before):
        """(estimate of the instant, key, offset) of the first guard that fires, or None, and the last values.

        The offset is the guard's tolerance if the guard was never above zero, else 0.
        """
        start = solver.t_old
        left = dict.fromkeys(before, start)
        offset = {key: 0.0 if value > 0 else tolerance for key, (value, tolerance) in before.items()}
        values = self.plant.guards(solver.t, solver.y, mode)
        dense = None
        for look in LOOKS:
            right = start + look * (solver.t - start)
            if look < 1:
                if dense is None:
                    dense = solver.dense_output()
                seen = self.plant.guards(right, dense(right), mode)
            else:
                seen = values
            fired = [key for key, (value, tolerance) in seen.items() if value < -tolerance and key in left]
            if fired:
                if dense is None:
                    dense = solver.dense_output()
                return min(
                    (*self.crossing(mode, key, offset[key], dense, left[key], right), key) for key in fired
                ), values
            for key, (value, _) in seen.items():
                if key in left and value + offset[key] > 0:
                    left[key] = right
                    offset[key] = 0.0 if value > 0 else offset[key]
        return None, values

    def crossing(self, mode, key, offset, dense, left, right):
        """(instant, offset) of the zero of guard + offset on the interpolant; the offset is dropped if not needed."""

        def along(t):
            return self.plant.guards(t, dense(t), mode)[key][0] + offset

        if offset > 0:  # began at zero: did it rise before it fell?
            for halving in range(1, 40):
                inside = left + (right - left) * 0.5**halving
                if along(inside) > offset:
                    left, offset = inside, 0.0
                    break
        if along(left) <= 0:
            return left, offset
        if along(right) >= 0:
            return right, offset
        return brentq(along, left, right, xtol=1e-16, rtol=1e-15), offset

    def land(self, mode, time, state, estimate, key, offset, latest):
        """The instant and the state at which the guard of the integrated state vanishes."""

        def guard(t, y):
            return self.plant.guards(t, y, mode)[key][0] + offset

        instant = min(max(estimate, time), latest)
        landed = self.integrate(mode, time, state, instant)
        value = guard(instant, landed)
        other = max(time, instant - 1e-3 * (latest - time))
        if other == instant:
            return instant, landed
        other_value = guard(other, self.integrate(mode, time, state, other))
        for _ in range(4):
            if value == other_value or value == 0:
                break
            corrected = instant - value * (instant - other) / (value - other_value)
            corrected = min(max(corrected, time), latest)
            if abs(corrected - instant) < 2 * np.spacing(instant):
                break
            candidate = self.integrate(mode, time, state, corrected)
            candidate_value = guard(corrected, candidate)
            if abs(candidate_value) >= abs(value):
                break
            other, other_value = instant, value
            instant, landed, value = corrected, candidate, candidate_value
        return instant, landed

    def advance(self, mode, time, state, end):
        """The mode and the state at `end`, through all events before it."""
        without_progress = 0
        while end - time > SAME_INSTANT / 100:
            before = self.plant.guards(time, state, mode)
            solver = self.solver(mode, time, state, end)
            event = None
            while solver.status == "running" and event is None:
                old = solver.y.copy()
                self.step(solver)
                event, values = self.first_event(mode, solver, before)
                if event is None:
                    before = values
                    self.proposed_step = getattr(solver, "h_abs", None)
            self.run.evaluations += solver.nfev
            if event is None:
                return mode, solver.y
            estimate, offset, key = event
            instant, state = self.land(mode, solver.t_old, old, estimate, key, offset, solver.t)
            without_progress = without_progress + 1 if instant - time < 1e-15 else 0
            if without_progress > 20:
                raise RuntimeError(f"no progress at t = {time} s in {mode} ({key})")
            time = instant
            mode, state, label = self.plant.after(key, time, mode, state)
            self.run.events.append((time, label))
            self.proposed_step = None
        return mode, state

    def sample_instants(self):
        interval, duration = self.experiment.sample_interval, self.experiment.duration
        count = int(duration / interval * (1 + 1e-12))
        samples = [k * interval for k in range(count + 1)]
        if duration - samples[-1] > SAME_INSTANT:
            samples.append(duration)
        return samples

    def observe(self, time, mode, state):
        _, seen, _ = self.plant.evaluate(time, state.tolist(), mode)
        return seen

    def known_instant(self):
        """The next instant at which something is known to happen, beside samples."""
        instants = [np.inf]
        for k, actuator in enumerate(self.plant.actuators):
            if actuator.valve:
                instants.append(actuator.valve.next_instant())
            if self.commands[k]:
                instants.append(self.commands[k][0][0])
        if self.experiment.controller:
            instants.append(self.experiment.controller.next_instant())
        instants += self.knots[:1]
        return min(instants)

    def pass_known(self, time, mode, state):
        """Everything known to happen at this instant: measurements, seats, then coils."""
        requests = []
        if self.experiment.controller and self.experiment.controller.next_instant() <= time + SAME_INSTANT:
            seen = self.observe(time, mode, state)
            for item in seen:
                item["state"] = state
            requests = self.experiment.controller.pass_instant(time, seen)
        self.pass_seats(time)
        for k, actuator in enumerate(self.plant.actuators):
            while self.commands[k] and self.commands[k][0][0] <= time + SAME_INSTANT:
                instant, request = self.commands[k].pop(0)
                actuator.valve.request(instant, request)
        for instant, k, request in requests:
            self.plant.actuators[k].valve.request(instant, request)
        self.pass_seats(time)
        if self.knots and self.knots[0] <= time + SAME_INSTANT:
            while self.knots and self.knots[0] <= time + SAME_INSTANT:
                self.knots.pop(0)
            mode.branches = Branches()
            self.experiment.pass_knot(time)
            speed = self.plant.mechanism.motion(time)[1] if not self.plant.n else 0.0
            mode.elements = [[0 if e * speed < 0 else e for e in row] for row in mode.elements]
        self.plant.refresh(time, state, mode)

    def pass_seats(self, time):
        for actuator in self.plant.actuators:
            while actuator.valve and actuator.valve.next_instant() <= time + SAME_INSTANT:
                actuator.valve.pass_instant(time)
                self.run.events.append((time, "valve edge"))

    def simulate(self):
        """The whole run."""
        self.commands = self.experiment.commands()
        self.knots = [t for t in self.experiment.knots if t > SAME_INSTANT]
        self.run.header = self.experiment.header
        while True:  # what happens at t = 0, before the mechanism is looked at
            for k, actuator in enumerate(self.plant.actuators):
                while self.commands[k] and self.commands[k][0][0] <= SAME_INSTANT:
                    instant, request = self.commands[k].pop(0)
                    actuator.valve.request(instant, request)
            break
        self.pass_seats(0.0)
        mode, state = self.plant.begin()
        time = 0.0
        if self.experiment.controller:
            self.pass_known(0.0, mode, state)
        for sample in self.sample_instants():
            while self.known_instant() <= sample + SAME_INSTANT:
                instant = self.known_instant()
                mode, state = self.advance(mode, time, state, instant)
                time = max(time, instant)
                self.pass_known(time, mode, state)
            mode, state = self.advance(mode, time, state, sample)
            time = max(time, sample)
            self.run.rows.append(self.experiment.row(sample, self.plant, self.observe(time, mode, state), state, mode))
        return self.run
