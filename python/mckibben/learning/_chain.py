"""Pictures of joints and chains of joints, with the muscles that cross them.

Segments, moment arms and attachments are the scenario's. A scenario leaves open where the muscles with moment arms begin and
end: they are drawn along the segment before the first joint that they cross, and pull by a cord that is fixed to the rim of the
last one.
"""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mckibben.learning._drawing import ACROSS, BONE, FINE, GHOST, GROUND, INK, PAPER, Array, Canvas, Muscle, Values
from mckibben.learning._plant import Plant

# Inclinations from straight down in rad, and where segments begin and end in m.
Posture = tuple[list[float], list[Array], list[Array]]


class Chain:
    """Segments behind joints, with the muscles that cross them."""

    def __init__(self, plant: Plant, path: str, columns: Sequence[str]) -> None:
        named = path != "load"
        section = plant.at(path)
        joints = section["joints"] if named else {"": section}
        names = list(joints)
        keys = [f"{path}.joints.{name}" if named else path for name in names]

        def each(key: str, other: float = 0.0) -> list[float]:
            return [value if (value := plant.number(f"{of}.{key}")) is not None else other for of in keys]

        self.columns = [f"{name}.angle_rad" if named else "angle_rad" for name in names]
        behind = [joints[name].get("after", names[place - 1] if place else None) for place, name in enumerate(names)]
        self.parents = [names.index(name) if name in names else -1 for name in behind]
        self.lengths, self.distances = each("length"), each("distance")
        self.ends = [length or distance for length, distance in zip(self.lengths, self.distances, strict=True)]
        self.bobs = [0.0 if length else (3.0 * mass / (4.0 * np.pi * 7800.0)) ** (1 / 3)
                     for length, mass in zip(self.lengths, each("mass"), strict=True)]
        self.stops = list(zip(each("min_angle", -np.pi), each("max_angle", np.pi), strict=True))
        self.hanging = plant.number(f"{path}.hanging_angle") or 0.0
        depth = plant.number(f"{path}.belt.depth") if named else None
        self.belt = None if depth is None else (depth, plant.number(f"{path}.belt.velocity") or 0.0)
        segments = [joints[name].get("segment", name) for name in names]
        self.cords = self._cords(plant, path, columns, names, segments)
        self.muscles = [cord.muscle for cord in self.cords]
        self._place()
        count = next(count for count in (9, 7, 5, 3, 2) if count ** len(names) <= 800)
        postures = itertools.product(*(np.linspace(low, high, count) for low, high in self.stops))
        points = [self.top - self.half, self.top + self.half]
        for angles in postures:
            _, bases, tips = self.posture(dict(zip(self.columns, angles, strict=True)))
            points += [*bases, *tips]
        room = max([*self.bobs, 0.03 * sum(self.ends)])
        self.low, self.high = np.min(points, axis=0) - room, np.max(points, axis=0) + room
        if self.belt is not None:
            self.high[1] = max(self.high[1], self.belt[0] + 0.07 * sum(self.ends))

    def _cords(
        self, plant: Plant, path: str, columns: Sequence[str], names: list[str], segments: list[str]
    ) -> list["Cord"]:
        if path == "load":
            cords = []
            for prefix, keys, sign in (("", "", 1.0), ("antagonist_", "antagonist.", -1.0)):
                muscle = Muscle(plant, "", columns, prefix, f"{keys}actuator")
                radii = plant.numbers(f"{keys}load.moment_arm") or plant.numbers(f"{keys}load.pulley_radius")
                angles = plant.angles(f"{keys}load.moment_arm_angle") or [0.0]
                rest = plant.number(f"{keys}load.rest_length", "load.rest_length") or muscle.longest
                cords.append(Cord(muscle, rest, {0: (np.array(angles), sign * np.array(radii))}))
            return cords
        cords = []
        for name in plant.actuators:
            coupling = plant.section(name, "coupling")
            own = f"actuators.{name}.coupling"
            if f"{name}.absolute_pressure_pa" not in columns or plant.at(f"actuators.{name}.load"):
                continue
            if coupling.get("mechanism", path.rpartition(".")[2]) != path.rpartition(".")[2]:
                continue

            def numbers(key: str, own: str = own) -> Array:
                return np.array(plant.numbers(f"{own}.{key}") or plant.numbers(f"coupling.{key}"))

            muscle = Muscle(plant, name, columns, f"{name}.", f"actuators.{name}")
            rest = plant.number(f"{own}.rest_length", "coupling.rest_length") or muscle.longest
            arms: dict[int, tuple[Array, Array]] = {}
            for joint, given in coupling.get("arms", {}).items():
                table = isinstance(given, Mapping)
                path_of = [f"{of}.arms.{joint}.angle" for of in (own, "coupling")]
                at = np.array(next((found for found in map(plant.angles, path_of) if found), [0.0])) if table else np.zeros(1)
                arms[names.index(joint)] = (at, numbers(f"arms.{joint}.arm" if table else f"arms.{joint}"))
            points = []
            for end in ("origin", "insertion"):
                if end in coupling:
                    on = coupling[end].get("segment")
                    along, across = (float(sum(numbers(f"{end}.{key}"))) for key in ("along", "across"))
                    points.append((segments.index(on) if on in segments else -1, along, across))
            cords.append(Cord(muscle, rest, dict(sorted(arms.items())), points))
        return cords

    def _place(self) -> None:
        """Place the origins of the muscles: the distances before their first joint and from the segment."""
        self.back = {}
        for joint in range(len(self.columns)):
            here = [cord for cord in self.cords if cord.first == joint]
            if not here:
                continue
            most = [cord.muscle.longest + 1.3 * ACROSS * cord.radius(joint) for cord in here]
            self.back[joint] = max(most)
            if self.parents[joint] >= 0:
                self.back[joint] = min(self.back[joint], 0.95 * self.ends[self.parents[joint]])
            for side in (1.0, -1.0):
                taken = 0.0
                for cord in sorted((c for c in here if c.side(joint) == side), key=lambda c: c.radius(joint)):
                    cord.off = side * max(ACROSS * cord.radius(joint), taken + 0.6 * cord.muscle.widest)
                    taken = abs(cord.off) + 0.6 * cord.muscle.widest
        roots = [joint for joint in self.back if self.parents[joint] < 0]
        offs = [abs(cord.off) + cord.muscle.widest for cord in self.cords if cord.first in roots]
        along, across = axes(-self.hanging)
        self.top = -max((self.back[joint] for joint in roots), default=0.12 * sum(self.ends)) * along
        self.half = max([*offs, 0.06 * sum(self.ends)]) * np.abs(across)

    def posture(self, values: Values) -> Posture:
        """Return the inclinations from straight down in rad, and both ends in m, of all segments."""
        leans: list[float] = []
        bases: list[Array] = []
        tips: list[Array] = []
        for column, parent, length in zip(self.columns, self.parents, self.ends, strict=True):
            leans.append((leans[parent] if parent >= 0 else -self.hanging) + values[column])
            bases.append(tips[parent] if parent >= 0 else np.zeros(2))
            tips.append(bases[-1] + length * axes(leans[-1])[0])
        return leans, bases, tips

    def draw(self, canvas: Canvas, values: Values, aims: Values, full: float, seconds: float) -> None:
        """Draw the chain, and behind it the chain at the targets of its joints."""
        posture = self.posture(values)
        leans, bases, tips = posture
        if any(column in aims for column in self.columns):
            _, from_, to = self.posture({**values, **aims})
            for base, tip, bob in zip(from_, to, self.bobs, strict=True):
                canvas.line([base, tip], GHOST, 9.0)
                canvas.dot(base, 6.5, GHOST, None)
                canvas.disc(tip, max(bob, 4.5 * FINE / canvas.scale), GHOST, None)
        if self.belt is not None:
            self._belt(canvas, seconds)
        canvas.line([self.top, (0.0, 0.0)], BONE, 7.0)
        canvas.ground(self.top - self.half, self.top + self.half)
        for joint, base in enumerate(bases):
            rims = sorted({cord.radius(joint, values[self.columns[joint]]) for cord in self.cords if cord.last == joint})
            for radius in reversed(rims):
                canvas.disc(base, ACROSS * radius, "#eef0f2", GROUND, 1.0)
        for base, tip, lean, distance, bob in zip(bases, tips, leans, self.distances, self.bobs, strict=True):
            canvas.line([base, tip], INK, 9.0)
            canvas.dot(tip, 4.5, INK, None)
            canvas.line([base, tip], BONE, 7.0)
            canvas.dot(tip, 3.5, BONE, None)
            if bob:
                canvas.disc(tip, bob, BONE)
            else:
                canvas.dot(base + distance * axes(lean)[0], 3.0, PAPER, INK, 1.0)
        for cord in self.cords:
            cord.draw(canvas, self, posture, values, full)
        for base in bases:
            canvas.dot(base, 5.0, PAPER, INK, 1.5)

    def _belt(self, canvas: Canvas, seconds: float) -> None:
        assert self.belt is not None
        depth, velocity = self.belt
        left, right, thick = self.low[0], self.high[0], 0.022 * sum(self.ends)
        canvas.polygon([(left, depth), (right, depth), (right, depth + thick), (left, depth + thick)], "#e7eaed")
        pitch = 3.0 * thick
        for x in np.arange(left + (velocity * seconds) % pitch, right, pitch):
            canvas.line([(x, depth + thick), (min(x + thick, right), depth)], GROUND, 1.5)
        for y in (depth, depth + thick):
            canvas.line([(left, y), (right, y)], INK, 1.5)


