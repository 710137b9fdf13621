"""The same hybrid system through SciPy: `solve_ivp`, restarted at every valve edge and event.

    python scipy_peer.py METHOD TOLERANCE REPEATS < problem

prints `seconds evaluations steps guard-evaluations events`, then length and pressure of each sample.
Seconds are the shortest of the repeats and hold the solving only, not the start of Python.
The physics is that of `muscle.c`, in plain floats; a mode's closures hold only its own branches.
"""

import sys
from dataclasses import dataclass, replace
from math import copysign, nan, pi, sqrt
from time import perf_counter
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

CLOSED, SUPPLY, EXHAUST = -1, 0, 1
CHOKED_IN, SUBSONIC_IN, LAMINAR_IN, LAMINAR_OUT, SUBSONIC_OUT, CHOKED_OUT = range(6)
SLACK, FREE, TAUT, REBOUND = range(4)


@dataclass(frozen=True)
class Mode:
    port: int
    zone: int = CHOKED_IN
    regime: int = FREE
    sliding: int = 1  # +1 lengthening, -1 shortening, 0 stuck
    clamped: bool = False


def read(stream):
    """The numbers of the problem and what follows from them."""
    k = SimpleNamespace()
    for line in stream:
        name, value = line.split()
        setattr(k, name, float(value))
        if name == "edges":
            break
    k.switches = [(float(t), int(port)) for t, port in (line.split() for line in stream)]
    g, r_lam = k.gamma, k.laminar_ratio
    k.inverse_turns = 1 / (4 * pi * k.turns**2)
    k.critical = (2 / (g + 1)) ** (g / (g - 1))
    k.throat = k.area * sqrt(2 * g / (k.gas_constant * (g - 1)))
    k.choked = k.area * sqrt(g / k.gas_constant * (2 / (g + 1)) ** ((g + 1) / (g - 1)))
    k.laminar = k.throat * sqrt(r_lam ** (2 / g) - r_lam ** ((g + 1) / g)) / (1 - r_lam)
    ratios = lambda p: (p * k.critical, p * r_lam, p, p / r_lam, p / k.critical)  # noqa: E731
    k.bounds = (ratios(k.supply), ratios(k.atmosphere))
    return k


