"""The programmed stiffness on the edge of stability: the smallest under a valve, the largest under a motor."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.linear.bracketing import root_between
from forcefeel.linear.models import Linkage, loader_model
from forcefeel.linear.modes import spectral_abscissa
from forcefeel.linear.sampled_feel import sampled_feel
from forcefeel.loader.loader import Loader, check_electric, check_hydraulic
from forcefeel.units import HERTZ, ROTARY_STIFFNESS

_LOWEST = 1e-6
"""Share of G_max below which no boundary is looked for: far below any stiffness that a pilot could feel."""


@dataclass(frozen=True)
class StabilityBoundary:
    """Where the loader becomes unstable as G changes, with I and B scaled along.

    Attributes:
        stiffness_n_m_per_rad: As G falls from G_max the smallest stable one; zero if the loader stays stable all the way down,
            infinite if it is unstable at G_max already. As it grows from next to nothing the largest; infinite if the loader stays
            stable all the way up, zero if it is unstable from the first.
        frequency_rad_per_s: Frequency of the oscillation at the boundary; zero where a real pole crosses.
        note: What was found, in words.
    """

    stiffness_n_m_per_rad: Annotated[float, ROTARY_STIFFNESS]
    frequency_rad_per_s: Annotated[float, HERTZ]
    note: str


def smallest_stable_stiffness(
    loader: Loader, linkage: Linkage = Linkage.COMPLIANT, law: GainLaw | None = None
) -> StabilityBoundary:
    """The smallest G at which the loader is stable, frequency and damping ratio of the feel kept.

    The largest real part of the poles is followed downwards from G_max, or from the programmed G if that is larger, until
    it changes sign; the root between is then bracketed to rounding by ``root_between``.

    Args:
        loader: The loader.
        linkage: Rigid or compliant link.
        law: A fixed law; the original one, eq. (13), if not given. State feedback may stay fixed along the
            way, because its gains depend on I, B, G only through G/I and B/I.

    Raises:
        InputError: If the loader has a motor, whose feel by current alone bears any softness.

    Example:
        >>> edge = ff.linear.smallest_stable_stiffness(ff.elevator())
        >>> f"{edge.stiffness_n_m_per_rad:.0f} N m/rad"
        '428 N m/rad'
    """
    check_hydraulic(loader, "the smallest stable stiffness", "linear.largest_stable_stiffness has what bounds its feel")
    build = _core.rigid if linkage is Linkage.RIGID else _core.compliant
    law = law or GainLaw.original(loader.si_values)

    def closed_loop(log_share: float) -> NDArray[np.float64]:
        scale = np.exp(log_share) * loader["feel.maximum_stiffness"] / loader["feel.stiffness"]
        return build(loader.scale_feel(scale).si_values, law)[0]

    start = max(0.0, float(np.log(loader["feel.stiffness"] / loader["feel.maximum_stiffness"])))
    edge = _first_crossing(lambda log_share: spectral_abscissa(closed_loop(log_share)), start)
    if edge is None:
        return StabilityBoundary(0.0, 0.0, f"stable from G_max down to {_LOWEST:g} of it")
    if edge == np.inf:
        return StabilityBoundary(np.inf, 0.0, "unstable at G_max already")
    poles = np.linalg.eigvals(closed_loop(edge))
    frequency = abs(poles[np.argmax(poles.real)].imag)
    return _lost(np.exp(edge) * loader["feel.maximum_stiffness"], frequency)


def _lost(stiffness: float, frequency: float) -> StabilityBoundary:
    how = f"oscillation at {frequency / 2 / np.pi:.1f} Hz" if frequency > 0 else "real pole"
    return StabilityBoundary(float(stiffness), float(frequency), f"lost by {how}")


def _first_crossing(
    growth: Callable[[float], float], start: float, end: float = float(np.log(_LOWEST))
) -> float | None:
    """Where ``growth`` first becomes positive on the way from ``start``; None if nowhere, infinite if at once."""
    path = np.linspace(start, end, 141)  # tenths of a power of e: far finer than the poles move
    if growth(path[0]) >= 0:
        return np.inf
    for near, far in pairwise(path):
        if growth(far) >= 0:
            return root_between(growth, float(far), float(near), tolerance=1e-13)
    return None


_SOFT, _STIFF = 1e-3, 1e3
"""Shares of G_max between which the largest stable stiffness is looked for: softer than is felt, stiffer than any link."""


def largest_stable_stiffness(loader: Loader, linkage: Linkage = Linkage.COMPLIANT) -> StabilityBoundary:
    """The largest G that a motor renders by its current alone, frequency and damping ratio of the feel kept.

    Spring and damper of the feel at the motor's own position, ``linear.compliant_model``, sampled with the controller's period and
    delay, the velocity from the difference of two samples; continuous in time where the loader has no period. Nothing that
    dissipates but the link and the feel itself is counted: friction of the real machine allows more.

    Args:
        loader: The loader, with a motor.
        linkage: Rigid or compliant link.

    Raises:
        InputError: If the loader has a valve.

    Example:
        >>> edge = ff.linear.largest_stable_stiffness(ff.loader.electric("sidestick-roll"))
        >>> edge.note[:19]
        'lost by oscillation'
    """
    check_electric(loader, "the largest stable stiffness", "linear.smallest_stable_stiffness has what bounds its feel")
    highest, period = loader["feel.maximum_stiffness"], loader["controller.period"]

    def poles(log_share: float) -> NDArray[np.complex128]:
        """In 1/s: ``ln(z) / T`` of what is sampled."""
        scaled = loader.scale_feel(np.exp(log_share) * highest / loader["feel.stiffness"])
        if not period:
            return np.asarray(np.linalg.eigvals(loader_model(scaled, None, linkage).A), dtype=np.complex128)
        eigenvalues = np.linalg.eigvals(sampled_feel(scaled, rigid=linkage is Linkage.RIGID))
        return np.asarray(np.log(eigenvalues[eigenvalues != 0].astype(complex)) / period, dtype=np.complex128)

    edge = _first_crossing(lambda log_share: float(poles(log_share).real.max()), np.log(_SOFT), np.log(_STIFF))
    if edge is None:
        return StabilityBoundary(np.inf, 0.0, f"stable up to {_STIFF:g} G_max")
    if edge == np.inf:
        return StabilityBoundary(0.0, 0.0, "unstable however soft")
    edge_poles = poles(edge)
    return _lost(np.exp(edge) * highest, float(abs(edge_poles[np.argmax(edge_poles.real)].imag)))
