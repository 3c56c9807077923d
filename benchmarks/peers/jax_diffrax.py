"""JAX: the steps of `numba_rk4` in a jitted scan over arrays of samples, float64, on the processor.

XLA computes an expression anew for each of its uses unless it is a division or root: divisions by one halve the time.
Diffrax's adaptive solvers under vmap take hundreds of times longer.
"""

import os
from functools import cache
from importlib import import_module
from importlib.util import find_spec

import numpy as np

from . import case

NAME = "JAX, RK4 scan"
STEP = 2e-3  # s, two outputs
BATCH = 256  # samples in one scan
FLAGS = "--xla_cpu_prefer_vector_width=512"


def available() -> bool:
    return find_spec("jax") is not None


@cache
def simulator():
    """Compiled function of the (18, N) coefficients and N ones: theta at all `case.TIMES` but the first, (1000, 2, N)."""
    os.environ.setdefault("XLA_FLAGS", FLAGS)
    jax, jnp = import_module("jax"), import_module("jax.numpy")
    jax.config.update("jax_enable_x64", True)

    def derivative(y, push, moving, c):
        """Rates of the state, and the column's acceleration if it were free to move."""
        Z, Q, Q1, X, V, D, D1 = y
        r_z, t_p, a_p, _, _, stop, k_s, d_s, g_z, g_x, g_p, limit, w2, zw, d_p, d_1, d_0, _, unit = c
        size, sign = jnp.abs(Q), jnp.where(Q < 0, -1.0, 1.0)
        W = 1.0 - sign * (Z - V)
        square = Q * Q + jnp.abs(W)
        u = jnp.sqrt(square) - size
        U = jnp.where(W < 0, -u, u)
        P = sign * (1.0 - U * u)
        side = jnp.where(X < 0, -1.0, 1.0)
        over = jnp.abs(X) - stop
        push = push - jnp.where(over > 0, side * jnp.maximum(k_s * over + d_s * side * V, 0.0), 0.0)
        Z1 = r_z * (2.0 * Q * U - V)
        E = t_p / square * u * (Z1 + 2.0 * U * Q1 - jnp.where(moving, push + a_p * P, 0.0))
        P = (P - u * E) / unit
        free = push + a_p * P
        Q2 = w2 * (jnp.clip(D - g_z * Z - g_x * X + g_p * P, -limit, limit) - Q) - zw * Q1
        D2 = -(d_p * P + d_1 * D1 + d_0 * D)
        V1 = jnp.where(moving, free, 0.0)
        return ((Z1 + r_z * size * E) / unit, Q1, Q2 / unit, V, V1 / unit, D1, D2 / unit), free

    def advance(y, force, c):
        """State after one step."""
        V, friction = y[4], c[3]
        free = derivative(y, force, False, c)[1]
        moving = (V != 0.0) | (jnp.abs(free) > friction)
        direction = jnp.where(jnp.where(V != 0.0, V, free) < 0, -1.0, 1.0)
        push = force - direction * friction
        k1, _ = derivative(y, push, moving, c)
        k2, _ = derivative(tuple(a + 0.5 * STEP * b for a, b in zip(y, k1, strict=True)), push, moving, c)
        k3, _ = derivative(tuple(a + 0.5 * STEP * b for a, b in zip(y, k2, strict=True)), push, moving, c)
        k4, _ = derivative(tuple(a + STEP * b for a, b in zip(y, k3, strict=True)), push, moving, c)
        rates = zip(y, k1, k2, k3, k4, strict=True)
        Z, Q, Q1, X, end, D, D1 = (a + STEP / 6 * (b + 2 * (d + e) + f) for a, b, d, e, f in rates)
        turned = direction * end < 0
        left = STEP * end / jnp.where(turned, end - V, 1.0)
        after = direction * jnp.minimum(0.0, direction * end + 2 * friction * left)
        slip = jnp.where(turned, 0.5 * left * (after - end), 0.0)
        return Z - c[0] * slip, Q, Q1, X + slip, jnp.where(turned, after, end), D, D1

    @jax.jit
    def simulate(coefficients, ones):
        c = (*coefficients, ones)

        def step(y, pushing):
            after = advance(y, pushing * c[4], c)
            middle = 0.5 * (y[3] + after[3]) + 0.125 * STEP * (y[4] - after[4])
            return after, c[17] * jnp.stack((middle, after[3]))

        pushing = jnp.asarray(case.TIMES[:-1:2] >= case.STEP_TIME, float)
        return jax.lax.scan(step, (0.0 * ones,) * 7, pushing, unroll=2)[1]

    return simulate


def run(parameters: np.ndarray) -> np.ndarray:
    """theta in rad at `case.TIMES`, (N, 2001); a last batch of another size is compiled anew."""
    simulate, coefficients = simulator(), case.scaled(parameters)
    theta = np.zeros((len(parameters), case.OUTPUTS))
    for first in range(0, len(parameters), BATCH):
        part = coefficients[:, first : first + BATCH]
        outputs = np.asarray(simulate(part, np.ones(part.shape[1])))
        theta[first : first + BATCH, 1:] = outputs.reshape(case.OUTPUTS - 1, -1).T
    return theta
