"""numbalsoda: LSODA compiled from C++, the right-hand side by numba. Scaled equations, the pressure slaved to first order.

Dry friction is v / (1 + v^4)^(1/4) of v = theta' / v_s: with fewer steps than tanh at the same error.
"""

import math
from functools import cache
from importlib import import_module
from importlib.util import find_spec

import numpy as np

from . import case

NAME = "numbalsoda, LSODA"
RTOL, ATOL = 1e-6, 1e-6
SMOOTHING = 5e-5  # v_s, rad/s
SIZES = (0.5, 0.05, 5.0, 3e-3, 0.03, 0.05, 0.5)  # of [Z, Q, Q', X, V, D, D']: one ATOL for all


def available() -> bool:
    return all(find_spec(module) for module in ("numba", "numbalsoda"))


@cache
def simulator():
    """Compiled function of the (N, 18) coefficients and the times from the force on: theta from then on."""
    numba, numbalsoda = import_module("numba"), import_module("numbalsoda")
    carray, lsoda = numba.carray, numbalsoda.lsoda
    s_Z, s_Q, s_Q1, s_X, s_V, s_D, s_D1 = SIZES

    @numba.cfunc(numbalsoda.lsoda_sig, fastmath=True, error_model="numpy")
    def derivative(_, y, rate, data):
        c = carray(data, (18,))
        r_z, t_p, a_p, a_f, f, stop, k_s, d_s, g_z, g_x, g_p, limit, w2, zw, d_p, d_1, d_0, angle = c
        Z, Q, Q1, X, V, D, D1 = s_Z * y[0], s_Q * y[1], s_Q1 * y[2], s_X * y[3], s_V * y[4], s_D * y[5], s_D1 * y[6]
        size = abs(Q)
        W = 1.0 - math.copysign(1.0, Q) * (Z - V)
        square = Q * Q + abs(W)
        u = math.sqrt(square) - size
        U = math.copysign(u, W)
        P = math.copysign(1.0, Q) * (1.0 - U * u)
        v = V * (angle / SMOOTHING)
        push = f - a_f * v / math.sqrt(math.sqrt(1.0 + v * v * v * v))
        over = abs(X) - stop
        if over > 0.0:
            push -= math.copysign(max(k_s * over + math.copysign(d_s, X) * V, 0.0), X)
        Z1 = r_z * (2.0 * Q * U - V)
        E = t_p / square * u * (Z1 + 2.0 * U * Q1 - (push + a_p * P))
        P -= u * E
        Q2 = w2 * (min(max(D - g_z * Z - g_x * X + g_p * P, -limit), limit) - Q) - zw * Q1
        rate[0], rate[1], rate[2], rate[3] = (Z1 + r_z * size * E) / s_Z, Q1 / s_Q, Q2 / s_Q1, V / s_X
        rate[4], rate[5], rate[6] = (push + a_p * P) / s_V, D1 / s_D, -(d_p * P + d_1 * D1 + d_0 * D) / s_D1

    address = derivative.address

    @numba.njit
    def simulate(rows, times):
        theta = np.empty((len(rows), len(times)))
        for i in range(len(rows)):
            states, good = lsoda(address, np.zeros(7), times, rows[i], RTOL, ATOL, 100_000)
            theta[i] = states[:, 3] * (s_X * rows[i, 17] if good else np.nan)
        return theta

    return simulate


def run(parameters: np.ndarray) -> np.ndarray:
    """theta in rad at `case.TIMES`, (N, 2001): rest until the force steps, and solved from there."""
    theta = np.zeros((len(parameters), case.OUTPUTS))
    rows = np.ascontiguousarray(case.scaled(parameters).T)
    theta[:, case.STEP_OUTPUT :] = simulator()(rows, case.TIMES[case.STEP_OUTPUT :].copy())
    return theta
