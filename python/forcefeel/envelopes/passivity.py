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
from scipy.linalg import matrix_balance
from scipy.optimize import brentq

from forcefeel import _core
from forcefeel._core import Compensator
from forcefeel.envelopes.laws import Law, SettingLaws
from forcefeel.loader import FEEL_SETTING, Loader
from forcefeel.models import state_feedback
from forcefeel.parameters import INDEX
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
    """How passive the grip of one compensator is.

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


def passivity(loader: Loader, law: Law, laws: SettingLaws, feel: NDArray[np.float64]) -> Passivity:
    """The passivity at the loader's own setting, and how many of the settings are passive.

    Args:
        loader: The loader.
        law: The compensator.
        laws: Its law for each setting.
        feel: I, B, G of the settings, a row each.
    """
    own = np.array([[loader[key] for key in FEEL_SETTING]])
    compensator = SettingLaws.of(law, loader, own).single(loader, 0)
    frequency = np.geomspace(LOWEST_HZ, HIGHEST_HZ, POINTS)
    a, b, c = _model(loader.values, compensator)
    admittance = _admittance(a, b, c, frequency)
    return Passivity(
        frequency,
        1 / admittance,
        bool(np.linalg.eigvals(a).real.max() < 0),
        _bands(lambda hz: float(_short(_admittance(a, b, c, np.array([hz])))[0]), frequency, _short(admittance)),
        *_survey(loader, laws, feel),
    )


def _model(
    values: NDArray[np.float64], law: Compensator | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """``A`` of eq. (17) balanced, the column for the pilot's force and the row for the velocity at the grip."""
    a, b, c, _ = _core.compliant(values, law or Compensator.original(values))
    row = np.zeros(len(a))
    # v = R_p theta', theta' the same row on the velocity as theta on the position
    row[_BASE_RATE] = values[INDEX["column.grip_arm"]] * c[0, _BASE]
    balanced, (scale, _) = matrix_balance(a, permute=False, separate=True)
    return balanced, b[:, 0] / scale, row * scale


_BASE, _BASE_RATE = 6, 7
"""States x_b and x_b' of eq. (17)."""


def _admittance(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64], frequency_hz: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """``c (jw - a)^-1 b``."""
    s = 2j * np.pi * frequency_hz[:, None, None]
    states = np.linalg.solve(s * np.eye(len(a)) - a, np.broadcast_to(b[:, None], (len(frequency_hz), len(a), 1)))
    return np.asarray((c @ states)[:, 0])


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


def _survey(loader: Loader, laws: SettingLaws, feel: NDArray[np.float64]) -> tuple[float, float]:
    """Shares of the settings that are stable and passive: everywhere, and up to ``ARM_HZ``."""
    frequency = np.geomspace(LOWEST_HZ, HIGHEST_HZ, _SURVEY)
    found = np.zeros((2, len(feel)), dtype=bool)
    values = loader.values.copy()
    for first in range(0, len(feel), _AT_A_TIME):
        models = []
        for k in range(first, min(first + _AT_A_TIME, len(feel))):
            values[[INDEX[key] for key in FEEL_SETTING]] = feel[k]
            models.append(_model(values, laws.law if laws.gains is None else state_feedback(loader, laws.gains[k])))
        a, b, c = (np.array(part) for part in zip(*models, strict=True))
        # Y = sum of residues over s - pole, c v_k (V^-1 b)_k / (jw - p_k)
        poles, vectors = np.linalg.eig(a)
        residues = (c[:, None] @ vectors)[:, 0] * np.linalg.solve(vectors, b[..., None].astype(complex))[..., 0]
        admittance = np.einsum("nk,nkf->nf", residues, 1 / (2j * np.pi * frequency - poles[..., None]))
        good = (_short(admittance) >= _DECOMPOSED) & (poles.real.max(axis=1) < 0)[:, None]
        found[:, first : first + len(models)] = good.all(axis=1), good[:, frequency <= ARM_HZ].all(axis=1)
    everywhere, below = found.mean(axis=1)
    return float(everywhere), float(below)


_AT_A_TIME = 2048
"""Settings whose poles are in memory together."""

_DECOMPOSED = -1e-6
"""What the poles' residues leave of a phase of 90 deg, as a share; far below what any edge of passivity is known to."""
