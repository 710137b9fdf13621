"""The peers: SciPy, Numba and diffrax on the work of `work.py`, each written as its documentation recommends.

A peer is a function of a tolerance (of Runge-Kutta 4, of a step) that gives length and pressure at the samples. All of
them restart at every motion of the poppet, whose times are known beforehand.
"""

from __future__ import annotations

import collections.abc
import dataclasses
import importlib.util
import io
import sys
import types

import numpy as np
from scipy.integrate import solve_ivp
from work import ROOT, Muscle, Work, rates, rates_of_arrays

#: Sizes of the states, by which the absolute tolerance of each solver is the relative one times a tenth: m, m/s, Pa, kg.
SCALES = np.array([0.1, 0.1, 1e5, 1e-5])
#: Times in s that are no further apart are one instant.
SAME = 1e-9


@dataclasses.dataclass(frozen=True)
class Peer:
    """A library that does the work."""

    name: str
    #: Length and pressure at the samples, from a tolerance or a step.
    run: collections.abc.Callable[[float], np.ndarray]
    #: What is tried for an error, from loose to tight.
    settings: collections.abc.Sequence[float]


TOLERANCES = [10.0 ** (-quarter / 4) for quarter in range(8, 45)]


def plain(work: Work) -> collections.abc.Callable:
    """The right-hand side as Python goes through it: of the four states and whether the supply is open."""
    k, mass = work.muscle, work.mass
    return lambda y, filling: rates(*y.tolist(), mass, filling, k)


def scipy_between_instants(work: Work, method: str, right_hand_side: collections.abc.Callable) -> Peer:
    """`solve_ivp` from one motion of the seat to the next; kinks of the laws shorten its steps."""

    def run(tolerance: float) -> np.ndarray:
        state, answer = work.start.copy(), np.empty((2, len(work.samples)))
        for begin, end, filling in work.spans:
            # A sample and an edge that a rounding parts are one instant.
            inside = (work.samples >= begin - SAME) & (work.samples < end - SAME)
            solution = solve_ivp(
                lambda _, y, filling=filling: right_hand_side(y, filling),
                (begin, end),
                state,
                method=method,
                t_eval=np.append(np.maximum(work.samples[inside], begin), end),
                rtol=tolerance,
                atol=0.1 * tolerance * SCALES,
            )
            if solution.status < 0:
                return np.full_like(answer, np.nan)
            answer[:, inside] = solution.y[[0, 2], : inside.sum()]
            state = solution.y[:, -1]
        answer[:, -1] = state[[0, 2]]
        return answer

    return Peer("", run, TOLERANCES)


def scipy_with_events(work: Work, method: str) -> Peer:
    """`solve_ivp` with every event located by its own event finding: the peer of `benches/peers/scipy_peer.py`."""
    path = ROOT / "benches" / "peers" / "scipy_peer.py"
    peer = importlib.util.module_from_spec(importlib.util.spec_from_file_location("scipy_peer", path))
    sys.modules["scipy_peer"] = peer  # where its dataclass looks for its own module
    peer.__spec__.loader.exec_module(peer)
    k = work.muscle
    numbers = types.SimpleNamespace(**k._asdict())
    turns = (1 / (4 * np.pi * k.per_turns)) ** 0.5
    area = k.throat / (2 * k.gamma / (k.gas_constant * (k.gamma - 1))) ** 0.5
    text = {
        "thread_length": k.square_thread**0.5,
        "turns": turns,
        "area": area,
        "temperature": 1 / k.per_temperature,
        "mass": work.mass,
        "pull": work.mass * k.gravity,
        "length": work.start[0],
        "velocity": work.start[1],
        "pressure": work.start[2],
        "air_mass": work.start[3],
        "length_scale": SCALES[0],
        "velocity_scale": SCALES[1],
        "pressure_scale": SCALES[2],
        "air_mass_scale": SCALES[3],
        "duration": work.spans[-1][1],
        "sample_interval": work.samples[1],
        "initial_port": 1.0,
    }
    named = {name: getattr(numbers, name) for name in Muscle._fields}
    lines = [f"{name} {float(value)!r}" for name, value in (named | text | {"edges": len(work.spans) - 1}).items()]
    lines += [f"{begin!r} {0 if filling else 1}" for begin, _, filling in work.spans[1:]]
    problem = peer.read(io.StringIO("\n".join(lines)))

    def run(tolerance: float) -> np.ndarray:
        rows, *_ = peer.simulate(problem, method, tolerance)
        return np.array(rows).T

    return Peer("", run, TOLERANCES)


