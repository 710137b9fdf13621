"""What the actuators move: M(q) q̈ = τ(q, q̇) − Σ J_iᵀ F_i with J_i = ∂L_i/∂q. Model section 7.

Each mechanism gives `coordinates`, `lengths(q)`, `arms(q)` (J as a list of rows), `inertia(q)`, `generalised_force(q, q̇)`
(what is not the actuators'), and `bias(q, q̇)`: γ_i = J̇_i q̇.
"""

import itertools
import math

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import lsq_linear

STOP_TOLERANCE = 1e-15  # rad
TORQUE_TOLERANCE = 1e-12  # N·m


class Held:
    """A fixed length, or one that is a given function of time."""

    coordinates = 0

    def __init__(self, motion):
        self.motion = motion  # time -> (length, velocity)


class Mass:
    """One mass on one actuator: M v̇ = W − F."""

    coordinates = 1
    scales = (1e-2, 1e-1)

    def __init__(self, mass, pull):
        self.mass, self.pull = mass, pull

    def lengths(self, q):
        return [q[0]]

    def arms(self, q):
        return [[1.0]]

    def inertia(self, q):
        return [[self.mass]]

    def generalised_force(self, branches, q, qd):
        return [self.pull]

    def bias(self, q, qd):
        return [0.0]


class Masses:
    """Any number of masses, each on an actuator of its own: M_k v̇_k = W_k − F_k."""

    scales = (1e-2, 1e-1)

    def __init__(self, masses, pulls):
        self.masses, self.pulls = masses, pulls
        self.coordinates = len(masses)

    def diagonal(self, values):
        return [[v if i == k else 0.0 for i in range(len(values))] for k, v in enumerate(values)]

    def lengths(self, q):
        return list(q)

    def arms(self, q):
        return self.diagonal([1.0] * len(self.masses))

    def inertia(self, q):
        return self.diagonal(self.masses)

    def generalised_force(self, branches, q, qd):
        return list(self.pulls)

    def bias(self, q, qd):
        return [0.0] * len(self.masses)


class Pulley:
    """A constant moment arm r: e(θ) = r θ."""

    knots = ()

    def __init__(self, radius):
        self.radius = radius

    def arm(self, piece, angle):
        return self.radius

    def slope(self, piece, angle):
        return 0.0

    def excursion(self, piece, angle):
        return self.radius * angle


class ArmTable:
    """r(θ) by monotone cubics between rows, constant outside; e(θ) = ∫₀^θ r dθ exactly."""

    def __init__(self, angles, arms):
        self.knots = tuple(angles)
        self.ends = (arms[0], arms[-1])
        self.cubic = PchipInterpolator(angles, arms)
        self.area = [0.0]  # of each row since the first
        for i, (a, b) in enumerate(itertools.pairwise(angles)):
            self.area.append(self.area[-1] + self.primitive(i, b - a))
        self.zero = 0.0
        self.zero = self.excursion(sum(0.0 > k for k in self.knots), 0.0)

    def coefficients(self, i):
        return [float(c) for c in self.cubic.c[:, i]]

    def primitive(self, i, d):
        c3, c2, c1, c0 = self.coefficients(i)
        return c3 * d**4 / 4 + c2 * d**3 / 3 + c1 * d**2 / 2 + c0 * d

    def excursion(self, piece, angle):
        if piece == 0:
            return self.ends[0] * (angle - self.knots[0]) - self.zero
        if piece == len(self.knots):
            return self.area[-1] + self.ends[1] * (angle - self.knots[-1]) - self.zero
        return self.area[piece - 1] + self.primitive(piece - 1, angle - self.knots[piece - 1]) - self.zero

    def arm(self, piece, angle):
        if piece in (0, len(self.knots)):
            return self.ends[0 if piece == 0 else 1]
        c3, c2, c1, c0 = self.coefficients(piece - 1)
        d = angle - self.knots[piece - 1]
        return ((c3 * d + c2) * d + c1) * d + c0

    def slope(self, piece, angle):
        if piece in (0, len(self.knots)):
            return 0.0
        c3, c2, c1, _ = self.coefficients(piece - 1)
        d = angle - self.knots[piece - 1]
        return (3 * c3 * d + 2 * c2) * d + c1


