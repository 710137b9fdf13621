"""The batch in Numba: a block of rows for the whole run, the rows of a block as one loop that LLVM turns into vectors.

    python numba_step.py THREADS REPEATS CHECKED < work
"""

import work

THREADS, REPEATS, CHECKED = work.arguments()

import numba
import numpy as np

m, parts, rows = work.read()
LANES = 32
per_turns, square_thread, effectiveness = m.per_turns, m.square_thread, m.effectiveness
min_length, max_length, external_volume = m.min_length, m.max_length, m.external_volume
viscous, coulomb_width, stiffness, damping = m.viscous, m.coulomb_width, m.stiffness, m.damping
gamma, gas_constant, atmosphere, gravity = m.gamma, m.gas_constant, m.atmosphere, m.gravity
per_temperature, conductance = 1 / m.temperature, m.conductance
critical_ratio, laminar_ratio, laminar_slope = m.critical_ratio, m.laminar_ratio, m.laminar_slope
scale, offset, g = m.scale, m.offset, m.g


@numba.njit(fastmath=True, inline="always")
def rates(per_mass, beyond, L, v, P, air):
    length = max(L, min_length)
    gauge = P - atmosphere
    square = length * length
    slope = (square_thread - 3 * square) * per_turns
    volume = length * (square_thread - square) * per_turns + external_volume
    secant = 3 * gauge * (length + min_length) * per_turns * effectiveness
    taut = max(stiffness * (L - max_length) + damping * v, 0.0)
    taut = taut if L > max_length else 0.0
    friction = coulomb_width * max(secant, 0.0)
    backwards = -friction if v < 0.0 else 0.0
    coulomb = friction if v > 0.0 else backwards
    force = max(taut + viscous * v + coulomb - effectiveness * gauge * slope, 0.0)
    slack = L < min_length
    tension = 0.0 if slack else force
    volume_rate = 0.0 if slack else slope * v

    high = max(P, beyond)
    ratio = min(P, beyond) / high
    kept = min(max(ratio, critical_ratio), laminar_ratio)
    t = scale * kept + offset
    t2 = t * t
    t4 = t2 * t2
    low = (g[0] + g[1] * t) + t2 * (g[2] + g[3] * t)
    middle = (g[4] + g[5] * t) + t2 * (g[6] + g[7] * t)
    top = (g[8] + g[9] * t) + t2 * (g[10] + g[11] * t) + t4 * g[12]
    orifice = np.sqrt(1.0 - kept) * (low + t4 * (middle + t4 * top))
    psi = laminar_slope * (1.0 - ratio) if ratio > laminar_ratio else orifice
    per_content = 1.0 / (air * volume)
    outward = P * gas_constant * air * air * per_content
    square_drive = high * high * per_temperature if P < beyond else outward
    flow = conductance * np.sqrt(square_drive) * psi
    flow = flow if P < beyond else -flow
    rate = gamma * P * (flow * volume - volume_rate * air) * per_content
    return v, gravity - tension * per_mass, rate, flow


@numba.njit(fastmath=True, parallel=True, error_model="numpy")
def run(parts, blocks):
    states = np.empty_like(blocks)
    for block in numba.prange(blocks.shape[0]):
        s = np.empty((6, LANES))
        s[:] = blocks[block]
        advance(parts, s)
        states[block] = s
    return states


@numba.njit(fastmath=True, error_model="numpy")
def advance(parts, s):
    for n in range(parts.shape[0]):
        h = parts[n, 1]
        filling = parts[n, 2] > 0.0
        half = 0.5 * h
        sixth = h / 6.0
        for i in range(LANES):
            per_mass = s[0, i]
            beyond = s[1, i] if filling else atmosphere
            L, v, P, air = s[2, i], s[3, i], s[4, i], s[5, i]
            L1, v1, P1, a1 = rates(per_mass, beyond, L, v, P, air)
            L2, v2, P2, a2 = rates(per_mass, beyond, L + half * L1, v + half * v1, P + half * P1, air + half * a1)
            L3, v3, P3, a3 = rates(per_mass, beyond, L + half * L2, v + half * v2, P + half * P2, air + half * a2)
            L4, v4, P4, a4 = rates(per_mass, beyond, L + h * L3, v + h * v3, P + h * P3, air + h * a3)
            s[2, i] = L + sixth * (L1 + 2.0 * (L2 + L3) + L4)
            s[3, i] = v + sixth * (v1 + 2.0 * (v2 + v3) + v4)
            s[4, i] = P + sixth * (P1 + 2.0 * (P2 + P3) + P4)
            s[5, i] = air + sixth * (a1 + 2.0 * (a2 + a3) + a4)


rows[:, 0] = 1 / rows[:, 0]
# The last block is filled up with copies of its last row.
padded = np.pad(rows, ((0, -len(rows) % LANES), (0, 0)), mode="edge")
blocks = np.ascontiguousarray(padded.reshape(-1, LANES, 6).transpose(0, 2, 1))
numba.set_num_threads(THREADS)
work.answer(lambda: run(parts, blocks).transpose(0, 2, 1).reshape(-1, 6)[:, 2:], REPEATS, CHECKED)