class Muscle:
    """Rates and guards of each mode, and what follows a guard."""

    def __init__(self, k, tolerance):
        self.k = k
        self.band = max(tolerance, 1e-12)
        self.force_band = self.band * k.pull
        self.rest_band = self.band * k.velocity_scale

    def static_force(self, length, pressure):
        k = self.k
        return (pressure - k.atmosphere) * (3 * length**2 - k.thread_length**2) * k.inverse_turns

    def coulomb(self, length, pressure):
        k = self.k
        gauge = max(pressure - k.atmosphere, 0.0)
        return k.coulomb_width * 3 * gauge * (length + k.min_length) * k.inverse_turns

    def limit(self, length, velocity):
        k = self.k
        return k.stiffness * (length - k.max_length) + k.damping * velocity

    def force(self, mode, length, velocity, pressure):
        total = self.static_force(length, pressure) + self.k.viscous * velocity
        total += mode.sliding * self.coulomb(length, pressure)
        return total + self.limit(length, velocity) if mode.regime == TAUT else total

    def flow(self, mode):
        """Net flow in kg/s as a function of pressure, mass and volume."""
        k, zone = self.k, mode.zone
        if mode.port == CLOSED:
            return lambda pressure, mass, volume: 0.0
        beyond = k.supply if mode.port == SUPPLY else k.atmosphere
        throat, inverse, gas, laminar = k.throat, 1 / k.gamma, k.gas_constant, k.laminar
        root = sqrt(k.temperature)

        def subsonic(up, ratio):
            if ratio <= 0:
                return nan  # a trial stage has left the physics: the step becomes shorter
            power = ratio**inverse
            under = power * (power - ratio)  # continued as an odd function beyond ratio 1
            return copysign(throat * up * sqrt(abs(under)), under)

        if zone == CHOKED_IN:
            constant = k.choked * beyond / root
            return lambda pressure, mass, volume: constant
        if zone == SUBSONIC_IN:
            return lambda pressure, mass, volume: subsonic(beyond, pressure / beyond) / root
        if zone == LAMINAR_IN:
            return lambda pressure, mass, volume: laminar * (beyond - pressure) / root
        if zone == LAMINAR_OUT:
            law = lambda pressure: laminar * (pressure - beyond)  # noqa: E731
        elif zone == SUBSONIC_OUT:
            law = lambda pressure: subsonic(pressure, beyond / pressure)  # noqa: E731
        else:
            law = lambda pressure: k.choked * pressure  # noqa: E731

        def outward(pressure, mass, volume):
            temperature = pressure * volume / (mass * gas)
            return -law(pressure) / sqrt(temperature) if temperature > 0 else nan

        return outward

    def rates(self, mode):
        k, flow = self.k, self.flow(mode)
        gamma, pull, load, external = k.gamma, k.pull, k.mass, k.external_volume
        thread2, turns = k.thread_length**2, k.inverse_turns
        slack, stuck = mode.regime == SLACK, mode.sliding == 0
        pulls = not (slack or stuck or mode.clamped)
        atmosphere, viscous = k.atmosphere, k.viscous
        secant, shortest = mode.sliding * k.coulomb_width * 3, k.min_length
        taut = mode.regime == TAUT
        stiffness, damping, longest = k.stiffness, k.damping, k.max_length

        def derivative(_time, state):
            length, velocity, pressure, mass = state.tolist()
            if slack:
                volume, volume_rate = shortest * (thread2 - shortest**2) * turns + external, 0.0
            else:
                square = length * length
                volume = length * (thread2 - square) * turns + external
                volume_rate = 0.0 if stuck else (thread2 - 3 * square) * turns * velocity
            net = flow(pressure, mass, volume)
            pressure_rate = gamma * pressure * (net / mass - volume_rate / volume)
            if stuck:
                return 0.0, 0.0, pressure_rate, net
            tension = 0.0
            if pulls:
                gauge = (pressure - atmosphere) * turns
                tension = gauge * (3 * square - thread2) + viscous * velocity
                if gauge > 0:
                    tension += secant * gauge * (length + shortest)
                if taut:
                    tension += stiffness * (length - longest) + damping * velocity
            return velocity, (pull - tension) / load, pressure_rate, net

        return derivative

    def holdable(self, length, pressure):
        bound = self.coulomb(length, pressure)
        middle = self.static_force(length, pressure) + max(self.limit(length, 0.0), 0.0)
        least = 0.0 if length <= self.k.min_length else max(middle - bound, 0.0)
        return least, max(middle + bound, 0.0)

    def guards(self, mode):
        """(name, function of time and state) of each way in which the mode can end."""
        k, band = self.k, self.force_band
        guards = []
        if mode.port != CLOSED:
            bounds = k.bounds[mode.port]
            if mode.zone > CHOKED_IN:
                low = bounds[mode.zone - 1] * (1 - self.band)
                guards.append(("pressure down", lambda _, y: y[2] - low))
            if mode.zone < CHOKED_OUT:
                high = bounds[mode.zone] * (1 + self.band)
                guards.append(("pressure up", lambda _, y: high - y[2]))
        if mode.regime == SLACK:
            return [*guards, ("tight", lambda _, y: k.min_length - y[0])]
        if mode.sliding == 0:
            longer = lambda _, y: self.holdable(y[0], y[2])[1] + band - k.pull  # noqa: E731
            shorter = lambda _, y: k.pull - self.holdable(y[0], y[2])[0] + band  # noqa: E731
            return [*guards, ("break longer", longer), ("break shorter", shorter)]
        sliding, sign = mode.sliding, -1 if mode.clamped else 1
        # A motion that begins at rest and comes to rest within one step must not be found at its beginning.
        guards.append(("rest", lambda _, y: sliding * y[1] + self.rest_band))
        if mode.regime == FREE:
            guards.append(("slack", lambda _, y: y[0] - k.min_length))
            guards.append(("taut", lambda _, y: k.max_length - y[0]))
        elif mode.regime == TAUT:
            guards.append(("rebound", lambda _, y: self.limit(y[0], y[1])))
        else:
            guards.append(("taut end", lambda _, y: y[0] - k.max_length))
            guards.append(("retaut", lambda _, y: -self.limit(y[0], y[1])))
        guards.append(("tension", lambda _, y: sign * self.force(mode, y[0], y[1], y[2]) + band))
        return guards

    def with_clamp(self, mode, state):
        moves = mode.regime != SLACK and mode.sliding != 0
        return replace(mode, clamped=bool(moves and self.force(mode, *state[:3]) < 0))

    def slide(self, mode, state, sliding):
        slack = sliding < 0 and state[0] <= self.k.min_length
        regime = SLACK if slack else mode.regime
        return self.with_clamp(replace(mode, sliding=sliding, regime=regime), state)

    def rest_or_slide(self, mode, state):
        least, most = self.holdable(state[0], state[2])
        pull = self.k.pull
        longer, shorter = pull > most + self.force_band, pull < least - self.force_band
        return self.slide(mode, state, 1 if longer else -1 if shorter else 0)

    def rests_on_the_stop(self, state):
        most = self.holdable(state[0], state[2])[1]
        acceleration = min(self.k.pull, most - self.k.pull) / self.k.mass
        height = self.band * self.k.max_length
        return acceleration > 0 and state[1] ** 2 <= 2 * acceleration * height

    def open(self, mode, state, port):
        zone = 0 if port == CLOSED else sum(state[2] > bound for bound in self.k.bounds[port])
        return replace(mode, port=port, zone=zone)

    def begin(self, state):
        k = self.k
        mode = self.open(Mode(CLOSED, sliding=-1 if state[1] < 0 else 1), state, int(k.initial_port))
        if state[0] > k.max_length:
            mode = replace(mode, regime=TAUT if self.limit(*state[:2]) >= 0 else REBOUND)
        elif state[0] < k.min_length:
            mode = replace(mode, regime=SLACK)
        if state[1] == 0 and mode.regime != SLACK:
            mode = self.rest_or_slide(mode, state)
        return self.with_clamp(mode, state)

    def cross(self, event, mode, state):
        """The mode after an event; the state is reset onto the border where the event is one."""
        k = self.k
        if event == "pressure down":
            return replace(mode, zone=mode.zone - 1)
        if event == "pressure up":
            return replace(mode, zone=mode.zone + 1)
        if event in ("slack", "tight"):
            state[0] = k.min_length
            if self.rests_on_the_stop(state):
                state[1] = 0.0
                return self.slide(replace(mode, regime=FREE), state, 0)
            if event == "slack":
                return self.with_clamp(replace(mode, regime=SLACK), state)
            return self.slide(replace(mode, regime=FREE), state, 1)
        if event in ("taut", "taut end"):
            state[0] = k.max_length
        if event in ("taut", "retaut", "rebound", "taut end"):
            regime = {"rebound": REBOUND, "taut end": FREE}.get(event, TAUT)
            return self.with_clamp(replace(mode, regime=regime), state)
        if event == "rest":
            state[1] = 0.0
            return self.rest_or_slide(mode, state)
        if event == "tension":
            return replace(mode, clamped=not mode.clamped)
        return self.slide(mode, state, 1 if event == "break longer" else -1)


