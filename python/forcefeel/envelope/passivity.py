"""Passivity of the impedance at the grip: whether the column ever feeds energy into the hand.

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
from scipy.optimize import brentq

from forcefeel.envelope.grip import Grips
from forcefeel.laws.law import Law, LawLike
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import Loader
from forcefeel.units import PERCENT

LOWEST_HZ, HIGHEST_HZ, POINTS = 0.05, 500.0, 401
"""Frequencies, evenly in proportion, of the curves; between two of them an edge is found by bisection."""

ARM_HZ = 10.0
"""Above some 10 Hz the pilot's arm is passive by itself; below, the pilot may act."""

_ROUNDING = 1e-9
"""Share of ``|Y|`` by which its real part may fall short of zero and still be rounding."""

_SURVEY = 60
"""Frequencies, evenly in proportion, at which every setting of an envelope is looked at."""


@dataclass(frozen=True, eq=False)
class Passivity:
    """How passive the grip of one law is.

    Attributes:
        frequency_hz: Frequencies.
        impedance: ``Z(jw)`` in N s/m at the loader file's own setting.
        stable: Whether that loop is stable; if not, the grip is not passive whatever its phase.
        bands_hz: From where to where ``Re Z < 0`` there.
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
        """Frequency from which on it is not passive; infinite if it is passive wherever it was looked at."""
        return self.bands_hz[0][0] if self.bands_hz else np.inf

    @property
    def phase_deg(self) -> NDArray[np.float64]:
        """Phase of the impedance; beyond 90 deg it is not passive."""
        return np.asarray(np.degrees(np.angle(self.impedance)))


def passivity(loader: Loader, law: LawLike, laws: Law, feel: NDArray[np.float64]) -> Passivity:
    """The passivity at the loader's own setting, and how many of the settings are passive.

    Args:
        loader: The loader.
        law: The law.
        laws: Its law for each setting.
        feel: I, B, G of the settings, a row each.
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
    """``Re Y / |Y|``, the cosine of the phase, above zero where passive."""
    return np.asarray(admittance.real / np.abs(admittance) + _ROUNDING)


def _bands(
    at: Callable[[float], float], frequency: NDArray[np.float64], cosine: NDArray[np.float64]
) -> tuple[tuple[float, float], ...]:
    """From where to where it is not passive, each edge by bisection."""
    edges = [float(brentq(at, *frequency[k : k + 2])) for k in np.flatnonzero(np.diff(np.sign(cosine)))]
    if cosine[0] < 0:
        edges.insert(0, float(frequency[0]))
    if cosine[-1] < 0:
        edges.append(float(frequency[-1]))
    return tuple(zip(edges[::2], edges[1::2], strict=True))


def _survey(loader: Loader, laws: Law, feel: NDArray[np.float64]) -> tuple[float, float]:
    """Shares of the settings that are stable and passive: everywhere, and up to ``ARM_HZ``."""
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
"""Settings whose poles are in memory together."""

_DECOMPOSED = -1e-6
"""What the poles' residues leave of a phase of 90 deg, as a share; far below what any edge of passivity is known to."""
