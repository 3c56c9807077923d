"""Bound of the column's dry friction, known to a share e: two machines that no sensor can distinguish.

Every sensor sits on the machine's side of the friction. With ``s`` the sign of the column's velocity,

    J theta'' = T_p - R_p F s + T_link,

so a friction of ``(1 + e) F``, hands off, moves as one of ``(1 - e) F`` under a hand that drags with ``2 e F``: sample by sample,
under every law. A law that must be correct for both gives them one motion. Even with the motion in the middle, the force at the
hand has an error of ``e F`` or more in one of the two.

Hands off, compensation of ``(1 + c e) F`` leaves dry friction from ``(-1 - c) e F`` to ``(1 - c) e F``. Negative friction drives
the column, and the release does not come to rest. A setting is possible for such a law if *one* lean c and one damping B' pass the
rule at both ends, between, and with each arm. The bound covers c of ``LEANS`` and B' = b B, b of ``DAMPINGS``.

**Not bound** is a law that takes a steady drag within the tolerance for friction of the machine, as the laws that learn friction
do. Hands off it may exceed the bound; a hand with such a drag then feels up to ``2 e F`` less.

``x`` angle · ``f`` remaining dry friction, a torque · ``phi`` release of I, B, G · ``r`` ratio of successive swings, ``T``
duration of a half swing

    x(t) = c_k + (x_k - c_k) phi(t - k T),   c_k = sgn(x_k) f / G,   x_k+1 = c_k - r (x_k - c_k)      from the k-th turn on
    at rest once  G |x_k| <= f

Source: J. P. Den Hartog, Mechanical Vibrations, 4th edition, McGraw-Hill 1956.
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
from forcefeel.frontier.second_order_bound import SettingGroup, setting_groups
from forcefeel.threads import threads_or_cores

KNOWN_TO = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Relative errors of the friction at which the bound is computed, beside its tolerance."""

LEANS = (0.0, -0.5, 0.5, -1.0, 1.0)
"""Compensated friction beyond F, as shares of e F; at -1 friction never drives the column."""

DAMPINGS = (1.0, 0.9, 1.1)
"""Factors on the programmed damping."""


@dataclass(frozen=True, eq=False)
class FrictionBound:
    """The bound over the error of the friction.

    Attributes:
        friction_n: Dry friction of the column, at the grip.
        tolerance: Its tolerance as a share.
        errors: Relative errors e, rising, including the tolerance.
        possible: Possible settings at each error, (errors, settings).
    """

    friction_n: Annotated[float, FORCE]
    tolerance: float
    errors: tuple[float, ...]
    possible: NDArray[np.bool_] = field(repr=False)

    @property
    def shares(self) -> tuple[float, ...]:
        """Share of possible settings at each error."""
        return tuple(self.possible.mean(axis=1).tolist())

    @property
    def share(self) -> float:
        """Share of possible settings at the tolerance."""
        return self.shares[self.errors.index(self.tolerance)]

    @property
    def off_n(self) -> Annotated[float, FORCE]:
        """Smallest possible force error at the hand in one of the two machines at the ends of the tolerance."""
        return self.tolerance * self.friction_n


def friction_bound(
    plan: Plan, errors: Sequence[float] = KNOWN_TO, *, threads: int | None = None
) -> FrictionBound | None:
    """Compute the bound for a plan's settings, rule, angle and arms; ``None`` without dry friction or without its tolerance.

    Args:
        plan: The envelope; its laws are not used.
        errors: Relative errors e, in addition to the plan's tolerance.
        threads: Number of threads; default: all cores.
    """
    if FRICTION not in plan.deviations or not plan.loader[FRICTION]:
        return None
    tolerance = plan.deviations[FRICTION].size
    all_errors = tuple(sorted({tolerance, *(error for error in errors if abs(error - tolerance) > _SAME)}))
    torque = plan.loader[FRICTION] * plan.loader["column.grip_arm"]
    possible = np.zeros((len(all_errors), plan.settings.count), dtype=bool)
    for group in setting_groups(plan, threads_or_cores(threads)):
        for k, error in enumerate(all_errors):
            possible[k, group.which] = _possible(group, error * torque)
    return FrictionBound(plan.loader[FRICTION], tolerance, all_errors, possible)


_SAME = 1e-9
"""Difference of errors that counts as rounding."""


def _possible(group: SettingGroup, off: float) -> NDArray[np.bool_]:
    """Settings at which a lean and damping pass with the friction torque off by ``off`` to either side."""
    possible = np.zeros(len(group.which), dtype=bool)
    for damping in DAMPINGS:
        for lean in LEANS:
            if len(left := np.flatnonzero(~possible)):
                possible[left] = _renders(group.some(left), damping, off, lean)
    return possible


def _renders(group: SettingGroup, damping: float, off: float, lean: float) -> NDArray[np.bool_]:
    trial = group.feel * [1.0, damping, 1.0]

    def passes(end: float, arm: PilotArm | None = None) -> NDArray[np.bool_]:
        carried = group.carrying(trial, arm)
        angles = rubbed_releases(carried, (end - lean) * off, group.plan.release_rad, group.record.time_s)
        return group.judged(angles, arm)

    rendered = passes(-1.0) & passes(1.0)
    if rendered.any():
        rendered &= passes(0.0)
        for arm in group.plan.arms:
            rendered &= passes(0.0, arm)
    return rendered


def rubbed_releases(
    feel: NDArray[np.float64], friction: float, angle: float, time_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Releases (settings, samples) of I, B, G with dry friction in N m; negative friction drives the column."""
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
    turns, centers = np.empty(swing[-1] + 1), np.empty(swing[-1] + 1)
    at = angle
    for k in range(len(turns)):
        held = stiffness * abs(at) <= friction
        turns[k], centers[k] = at, at if held else np.sign(at) * friction / stiffness
        at = centers[k] - left * (at - centers[k])
    since = time_s - np.where(swing > 0, swing * half, 0.0) if square > 0 else time_s
    phi = _core.feel_transitions(feel[None], since)[0, :, 0, 0]
    return np.asarray(centers[swing] + (turns - centers)[swing] * phi, dtype=np.float64)
