"""The bound that the column's dry friction sets, known to a share e: two machines that no sensor tells apart.

Every sensor sits on the machine's side of the friction. With ``s`` the way that the column moves,

    J theta'' = T_p - R_p F s + T_link,

so a friction of ``(1 + e) F``, hands off, moves as one of ``(1 - e) F`` under a hand that drags with ``2 e F``: sample by sample,
under every law. A law that must be right for either gives both one motion, and with the one that lies between, the hand feels a
force that is off by ``e F`` or more in one of the two.

Hands off, who takes off ``(1 + c e) F`` leaves dry friction from ``(-1 - c) e F`` to ``(1 - c) e F``, where what is below zero
drives on and the release does not come to rest. A setting is left to such a law if *one* lean c and one damping B' pass the rule at
both ends, between, and with each arm. The bound is taken over c of ``LEANS`` and B' = b B, b of ``DAMPINGS``.

**Whom it does not bind**: a law that takes what drags steadily for the machine's, within the tolerance, as the laws that learn
friction do. Hands off it may get beyond the bound; the hand that does drag then feels less, by up to ``2 e F``.

``x`` angle · ``f`` dry friction that is left, a torque · ``phi`` release of I, B, G · ``r`` what a half
swing leaves, ``T`` its time

    x(t) = c_k + (x_k - c_k) phi(t - k T),   c_k = sgn(x_k) f / G,   x_k+1 = c_k - r (x_k - c_k)      from the k-th turn on
    at rest once  G |x_k| <= f

The friction that a motion leaves: J. P. Den Hartog, Mechanical Vibrations, 4th edition, McGraw-Hill 1956.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.cases import PilotArm
from forcefeel.envelope.deviations import FRICTION
from forcefeel.envelope.plan import Plan
from forcefeel.frontier.friction import FORCE
from forcefeel.frontier.second_order_bound import Referee, referees
from forcefeel.threads import threads_or_cores

KNOWN_TO = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Relative errors of the friction at which the bound is computed, beside its tolerance."""

LEANS = (0.0, -0.5, 0.5, -1.0, 1.0)
"""Which friction is taken off, as shares of e F beyond F; at -1 none is ever driven on."""

DAMPINGS = (1.0, 0.9, 1.1)
"""Factors on the programmed damping that a rendering may have."""


@dataclass(frozen=True, eq=False)
class FrictionBound:
    """The bound over the error of the friction.

    Attributes:
        friction_n: The column's dry friction, at the grip.
        tolerance: To which share the loader knows it.
        errors: Relative errors e, rising; the tolerance is one.
        possible: Which settings are left at each, (errors, settings).
    """

    friction_n: Annotated[float, FORCE]
    tolerance: float
    errors: tuple[float, ...]
    possible: NDArray[np.bool_] = field(repr=False)

    @property
    def shares(self) -> tuple[float, ...]:
        """Share of the settings that are left at each error."""
        return tuple(self.possible.mean(axis=1).tolist())

    @property
    def share(self) -> float:
        """The same at the tolerance."""
        return self.shares[self.errors.index(self.tolerance)]

    @property
    def off_n(self) -> Annotated[float, FORCE]:
        """The least error of the force at the hand in one of the two machines at the ends of the tolerance."""
        return self.tolerance * self.friction_n


def friction_bound(
    plan: Plan, errors: Sequence[float] = KNOWN_TO, *, threads: int | None = None
) -> FrictionBound | None:
    """The bound for a plan's settings, rule, angle and arms; ``None`` for a column without dry friction, or of which none is off.

    Args:
        plan: The envelope; its laws are not used.
        errors: Relative errors e, beside the plan's own.
        threads: How many; all cores if not given.
    """
    if FRICTION not in plan.deviations or not plan.loader[FRICTION]:
        return None
    tolerance = plan.deviations[FRICTION].size
    all_errors = tuple(sorted({tolerance, *(error for error in errors if abs(error - tolerance) > _SAME)}))
    torque = plan.loader[FRICTION] * plan.loader["column.grip_arm"]
    possible = np.zeros((len(all_errors), plan.settings.count), dtype=bool)
    for referee in referees(plan, threads_or_cores(threads)):
        for k, error in enumerate(all_errors):
            possible[k, referee.which] = _possible(referee, error * torque)
    return FrictionBound(plan.loader[FRICTION], tolerance, all_errors, possible)


_SAME = 1e-9
"""Errors that are the same but for rounding."""


def _possible(referee: Referee, off: float) -> NDArray[np.bool_]:
    """Where some lean and damping pass with the friction off by so much, as torque, to either side."""
    possible = np.zeros(len(referee.which), dtype=bool)
    for damping in DAMPINGS:
        for lean in LEANS:
            if len(left := np.flatnonzero(~possible)):
                possible[left] = _renders(referee.some(left), damping, off, lean)
    return possible


def _renders(referee: Referee, damping: float, off: float, lean: float) -> NDArray[np.bool_]:
    trial = referee.feel * [1.0, damping, 1.0]

    def passes(end: float, arm: PilotArm | None = None) -> NDArray[np.bool_]:
        carried = referee.carrying(trial, arm)
        angles = rubbed_releases(carried, (end - lean) * off, referee.plan.release_rad, referee.record.time_s)
        return referee.judged(angles, arm)

    rendered = passes(-1.0) & passes(1.0)
    if rendered.any():
        rendered &= passes(0.0)
        for arm in referee.plan.arms:
            rendered &= passes(0.0, arm)
    return rendered


def rubbed_releases(
    feel: NDArray[np.float64], friction: float, angle: float, time_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Releases (settings, samples) of I, B, G and a dry friction in N m, which drives on where it is below zero."""
    angles = np.empty((len(feel), len(time_s)))
    for row, out in zip(feel, angles, strict=True):
        out[:] = _rubbed(row, friction, angle, time_s)
    return angles


def _rubbed(
    feel: NDArray[np.float64], friction: float, angle: float, time_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    inertia, damping, stiffness = feel
    decay, square = damping / (2 * inertia), stiffness / inertia - (damping / (2 * inertia)) ** 2
    half = np.pi / np.sqrt(square) if square > 0 else np.inf
    left = np.exp(-decay * half) if square > 0 else 0.0
    swing = np.floor(time_s / half).astype(int)
    turns, centres = np.empty(swing[-1] + 1), np.empty(swing[-1] + 1)
    at = angle
    for k in range(len(turns)):
        held = stiffness * abs(at) <= friction
        turns[k], centres[k] = at, at if held else np.sign(at) * friction / stiffness
        at = centres[k] - left * (at - centres[k])
    since = time_s - np.where(swing > 0, swing * half, 0.0) if square > 0 else time_s
    phi = _core.feel_transitions(feel[None], since)[0, :, 0, 0]
    return np.asarray(centres[swing] + (turns - centres)[swing] * phi, dtype=np.float64)
