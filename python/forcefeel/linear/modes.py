"""Poles with frequency and damping."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.models import StateSpaceLike, check_model
from forcefeel.units import HERTZ, RATE, RATIO


@dataclass(frozen=True)
class Mode:
    """A real pole or a conjugate pair, ``s = -zeta w +- w sqrt(zeta^2 - 1)``.

    Attributes:
        real_per_s: Real part of the pole.
        imaginary_per_s: Imaginary part, zero or positive.
        frequency_rad_per_s: Distance w of the pole from the origin.
        damping_ratio: zeta; 1 for a stable real pole, negative for an unstable one.
    """

    real_per_s: Annotated[float, RATE]
    imaginary_per_s: Annotated[float, RATE]
    frequency_rad_per_s: Annotated[float, HERTZ]
    damping_ratio: Annotated[float, RATIO]


def modes(model: StateSpaceLike) -> tuple[Mode, ...]:
    """The modes of ``model``, slowest first; a conjugate pair counts once.

    Example:
        >>> for mode in ff.modes(ff.linear.ideal_feel(ff.elevator())):
        ...     print(f"{mode.frequency_rad_per_s:.2f} rad/s, damping ratio {mode.damping_ratio:.2f}")
        12.65 rad/s, damping ratio 0.20
    """
    check_model("model", model)
    poles = sorted((complex(s) for s in np.linalg.eigvals(model.A) if s.imag >= 0), key=abs)
    return tuple(Mode(s.real, s.imag, abs(s), -s.real / abs(s) if s != 0 else 0.0) for s in poles)


MARGINAL_PER_S = 1e-6
"""A pole closer to the imaginary axis than this takes days to move: an integrator, or rounding of one."""


def is_stable(abscissa_per_s: float) -> bool:
    """Whether the largest real part of the poles lies clearly in the left half plane."""
    return abscissa_per_s < -MARGINAL_PER_S


def spectral_abscissa(a: NDArray[np.float64]) -> float:
    """Largest real part of the eigenvalues of the state matrix ``a`` in 1/s."""
    return float(np.max(np.linalg.eigvals(a).real))


def least_damped(modes: Iterable[Mode]) -> Mode:
    """The mode of the smallest damping ratio."""
    return min(modes, key=lambda mode: mode.damping_ratio)


def feel_mode(modes: tuple[Mode, ...], frequency_rad_per_s: float, damping_ratio: float) -> Mode:
    """The mode of a loader that renders a feel of this frequency and damping ratio.

    For an underdamped feel the oscillating mode that is nearest in frequency, on a logarithmic scale. An overdamped feel
    has two real poles, so its rendering is the slowest pair: an oscillating mode or two real poles, which make one
    oscillator of the same product and sum.
    """
    if damping_ratio < 1:
        swinging = [mode for mode in modes if mode.imaginary_per_s > 0] or list(modes)
        return min(swinging, key=lambda mode: abs(np.log(mode.frequency_rad_per_s / frequency_rad_per_s)))
    first, second = modes[:2]
    if first.imaginary_per_s > 0 or second.imaginary_per_s > 0:
        return first
    w = float(np.sqrt(abs(first.real_per_s * second.real_per_s)))
    mean = (first.real_per_s + second.real_per_s) / 2
    return Mode(mean, 0.0, w, -mean / w)
