"""Controllers: what is measured at t = k/f_s, what is decided, and the command of the valve: `docs/control.md`.

`Modulator` turns decisions into requests at instants; `Relay` and `Pid` regulate; `Tracker` and `ByModel` say what.
"""

import math
from dataclasses import dataclass

from .solenoid import SAME_INSTANT


@dataclass
class SetPoint:
    """A value, a sinusoid, or a table in steps or lines."""

    times: list
    values: list
    lines: bool = False
    sinusoid: tuple | None = None  # amplitude, frequency, phase

    def at(self, time):
        if self.sinusoid:
            amplitude, frequency, phase = self.sinusoid
            return self.values[0] + amplitude * math.sin(2 * math.pi * frequency * time + phase)
        passed = sum(t <= time + SAME_INSTANT for t in self.times)
        if passed == 0:
            return self.values[0]
        if self.lines and passed < len(self.times):
            t0, t1 = self.times[passed - 1 : passed + 1]
            w0, w1 = self.values[passed - 1 : passed + 1]
            return w0 + (w1 - w0) * (time - t0) / (t1 - t0)
        return self.values[passed - 1]


class Relay:
    """Fills once e > δ until e ≤ δ − h, exhausts once e < −δ until e ≥ h − δ, else holds."""

    def __init__(self, dead_band, hysteresis, can_hold):
        self.dead_band, self.hysteresis, self.can_hold = dead_band, hysteresis, can_hold
        self.state = "hold"

    def decide(self, target, measured):
        error = target - measured
        back = self.dead_band - self.hysteresis
        if error > self.dead_band or (self.state == "fill" and error > back):
            self.state = "fill"
        elif error < -self.dead_band or (self.state == "exhaust" and error < -back):
            self.state = "exhaust"
        elif self.can_hold:
            self.state = "hold"
        return self.state


class Pid:
    """The output is a duty cycle, signed where the valve can hold."""

    def __init__(self, band, integral_time, derivative_time, n, weight, tracking_time, bias, h, signed):
        self.gain, self.t_i, self.t_d, self.n, self.weight = 1 / band, integral_time, derivative_time, n, weight
        self.t_t, self.bias, self.h = tracking_time, bias, h
        self.low = -1.0 if signed else 0.0
        self.last = None

    def decide(self, target, measured):
        integral, derivative = 0.0, 0.0
        if self.last:
            y, w, integral, derivative, u, v = self.last
            derivative = (self.t_d * derivative - self.gain * self.t_d * self.n * (measured - y)) / (
                self.t_d + self.n * self.h
            )
            if self.t_i:
                integral += self.h * (self.gain * (w - y) / self.t_i + (u - v) / self.t_t)
        v = self.bias + self.gain * (self.weight * target - measured) + integral + derivative
        u = min(1.0, max(self.low, v))
        self.last = (measured, target, integral, derivative, u, v)
        return u


class Modulator:
    """The commands of one valve from decisions that arrive at sampling instants."""

    def __init__(self, frequency, can_hold):
        self.frequency, self.can_hold = frequency, can_hold
        self.duty = None
        self.period = 0
        self.pulse_end = math.inf

    def next_instant(self):
        begin = self.period / self.frequency if self.duty is not None else math.inf
        return min(begin, self.pulse_end)

    def rest(self):
        return "hold" if self.can_hold else "exhaust"

    def command(self, instant, drive):
        """Requests (instant, request) that follow from a new decision."""
        if isinstance(drive, str):
            self.duty, self.pulse_end = None, math.inf
            return [(instant, drive)]
        if self.duty is None:
            self.period = math.ceil(instant * self.frequency - 1e-9)
        self.duty = drive
        return []

    def pass_instant(self, instant):
        requests = []
        if self.pulse_end <= instant + SAME_INSTANT:
            requests.append((instant, self.rest()))
            self.pulse_end = math.inf
        if self.duty is not None and self.period / self.frequency <= instant + SAME_INSTANT:
            self.pulse_end = math.inf
            share = abs(self.duty)
            pulse = "fill" if self.duty > 0 else "exhaust"
            if share <= 0:
                requests.append((instant, self.rest()))
            else:
                requests.append((instant, pulse))
                if share < 1:
                    self.pulse_end = (self.period + share) / self.frequency
            self.period += 1
        return requests


def quantise(value, step):
    return step * math.floor(value / step + 0.5) if step else value


class Controller:
    """Samples, decides, and lets decisions take effect `delay` samples later.

    `measure(observation)` gives (target, measured) as shown; `sign` is −1 where more air makes less of it;
    `outputs` says for each actuator with which sign the error drives it.
    """

    def __init__(self, rate, delay, resolution, aim, regulators, modulators):
        self.rate, self.delay, self.resolution = rate, delay, resolution
        self.aim, self.regulators, self.modulators = aim, regulators, modulators
        self.sample = 0
        self.decided = []  # (index of the sample at which it takes effect, drives)
        self.shown = {}

    def next_instant(self):
        return min(self.sample / self.rate, *(m.next_instant() for m in self.modulators))

    def pass_instant(self, instant, observations):
        """Requests [(instant, actuator, request)] at this instant."""
        requests = []
        while self.sample / self.rate <= instant + SAME_INSTANT:
            self.shown, errors = self.aim(self.sample / self.rate, observations, self.resolution)
            drives = [r.decide(*e) for r, e in zip(self.regulators, errors, strict=True)]
            self.decided.append((self.sample + self.delay, drives))
            if self.decided[0][0] == self.sample:
                for k, drive in enumerate(self.decided.pop(0)[1]):
                    requests += [(t, k, r) for t, r in self.modulators[k].command(instant, drive)]
            self.sample += 1
        for k, modulator in enumerate(self.modulators):
            if modulator.next_instant() <= instant + SAME_INSTANT:
                requests += [(t, k, r) for t, r in modulator.pass_instant(instant)]
        return requests
