"""When seats move and how far they are open: model section 6 and `docs/valves.md`.

A valve is given requests as time goes on (`request`), says when it does something next (`next_instant`), does it
(`pass_instant`), and says how far its two flow paths are open in between (`openings`, straight lines in time).
Before t = 0 every coil has been released for long. All instants are shifted by `late`, the delay of a hose.
"""

import math

from .solenoid import SAME_INSTANT


class Seat:
    """One coil and its seat: dead times, then a straight line from shut to open."""

    def __init__(self, opening_delay, closing_delay, opening_time, closing_time):
        self.delays = (closing_delay, opening_delay)
        self.times = (closing_time, opening_time)
        self.energised = False
        self.sent = False  # where the seat is going, or is
        self.pending = math.inf
        self.since, self.start, self.slope = 0.0, 0.0, 0.0  # λ = start + slope (t − since)

    def drive(self, instant, energised):
        if energised == self.energised:
            return
        self.energised = energised
        self.pending = math.inf
        if energised != self.sent:
            self.pending = instant + self.delays[energised]

    def arrival(self):
        if self.slope == 0:
            return math.inf
        end = 1.0 if self.slope > 0 else 0.0
        return self.since + (end - self.start) / self.slope

    def next_instant(self):
        return min(self.pending, self.arrival())

    def pass_instant(self, instant):
        if self.arrival() <= instant + SAME_INSTANT:
            self.since, self.start, self.slope = instant, 1.0 if self.slope > 0 else 0.0, 0.0
        if self.pending <= instant + SAME_INSTANT:
            self.pending = math.inf
            opening = self.opening(instant)
            self.sent = self.energised
            time = self.times[self.sent]
            self.since = instant
            if time > 0:
                self.start, self.slope = opening, (1.0 if self.sent else -1.0) / time
            else:
                self.start, self.slope = float(self.sent), 0.0

    def opening(self, time):
        return self.start + self.slope * (time - self.since)

    @property
    def is_open(self):
        return self.start > 0 or self.slope > 0

    @property
    def is_shut(self):
        return self.start < 1 or self.slope < 0


# kind -> for each coil the request that energises it; how (λ of the coils) becomes (λ_supply, λ_exhaust)
COILS = {
    "two-way": ("fill",),
    "three-way": ("fill",),
    "three-way-normally-open": ("exhaust",),
    "fill-hold-exhaust": ("fill", "exhaust"),
    # the outputs of five-way valves: A and, with ' B', B
    "five-way": ("fill",),
    "five-way B": ("fill",),
    "five-way-closed": ("fill", "exhaust"),
    "five-way-closed B": ("fill", "exhaust"),
    "five-way-exhausted": ("fill", "exhaust"),
    "five-way-exhausted B": ("fill", "exhaust"),
    "five-way-pressurised": ("fill", "exhaust"),
    "five-way-pressurised B": ("fill", "exhaust"),
}
PATHS = {
    "two-way": lambda a: (a, 0.0),
    "three-way": lambda a: (a, 1 - a),
    "three-way-normally-open": lambda a: (1 - a, a),
    "fill-hold-exhaust": lambda a, b: (a, b),
    "five-way": lambda a: (a, 1 - a),
    "five-way B": lambda a: (1 - a, a),
    "five-way-closed": lambda a, b: (a, b),
    "five-way-closed B": lambda a, b: (b, a),
    "five-way-exhausted": lambda a, b: (a, 1 - a),
    "five-way-exhausted B": lambda a, b: (b, 1 - b),
    "five-way-pressurised": lambda a, b: (1 - b, b),
    "five-way-pressurised B": lambda a, b: (1 - a, a),
}


class SeatValve:
    """Solenoid seats of any kind."""

    states = 0
    follows_set_points = False

    def __init__(self, kind, opening_delay, closing_delay, opening_time, closing_time, late):
        self.kind, self.late = kind, late
        delays = (opening_delay, closing_delay, opening_time, closing_time)
        self.seats = [Seat(*delays) for _ in COILS[kind]]
        self.not_shut = self.find_not_shut()

    def request(self, instant, request):
        for seat, energises in zip(self.seats, COILS[self.kind], strict=True):
            seat.drive(instant + self.late, request == energises)

    def next_instant(self):
        return min(seat.next_instant() for seat in self.seats)

    def pass_instant(self, instant):
        for seat in self.seats:
            seat.pass_instant(instant)
        self.not_shut = self.find_not_shut()

    def openings(self, time):
        return PATHS[self.kind](*(seat.opening(time) for seat in self.seats))

    def open_ports(self):
        """(supply, exhaust) not shut."""
        return self.not_shut

    def find_not_shut(self):
        opened = PATHS[self.kind](*(float(seat.is_open) for seat in self.seats))
        shut = PATHS[self.kind](*(float(not seat.is_shut) for seat in self.seats))
        return tuple(a > 0 or b > 0 for a, b in zip(opened, shut, strict=True))


class Spool:
    """ẍ = ω²(u − x) − 2ζω ẋ as two states; edges with overlap, stops that take the speed."""

    states = 2
    follows_set_points = False

    def __init__(self, natural_frequency, damping_ratio, supply_overlap, exhaust_overlap, late):
        self.omega, self.zeta = 2 * math.pi * natural_frequency, damping_ratio
        self.overlaps, self.late = (supply_overlap, exhaust_overlap), late
        self.coming = []
        self.position = 0.0

    def request(self, instant, position):
        self.coming.append((instant + self.late, position))

    def next_instant(self):
        return self.coming[0][0] if self.coming else math.inf

    def pass_instant(self, instant):
        while self.coming and self.coming[0][0] <= instant + SAME_INSTANT:
            self.position = self.coming.pop(0)[1]

    def rates(self, branches, key, x, speed):
        branches.guard(("spool stop", key, 1), 1 - x, 1e-13)
        branches.guard(("spool stop", key, -1), 1 + x, 1e-13)
        return speed, self.omega**2 * (self.position - x) - 2 * self.zeta * self.omega * speed

    def uncovered(self, branches, key, x):
        """(λ_supply, λ_exhaust)."""
        openings = []
        for side, overlap in zip((1, -1), self.overlaps, strict=True):
            opened = branches.positive(("spool edge", key, side), side * x - overlap, 1e-13)
            openings.append((side * x - overlap) / (1 - overlap) if opened else 0.0)
        return tuple(openings)


class RegulatorValve:
    """dp/dt = max(−q, min(q, (u(t − θ) − p)/τ)) as one state."""

    states = 1
    follows_set_points = True

    def __init__(self, time_constant, dead_time, rate_limit, late):
        self.time_constant, self.dead_time, self.rate_limit = time_constant, dead_time, rate_limit
        self.late, self.coming = late, []
        self.target = None  # Pa, absolute; None until the first set point takes effect
        self.asked = None  # what was asked last, for the column

    def request(self, instant, pressure):
        self.asked = pressure
        self.coming.append((instant + self.dead_time + self.late, pressure))

    def next_instant(self):
        return self.coming[0][0] if self.coming else math.inf

    def pass_instant(self, instant):
        while self.coming and self.coming[0][0] <= instant + SAME_INSTANT:
            self.target = self.coming.pop(0)[1]

    def rate(self, branches, key, pressure):
        if self.target is None:
            return 0.0
        rate = (self.target - pressure) / self.time_constant
        limit = self.rate_limit
        if branches.positive(("regulator rises", key), rate - limit, 1e-4):
            return limit
        if branches.positive(("regulator falls", key), -rate - limit, 1e-4):
            return -limit
        return rate