def numba_peers(work: Work) -> tuple[Peer, Peer, collections.abc.Callable, collections.abc.Callable]:
    """Runge-Kutta 4 at a fixed step and Dormand-Prince 5(4) at an adaptive one, compiled; then the compiled right-hand
    side, and the adaptive method for many masses on all cores."""
    import numba

    jit = numba.njit(fastmath=True, error_model="numpy")
    slopes = jit(rates)

    @jit
    def ahead(y, h, a1, k1, a2, k2, a3, k3, a4, k4, a5, k5, mass, filling, k):
        out = np.empty(4)
        for i in range(4):
            out[i] = y[i] + h * (a1 * k1[i] + a2 * k2[i] + a3 * k3[i] + a4 * k4[i] + a5 * k5[i])
        return out, slopes(out[0], out[1], out[2], out[3], mass, filling, k)

    @jit
    def classical(y, h, mass, filling, k):
        k1 = slopes(y[0], y[1], y[2], y[3], mass, filling, k)
        _, k2 = ahead(y, h, 0.5, k1, 0.0, k1, 0.0, k1, 0.0, k1, 0.0, k1, mass, filling, k)
        _, k3 = ahead(y, h, 0.0, k1, 0.5, k2, 0.0, k1, 0.0, k1, 0.0, k1, mass, filling, k)
        _, k4 = ahead(y, h, 0.0, k1, 0.0, k1, 1.0, k3, 0.0, k1, 0.0, k1, mass, filling, k)
        for i in range(4):
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])

    @jit
    def to_the_end(y, begin, end, h, tolerance, scales, mass, filling, k):
        """By Dormand & Prince; the step that the next span may begin with."""
        t = begin
        k1 = slopes(y[0], y[1], y[2], y[3], mass, filling, k)
        while t < end:
            last = t + h >= end * (1.0 - 1e-15)
            d = end - t if last else h
            _, k2 = ahead(y, d, 1 / 5, k1, 0.0, k1, 0.0, k1, 0.0, k1, 0.0, k1, mass, filling, k)
            _, k3 = ahead(y, d, 3 / 40, k1, 9 / 40, k2, 0.0, k1, 0.0, k1, 0.0, k1, mass, filling, k)
            _, k4 = ahead(y, d, 44 / 45, k1, -56 / 15, k2, 32 / 9, k3, 0.0, k1, 0.0, k1, mass, filling, k)
            _, k5 = ahead(
                y, d, 19372 / 6561, k1, -25360 / 2187, k2, 64448 / 6561, k3, -212 / 729, k4, 0.0, k1, mass, filling, k
            )
            _, k6 = ahead(
                y,
                d,
                9017 / 3168,
                k1,
                -355 / 33,
                k2,
                46732 / 5247,
                k3,
                49 / 176,
                k4,
                -5103 / 18656,
                k5,
                mass,
                filling,
                k,
            )
            new, k7 = ahead(
                y, d, 35 / 384, k1, 500 / 1113, k3, 125 / 192, k4, -2187 / 6784, k5, 11 / 84, k6, mass, filling, k
            )
            error = 0.0
            for i in range(4):
                off = (71 / 57600) * k1[i] - (71 / 16695) * k3[i] + (71 / 1920) * k4[i]
                off += -(17253 / 339200) * k5[i] + (22 / 525) * k6[i] - (1 / 40) * k7[i]
                error = max(error, abs(d * off) / (tolerance * (max(abs(y[i]), abs(new[i])) + 0.1 * scales[i])))
            factor = 5.0 if error == 0.0 else min(5.0, max(0.2, 0.9 * error**-0.2))
            if error <= 1.0:
                t = end if last else t + d
                y[:] = new
                k1 = k7
                if not last or factor < 1.0:
                    h = d * factor
            else:
                h = d * max(factor, 0.1) if error < 1e300 else 0.1 * d
        return h

    instants, filling_of, is_sample = grid(work)
    k, mass = work.muscle, work.mass

    @jit
    def fixed(start, instants, fillings, kept, step, mass, k):
        y, answer, place = start.copy(), np.empty((2, kept.sum() + 1)), 1
        answer[0, 0], answer[1, 0] = y[0], y[2]
        for n in range(len(fillings)):
            span = instants[n + 1] - instants[n]
            parts = int(np.ceil(span / step - 1e-9))
            for _ in range(parts):
                classical(y, span / parts, mass, fillings[n], k)
            if kept[n]:
                answer[0, place], answer[1, place] = y[0], y[2]
                place += 1
        return answer

    @jit
    def adaptive(start, instants, fillings, kept, tolerance, scales, mass, k):
        y, answer, place, h = start.copy(), np.empty((2, kept.sum() + 1)), 1, 1e-5
        answer[0, 0], answer[1, 0] = y[0], y[2]
        for n in range(len(fillings)):
            h = to_the_end(y, instants[n], instants[n + 1], h, tolerance, scales, mass, fillings[n], k)
            if kept[n]:
                answer[0, place], answer[1, place] = y[0], y[2]
                place += 1
        return answer

    @numba.njit(fastmath=True, error_model="numpy", parallel=True)
    def of_many(starts, masses, edges, fillings, tolerance, scales, k):
        ends = np.empty((len(masses), 4))
        for row in numba.prange(len(masses)):
            y, h = starts[row].copy(), 1e-5
            for n in range(len(fillings)):
                h = to_the_end(y, edges[n], edges[n + 1], h, tolerance, scales, masses[row], fillings[n], k)
            ends[row] = y
        return ends

    @jit
    def right_hand_side(y, filling):
        return slopes(y[0], y[1], y[2], y[3], mass, filling, k)

    edges = np.array([span[0] for span in work.spans] + [work.spans[-1][1]])
    fillings = np.array([span[2] for span in work.spans])
    steps = [1e-3 / 2**half for half in np.arange(0, 8, 0.5)]
    return (
        Peer("", lambda step: fixed(work.start, instants, filling_of, is_sample, step, mass, k), steps),
        Peer("", lambda rtol: adaptive(work.start, instants, filling_of, is_sample, rtol, SCALES, mass, k), TOLERANCES),
        right_hand_side,
        lambda starts, masses, rtol: of_many(starts, masses, edges, fillings, rtol, SCALES, k),
    )


