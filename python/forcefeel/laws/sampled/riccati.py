"""Stationary discrete Riccati equations, their solution checked by its residual.

By doubling in Rust, which is also the most exact for a filter or a regulator in scaled units. Where rounding leaves it a larger
residual, such as in an equation of H-infinity, by SciPy's deflating subspaces.
"""

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from forcefeel import _core

MOST_RESIDUAL = 1e-8
"""Relative; a solution with more is refused. Those of the elevator's designs have 1e-12 at most."""

_EXACT = 1e-12
"""Residual up to which doubling is taken: that of SciPy in the elevator's designs."""

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
    if doubled is not None and doubled[1] <= _EXACT:
        return doubled
    try:
        solution = np.asarray(scipy.linalg.solve_discrete_are(a, b, q, r))
    except ValueError as error:  # a pencil that cannot be reordered
        raise np.linalg.LinAlgError(str(error)) from error
    left = residual(a, b, q, r, solution)
    if not left <= MOST_RESIDUAL:
        raise np.linalg.LinAlgError(f"Riccati equation: residual of {left:.1e}")
    if not np.abs(np.linalg.eigvals(a - b @ _gain(a, b, r, solution))).max() < 1 - _ROUNDING:
        raise np.linalg.LinAlgError("Riccati equation: a state is left that does not decay")
    return solution, left


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
