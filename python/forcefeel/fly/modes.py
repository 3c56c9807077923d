"""Modes of a recorded free motion by a matrix pencil.

The samples `y_k` of a free motion are sums of `z_i^k`. Of two Hankel matrices, the second a sample later, `z_i` are the
eigenvalues of `H_0^+ H_1` within the strongest singular directions of `H_0`; `s_i = ln z_i / h`.

Source: Y. Hua and T. K. Sarkar, Matrix pencil method for estimating parameters of exponentially damped/undamped sinusoids in
noise, IEEE Trans. Acoust., Speech, Signal Process. 38 (1990), 814-824.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.modes import Mode

_WINDOW = 3
"""Share of the samples in a row of the Hankel matrix: one third."""


def free_modes(signals: NDArray[np.float64], period_s: float, order: int) -> tuple[Mode, ...]:
    """The oscillations in a free motion, slowest first.

    Args:
        signals: Samples from the motion's rest, (signals, samples).
        period_s: Time between samples.
        order: Number of poles, real ones too.

    Example:
        >>> time = np.arange(100) * 0.1
        >>> (mode,) = ff.fly.free_modes(np.exp(-0.3 * time)[None] * np.cos(2 * time)[None], 0.1, 2)
        >>> round(mode.imaginary_per_s, 6), round(mode.real_per_s, 6)
        (2.0, -0.3)
    """
    scaled = signals / np.ptp(signals, axis=1, keepdims=True)
    width = signals.shape[1] // _WINDOW
    rows = np.concatenate([np.lib.stride_tricks.sliding_window_view(signal, width) for signal in scaled], axis=1)
    u, s, v = np.linalg.svd(rows[:-1], full_matrices=False)
    moved = (u[:, :order].T @ rows[1:] @ v[:order].T) / s[:order]
    poles = np.log(np.linalg.eigvals(moved).astype(complex)) / period_s
    pairs = sorted((complex(pole) for pole in poles if pole.imag > 0), key=abs)
    return tuple(Mode(pole.real, pole.imag, abs(pole), -pole.real / abs(pole)) for pole in pairs)
