"""The ideal of a setting: I, B, G of eq. (11), with the pilot's arm where there is one, released from rest.

``x(t + tau) = phi_11(tau) x(t) + phi_12(tau) v(t)`` with the transition matrix of ``x'' + 2 zeta w x' + w^2 x = 0``,

``phi_11 = e^s (cosh r + zeta w tau sinh r / r)``, ``phi_12 = tau e^s sinh r / r``, ``s = -zeta w tau``,
``r = w tau sqrt(zeta^2 - 1)``, which holds below, at and above critical damping.
"""

import numpy as np
from numpy.typing import NDArray

_BLOCK = 64


def frequency_and_damping(feel: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Natural frequency in rad/s and damping ratio of each row I, B, G, eq. (11)."""
    inertia, damping, stiffness = feel.T
    frequency = np.sqrt(stiffness / inertia)
    return frequency, damping / (2 * inertia * frequency)


def ideal_releases(feel: NDArray[np.float64], angle: float, step_s: float, samples: int) -> NDArray[np.float64]:
    """Column angle (settings, samples) from the release at ``angle`` on; exact at the samples."""
    frequency, damping = frequency_and_damping(feel)
    blocks = -(-samples // _BLOCK)
    within = _transition(frequency, damping, np.arange(_BLOCK, dtype=np.float64) * step_s)
    starts = np.arange(blocks, dtype=np.float64) * (_BLOCK * step_s)
    first, second = _transition(frequency, damping, starts)
    # At rest x' = -w^2 phi_12 x_0.
    states = angle * np.stack([first, -(frequency[:, None] ** 2) * second], axis=-1)
    found = states @ np.stack(within, axis=1)
    return np.ascontiguousarray(found.reshape(len(feel), -1)[:, :samples])


def _transition(
    frequency: NDArray[np.float64], damping: NDArray[np.float64], time_s: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """phi_11 and phi_12 (settings, times)."""
    turned = frequency[:, None] * time_s
    s = -damping[:, None] * turned
    r = turned * np.sqrt(damping[:, None] ** 2 - 1 + 0j)
    # e^s cosh r and e^s sinh r / r as sums of e^(s + r) and e^(s - r), none of which grows.
    up, down = np.exp(s + r), np.exp(s - r)
    near = np.abs(r) < _NEAR
    by_r = np.where(near, np.exp(s) * (1 + r * r / 6), (up - down) / np.where(near, 1.0, 2 * r)).real
    cosh = ((up + down) / 2).real
    return cosh - s * by_r, time_s * by_r


_NEAR = 1e-4
"""Where ``sinh r / r`` is ``1 + r^2 / 6`` to rounding."""
