"""The batch in heyoka: adaptive Taylor series on one vector of rows at a time, compiled for the machine.

    python heyoka_taylor.py THREADS REPEATS CHECKED < work

The selects of the model are not analytic, and a series does not see a kink ahead of it, so no step is longer than half
the fixed one of the others, and each ends at a valve's edge.
"""

import work

THREADS, REPEATS, CHECKED = work.arguments()

from concurrent.futures import ThreadPoolExecutor

import heyoka as hy
import numpy as np

# The series has order 3 at this tolerance; a tighter one costs more and leaves the error, which the kinks make.
TOLERANCE = 0.1
LONGEST = 0.5  # of the others' steps: so the error is theirs
LANES = hy.recommended_simd_size()
m, parts, rows = work.read()


def larger(a, b):
    return hy.select(hy.gt(a, b), a, b)


def smaller(a, b):
    return hy.select(hy.lt(a, b), a, b)


def equations():
    L, v, P, air = hy.make_vars("L", "v", "P", "air")
    per_mass, beyond = hy.par[0], hy.par[1]
    length = larger(L, m.min_length)
    gauge = P - m.atmosphere
    square = length * length
    slope = (m.square_thread - 3 * square) * m.per_turns
    volume = length * (m.square_thread - square) * m.per_turns + m.external_volume
    secant = 3 * gauge * (length + m.min_length) * m.per_turns * m.effectiveness
    taut = larger(m.stiffness * (L - m.max_length) + m.damping * v, 0.0)
    taut = hy.select(hy.gt(L, m.max_length), taut, 0.0)
    friction = m.coulomb_width * larger(secant, 0.0)
    coulomb = hy.select(hy.gt(v, 0.0), friction, hy.select(hy.lt(v, 0.0), -friction, 0.0))
    force = larger(taut + m.viscous * v + coulomb - m.effectiveness * gauge * slope, 0.0)
    slack = hy.lt(L, m.min_length)
    tension = hy.select(slack, 0.0, force)
    volume_rate = hy.select(slack, 0.0, slope * v)

    inwards = hy.lt(P, beyond)
    high = larger(P, beyond)
    ratio = smaller(P, beyond) / high
    kept = smaller(larger(ratio, m.critical_ratio), m.laminar_ratio)
    u = kept ** ((m.gamma - 1) / m.gamma)
    choked = (2 / (m.gamma + 1)) ** ((m.gamma + 1) / (m.gamma - 1))
    orifice = hy.sqrt(2 / ((m.gamma - 1) * choked) * u**5.0 * (1 - u))
    psi = hy.select(hy.gt(ratio, m.laminar_ratio), m.laminar_slope * (1 - ratio), orifice)
    outward = P * m.gas_constant * air / volume
    drive = hy.sqrt(hy.select(inwards, high * high * (1 / m.temperature), outward))
    flow = m.conductance * drive * psi
    flow = hy.select(inwards, flow, -flow)
    rate = m.gamma * P * (flow / air - volume_rate / volume)
    return [(L, v), (v, m.gravity - tension * per_mass), (P, rate), (air, flow)]


filling = parts[:, 2] > 0
turns = np.flatnonzero(np.diff(filling)) + 1
ends = [*parts[turns, 0], parts[-1, 0] + parts[-1, 1]]
fills = [*filling[np.append(0, turns)]]
longest = LONGEST * parts[:, 1].max()
padded = np.pad(rows, ((0, -len(rows) % LANES), (0, 0)), mode="edge")
lots = padded.reshape(-1, LANES, 6).transpose(0, 2, 1).copy()
lots[:, 0] = 1 / lots[:, 0]
system = equations()
solver = hy.taylor_adaptive_batch(
    system, np.zeros((4, LANES)), pars=np.zeros((2, LANES)), tol=TOLERANCE, high_accuracy=False, compact_mode=False
)


def solve(lots):
    # Each thread has a copy of the compiled integrator.
    own = solver.__copy__()
    states = np.empty((len(lots), 4, LANES))
    for n, lot in enumerate(lots):
        own.set_time(0.0)
        own.state[:] = lot[2:]
        own.pars[0] = lot[0]
        for end, fill in zip(ends, fills):
            own.pars[1] = lot[1] if fill else m.atmosphere
            own.propagate_until(end, max_delta_t=longest)
        states[n] = own.state
    return states


def run():
    if THREADS == 1:
        states = solve(lots)
    else:
        with ThreadPoolExecutor(THREADS) as pool:
            states = np.concatenate(list(pool.map(solve, np.array_split(lots, THREADS))))
    return states.transpose(0, 2, 1).reshape(-1, 4)


work.answer(run, REPEATS, CHECKED)
