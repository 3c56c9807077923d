"""Stationary Riccati equations.

The discrete one by doubling in Rust, checked by its residual: the most exact for a filter or a regulator in scaled units. Near the
least gamma of an H-infinity filter rounding leaves a larger residual, to doubling as to SciPy's deflating subspaces.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core

MOST_RESIDUAL = 1e-8
"""Relative; a solution with more is refused. Those of the elevator's designs have 1e-12 at most."""

_ROUNDING = 1e-12
"""Of a pole near one."""


def stationary(
    a: NDArray[np.float64], b: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """The stabilizing ``P`` of ``P = a' P a - a' P b (r + b' P b)^-1 b' P a + q``, and its ``residual``.

    Raises:
        numpy.linalg.LinAlgError: If it has no solution, or none in double precision.
    """
    doubled = _core.stationary(a, b, q, r)
    if doubled is None:
        raise np.linalg.LinAlgError("Riccati equation: doubling does not converge")
    solution, left = doubled
    if not left <= MOST_RESIDUAL:
        raise np.linalg.LinAlgError(f"Riccati equation: residual of {left:.1e}")
    if not np.abs(np.linalg.eigvals(a - b @ _gain(a, b, r, solution))).max() < 1 - _ROUNDING:
        raise np.linalg.LinAlgError("Riccati equation: a state is left that does not decay")
    return solution, left


def stationary_continuous(
    a: NDArray[np.float64], g: NDArray[np.float64], q: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The stabilizing ``P`` of ``A' P + P A - P G P + Q = 0``, from the stable invariant subspace of its Hamiltonian matrix.

    Raises:
        numpy.linalg.LinAlgError: If a pole lies on the imaginary axis.

    Source: A. J. Laub, A Schur method for solving algebraic Riccati equations, IEEE Trans. Automatic Control 24 (1979).
    """
    poles, vectors = np.linalg.eig(np.block([[a, -g], [-q, -a.T]]))
    stable = vectors[:, poles.real < 0]
    if stable.shape[1] != len(a):
        raise np.linalg.LinAlgError("Riccati equation: a pole on the imaginary axis")
    cost = np.linalg.solve(stable[: len(a)].T, stable[len(a) :].T).T.real
    return np.asarray(cost + cost.T) / 2


def residual(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    q: NDArray[np.float64],
    r: NDArray[np.float64],
    p: NDArray[np.float64],
) -> float:
    """How far ``p`` is from solving the equation, as a share of its largest number."""
    closed = a - b @ _gain(a, b, r, p)
    return float(np.abs(a.T @ p @ closed + q - p).max() / np.abs(p).max())


def _gain(
    a: NDArray[np.float64], b: NDArray[np.float64], r: NDArray[np.float64], p: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.asarray(np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a))
