"""Ideal release of a setting: I, B, G of eq. (11), with the pilot's arm if any, released from rest.

``x(t + tau) = phi_11(tau) x(t) + phi_12(tau) v(t)`` with the transition matrix of ``x'' + 2 zeta w x' + w^2 x = 0``.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core

_BLOCK = 64


def ideal_releases(feel: NDArray[np.float64], angle: float, step_s: float, samples: int) -> NDArray[np.float64]:
    """Column angle (settings, samples) after the release at ``angle``; exact at the samples."""
    blocks = -(-samples // _BLOCK)
    within = _core.feel_transitions(feel, np.arange(_BLOCK, dtype=np.float64) * step_s)[:, :, 0]
    starts = np.arange(blocks, dtype=np.float64) * (_BLOCK * step_s)
    # Released from rest, so only the first column of the transition matrix counts.
    states = angle * _core.feel_transitions(feel, starts)[..., 0]
    angles = states @ within.swapaxes(1, 2)
    return np.ascontiguousarray(angles.reshape(len(feel), -1)[:, :samples])
