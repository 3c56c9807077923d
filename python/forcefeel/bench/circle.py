"""Circle fit of a response about a resonance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

_MOST_OFF = 0.1
"""Largest r.m.s. distance of the lines from the circle, as a share of its radius."""
_LEAST_SWEEP_RAD = 1.0
"""Least angle that the lines sweep, rad; a shorter arc does not determine a circle."""


@dataclass(frozen=True)
class Mode:
    """A mode by its circle.

    Attributes:
        frequency_hz: Undamped natural frequency.
        damping_ratio: Damping ratio.
        off: R.m.s. distance of the lines from the circle, as a share of its radius.
    """

    frequency_hz: float
    damping_ratio: float
    off: float


def fit_mode(frequency_hz: NDArray[np.float64], mobility: NDArray[np.complex128]) -> Mode | str:
    """Natural frequency and damping ratio from the circle of a mobility, or the reason why there is no circle.

    A mobility ``A j w / (w_n^2 - w^2 + 2 j zeta w_n w) + D`` with complex constants A and D goes round a circle. Seen from its
    center it stands at ``theta = theta_n - 2 atan((w/w_n - w_n/w) / (2 zeta))``: it sweeps fastest at ``w_n``. Center and radius
    are those of least squares (linear, then by distance), ``theta_n``, ``w_n`` and ``zeta`` those of least squares of the angles.

    Args:
        frequency_hz: Rising frequencies about one resonance, (lines,).
        mobility: Complex response, velocity per force, (lines,).

    Source: D. J. Ewins, Modal Testing, 2nd ed. (2000), sec. 4.3.3; I. Kasa, A Circle Fitting Procedure and Its Error Analysis, IEEE
    Trans. Instrumentation and Measurement 25 (1976).
    """
    if len(frequency_hz) < 4:
        return f"{len(frequency_hz)} lines are too few for a circle; measure at more frequencies about the peak"
    scale = float(np.max(np.abs(mobility)))
    center, radius = _circle(mobility / scale)
    points = mobility / scale - center
    misfit = float(np.sqrt(np.mean((np.abs(points) - radius) ** 2))) / radius
    if not misfit < _MOST_OFF:
        return f"the lines about the peak are {misfit:.0%} of its radius off a circle: several modes, or noise; narrow the band"
    angle = _clockwise(np.angle(points))
    if abs(float(np.ptp(angle))) < _LEAST_SWEEP_RAD:
        return (
            f"the lines about the peak sweep {np.ptp(angle):.2g} rad of a circle; measure at more frequencies about it"
        )
    return _sweep(frequency_hz, angle, misfit)


def _clockwise(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unwrapped angles: a passive mode sweeps clockwise, by up to three quarters of a turn from line to line."""
    steps = np.diff(angle)
    steps = steps - 2 * np.pi * np.ceil((steps - np.pi / 2) / (2 * np.pi))
    return np.asarray(angle[0] + np.concatenate(([0.0], np.cumsum(steps))))


def _circle(z: NDArray[np.complex128]) -> tuple[complex, float]:
    """Center and radius of the circle nearest to points of size one."""
    rows = np.column_stack((2 * z.real, 2 * z.imag, np.ones(len(z))))
    x, y, constant = np.linalg.lstsq(rows, np.abs(z) ** 2, rcond=None)[0]

    def residual(p: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.abs(z - complex(p[0], p[1])) - p[2])

    start = [x, y, np.sqrt(max(constant + x**2 + y**2, np.finfo(np.float64).tiny))]
    solution = least_squares(residual, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, method="lm").x
    return complex(solution[0], solution[1]), abs(float(solution[2]))


def _sweep(f: NDArray[np.float64], angle: NDArray[np.float64], misfit: float) -> Mode | str:
    """Frequency and damping from the angles: initial values at the fastest sweep, then least squares."""
    speed = np.maximum(-np.diff(angle), 0.0) / np.diff(f)
    fastest = int(np.argmax(speed))
    guess = float(np.sqrt(f[fastest] * f[fastest + 1]))
    # At resonance |d theta / d w| = 2 / (zeta w_n).
    damping = min(2 / (float(speed[fastest]) * guess), 1.0)

    def residual(p: NDArray[np.float64]) -> NDArray[np.float64]:
        at, share = f / (guess * np.exp(p[1])), damping * np.exp(p[2])
        return np.asarray(p[0] - 2 * np.arctan((at - 1 / at) / (2 * share)) - angle)

    start = [0.5 * float(angle[fastest] + angle[fastest + 1]), 0.0, 0.0]
    solution = least_squares(residual, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, method="lm")
    frequency, ratio = guess * float(np.exp(solution.x[1])), damping * float(np.exp(solution.x[2]))
    if not (f[0] <= frequency <= f[-1] and 0 < ratio < 1):
        return "the angle about the circle's center does not sweep as that of one mode does; narrow the band"
    return Mode(frequency, ratio, misfit)
