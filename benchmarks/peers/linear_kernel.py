"""The yardstick of the linear runs: the same loop without nonlinear effects, its steps by hand in C, dense and in modal form."""

import ctypes

import numpy as np
from scipy.linalg import expm

from . import case
from .kernel import LANES, aligned, available, build, pointer

__all__ = ["NAMES", "available", "grouped", "run", "simulate"]

NAMES = {"dense": "C by hand, linear, dense", "modal": "C by hand, linear, modal"}
CURRENT_GAIN, PRESSURE_GAIN = 5.45, 0.0102  # C_i, C_p: eqs. (3), (4) in place of eq. (1)
STATES = 8
STEP = case.DURATION / (case.OUTPUTS - 1)


def matrices(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """State matrix of [x_p, p, q_i, q_i', delta, delta', theta, theta'] and its column of the pilot's torque."""
    K_2, w_n, zeta, _, _, A, V_E, beta, k, c, J, K_1, K_3, inertia, B, G = numbers
    lever = case.RATIO * case.BASE_ARM
    M = np.zeros((STATES, STATES))
    M[0, [0, 1, 6, 7]] = -k / c, A / c, lever * k / c, lever
    M[1] = -4 * beta / V_E * A * M[0]
    M[1, [1, 2]] += 4 * beta / V_E * np.array([-PRESSURE_GAIN, 1.0])
    M[2, 3] = M[4, 5] = M[6, 7] = 1.0
    M[3, [0, 2, 3, 4]] = -(w_n**2) * CURRENT_GAIN * K_2 * K_3, -(w_n**2), -2 * zeta * w_n, w_n**2 * CURRENT_GAIN * K_2
    M[5, [1, 4, 5]] = -case.MAXIMUM_STIFFNESS * K_1 * A / inertia, -G / inertia, -B / inertia
    M[7, 1] = lever * A / J
    return M, np.array([*np.zeros(STATES - 1), 1 / J])


def dense(M: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Phi by columns, then g, of one step with the torque held."""
    both = expm(STEP * np.block([[M, column[:, None]], [np.zeros((1, STATES + 1))]]))
    return np.concatenate([both[:STATES, :STATES].T.ravel(), both[:STATES, STATES]])


def modal(M: np.ndarray, column: np.ndarray) -> np.ndarray:
    """The same in pairs of real or conjugate modes, each scaled so that theta is the sum of the pairs' first states."""
    values, vectors = np.linalg.eig(M)
    gains = np.linalg.solve(vectors, column) * vectors[STATES - 2]  # theta per mode
    order = np.lexsort((values.imag, values.real))
    pairs = np.concatenate([order[values[order].imag == 0], order[values[order].imag != 0]]).reshape(-1, 2)
    own, other, g = np.zeros((3, STATES))
    for first, (low, high) in zip(range(0, STATES, 2), pairs, strict=True):
        s = values[[low, high]]
        phi, held = np.exp(STEP * s), gains[[low, high]] * np.expm1(STEP * s) / s
        if s[0].imag:  # theta's part is twice the real part of one mode
            own[[first, first + 1]] = phi[0].real
            other[[first, first + 1]] = -phi[0].imag, phi[0].imag
            g[[first, first + 1]] = 2 * held[0].real, 2 * held[0].imag
        else:  # their sum, and the second by itself
            own[[first, first + 1]] = phi.real
            other[first] = phi[1].real - phi[0].real
            g[[first, first + 1]] = held.sum().real, held[1].real
    return np.concatenate([own, other, g])


def grouped(parameters: np.ndarray, form: str) -> np.ndarray:
    """Matrices (groups, 72 or 24, 8) of the runs; N a multiple of eight."""
    rows = np.array([{"dense": dense, "modal": modal}[form](*matrices(numbers)) for numbers in parameters])
    systems = aligned(len(rows) // LANES, rows.shape[1], LANES)
    systems[:] = rows.reshape(-1, LANES, rows.shape[1]).swapaxes(1, 2)
    return systems


def simulate(systems: np.ndarray, theta: np.ndarray, form: str) -> None:
    """Fills theta (groups, 2001, 8) in rad. What one times."""
    torque = np.where(np.arange(case.OUTPUTS) >= case.STEP_OUTPUT, case.STEP_TORQUE, 0.0)
    library = build("linear_kernel.c")
    library[form](ctypes.c_long(len(systems)), pointer(systems), pointer(torque), pointer(theta))


def run(parameters: np.ndarray, form: str = "dense") -> np.ndarray:
    """theta in rad at `case.TIMES`, (N, 2001); N a multiple of eight."""
    theta = aligned(len(parameters) // LANES, case.OUTPUTS, LANES)
    simulate(grouped(parameters, form), theta, form)
    return theta.swapaxes(1, 2).reshape(-1, case.OUTPUTS)
