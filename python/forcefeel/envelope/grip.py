"""Admittance at the grip, hands off: ``Y(jw) = v / F_p``, ``v`` velocity of the grip, from linear models of many loops.

| loop | ``Y(jw)`` |
|---|---|
| analog, eq. (17) | ``c (jw - A)^-1 b`` |
| sampled, ``x+ = M x + b_F F_p`` | ``jw c (e^(jwT) - M)^-1 b_F / H(jw)`` |

``H(jw) = (1 - e^(-jwT)) / (jwT)`` compensates the hold of the pilot's force over a period in ``b_F``. This is valid well below half
the sampling rate.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw, balanced
from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.loops.sampled_loop import sampled_loops


@dataclass(frozen=True, eq=False)
class Grips:
    """Linear models from the pilot's force to the grip, one for each loop.

    Attributes:
        matrix: A or M, (loops, states, states), balanced.
        by_force: b or b_F, (loops, states), per N.
        row: c, (loops, states): velocity of the grip in m/s for an analog loop, its position in m for a sampled loop.
        period_s: Sample period in s; ``None`` for analog loops.
    """

    matrix: NDArray[np.float64] = field(repr=False)
    by_force: NDArray[np.float64] = field(repr=False)
    row: NDArray[np.float64] = field(repr=False)
    period_s: float | None

    @classmethod
    def of(cls, loader: Loader, laws: Law, feel: NDArray[np.float64]) -> "Grips":
        """Models of a loader at settings I, B, G, (settings, 3)."""
        rows = loader.rows(FEEL_SETTING, feel)
        if not loader["controller.period"]:
            return cls(
                *_balanced([_analog(values, laws.numbers.gain_law(loader, k)) for k, values in enumerate(rows)]), None
            )
        loops = sampled_loops(loader, laws, rows)
        angle_row = np.zeros(loops.matrix.shape[1])
        angle_row[loops.base] = loader["column.grip_arm"] / loader["column.base_arm"]
        models = [(m, b, angle_row) for m, b in zip(loops.matrix, loops.by_force, strict=True)]
        return cls(*_balanced(models), loops.period_s)

    def poles_and_residues(self) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """``Y / factor`` as a sum of ``residue / (point - pole)``, both (loops, states)."""
        poles, vectors = np.linalg.eig(self.matrix)
        weights = np.linalg.solve(vectors, self.by_force[..., None].astype(complex))[..., 0]
        return poles, (self.row[:, None] @ vectors)[:, 0] * weights

    def stable(self, poles: NDArray[np.complex128]) -> NDArray[np.bool_]:
        """Whether the loops of these poles are stable."""
        inside = poles.real < 0 if self.period_s is None else np.abs(poles) < 1
        return np.asarray(inside.all(axis=-1))

    def points(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        """``jw`` or ``e^(jwT)``."""
        s = 2j * np.pi * frequency_hz
        return np.asarray(s if self.period_s is None else np.exp(s * self.period_s))

    def factor(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Factor on the sum of residues: 1, or ``jw / H(jw)`` of a sampled loop."""
        s = 2j * np.pi * frequency_hz
        if self.period_s is None:
            return np.ones_like(s)
        return np.asarray(s * (s * self.period_s) / (1 - np.exp(-s * self.period_s)))

    def admittance(self, loop: int, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        """``Y(jw)`` of one loop, by solving the linear system instead of residues."""
        response = _core.frequency_response(
            self.matrix[loop], self.by_force[loop], self.row[loop], self.points(frequency_hz)
        )
        return np.asarray(response * self.factor(frequency_hz))


_Model = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def _analog(values: NDArray[np.float64], law: GainLaw) -> _Model:
    """``A`` of eq. (17), the input column of the pilot's force and the output row of the grip's velocity."""
    a, b, c, _ = _core.compliant(values, law)
    row = np.zeros(len(a))
    # v = R_p theta'; theta' has the same row on the velocity state as theta on the position state.
    row[_BASE_RATE] = values[INDEX["column.grip_arm"]] * c[0, _BASE]
    return a, b[:, 0], row


_BASE, _BASE_RATE = 6, 7
"""States x_b and x_b' of eq. (17)."""


def _balanced(models: Sequence[_Model]) -> _Model:
    balanced_models = []
    for a, b, row in models:
        like, scale = balanced(a)
        balanced_models.append((like, b / scale, row * scale))
    matrix, by_force, row = (np.array(part) for part in zip(*balanced_models, strict=True))
    return matrix, by_force, row
