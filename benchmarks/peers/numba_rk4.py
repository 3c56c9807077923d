"""Hand-written for numba: Runge-Kutta steps of 2 ms, the pressure slaved to first order, dry friction set-valued by steps.

Within a step friction has one sign, or holds. A rate that passes zero within a step gets friction of the other sign from
there on, or rests: explicit steps do not bear a smooth law that is steep enough. Between steps theta is its cubic.
"""

import math
from importlib.util import find_spec

import numpy as np

from . import case

try:
    from llvmlite.binding import set_option
    from numba import njit

    set_option("", "-force-vector-interleave=2")  # one vector computes while the other waits for its square root
except ImportError:  # `available` says so

    def njit(**_):
        return lambda function: function


NAME = "numba, RK4 over samples"
NAME_SINGLE = "numba, RK4 one by one"
STEP = 2e-3  # s, two outputs
BLOCK = 32  # samples side by side: their states and coefficients stay in the first-level cache
ROWS = len(case.SCALED)
compiled = njit(fastmath=True, error_model="numpy")
inlined = njit(fastmath=True, error_model="numpy", inline="always")


def available() -> bool:
    return find_spec("numba") is not None


@inlined
def derivative(y, push, moving, c):
    """Rates of the state, and the column's acceleration if it were free to move."""
    Z, Q, Q1, X, V, D, D1 = y
    r_z, t_p, a_p, _, _, stop, k_s, d_s, g_z, g_x, g_p, limit, w2, zw, d_p, d_1, d_0, _ = c
    size = abs(Q)
    W = 1.0 - math.copysign(1.0, Q) * (Z - V)
    square = Q * Q + abs(W)
    u = math.sqrt(square) - size
    U = math.copysign(u, W)
    P = math.copysign(1.0, Q) * (1.0 - U * u)
    over = abs(X) - stop
    push -= math.copysign(max(k_s * over + math.copysign(d_s, X) * V, 0.0) if over > 0.0 else 0.0, X)
    Z1 = r_z * (2.0 * Q * U - V)
    E = t_p / square * u * (Z1 + 2.0 * U * Q1 - moving * (push + a_p * P))
    P -= u * E
    free = push + a_p * P
    Q2 = w2 * (min(max(D - g_z * Z - g_x * X + g_p * P, -limit), limit) - Q) - zw * Q1
    return (Z1 + r_z * size * E, Q1, Q2, V, moving * free, D1, -(d_p * P + d_1 * D1 + d_0 * D)), free


@inlined
def moved(y, h, r):
    """State after ``h`` at the rates ``r``."""
    return (
        *(y[0] + h * r[0], y[1] + h * r[1], y[2] + h * r[2], y[3] + h * r[3]),
        *(y[4] + h * r[4], y[5] + h * r[5], y[6] + h * r[6]),
    )


@inlined
def advance(y, force, h, c):
    """State after one step."""
    V, r_z, friction = y[4], c[0], c[3]
    _, free = derivative(y, force, 0.0, c)
    direction = math.copysign(1.0, V if V != 0.0 else free)
    moving = 1.0 if V != 0.0 or abs(free) > friction else 0.0
    push = force - direction * friction
    k1, _ = derivative(y, push, moving, c)
    k2, _ = derivative(moved(y, 0.5 * h, k1), push, moving, c)
    k3, _ = derivative(moved(y, 0.5 * h, k2), push, moving, c)
    k4, _ = derivative(moved(y, h, k3), push, moving, c)
    Z, Q, Q1, X, end, D, D1 = moved(y, h / 6.0, moved(moved(moved(k1, 2.0, k2), 2.0, k3), 1.0, k4))
    slip = 0.0
    if direction * end < 0.0:
        left = h * end / (end - V)
        turned = direction * min(0.0, direction * end + 2.0 * friction * left)
        slip = 0.5 * left * (turned - end)
        end = turned
    return Z - r_z * slip, Q, Q1, X + slip, end, D, D1


@compiled
def aligned(size):
    """Zeros that start with a cache line."""
    room = np.zeros(size + 8)
    start = (64 - room.ctypes.data % 64) % 64 // 8
    return room[start : start + size]


def stepper(width):
    """Function that runs ``width`` samples side by side: coefficients (ROWS * width), outputs (OUTPUTS * width)."""
    # One flat array each with constant strides: so LLVM sees that the rows do not overlap and vectorises the loop.

    @compiled
    def sweep(y, force, B, middle, end):
        for i in range(width):
            c = (
                *(B[i], B[width + i], B[2 * width + i], B[3 * width + i], B[4 * width + i], B[5 * width + i]),
                *(B[6 * width + i], B[7 * width + i], B[8 * width + i], B[9 * width + i], B[10 * width + i]),
                *(B[11 * width + i], B[12 * width + i], B[13 * width + i], B[14 * width + i], B[15 * width + i]),
                *(B[16 * width + i], B[17 * width + i]),
            )
            X, V = y[3 * width + i], y[4 * width + i]
            state = (y[i], y[width + i], y[2 * width + i], X, V, y[5 * width + i], y[6 * width + i])
            Z, Q, Q1, X_end, V_end, D, D1 = advance(state, force * c[4], STEP, c)
            y[i], y[width + i], y[2 * width + i], y[3 * width + i] = Z, Q, Q1, X_end
            y[4 * width + i], y[5 * width + i], y[6 * width + i] = V_end, D, D1
            middle[i] = c[17] * (0.5 * (X + X_end) + 0.125 * STEP * (V - V_end))
            end[i] = c[17] * X_end

    @compiled
    def simulate(B, out):
        y = aligned(7 * width)
        out[:width] = 0.0
        for n in range(0, case.OUTPUTS - 1, 2):
            force = 1.0 if n >= case.STEP_OUTPUT else 0.0
            sweep(y, force, B, out[(n + 1) * width : (n + 2) * width], out[(n + 2) * width : (n + 3) * width])

    @compiled
    def simulate_all(C, theta):
        B, out = aligned(ROWS * width), aligned(case.OUTPUTS * width)
        for first in range(0, theta.shape[0], width):
            count = min(width, theta.shape[0] - first)
            for row in range(ROWS):
                for i in range(width):
                    B[row * width + i] = C[row, first + min(i, count - 1)]
            simulate(B, out)
            for i in range(count):
                for n in range(case.OUTPUTS):
                    theta[first + i, n] = out[n * width + i]

    return simulate_all


blocks, singles = stepper(BLOCK), stepper(1)


def run(parameters: np.ndarray) -> np.ndarray:
    """theta in rad at `case.TIMES`, (N, 2001)."""
    theta = np.empty((len(parameters), case.OUTPUTS))
    blocks(case.scaled(parameters), theta)
    return theta


def run_single(parameters: np.ndarray) -> np.ndarray:
    """As `run`, one sample after the other."""
    theta = np.empty((len(parameters), case.OUTPUTS))
    singles(case.scaled(parameters), theta)
    return theta
