"""Bound on the worst-case share of any linear law, with the column's inertia known to a share e.

Every sensor sits on the machine's side of the column's inertia. With ``T_link = alpha R_b F_c`` the torque of the link, a column of
inertia ``j`` and a hand that holds the mass ``m``,

    (j + m R_p^2) theta'' = T_p + T_link,      eqs. (6), (7)

and all measured quantities (F_c, x_p, theta, also theta'') and the drive interact with the column only through theta and T_link.
So sensors, commands and motion depend only on the sum ``j + m R_p^2``, sample by sample, with any law. Hands off,

    (1 + e) J        moves as       J        with the mass  e J / R_p^2  in the hand,
         J           moves as   (1 - e) J    with the mass  e J / R_p^2  in the hand.

**Linear laws.** A linear response of T_link to theta is the same with all columns. So a law that renders I', B', G with the nominal
column renders I' + d J, B', G with a column of (1 + d) J, hands off. A setting can be rendered for all inertias from (1 - e) J to
(1 + e) J only if *one* I', B', G passes the rule e J below, at and e J above, hands off, and with each arm at the nominal column.
This bound makes no assumption on hands; it is the computed one.

**Any law**, adaptive or not, is bound if the hand may hold any mass up to 2 e J / R_p^2: one motion must then pass as the release
of I and of I + 2 e J. More information removes this bound: a sensor of the force at the grip, a switch that detects the hand, or a
model of the arm, which has a damper and a spring unlike the column. See docs/concepts/no-law.md.

**Not proved**: that no rendering of higher order is better. The bound covers I' = I + s e J, s of ``SHIFTS``, and B' = b B, b of
``DAMPINGS``, with G as programmed, because of the static force. ``Frontier.beyond_bound`` counts passes beyond the bound.

**A sensor of the force at the grip** measures beyond the column. Only the mass outboard of that sensor cannot be distinguished from
the hand's: ``m_o R_p^2`` replaces J in all equations. Without outboard mass the inertia sets no bound.

**The torque's scale** alpha R_b acts in the same way on a law that relates F_c to theta by the nominal alpha R_b. With a scale of s
times the nominal, ``J theta'' = s T``, T the nominally rendered torque, ``-T = (I - J) theta'' + B theta' + G theta``:

    [I + (1/s - 1) J] theta'' + B theta' + G theta = 0,

the error e = 1/s - 1 of the inertia. This bound can be removed: x_p = alpha R_b theta + F_c / k makes alpha R_b measurable.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.plan import Plan
from forcefeel.errors import InputError
from forcefeel.frontier.second_order_bound import SettingGroup, setting_groups
from forcefeel.loader.sensors import unseen_inertia
from forcefeel.threads import threads_or_cores
from forcefeel.units import show

ERRORS = (0.001, 0.002, 0.003, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3)
"""Relative errors of the inertia at which the bound is computed."""

SHIFTS = (0.0, -1.0, -0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.0)
"""Shifts of the rendered inertia, as shares of e J."""

DAMPINGS = (1.0, 0.9, 0.95, 1.05, 1.1)
"""Factors on the programmed damping."""


@dataclass(frozen=True, eq=False)
class Bound:
    """The bound over the error of the inertia.

    Attributes:
        errors: Relative errors e, rising.
        possible: Settings that one response renders at -e, 0 and +e and with every arm, (errors, settings).
        centered: The same for the response that is exact at e = 0.
    """

    errors: tuple[float, ...]
    possible: NDArray[np.bool_] = field(repr=False)
    centered: NDArray[np.bool_] = field(repr=False)

    @property
    def shares(self) -> tuple[float, ...]:
        """Share of the settings that can be rendered at each error."""
        return tuple(self.possible.mean(axis=1).tolist())

    @property
    def centered_shares(self) -> tuple[float, ...]:
        """The same for the response that is exact at e = 0."""
        return tuple(self.centered.mean(axis=1).tolist())

    def at(self, error: float) -> NDArray[np.bool_]:
        """Settings that can be rendered at a computed error.

        Raises:
            InputError: If the error was not computed.
        """
        places = np.flatnonzero(np.isclose(self.errors, error, rtol=_SAME))
        if not len(places):
            raise InputError(f"error: expected one of {', '.join(f'{e:g}' for e in self.errors)}, got {error:g}")
        return np.asarray(self.possible[places[0]])


_SAME = 1e-9
"""Relative difference of errors that counts as rounding."""


def inertia_bound(
    plan: Plan, errors: Sequence[float] = ERRORS, *, lean: float = 0.0, threads: int | None = None
) -> Bound:
    """Compute the bound for a plan's settings, rule, angle and arms.

    Args:
        plan: The envelope; its laws are not used.
        errors: Relative errors e of the column's inertia, above 0 and below 1.
        lean: Offset of the middle of the range of inertias from the nominal one, as a share of e: 0 for (1 - e) J to (1 + e) J.
        threads: Number of threads; default: all cores.

    Raises:
        InputError: If the errors do not rise or are out of range.
    """
    rising = tuple(map(float, errors))
    if not rising or not all(0 < error < 1 for error in rising) or any(np.diff(rising) <= 0):
        raise InputError(f"errors: expected rising shares above 0 and below 1, got {show(list(rising))}")
    shape = len(rising), plan.settings.count
    possible, centered = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    for group in setting_groups(plan, threads_or_cores(threads)):
        for k, error in enumerate(rising):
            possible[k, group.which], centered[k, group.which] = _possible(group, error, lean)
    return Bound(rising, possible, centered)


def _possible(group: SettingGroup, error: float, lean: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Settings at which a trial response passes in every case, and at which the exact response does."""
    size = np.array([error * unseen_inertia(group.plan.loader), 0.0, 0.0])
    off = (lean - 1) * size, (lean + 1) * size
    # At the nominal inertia, with and without an arm, the exact response is the ideal.
    centered = group.passes(group.feel + off[0]) & group.passes(group.feel + off[1])
    possible = centered.copy()
    for damping in DAMPINGS:
        left = np.flatnonzero(~possible)
        if len(left):
            # All shifts in one batch.
            shifts = (np.repeat(SHIFTS, len(left))[:, None] - lean) * size
            renders = _renders(group.some(np.tile(left, len(SHIFTS))), shifts, damping, off)
            possible[left] = renders.reshape(len(SHIFTS), -1).any(axis=0)
    return possible, centered


def _renders(
    group: SettingGroup,
    shifts: NDArray[np.float64],
    damping: float,
    off: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> NDArray[np.bool_]:
    """Whether each trial response passes at both ends of the inertia, at its nominal value, and with every arm."""
    trial = group.feel * [1.0, damping, 1.0] + shifts
    passes = group.passes(trial + off[0]) & group.passes(trial + off[1])
    if passes.any():
        passes &= group.passes(trial)
        for arm in group.plan.arms:
            passes &= group.passes(trial, arm)
    return passes
