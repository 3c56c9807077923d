"""SciPy: LSODA by ``odeint``, the right-hand side in pure Python. ``solve_ivp`` with the same LSODA takes three times as long."""

import math

import numpy as np
from scipy.integrate import odeint

from . import case

NAME = "SciPy odeint, tuned"
NAME_PLAIN = "SciPy odeint, plain"

RTOL, ATOL = 1e-6, 1e-6
SMOOTHING = 5e-5  # v_s, rad/s
SIZES = np.array([0.5, 0.05, 5.0, 3e-3, 0.03, 0.05, 0.5])  # of [Z, Q, Q', X, V, D, D']

RTOL_PLAIN = ATOL_PLAIN = 3e-6
SMOOTHING_PLAIN = 5e-5


def available() -> bool:
    return True  # forcefeel itself needs SciPy


def plain(y, _, numbers):
    """The equations as they stand: states [x_p, p, q_i, q_i', delta, delta', x_b, x_b']."""
    K_2, w_n, zeta, q_r, p_s, A, V_E, beta, k, c, J, K_1, K_3, inertia, B, G = numbers
    x_p, p, q_i, q_i_rate, delta, delta_rate, x_b, x_b_rate = y
    i = np.clip(K_2 * (delta - K_3 * x_p), -case.CURRENT_LIMIT, case.CURRENT_LIMIT)
    r = 1 - np.sign(q_i) * p / p_s
    q = q_i * np.sign(r) * np.sqrt(abs(r))
    x_p_rate = (A * p - k * (x_p - case.RATIO * x_b)) / c + case.RATIO * x_b_rate
    theta, theta_rate = x_b / case.BASE_ARM, x_b_rate / case.BASE_ARM
    torque = case.STEP_TORQUE + case.BASE_ARM * case.RATIO * A * p
    torque -= case.FRICTION_TORQUE * np.tanh(theta_rate / SMOOTHING_PLAIN)
    if theta > case.STOP:
        torque -= max(0.0, case.STOP_STIFFNESS * (theta - case.STOP) + case.STOP_DAMPING * theta_rate)
    elif theta < -case.STOP:
        torque -= min(0.0, case.STOP_STIFFNESS * (theta + case.STOP) + case.STOP_DAMPING * theta_rate)
    return [
        x_p_rate,
        4 * beta / V_E * (q - A * x_p_rate),
        q_i_rate,
        w_n**2 * (q_r / case.RATED_CURRENT * i - q_i) - 2 * zeta * w_n * q_i_rate,
        delta_rate,
        (-case.MAXIMUM_STIFFNESS * K_1 * A * p - B * delta_rate - G * delta) / inertia,
        x_b_rate,
        case.BASE_ARM * torque / J,
    ]


def tuned(coefficients):
    """Right-hand side of the scaled equations in floats; friction v / (1 + v^4)^(1/4), with fewer steps than tanh."""
    r_z, t_p, a_p, a_f, f, stop, k_s, d_s, g_z, g_x, g_p, limit, w2, zw, d_p, d_1, d_0, angle = coefficients.tolist()
    steepness, sqrt = angle / SMOOTHING, math.sqrt

    def derivative(y, _):
        Z, Q, Q1, X, V, D, D1 = y.tolist()
        sign, size = (1.0, Q) if Q > 0.0 else (-1.0, -Q)
        W = 1.0 - sign * (Z - V)
        square = Q * Q + abs(W)
        u = sqrt(square) - size
        U = u if W > 0.0 else -u
        P = sign * (1.0 - U * u)
        v = V * steepness
        push = f - a_f * v / sqrt(sqrt(1.0 + v * v * v * v))
        over = abs(X) - stop
        if over > 0.0:
            side = 1.0 if X > 0.0 else -1.0
            push -= side * max(0.0, k_s * over + d_s * side * V)
        Z1 = r_z * (2.0 * Q * U - V)
        E = t_p / square * u * (Z1 + 2.0 * U * Q1 - push - a_p * P)
        P -= u * E
        command = D - g_z * Z - g_x * X + g_p * P
        if command > limit:
            command = limit
        elif command < -limit:
            command = -limit
        Q2 = w2 * (command - Q) - zw * Q1
        return [Z1 + r_z * size * E, Q1, Q2, V, push + a_p * P, D1, -(d_p * P + d_1 * D1 + d_0 * D)]

    return derivative


def run(parameters: np.ndarray) -> np.ndarray:
    """theta in rad at `case.TIMES`, (N, 2001): rest until the force steps, and solved from there."""
    theta, times = np.zeros((len(parameters), case.OUTPUTS)), case.TIMES[case.STEP_OUTPUT :]
    for row, coefficients in zip(theta, case.scaled(parameters).T, strict=True):
        states = odeint(tuned(coefficients), np.zeros(7), times, rtol=RTOL, atol=ATOL * SIZES, mxstep=100_000)
        row[case.STEP_OUTPUT :] = states[:, 3] * coefficients[17]
    return theta


def run_plain(parameters: np.ndarray) -> np.ndarray:
    """As `run`, as one would write it first: `plain` with its sixteen numbers and one tolerance."""
    theta, times = np.zeros((len(parameters), case.OUTPUTS)), case.TIMES[case.STEP_OUTPUT :]
    for row, numbers in zip(theta, parameters, strict=True):
        options = {"rtol": RTOL_PLAIN, "atol": ATOL_PLAIN, "mxstep": 100_000}
        states = odeint(plain, np.zeros(8), times, args=(numbers,), **options)
        row[case.STEP_OUTPUT :] = states[:, 6] / case.BASE_ARM
    return theta