class Joint:
    """A limb on two actuators; J dω/dt = r₁F₁ − r₂F₂ + W − M g d sin(θ − θ₀) − c ω − S."""

    coordinates = 1
    scales = (1e-1, 1.0)

    def __init__(self, arms, rest_lengths, mass, gravity, distance, inertia, hanging, torque, damping, stops):
        self.arm_laws, self.rest_lengths = arms, rest_lengths
        self.inertia_value = inertia + mass * distance**2
        self.weight = mass * gravity * distance
        self.hanging, self.torque, self.damping = hanging, torque, damping
        self.stops = stops  # (lower, upper, stiffness, damping)
        self.pieces = [0, 0]

    def locate(self, branches, q):
        """The rows of the tables between which the angle is."""
        for k, law in enumerate(self.arm_laws):
            self.pieces[k] = sum(
                branches.positive(("arm row", k, i), q[0] - knot, STOP_TOLERANCE)
                for i, knot in enumerate(law.knots)
            )

    def lengths(self, q):
        first, second = (law.excursion(p, q[0]) for law, p in zip(self.arm_laws, self.pieces, strict=True))
        return [self.rest_lengths[0] - first, self.rest_lengths[1] + second]

    def arms(self, q):
        first, second = (law.arm(p, q[0]) for law, p in zip(self.arm_laws, self.pieces, strict=True))
        return [[-first], [second]]

    def bias(self, q, qd):
        first, second = (law.slope(p, q[0]) for law, p in zip(self.arm_laws, self.pieces, strict=True))
        return [-first * qd[0] ** 2, second * qd[0] ** 2]

    def inertia(self, q):
        return [[self.inertia_value]]

    def stop_torque(self, branches, angle, rate):
        lower, upper, stiffness, damping = self.stops
        total = 0.0
        for side, bound in ((1, upper), (-1, lower)):
            if bound is None:
                continue
            depth = side * (angle - bound)
            if not branches.positive(("stop", side), depth, STOP_TOLERANCE):
                continue
            press = stiffness * depth + damping * side * rate
            if damping == 0 or branches.positive(("stop presses", side), press, TORQUE_TOLERANCE):
                total += side * press
        return total

    def generalised_force(self, branches, q, qd):
        angle, rate = q[0], qd[0]
        weight = self.weight * math.sin(angle - self.hanging)
        stop = self.stop_torque(branches, angle, rate)
        return [self.torque - weight - self.damping * rate - stop]


class Chain:
    """A planar chain of two segments; angles absolute from straight down for q₁, relative for q₂.

    Segment i has mass m, length l, centre at c from its joint and inertia I about the centre. Actuator k has
    constant arms: L_k = ℓ_k + Σ_j J_kj q_j.
    """

    coordinates = 2
    scales = (1e-1, 1.0)

    def __init__(self, masses, lengths, centres, inertias, damping, gravity, rest_lengths, arms):
        self.m, self.l, self.c, self.i = masses, lengths, centres, inertias
        self.damping, self.gravity = damping, gravity
        self.rest_lengths, self.j = rest_lengths, arms

    def lengths(self, q):
        return [l + sum(a * b for a, b in zip(j, q, strict=True)) for l, j in zip(self.rest_lengths, self.j, strict=True)]

    def arms(self, q):
        return self.j

    def bias(self, q, qd):
        return [0.0] * len(self.j)

    def inertia(self, q):
        (m1, m2), (l1, _), (c1, c2), (i1, i2) = self.m, self.l, self.c, self.i
        cos = math.cos(q[1])
        both = i2 + m2 * (c2**2 + l1 * c2 * cos)
        return [[i1 + i2 + m1 * c1**2 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * cos), both], [both, i2 + m2 * c2**2]]

    def generalised_force(self, branches, q, qd):
        (m1, m2), (l1, _), (c1, c2), _ = self.m, self.l, self.c, self.i
        h = m2 * l1 * c2 * math.sin(q[1])
        w1, w2 = qd
        g = self.gravity
        below = m2 * g * c2 * math.sin(q[0] + q[1])
        return [
            h * (2 * w1 * w2 + w2**2) - (m1 * c1 + m2 * l1) * g * math.sin(q[0]) - below - self.damping[0] * w1,
            -h * w1**2 - below - self.damping[1] * w2,
        ]