def grid(work: Work) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples and motions of the seat as one list of instants; what is open before each, and whether it is a sample."""
    edges = np.array([span[0] for span in work.spans[1:]])
    alone = edges[np.abs(edges[:, None] - work.samples).min(axis=1) > SAME]
    instants = np.sort(np.concatenate([work.samples, alone]))
    middles = 0.5 * (instants[1:] + instants[:-1])
    filling = np.array([span[2] for span in work.spans])[np.searchsorted(edges, middles)]
    return instants, filling, np.isin(instants[1:], work.samples)


def diffrax_solver(work: Work, samples: np.ndarray) -> collections.abc.Callable:
    """The states at the samples of a row as a function of its mass, start and tolerance, to be jitted and vmapped."""
    import diffrax
    import jax
    from jax import numpy as jnp

    jax.config.update("jax_enable_x64", True)
    edges = jnp.array([span[0] for span in work.spans[1:]])
    k = work.muscle

    def field(t, state, mass):
        # The exhaust is open first, and every edge changes over.
        filling = jnp.searchsorted(edges, t, side="right") % 2 == 1
        return rates_of_arrays(jnp, state, mass, filling, k)

    def run(mass, start, tolerance):
        controller = diffrax.PIDController(rtol=tolerance, atol=0.1 * tolerance * jnp.array(SCALES))
        controller = diffrax.ClipStepSizeController(controller, jump_ts=edges)
        return diffrax.diffeqsolve(
            diffrax.ODETerm(field),
            diffrax.Dopri5(),
            t0=0.0,
            t1=work.spans[-1][1],
            dt0=1e-5,
            y0=start,
            args=mass,
            stepsize_controller=controller,
            saveat=diffrax.SaveAt(ts=jnp.array(samples)),
            max_steps=200_000,
            adjoint=diffrax.ForwardMode(),
            throw=False,
        ).ys

    return run


def diffrax_peer(work: Work) -> Peer:
    """diffrax, compiled: Dormand-Prince 5(4) with its PID controller and the times at which the field jumps."""
    import jax

    run = jax.jit(diffrax_solver(work, work.samples))
    return Peer("", lambda rtol: np.asarray(run(work.mass, work.start, rtol))[:, [0, 2]].T, TOLERANCES)
