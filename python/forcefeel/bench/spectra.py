"""Averaged spectra of two signals."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Signals = tuple[NDArray[np.float64], NDArray[np.float64]]

_LOBE = 2
"""Lines of Hann segments that the removed mean affects."""


@dataclass(frozen=True)
class Spectra:
    """Averaged spectra of an input u and an output y.

    Attributes:
        frequency_hz: Lines above zero and below half of the sampling rate, (lines,).
        uu, uy, yy: ``S_uu``, ``S_uy = mean(U* Y)`` and ``S_yy`` on them.
        averages: Number of independent averages.
    """

    frequency_hz: NDArray[np.float64]
    uu: NDArray[np.float64]
    uy: NDArray[np.complex128]
    yy: NDArray[np.float64]
    averages: float


def by_periods(signals: Signals, step_s: float, samples: int) -> Spectra:
    """Spectra of whole periods of ``samples``, one after the other; each without its mean."""
    return _spectra(signals, step_s, np.ones(samples), samples, 1)


def by_hann(signals: Signals, step_s: float, samples: int) -> Spectra:
    """Spectra of Hann segments of ``samples``, an even number, that overlap by half; each without its mean."""
    return _spectra(signals, step_s, signal.windows.hann(samples, sym=False), samples // 2, _LOBE)


def independent_averages(window: NDArray[np.float64], shift: int, count: int) -> float:
    """Number of independent segments in ``count`` overlapping segments of a smooth spectrum.

    ``n = K / (1 + 2 sum_j (1 - j/K) rho_j)``, ``rho_j = (sum w_k w_(k + j D))^2 / (sum w_k^2)^2`` for segments D apart.

    Args:
        window: Weights of a segment, (samples,).
        shift: Samples D from one segment's start to the next's.
        count: Segments K.

    Source: P. D. Welch, The Use of Fast Fourier Transform for the Estimation of Power Spectra, IEEE Trans. Audio and
    Electroacoustics 15 (1967).
    """
    energy = float(np.sum(window**2))
    total = 1.0
    for j in range(1, min(count, -(-len(window) // shift))):
        rho = (float(np.sum(window[: -j * shift] * window[j * shift :])) / energy) ** 2
        total += 2 * (1 - j / count) * rho
    return count / total


def _spectra(signals: Signals, step_s: float, window: NDArray[np.float64], shift: int, first: int) -> Spectra:
    u, y = signals
    samples = len(window)
    options = {
        "fs": 1 / step_s,
        "window": window,
        "nperseg": samples,
        "noverlap": samples - shift,
        "detrend": "constant",
    }
    frequency, uu = signal.welch(u, **options)
    lines = slice(first, (samples + 1) // 2)
    cross, yy = signal.csd(u, y, **options)[1], signal.welch(y, **options)[1]
    averages = independent_averages(window, shift, (len(u) - samples) // shift + 1)
    return Spectra(frequency[lines], uu[lines], cross[lines], yy[lines], averages)
