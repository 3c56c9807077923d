"""Losses of a fit, as ``scipy.optimize.least_squares`` defines them: ``rho(z)`` of ``z = (r / C)^2``, and its derivative.

``r`` residuals in units of the noise · ``C`` threshold of the robust loss
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Loss = Literal["linear", "huber", "soft_l1", "cauchy"]
"""Loss of large residuals: full or robust."""

ROBUST_FROM = 3.0
"""Threshold of the robust loss in standard deviations, rarely exceeded by normal noise."""

_Of = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_LOSSES: Mapping[str, tuple[_Of, _Of]] = MappingProxyType(
    {
        "linear": (lambda z: z, np.ones_like),
        "huber": (
            lambda z: np.where(z <= 1, z, 2 * np.sqrt(z) - 1),
            lambda z: np.where(z <= 1, 1.0, 1 / np.sqrt(np.maximum(z, 1.0))),
        ),
        "soft_l1": (lambda z: 2 * (np.sqrt(1 + z) - 1), lambda z: 1 / np.sqrt(1 + z)),
        "cauchy": (np.log1p, lambda z: 1 / (1 + z)),
    }
)
"""rho and its derivative by name."""


def cost_of(residual: NDArray[np.float64], loss: Loss) -> float:
    """``1/2 C^2 sum rho((r / C)^2)``: half the sum of squares without large residuals."""
    rho, _ = _LOSSES[loss]
    return float(0.5 * ROBUST_FROM**2 * np.sum(rho((residual / ROBUST_FROM) ** 2)))


def weight_of(residual: NDArray[np.float64], loss: Loss) -> NDArray[np.float64]:
    """Weight of each residual, ``rho'((r / C)^2)``: 1 if it is not large."""
    _, slope = _LOSSES[loss]
    return slope((residual / ROBUST_FROM) ** 2)