def simulate(k, method, tolerance):
    """Length and pressure at the samples, and the counts of evaluations, steps and events."""
    muscle = Muscle(k, tolerance)
    state = np.array([k.length, k.velocity, k.pressure, k.air_mass])
    scales = [k.length_scale, k.velocity_scale, k.pressure_scale, k.air_mass_scale]
    absolute = 0.1 * tolerance * np.array(scales)
    mode = muscle.begin(state.tolist())
    instants = np.arange(round(k.duration / k.sample_interval) + 1) * k.sample_interval
    rows = [(k.length, k.pressure)]
    evaluations = steps = events = 0
    time = 0.0
    for stop, port in [*k.switches, (k.duration, None)]:
        while time < stop:
            names, functions = zip(*muscle.guards(mode))
            for function in functions:
                function.terminal, function.direction = True, -1
            solution = solve_ivp(
                muscle.rates(mode),
                (time, stop),
                state,
                method=method,
                rtol=tolerance,
                atol=absolute,
                events=functions,
                dense_output=True,
            )
            if solution.status < 0:
                raise RuntimeError(f"at {solution.t[-1]} s: {solution.message}")
            evaluations += solution.nfev
            steps += len(solution.t) - 1
            events += 1
            time, state = float(solution.t[-1]), solution.y[:, -1].copy()
            ready = instants[len(rows) : np.searchsorted(instants, time + 1e-13)]
            if len(ready):
                values = solution.sol(ready)
                rows.extend(zip(values[0].tolist(), values[2].tolist()))
            if solution.status == 0:
                time = stop
                break
            plain = state.tolist()
            for name, instants_of_event in zip(names, solution.t_events):
                if len(instants_of_event):
                    mode = muscle.cross(name, mode, plain)
            state = np.array(plain)
        if port is not None:
            mode = muscle.open(mode, state.tolist(), port)
    return rows, evaluations, steps, events


def main():
    method, tolerance, repeats = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
    problem = read(sys.stdin)
    best = float("inf")
    for _ in range(repeats):
        before = perf_counter()
        rows, evaluations, steps, events = simulate(problem, method, tolerance)
        best = min(best, perf_counter() - before)
    print(f"{best:.9g} {evaluations} {steps} 0 {events}")
    for length, pressure in rows:
        print(f"{length!r} {pressure!r}")


if __name__ == "__main__":
    main()
