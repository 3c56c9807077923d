"""Signals of a spectrum: a multisine with a low crest factor, or a chirp; both ramp up from zero and down to it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.excitation.crest_factor import PeakProblem, low_crest_phases
from forcefeel.bench.excitation.plan import Timing
from forcefeel.simulation.inputs import Chirp
from forcefeel.simulation.inputs.signals import Spacing

_SPANS = (0.0, 0.25, 0.5)
"""Shares of the logarithmic band that a chirp omits below and above."""

_ENDS = 0.05
"""Length of the ramps of a chirp, as a share of its time."""


@dataclass(frozen=True, eq=False)
class Wave:
    """A signal and its spectrum at some scale.

    Attributes:
        words: Description.
        signal: At every sample, (samples,).
        power: Mean square of each line, (lines,), over the samples that are counted.
        counted: Number of samples with information: without the first period of a multisine and without ramps.
    """

    words: str
    signal: NDArray[np.float64]
    power: NDArray[np.float64]
    counted: int


def multisine(
    timing: Timing,
    frequency_hz: NDArray[np.float64],
    power: NDArray[np.float64],
    limited: NDArray[np.complex128],
    travel: NDArray[np.complex128],
) -> Wave:
    """A multisine of these powers.

    Its phases keep the peaks of the limited channels low, for more power. Its start makes the ramp leave the column in place:
    during the ramp ``w(t) e(t)`` an open servo accumulates ``-int w' y dt`` with the travel y of the steady state.

    Args:
        timing: Its samples.
        frequency_hz: Its lines, (lines,).
        power: Mean square of each, above 0, (lines,).
        limited: Responses of the limited channels, in shares of the limits, (limits, lines).
        travel: Response to the column's travel, (lines,).
    """
    harmonics = np.rint(frequency_hz * timing.period_s).astype(np.int64)
    amplitude = np.sqrt(2 * power)
    phases = low_crest_phases(PeakProblem(harmonics, amplitude * limited))
    phasors = amplitude * np.exp(1j * phases)
    start = _quiet_start(_period(timing, harmonics, phasors * travel), timing.ramp)
    period = np.roll(_period(timing, harmonics, phasors), -start)
    signal = np.zeros(timing.samples)
    end = timing.periods * timing.period + timing.ramp
    signal[:end] = np.resize(period, end) * envelope(end, timing.ramp)
    words = (
        f"multisine, {len(harmonics)} lines from {frequency_hz[0]:.4g} to {frequency_hz[-1]:.4g} Hz, "
        f"{timing.periods} periods of {timing.period_s:.4g} s"
    )
    return Wave(words, signal, power, (timing.periods - 1) * timing.period)


def chirps(timing: Timing, frequency_hz: NDArray[np.float64]) -> list[Wave]:
    """Chirps of amplitude 1 over all the time: the whole band or parts of it, evenly over the logarithm or over frequency."""
    low, high = float(frequency_hz[0]), float(frequency_hz[-1])
    spacings: tuple[Spacing, ...] = ("logarithmic", "linear")
    waves = []
    for below in _SPANS:
        for above in _SPANS:
            if below + above >= 1:
                continue
            first, last = low * (high / low) ** below, high * (low / high) ** above
            waves += [_chirp(timing, frequency_hz, (first, last), spacing) for spacing in spacings]
    return waves


def _chirp(timing: Timing, frequency_hz: NDArray[np.float64], band: tuple[float, float], spacing: Spacing) -> Wave:
    count, step_s = timing.samples, 1 / timing.rate_hz
    sampled = Chirp(1.0, *band, count * step_s, spacing).sample(count * step_s, step_s).start
    signal = sampled * envelope(count, int(_ENDS * count))
    words = f"{spacing} chirp from {band[0]:.4g} to {band[1]:.4g} Hz in {count * step_s:.4g} s"
    return Wave(words, signal, power_near(signal, timing.rate_hz, frequency_hz), count)


def power_near(signal: NDArray[np.float64], rate_hz: float, frequency_hz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean square of a signal at each line: its Fourier lines within the band, each added to the nearest line, (lines,)."""
    count = len(signal)
    spectrum = 2 * np.abs(np.fft.rfft(signal) / count) ** 2
    line_hz = np.fft.rfftfreq(count, 1 / rate_hz)
    edges = np.concatenate([[frequency_hz[0]], (frequency_hz[1:] + frequency_hz[:-1]) / 2, [frequency_hz[-1]]])
    inside = (line_hz >= edges[0]) & (line_hz <= edges[-1])
    return np.histogram(line_hz[inside], edges, weights=spectrum[inside])[0]


def envelope(count: int, ramp: int) -> NDArray[np.float64]:
    """From 0 to 1 and back, ``(1 - cos)/2`` at either end, 1 between, (count,)."""
    shape = np.ones(count)
    rise = (1 - np.cos(np.pi * np.arange(ramp) / max(ramp, 1))) / 2
    shape[:ramp] = rise
    shape[count - ramp :] = rise[::-1]
    return shape


def _period(timing: Timing, harmonics: NDArray[np.int64], phasors: NDArray[np.complex128]) -> NDArray[np.float64]:
    """One period of the sum of ``Re(phasor exp(2 pi j f t))``."""
    spectrum = np.zeros(timing.period // 2 + 1, dtype=np.complex128)
    spectrum[harmonics] = phasors * timing.period / 2
    return np.fft.irfft(spectrum, timing.period)


def _quiet_start(travel: NDArray[np.float64], ramp: int) -> int:
    """The sample at which the ramp's weighted mean of the steady travel is nearest to zero."""
    count = len(travel)
    weights = np.zeros(count)
    weights[:ramp] = np.diff(envelope(2 * ramp + 1, ramp)[: ramp + 1]) if ramp else 0.0
    gathered = np.fft.irfft(np.fft.rfft(travel) * np.fft.rfft(weights).conj(), count)
    return int(np.argmin(np.abs(gathered)))
