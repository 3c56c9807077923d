"""The loader's equations written out by hand in U.S. units, from the report alone: the tests' independent witness."""

import numpy as np

A, C, CI, CP = 2.36, 16.2016, 5.45, 0.0102
GMAX, J, K = 28800.0, 37.4, 6107.86
K1, K2, K3 = 0.005, 1.56, 7.632
RB, RP, VE, ALPHA, BETA = 10.0, 31.375, 11.7, 0.59, 250000.0
ZETA, WN = 0.9, 377.0
NOMINAL = (60.0, 304.0, 9600.0)
LOW = (6.0, 30.4, 960.0)

LBF, INCH = 4.4482216152605, 0.0254


def compliant(x, force, setting=NOMINAL, gains=None):
    """Time derivative of [x_p, p, q_i, q_i', delta, delta', x_b, x_b'], eqs. (3)-(5), (7), (10)-(13).

    Without gains the original system, delta in V; with them (c_1 .. c_6) the compensated one, delta in rad.
    """
    inertia, damping, stiffness = setting
    x_p, p, q_i, q_i_rate, delta, delta_rate, x_b, x_b_rate = x
    if gains is None:
        e = delta - K3 * x_p
        torque = -GMAX * K1 * A * p
    else:
        e = np.dot(gains, [x_p, p, delta, delta_rate, x_b, x_b_rate])
        torque = -ALPHA * RB * A * p
    x_p_rate = -(K / C) * x_p + (A / C) * p + (ALPHA * K / C) * x_b + ALPHA * x_b_rate
    q = q_i - CP * p
    return np.array(
        [
            x_p_rate,
            4 * BETA / VE * (q - A * x_p_rate),
            q_i_rate,
            WN**2 * (CI * K2 * e - q_i) - 2 * ZETA * WN * q_i_rate,
            delta_rate,
            (torque - damping * delta_rate - stiffness * delta) / inertia,
            x_b_rate,
            (ALPHA * RB**2 * A * p + RB * RP * force) / J,
        ]
    )


def rigid(x, force, setting=NOMINAL):
    """Time derivative of [x_p, x_p', p, q_i, q_i', delta, delta'], eqs. (3)-(5), (8), (11)-(13)."""
    inertia, damping, stiffness = setting
    x_p, x_p_rate, p, q_i, q_i_rate, delta, delta_rate = x
    q = q_i - CP * p
    return np.array(
        [
            x_p_rate,
            (ALPHA**2 * RB**2 * A * p + ALPHA * RB * RP * force) / J,
            4 * BETA / VE * (q - A * x_p_rate),
            q_i_rate,
            WN**2 * (CI * K2 * (delta - K3 * x_p) - q_i) - 2 * ZETA * WN * q_i_rate,
            delta_rate,
            (-GMAX * K1 * A * p - damping * delta_rate - stiffness * delta) / inertia,
        ]
    )


def jacobian(derivative, n, **options):
    """State matrix of a linear ``derivative``: its value at each unit vector."""
    return np.column_stack([derivative(column, 0.0, **options) for column in np.eye(n)])
