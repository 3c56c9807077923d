"""Poles of many sampled systems, and whether they are inside the unit circle."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core


def sampled_poles(matrices: NDArray[np.float64], threads: int) -> NDArray[np.complex128]:
    """Poles of each matrix (systems, states, states); not numbers where the matrix is not made of numbers."""
    good = np.isfinite(matrices).all(axis=(1, 2))
    poles = np.full(matrices.shape[:2], complex(np.nan, np.nan))
    with ThreadPoolExecutor(threads) as pool:  # NumPy lets go of the interpreter meanwhile
        parts = np.array_split(matrices[good], threads)
        poles[good] = np.concatenate(list(pool.map(np.linalg.eigvals, parts)))
    return poles


def inside_unit_circle(matrices: NDArray[np.float64], threads: int) -> NDArray[np.bool_]:
    """Whether all poles of each matrix are inside the unit circle: by its powers, or by the poles where these do not tell."""
    verdict = _core.inside_unit_circle(matrices, threads)
    inside, untold = verdict == 1, verdict < 0
    if untold.any():
        inside[untold] = np.abs(sampled_poles(matrices[untold], threads)).max(axis=1) < 1
    return np.asarray(inside)
