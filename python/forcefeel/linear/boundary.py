"""The smallest programmed stiffness at which the loader is stable."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import Compensator
from forcefeel.linear.models import Linkage
from forcefeel.linear.modes import spectral_abscissa
from forcefeel.loader.loader import Loader
from forcefeel.units import HERTZ, ROTARY_STIFFNESS

_LOWEST = 1e-6
"""Share of G_max below which no boundary is looked for: far below any stiffness that a pilot could feel."""


@dataclass(frozen=True)
class StabilityBoundary:
    """Where the loader becomes unstable as G falls from G_max, with I and B scaled along.

    Attributes:
        stiffness_n_m_per_rad: The smallest stable G; zero if the loader stays stable all the way down, infinite if it
            is unstable at G_max already.
        frequency_rad_per_s: Frequency of the oscillation at the boundary; zero where a real pole crosses.
        note: What was found, in words.

    Example:
        >>> import forcefeel as ff
        >>> ff.linear.smallest_stable_stiffness(ff.elevator()).note
        'lost by oscillation at 12.0 Hz'
    """

    stiffness_n_m_per_rad: Annotated[float, ROTARY_STIFFNESS]
    frequency_rad_per_s: Annotated[float, HERTZ]
    note: str


def smallest_stable_stiffness(
    loader: Loader, linkage: Linkage = Linkage.COMPLIANT, compensator: Compensator | None = None
) -> StabilityBoundary:
    """The smallest G at which the loader is stable, frequency and damping ratio of the feel kept.

    The largest real part of the poles is followed downwards from G_max, or from the programmed G if that is larger, until
    it changes sign; the root between is then bracketed to rounding by Brent's method.

    Args:
        loader: The loader.
        linkage: Rigid or compliant link.
        compensator: A fixed law; the original one, eq. (13), if not given. State feedback may stay fixed along the
            way, because its gains depend on I, B, G only through G/I and B/I.

    Example:
        >>> import forcefeel as ff
        >>> edge = ff.linear.smallest_stable_stiffness(ff.elevator())
        >>> f"{edge.stiffness_n_m_per_rad:.0f} N m/rad"
        '428 N m/rad'
    """
    build = _core.rigid if linkage is Linkage.RIGID else _core.compliant
    law = compensator or Compensator.original(loader.values)

    def closed_loop(log_share: float) -> NDArray[np.float64]:
        scale = np.exp(log_share) * loader["feel.maximum_stiffness"] / loader["feel.stiffness"]
        return build(loader.scale_feel(scale).values, law)[0]

    start = max(0.0, float(np.log(loader["feel.stiffness"] / loader["feel.maximum_stiffness"])))
    edge = _first_crossing(lambda log_share: spectral_abscissa(closed_loop(log_share)), start)
    if edge is None:
        return StabilityBoundary(0.0, 0.0, f"stable from G_max down to {_LOWEST:g} of it")
    if edge == np.inf:
        return StabilityBoundary(np.inf, 0.0, "unstable at G_max already")
    poles = np.linalg.eigvals(closed_loop(edge))
    frequency = abs(poles[np.argmax(poles.real)].imag)
    stiffness = np.exp(edge) * loader["feel.maximum_stiffness"]
    how = f"oscillation at {frequency / 2 / np.pi:.1f} Hz" if frequency > 0 else "real pole"
    return StabilityBoundary(float(stiffness), float(frequency), f"lost by {how}")


def _first_crossing(abscissa: Callable[[float], float], start: float) -> float | None:
    """Where ``abscissa`` first becomes positive on the way down from ``start``; None if nowhere, infinite if at once."""
    path = np.linspace(start, np.log(_LOWEST), 141)  # tenths of a power of e: far finer than the poles move
    if abscissa(path[0]) >= 0:
        return np.inf
    for above, below in pairwise(path):
        if abscissa(below) >= 0:
            return float(scipy.optimize.brentq(abscissa, below, above, xtol=1e-13, rtol=1e-13))
    return None