def box_problem(inertia, free_force, arms, bias, boxes):
    """What each resting actuator does: `+1` lengthens, `−1` shortens, `0` sticks; brute force over all 3ⁿ cases.

    M a = Q − Σ J_iᵀ F_i; L̈_i = J_i a + γ_i > 0 needs F_i = u_i, < 0 needs ℓ_i, = 0 any F_i of [ℓ_i, u_i].
    The solution's a is unique. `boxes` has None for what has no Coulomb force here: (it is in Q).
    """
    M, Q, G = np.array(inertia), np.array(free_force), np.array(bias)
    J = np.array(arms)
    resting = [i for i, box in enumerate(boxes) if box is not None]
    best = None
    for signs in itertools.product((1, -1, 0), repeat=len(resting)):
        moving = [(i, s) for i, s in zip(resting, signs, strict=True) if s]
        stuck = [i for i, s in zip(resting, signs, strict=True) if not s]
        force = Q - sum((J[i] * boxes[i][1 if s > 0 else 0] for i, s in moving), np.zeros(len(Q)))
        n, k = len(Q), len(stuck)
        A = np.zeros((n + k, n + k))
        A[:n, :n] = M
        for row, i in enumerate(stuck):
            A[n + row, :n] = J[i]
            A[:n, n + row] = J[i]
        right = np.concatenate([force, [-G[i] for i in stuck]])
        solution = np.linalg.lstsq(A, right, rcond=1e-13)[0]
        if np.abs(A @ solution - right).max() > 1e-9 * (1 + np.abs(right).max()):
            continue  # the sticking ones contradict each other
        a = solution[:n]
        worst = 0.0
        for i, s in moving:
            worst = max(worst, -s * (J[i] @ a + G[i]) / math.sqrt(J[i] @ np.linalg.solve(M, J[i])))
        if stuck:
            need = force - M @ a
            scale = np.abs(J[stuck]).max()
            low = np.array([boxes[i][0] for i in stuck])
            high = np.array([boxes[i][1] for i in stuck]) + 1e-13
            fit = lsq_linear(J[stuck].T / scale, need / scale, (low, high), method="bvls", tol=1e-15)
            worst = max(worst, float(np.abs(fit.fun).max()) if len(fit.fun) else 0.0)
        if best is None or (worst, len(moving)) < (max(best[0], 1e-10), best[1]):
            best = (worst, len(moving), dict(zip(resting, signs, strict=True)), a)
    return best[2], best[3]


def shares(arms, need, boxes):
    """Tensions of the sticking: least Σ β ξ², ξ = (F − c̄)/β clipped to ±1, with Σ J_iᵀ F_i = need."""
    J = np.array(arms)
    centre = np.array([(a + b) / 2 for a, b in boxes])
    half = np.array([(b - a) / 2 for a, b in boxes])
    free = np.ones(len(boxes), bool)
    xi = np.zeros(len(boxes))
    for _ in range(2 * len(boxes) + 1):
        rest = np.array(need) - J.T @ centre - J[~free].T @ (half * xi)[~free]
        K = (J[free].T * half[free]) @ J[free]
        z = np.linalg.lstsq(K, rest, rcond=1e-13)[0]
        xi[free] = J[free] @ z
        out = free & (np.abs(xi) > 1 + 1e-12)
        if not out.any():
            break
        xi[out] = np.sign(xi[out])
        free &= ~out
    return (centre + half * xi).tolist()


def gauge(arms, need, boxes):
    """(1 − t*, z*): how far the needed force is from the edge of what the sticking can hold, by facets."""
    J = np.array(arms)
    centre = np.array([(a + b) / 2 for a, b in boxes])
    half = np.array([(b - a) / 2 for a, b in boxes])
    rho = np.array(need) - J.T @ centre
    _, sizes, axes = np.linalg.svd(J)
    rank = int((sizes > 1e-9 * sizes[0]).sum())
    axes = axes[:rank]  # of the forces that the rows can hold
    normals = []
    for rows in itertools.combinations(J @ axes.T, rank - 1):
        if rank == 1:
            normals.append(axes[0])
            continue
        _, sizes, across = np.linalg.svd(np.array(rows))
        if sizes[-1] > 1e-9 * sizes[0]:
            normals.append(across[-1] @ axes)
    worst, direction = -1.0, None
    for z in normals:
        capacity = half @ np.abs(J @ z)
        load = z @ rho
        size = abs(load) / capacity if capacity > 0 else (math.inf if abs(load) > 0 else 0.0)
        if size > worst:
            worst, direction = size, z * math.copysign(1.0, load)
    return 1 - worst, direction
