"""The feel by current alone as a digital controller runs it, from one sample to the next.

``x`` states of the motor's plant · ``p`` its position at the sample before · ``e`` commands under way, the youngest first · ``T``
period · ``tau`` delay of the command, ``n`` whole periods and a rest

    e+   = -(g x_m + d (x_m - p) / T),      g, d = (r / K_t) (G, B) / (alpha R_b)^2
    x+   = Phi x + Gamma_0 e_(n+1) + Gamma_1 e_n

exact for a command that stays over the period. The velocity is the difference of two samples: there is no sensor of it.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.linear.electric import POSITION, RATE, ElectricPlant
from forcefeel.loader.loader import Loader


def sampled_feel(loader: Loader, *, rigid: bool) -> NDArray[np.float64]:
    """M of ``[x; p; e]+ = M [x; p; e]``; of an electric loader with a ``controller.period``."""
    plant, period = ElectricPlant.of(loader, rigid=rigid), loader["controller.period"]
    whole, rest = divmod(loader["controller.delay"], period)
    states = len(plant.a)
    phi, older, younger = delayed(plant.a, plant.b[:, 1:], period, rest)
    before, first = states, states + 1
    size = first + int(whole) + 1
    command = np.zeros(size)
    row = plant.feel_by_current(loader)
    command[POSITION], command[before] = -(row[POSITION] + row[RATE] / period), row[RATE] / period
    matrix = np.zeros((size, size))
    matrix[:states, :states] = phi
    matrix[:states, -1] = older[:, 0]
    # The command that comes into its own in this period is the one made `whole` samples ago.
    matrix[:states] += np.outer(younger[:, 0], command if whole == 0 else np.eye(size)[-2])
    matrix[before, POSITION] = 1.0
    matrix[first] = command
    matrix[first + 1 :, first:-1] = np.eye(int(whole))
    return matrix


def delayed(
    a: NDArray[np.float64], b: NDArray[np.float64], period_s: float, delay_s: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """``Phi``, and how the command of the sample before and the new one enter over a period: Gamma_0 and Gamma_1."""
    phi, _ = _core.discretize(a, b, period_s)
    after, new = _core.discretize(a, b, period_s - delay_s)
    _, old = _core.discretize(a, b, delay_s)
    return phi, after @ old, new
