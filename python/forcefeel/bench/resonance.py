"""Frequency and damping ratio of one resonance of a measured response, and the stiffness and damping of the link."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from forcefeel import _core
from forcefeel.bench.circle import fit_mode
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader

Kind = Literal["receptance", "mobility"]

FEWEST_LINES = 3
"""Least number of lines between the half-power points."""
FEWEST_IN_BAND = 5
"""Least number of lines in the band and of a circle."""

_HALF_POWER_DB = 10 * math.log10(2)
_VELOCITIES = ("column_velocity", "actuator_flow", "motor_speed")


@dataclass(frozen=True)
class Reading:
    """A resonance by one method.

    Attributes:
        frequency_hz: Undamped natural frequency, Hz; ``None`` if it cannot be read.
        damping_ratio: Damping ratio; ``None`` likewise.
        note: Details of the reading, or the reason why it cannot be read.
    """

    frequency_hz: float | None
    damping_ratio: float | None
    note: str


@dataclass(frozen=True)
class Resonance:
    """The highest resonance of a response in a band.

    Attributes:
        kind: ``receptance`` for a displacement (or force) per input, ``mobility`` for a velocity (or flow).
        half_power: From the peak and the two points 3 dB below it.
        circle: From a circle through the response about the peak.
        note: For which responses the two hold.
    """

    kind: Kind
    half_power: Reading
    circle: Reading
    note: str

    @property
    def frequency_hz(self) -> float | None:
        """By the circle if it can be read, else by half power."""
        return self._best.frequency_hz

    @property
    def damping_ratio(self) -> float | None:
        """By the circle if it can be read, else by half power."""
        return self._best.damping_ratio

    @property
    def _best(self) -> Reading:
        return self.half_power if self.circle.frequency_hz is None else self.circle


def read_resonance(response: Response, band_hz: tuple[float, float] | None = None) -> Resonance:
    """Read frequency and damping ratio of the highest peak of a response.

    For one mode, ``G = R / (w_n^2 - w^2 + 2 j zeta w_n w)`` (receptance) or ``j w`` times that (mobility), with the gain at
    ``w_1`` and ``w_2`` the square root of half of the peak's:

    * receptance: ``zeta = sin(phi / 2)``, ``tan phi = (w_2^2 - w_1^2) / (w_2^2 + w_1^2)``,
      ``w_n^2 = (w_1^2 + w_2^2) / (2 (1 - 2 zeta^2))``;
    * mobility: ``w_n^2 = w_1 w_2``, ``zeta = (w_2 - w_1) / (2 w_n)``.

    Both are exact for viscous damping. The peak and the two points are those of a cubic spline through the gain in dB over the
    logarithm of the frequency. The circle is that of the mobility, a receptance times ``j w``; see ``circle.fit_mode``.

    Args:
        response: A measured response; its input should be like a force.
        band_hz: Lower and upper frequency of the search; default, the whole response.

    Raises:
        InputError: If the band does not rise or has fewer than five lines.

    Source: D. J. Ewins, Modal Testing, 2nd ed. (2000), ch. 4.

    Example:
        >>> f = np.arange(4, 24, 0.25)
        >>> receptance = 1 / (144 - f**2 + 2.4j * f)
        >>> experiment = ff.bench.Experiment.read("servo-closed")
        >>> swing = ff.bench.Response("swing", experiment, "pilot_force", "column_angle", f, receptance)
        >>> round(ff.bench.read_resonance(swing).frequency_hz, 2)
        12.0
    """
    low, high = (0.0, math.inf) if band_hz is None else band_hz
    if not 0 <= low < high:
        raise InputError(
            f"{response.name}: band_hz: expected two rising frequencies, got {low:.6g} Hz to {high:.6g} Hz"
        )
    f, g = response.frequency_hz, response.value
    inside = (f >= low) & (f <= high)
    if (lines := int(np.count_nonzero(inside))) < FEWEST_IN_BAND:
        raise InputError(
            f"{response.name}: band_hz: expected {FEWEST_IN_BAND} lines at least, got {lines}; widen the band, or measure at more "
            "frequencies"
        )
    f, g = f[inside], g[inside]
    kind: Kind = "mobility" if response.output in _VELOCITIES else "receptance"
    spline = CubicSpline(np.log(f), 20 * np.log10(np.abs(g)))
    peak = _peak(spline)
    if isinstance(peak, str):
        unread = Reading(None, None, f"not read: {peak}")
        return Resonance(kind, unread, unread, _holds_for(response, kind))
    mobility = g if kind == "mobility" else g * 2j * np.pi * f
    return Resonance(
        kind, _by_half_power(spline, peak, kind), _by_circle(f, mobility, peak), _holds_for(response, kind)
    )


def link_from_resonance(loader: Loader, frequency_hz: float, damping_ratio: float) -> tuple[float, float]:
    """Stiffness k and damping c of the link for a natural frequency and damping ratio of the column.

    The drive's end is fixed: ``J theta'' + (alpha R_b)^2 (c theta' + k theta) = 0``. On a machine this holds only if the drive is
    blocked; a free rotor raises the resonance.
    The elevator's link has 12 Hz and 0.1. With its servo the column resonates at 11.8 Hz and 0.169 in open loop, at 11.4 Hz and
    0.164 in closed loop, which gives c too large by 60 %. A fit of the whole model includes the oil.

    Args:
        loader: The loader, for the column's inertia and arm.
        frequency_hz: Undamped natural frequency, Hz, above 0.
        damping_ratio: Damping ratio, above 0.

    Returns:
        k in N/m and c in N s/m, as ``linkage.stiffness`` and ``linkage.damping``.

    Raises:
        InputError: If a number is not finite and above zero.

    Source: The report's appendix, 12 Hz and 0.1.

    Example:
        >>> k, c = ff.bench.link_from_resonance(ff.elevator(), frequency_hz=12.0, damping_ratio=0.1)
        >>> f"{k:.4g} N/m, {c:.4g} N s/m"
        '1.07e+06 N/m, 2837 N s/m'
    """
    for name, value in (("frequency_hz", frequency_hz), ("damping_ratio", damping_ratio)):
        if not 0 < value < math.inf:
            raise InputError(f"{name}: expected a number above 0, got {value}")
    return _core.linkage_from_resonance(loader.si_values, 2 * math.pi * frequency_hz, damping_ratio)


def _peak(spline: CubicSpline) -> float | str:
    """Logarithm of the frequency at the largest gain, or the reason why it is no peak."""
    turning = spline.derivative().roots(extrapolate=False)
    candidates = np.concatenate((spline.x, turning[np.isfinite(turning)]))
    peak = float(candidates[int(np.argmax(spline(candidates)))])
    if not spline.x[0] < peak < spline.x[-1]:
        return f"the gain is largest at the edge, {math.exp(peak):.4g} Hz: no peak in the band; measure beyond it"
    return peak


def _by_half_power(spline: CubicSpline, peak: float, kind: Kind) -> Reading:
    crossings = spline.solve(float(spline(peak)) - _HALF_POWER_DB, extrapolate=False)
    below, above = crossings[crossings < peak], crossings[crossings > peak]
    where = f"the peak at {math.exp(peak):.4g} Hz"
    if not len(below) or not len(above):
        side = "above" if len(below) else "below"
        return Reading(
            None, None, f"not read: the gain does not fall by 3 dB {side} {where}; measure further {side} it"
        )
    low, high = float(below.max()), float(above.min())
    if (lines := int(np.count_nonzero((spline.x >= low) & (spline.x <= high)))) < FEWEST_LINES:
        few = f"{lines} lines lie within 3 dB of {where}; expected at least {FEWEST_LINES}"
        return Reading(None, None, f"not read: {few}; measure at more frequencies about it")
    low, high = math.exp(low), math.exp(high)
    note = f"half power at {low:.4g} Hz and {high:.4g} Hz"
    if kind == "mobility":
        frequency = math.sqrt(low * high)
        return Reading(frequency, (high - low) / (2 * frequency), note)
    damping = math.sin(0.5 * math.atan2(high**2 - low**2, high**2 + low**2))
    return Reading(math.sqrt((low**2 + high**2) / (2 * (1 - 2 * damping**2))), damping, note)


def _by_circle(f: NDArray[np.float64], mobility: NDArray[np.complex128], peak: float) -> Reading:
    """From the lines about the peak that are within 3 dB of the largest, or the five about it."""
    gain = 20 * np.log10(np.abs(mobility))
    nearest = int(np.argmin(np.abs(np.log(f) - peak)))
    low = gain < np.max(gain[max(nearest - 1, 0) : nearest + 2]) - _HALF_POWER_DB
    first = nearest - int(np.argmax(np.append(low[nearest::-1], True))) + 1
    last = nearest + int(np.argmax(np.append(low[nearest:], True)))
    first, last = min(first, nearest), max(last, nearest + 1)
    while last - first < FEWEST_IN_BAND:
        first, last = max(first - 1, 0), min(last + 1, len(f))
    fit = fit_mode(f[first:last], mobility[first:last])
    if isinstance(fit, str):
        return Reading(None, None, f"not read: {fit}")
    note = f"circle through {last - first} lines from {f[first]:.4g} Hz to {f[last - 1]:.4g} Hz, {fit.off:.1%} of its radius off"
    return Reading(fit.frequency_hz, fit.damping_ratio, note)


def _holds_for(response: Response, kind: Kind) -> str:
    quantities = "a displacement or a force" if kind == "receptance" else "a velocity or a flow"
    reading = f"{response.output} is read as {quantities}: the {kind} of one mode by itself, driven by a force"
    if response.input == "pilot_force":
        return reading
    return f"{reading}; {response.input} is no force, so half power is off by the order of the damping ratio; the circle by less"
