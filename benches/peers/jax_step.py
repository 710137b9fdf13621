"""The batch in JAX: one row's run under `vmap` and `jit`, in double precision on the CPU.

    python jax_step.py THREADS REPEATS CHECKED < work

XLA has one device for each thread, and the rows are divided over them.
"""

import os

import work

THREADS, REPEATS, CHECKED = work.arguments()
os.environ["XLA_FLAGS"] = (
    "--xla_cpu_prefer_vector_width=512 --xla_cpu_enable_fast_math=true "
    f"--xla_force_host_platform_device_count={THREADS}"
)
os.environ["JAX_PLATFORMS"] = "cpu"

import jax
import numpy as np
from jax import lax
from jax import numpy as jnp

jax.config.update("jax_enable_x64", True)
m, parts, rows = work.read()


def rates(mass, beyond, state):
    L, v, P, air = state
    length = jnp.maximum(L, m.min_length)
    gauge = P - m.atmosphere
    square = length * length
    slope = (m.square_thread - 3 * square) * m.per_turns
    volume = length * (m.square_thread - square) * m.per_turns + m.external_volume
    secant = 3 * gauge * (length + m.min_length) * m.per_turns * m.effectiveness
    taut = jnp.maximum(m.stiffness * (L - m.max_length) + m.damping * v, 0)
    taut = jnp.where(L > m.max_length, taut, 0)
    coulomb = m.coulomb_width * jnp.maximum(secant, 0) * jnp.sign(v)
    force = jnp.maximum(taut + m.viscous * v + coulomb - m.effectiveness * gauge * slope, 0)
    slack = L < m.min_length
    tension = jnp.where(slack, 0, force)
    volume_rate = jnp.where(slack, 0, slope * v)

    inwards = P < beyond
    high = jnp.maximum(P, beyond)
    ratio = jnp.minimum(P, beyond) / high
    kept = jnp.clip(ratio, m.critical_ratio, m.laminar_ratio)
    t = m.scale * kept + m.offset
    g = jnp.full_like(t, m.g[-1])
    for coefficient in m.g[-2::-1]:
        g = g * t + coefficient
    psi = jnp.where(ratio > m.laminar_ratio, m.laminar_slope * (1 - ratio), jnp.sqrt(1 - kept) * g)
    per_content = 1 / (air * volume)
    outward = P * m.gas_constant * air * air * per_content
    flow = m.conductance * jnp.sqrt(jnp.where(inwards, high * high / m.temperature, outward)) * psi
    flow = jnp.where(inwards, flow, -flow)
    rate = m.gamma * P * (flow * volume - volume_rate * air) * per_content
    return v, m.gravity - tension / mass, rate, flow


def run_row(row, parts):
    mass, supply = row[0], row[1]

    def step(state, part):
        h = part[1]
        beyond = jnp.where(part[2] > 0, supply, m.atmosphere)
        ahead = lambda slopes, by: tuple(y + by * k for y, k in zip(state, slopes))
        a = rates(mass, beyond, state)
        b = rates(mass, beyond, ahead(a, h / 2))
        c = rates(mass, beyond, ahead(b, h / 2))
        d = rates(mass, beyond, ahead(c, h))
        return tuple(y + h / 6 * (p + 2 * (q + r) + s) for y, p, q, r, s in zip(state, a, b, c, d)), None

    state, _ = lax.scan(step, tuple(row[2:]), parts)
    return jnp.stack(state)


mesh = jax.make_mesh((THREADS,), ("rows",), axis_types=(jax.sharding.AxisType.Auto,))
over_rows = jax.sharding.NamedSharding(mesh, jax.sharding.PartitionSpec("rows"))
everywhere = jax.sharding.NamedSharding(mesh, jax.sharding.PartitionSpec())
whole = len(rows) - len(rows) % -THREADS
padded = np.pad(rows, ((0, -len(rows) % THREADS), (0, 0)), mode="edge")
rows_there, parts_there = jax.device_put(padded, over_rows), jax.device_put(parts, everywhere)
run = jax.jit(jax.vmap(run_row, in_axes=(0, None)))
work.answer(lambda: run(rows_there, parts_there).block_until_ready(), REPEATS, CHECKED)
