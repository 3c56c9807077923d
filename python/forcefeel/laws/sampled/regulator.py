"""The regulator: state feedback that brings the column's angle to where it should be, at least cost.

``s = [x; e_h]`` deviation of plant and held command from where they should be · ``K`` gains · ``P`` cost

    sum over samples of  theta^2 + w_r theta'^2 + w_e e^2,   e = -K s
    K = (w_e + Gamma' P Gamma)^-1 Gamma' P Phi                                 eqs. (22) at their fixed point
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.tuning import Tuning
from forcefeel.linear.riccati import stationary


@dataclass(frozen=True, eq=False)
class Regulator:
    """Gains and how well they are proved.

    Attributes:
        gains: K on ``[x; e_h]``, (n + 1,).
        cost: P, (n + 1, n + 1).
        riccati_residual: Residual of the Riccati equation, as a share of the cost.
    """

    gains: NDArray[np.float64] = field(repr=False)
    cost: NDArray[np.float64] = field(repr=False)
    riccati_residual: float


def regulate(plant: SampledPlant, tuning: Tuning, inertia_ratio: float, stretch: float = 0.0) -> Regulator:
    """The regulator for a programmed inertia of so many of the column's, and a stiffness of so many of the link's.

    Raises:
        numpy.linalg.LinAlgError: If it has no solution in double precision.
    """
    a, b, arm = plant.transition, plant.input[:, None], plant.arm_gain(inertia_ratio)
    q = np.zeros_like(a)
    base, rate = plant.places.base, plant.places.base_rate
    q[base, base] = 1.0
    if tuning.rate_weight is not None:
        q[rate, rate] = tuning.rate_weight.at(inertia_ratio, stretch, arm)
    r = np.array([[tuning.command_weight.at(inertia_ratio, stretch, arm)]])
    cost, left = stationary(a, b, q, r)
    gains = np.linalg.solve(r + b.T @ cost @ b, b.T @ cost @ a)
    return Regulator(gains[0], cost, left)
