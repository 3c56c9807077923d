"""Passivity of the grip impedance: whether the column can feed energy into the hand.

``Y(jw) = v / F_p`` is the admittance at the grip, ``v`` its velocity, from the linear model, hands off. A stable linear grip is
passive if and only if ``Re Y(jw) >= 0`` at every frequency, which is ``Re Z(jw) >= 0`` of its impedance ``Z = 1 / Y``: the
phase of either stays within 90 deg. A passive grip is stable with any passive arm, whatever its mass, damper and spring.

Source: J. E. Colgate and N. Hogan, Robust control of dynamically interacting systems, 1988.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.grip import Grips
from forcefeel.laws.law import Law, LawLike
from forcefeel.linear.bracketing import root_between
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import Loader
from forcefeel.units import PERCENT

LOWEST_HZ, HIGHEST_HZ, POINTS = 0.05, 500.0, 401
"""Logarithmic frequency grid of the curves; band edges between grid points are refined with Brent's method."""

ARM_HZ = 10.0
"""The pilot's arm is passive above some 10 Hz; below, the pilot may act."""

_ROUNDING = 1e-9
"""Negative real part, as a share of ``|Y|``, that counts as rounding."""

_SURVEY = 60
"""Number of logarithmically spaced frequencies at which every setting of an envelope is checked."""


@dataclass(frozen=True, eq=False)
class Passivity:
    """Passivity of the grip with one law.

    Attributes:
        frequency_hz: Frequencies.
        impedance: ``Z(jw)`` in N s/m at the loader file's own setting.
        stable: Whether this loop is stable; an unstable grip is not passive, whatever its phase.
        bands_hz: Frequency bands with ``Re Z < 0`` at that setting.
        settings: Share of all settings that are stable and passive at every frequency.
        settings_below_arm: Share that are stable and passive up to ``ARM_HZ``.
    """

    frequency_hz: NDArray[np.float64]
    impedance: NDArray[np.complex128]
    stable: bool
    bands_hz: tuple[tuple[float, float], ...]
    settings: Annotated[float, PERCENT]
    settings_below_arm: Annotated[float, PERCENT]

    @property
    def first_hz(self) -> float:
        """Lowest frequency at which the grip is not passive; infinite if it is passive at all checked frequencies."""
        return self.bands_hz[0][0] if self.bands_hz else np.inf

    @property
    def phase_deg(self) -> NDArray[np.float64]:
        """Phase of the impedance; beyond 90 deg the grip is not passive."""
        return np.asarray(np.degrees(np.angle(self.impedance)))


def passivity(loader: Loader, law: LawLike, laws: Law, feel: NDArray[np.float64]) -> Passivity:
    """Passivity at the loader's own setting, and the share of passive settings.

    Args:
        loader: The loader.
        law: The law.
        laws: The designed law for each setting.
        feel: I, B, G of the settings, (settings, 3).
    """
    own = own_feel(loader)
    grip = Grips.of(loader, Law.of(law, loader, own), own)
    frequency = np.geomspace(LOWEST_HZ, HIGHEST_HZ, POINTS)
    admittance = grip.admittance(0, frequency)
    return Passivity(
        frequency,
        1 / admittance,
        bool(grip.stable(np.linalg.eigvals(grip.matrix).astype(complex))[0]),
        _bands(lambda hz: float(_short(grip.admittance(0, np.array([hz])))[0]), frequency, _short(admittance)),
        *_survey(loader, laws, feel),
    )


def _short(admittance: NDArray[np.complex128]) -> NDArray[np.float64]:
    """``Re Y / |Y|``, the cosine of the phase; positive if passive."""
    return np.asarray(admittance.real / np.abs(admittance) + _ROUNDING)


def _bands(
    at: Callable[[float], float], frequency: NDArray[np.float64], cosine: NDArray[np.float64]
) -> tuple[tuple[float, float], ...]:
    """Frequency bands in which the grip is not passive."""
    edges = [root_between(at, *map(float, frequency[k : k + 2])) for k in np.flatnonzero(np.diff(np.sign(cosine)))]
    if cosine[0] < 0:
        edges.insert(0, float(frequency[0]))
    if cosine[-1] < 0:
        edges.append(float(frequency[-1]))
    return tuple(zip(edges[::2], edges[1::2], strict=True))


def _survey(loader: Loader, laws: Law, feel: NDArray[np.float64]) -> tuple[float, float]:
    """Shares of the settings that are stable and passive at all frequencies, and up to ``ARM_HZ``."""
    frequency = np.geomspace(LOWEST_HZ, HIGHEST_HZ, _SURVEY)
    passive = np.zeros((2, len(feel)), dtype=bool)
    for first in range(0, len(feel), _AT_A_TIME):
        some = slice(first, first + _AT_A_TIME)
        grips = Grips.of(loader, laws.some(some), feel[some])
        poles, residues = grips.poles_and_residues()
        admittance = np.einsum("nk,nkf->nf", residues, 1 / (grips.points(frequency) - poles[..., None]))
        good = (_short(admittance * grips.factor(frequency)) >= _DECOMPOSED) & grips.stable(poles)[:, None]
        passive[:, some] = good.all(axis=1), good[:, frequency <= ARM_HZ].all(axis=1)
    everywhere, below = passive.mean(axis=1)
    return float(everywhere), float(below)


_AT_A_TIME = 2048
"""Settings per batch, to limit memory."""

_DECOMPOSED = -1e-6
"""Error of the cosine at 90 deg from the residues; far below the uncertainty of the band edges."""