class Cord:
    """A muscle with the cord by which it pulls: about joints by moment arms, or between two points of segments."""

    def __init__(
        self, muscle: Muscle, rest: float, arms: dict[int, tuple[Array, Array]], points: Sequence[tuple[int, float, float]] = ()
    ) -> None:
        self.muscle, self.rest, self.arms, self.points = muscle, rest, arms, points
        self.first, self.last = (min(arms), max(arms)) if arms else (-1, -1)
        self.off = 0.0

    def arm(self, joint: int, angle: float) -> float:
        """Return the moment arm in m about a joint at an angle in rad, positive where tension increases the angle."""
        angles, arms = self.arms[joint]
        return float(np.interp(angle, angles, arms))

    def side(self, joint: int) -> float:
        """Return 1 where tension increases the angle of a joint, -1 where it decreases it."""
        return float(np.sign(self.arms[joint][1][0]))

    def radius(self, joint: int, angle: float = 0.0) -> float:
        """Return the magnitude of the moment arm about a joint in m."""
        return abs(self.arm(joint, angle))

    def ends(self, posture: Posture) -> list[Array]:
        """Return the points of segments, or of the ground, between which the muscle pulls."""
        leans, bases, _ = posture
        ends = []
        for on, far, aside in self.points:
            along, across = axes(leans[on] if on >= 0 else 0.0)
            ends.append((bases[on] if on >= 0 else 0.0) + far * along + aside * across)
        return ends

    def length(self, values: Values, posture: Posture, columns: Sequence[str]) -> float:
        """Return the length of the muscle in m: its column, the distance of its ends, or that at zero angles less the travel."""
        if self.muscle.length:
            return values[self.muscle.length]
        if self.points:
            start, end = self.ends(posture)
            return float(np.hypot(*(end - start)))
        taken = 0.0
        for joint, (angles, arms) in self.arms.items():
            steps = np.linspace(0.0, values[columns[joint]], 9)
            radii = np.interp(steps, angles, arms)
            taken += float(np.sum(0.5 * (radii[1:] + radii[:-1]) * np.diff(steps)))
        return self.rest - taken

    def draw(self, canvas: Canvas, chain: Chain, posture: Posture, values: Values, full: float) -> None:
        """Draw the cord, and the muscle at its beginning."""
        path = self.ends(posture) if self.points else self._path(chain, posture, values)
        length = self.length(values, posture, chain.columns)
        span = path[1] - path[0]
        far = float(np.hypot(*span))
        end = path[0] + span * min(1.0, length / far)
        canvas.line([end, *path[1:]], INK, 1.6)
        canvas.dot(path[-1], 2.0, INK, None)
        self.muscle.draw(canvas, path[0], end, values, full)

    def _path(self, chain: Chain, posture: Posture, values: Values) -> list[Array]:
        """Return the points of the cord: from the origin of the muscle past the joints, then along the last rim to its end."""
        leans, bases, _ = posture
        path = []
        for joint in self.arms:
            parent = chain.parents[joint]
            before = leans[parent] if parent >= 0 else -chain.hanging
            arm = ACROSS * self.arm(joint, values[chain.columns[joint]])
            along, across = axes(before)
            if joint == self.first:
                path.append(bases[joint] - chain.back[joint] * along + self.off * across)
            if joint != self.last:
                path.append(bases[joint] + arm * axes(0.5 * (before + leans[joint]))[1])
                continue
            side = np.sign(arm)
            touches = before + side * 0.5 * np.pi
            fixed = leans[joint]
            if side * (touches - fixed) < 0.0:
                touches = fixed
            path += list(bases[joint] + abs(arm) * axes(np.linspace(touches, fixed, 9))[0].T)
        return path


def axes(lean: Any) -> tuple[Array, Array]:
    """Return the directions along and across a segment of this inclination in rad; across is that of growing angles."""
    sine, cosine = np.sin(lean), np.cos(lean)
    return np.array([sine, cosine]), np.array([cosine, -sine])
