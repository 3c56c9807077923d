"""The nearest feel that a drive renders: a governor for settings whose demand is above flow, force, voltage or the link's throw.

``I``, ``B``, ``G`` programmed · ``s`` largest factor on G, 1 at most, whose demand is within the drive's capability

    I' = I,   B' = sqrt(s) B,   G' = s G

The damping ratio stays, and the natural frequency falls to ``sqrt(s)`` of the programmed one. So a release from the same angle is
the programmed one at ``sqrt(s)`` of its pace, and its demand follows from the programmed motion:

    theta' -> sqrt(s) theta',   theta'' -> s theta'',   theta''' -> s^1.5 theta''',   F_held -> s F_held

Each instant of it must be within the drive's limits (``sizing``), and the force that holds it before. ``envelope.forbidden``
requires less, with the drive at its limits throughout: a law follows the feel, not the limits. A setting that the link throws is
softened until ``forbidden`` allows it. ``s`` is found by bisection in steps of equal ratio.

A loader's own feel must also be held at the end of its travel, with all that its file programs there (``sizing.demand``).
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import feel_frequency
from forcefeel.envelope.forbidden import REASONS, THROW, forbidden
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import Record
from forcefeel.envelope.settings import ListedSettings
from forcefeel.errors import InputError
from forcefeel.linear.release_motion import holding_force, release_motion
from forcefeel.loader.curves import Curve
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.softened_feel import STIFFNESS, SoftenedFeel
from forcefeel.sizing.demand import PERIODS, feel_demands
from forcefeel.sizing.fastest import Fastest, Limit
from forcefeel.sizing.motor import Motor
from forcefeel.sizing.plan import SizingPlan
from forcefeel.sizing.valve import Valve
from forcefeel.units import PERCENT

LEAST = 0.1
"""Least share of the programmed stiffness: a softer feel is another one."""

_HALVINGS = 10
"""Of the ratio between the ends: a tenth of the stiffness and all of it are found to 0.3 %."""

_Array = NDArray[np.float64]
_Allowed = Callable[[_Array], NDArray[np.bool_]]
"""Whether each setting is allowed with a share of its stiffness, (settings,)."""


@dataclass(frozen=True, eq=False)
class Softening:
    """What the drive renders of each setting of a plan.

    Attributes:
        share: Largest share of the setting's stiffness that the drive renders: 1 as programmed, NaN if not even ``LEAST``,
            (settings,).
        reason: Index in ``forbidden.REASONS`` of the limit that softens it, -1 if none, (settings,).
    """

    share: _Array = field(repr=False)
    reason: NDArray[np.int8] = field(repr=False)


@dataclass(frozen=True)
class SoftenedShares:
    """Shares of the settings that one law renders with the nominal plant, hands off.

    Attributes:
        law: Its name.
        as_programmed: Passes the release test as programmed.
        softened: Passes it when softened.
        not_rendered: Passes neither way.
        least: Least share of its programmed stiffness that a softened one has; NaN if none passes.
    """

    law: str
    as_programmed: Annotated[float, PERCENT]
    softened: Annotated[float, PERCENT]
    not_rendered: Annotated[float, PERCENT]
    least: Annotated[float, PERCENT]

    @classmethod
    def of(
        cls, law: str, as_programmed: NDArray[np.bool_], softened: NDArray[np.bool_], share: _Array
    ) -> "SoftenedShares":
        """Those of the settings that pass as programmed, or with a share of their stiffness."""
        first, second = float(as_programmed.mean()), float(softened.mean())
        least = float(share[softened].min()) if softened.any() else np.nan
        return cls(law, first, second, 1 - first - second, least)


def softening(plan: Plan, *, threads: int | None = None) -> Softening:
    """Find what the drive renders of each setting of a plan; its laws and cases are not used."""
    feel, rows = plan.settings.feel(plan.loader), plan.settings.rows
    share, reason = np.ones(len(feel)), np.full(len(feel), -1, dtype=np.int8)
    for frequency in plan.settings.frequency:
        which = np.flatnonzero(rows[:, 1] == frequency)
        demand = _Demand.of(plan.loader, feel[which], frequency, plan.release_rad)
        limit = demand.limits(np.ones(len(which)))
        over = np.flatnonzero(limit >= 0)
        reason[which[over]] = limit[over]
        share[which[over]] = _largest(demand.some(over).allowed, len(over))
    thrown = np.flatnonzero(_thrown(plan, softened_rows(rows, np.nan_to_num(share, nan=LEAST)), threads))
    reason[thrown] = np.where(reason[thrown] < 0, REASONS.index(THROW), reason[thrown])
    quieter = _largest(lambda of: ~_thrown(plan, softened_rows(rows[thrown], of), threads), len(thrown))
    share[thrown] = np.minimum(share[thrown], quieter)
    return Softening(share, reason)


def softened_rows(rows: _Array, share: _Array) -> _Array:
    """Damping ratio, frequency and share of G_max (settings, 3) of settings with a share of their stiffness."""
    return np.asarray(rows * np.column_stack([np.ones(len(rows)), np.sqrt(share), share]))


def soften(loader: Loader) -> SoftenedFeel:
    """The loader with its own feel, or with the nearest one that its drive renders.

    Released from the angle of ``forcefeel size``, and held at the end of its travel; a force curve is scaled like the stiffness.

    Raises:
        InputError: If the drive does not render a tenth of the programmed stiffness, with the limit.

    Example:
        >>> stick = ff.loader.electric("sidestick-pitch").replace({"feel.stiffness": "900 lb*in/rad"})
        >>> ff.envelope.soften(stick).sentence(ff.UnitSystem.US)
        "Feel softened: stiffness 672 of 900 lb in/rad, the motor's torque."
    """
    own = _Own.of(loader)
    reason = own.limit(1.0)
    if reason < 0:
        return SoftenedFeel(loader, loader[STIFFNESS])
    share = float(_largest(own.allowed, 1)[0])
    if np.isnan(share):
        raise InputError(
            f"feel: the drive of {loader.name} does not render {LEAST:.0%} of its stiffness because of {REASONS[reason]}; "
            "forcefeel size computes a drive that does"
        )
    return SoftenedFeel(with_share(loader, share), loader[STIFFNESS], str(REASONS[reason]))


def largest_share(loader: Loader, most: float) -> float:
    """Largest multiple of a loader's stiffness, 1 to ``most``, that its drive renders; 1 if it renders no stiffer feel."""
    own = _Own.of(loader)
    if most <= 1 or own.limit(most) < 0:
        return max(most, 1.0)
    share = float(_largest(own.allowed, 1, (1.0, most))[0])
    return share if np.isfinite(share) else 1.0


def with_share(loader: Loader, share: float) -> Loader:
    """The loader with a share of its stiffness, of the same damping ratio; more than it programs widens its range."""
    stiffness = share * loader[STIFFNESS]
    rows = {STIFFNESS: stiffness, "feel.damping": np.sqrt(share) * loader["feel.damping"]}
    rows |= {"feel.maximum_stiffness": stiffness} if stiffness > loader["feel.maximum_stiffness"] else {}
    curve = loader.force_curve and Curve(loader.force_curve.x, tuple(share * y for y in loader.force_curve.y))
    return replace(loader.replace(rows, si=True), force_curve=curve)


@dataclass(frozen=True, eq=False)
class _Demand:
    """Demand of releases of one frequency on a drive: their motion (samples, settings) and the forces that hold them before."""

    loader: Loader
    motion: tuple[_Array, _Array, _Array]
    held_n: _Array

    @classmethod
    def of(cls, loader: Loader, feel: _Array, frequency: float, angle_rad: float) -> "_Demand":
        step = Record.of(frequency, 1.0).step_s
        samples = int(np.ceil(PERIODS * 2 * np.pi / frequency / step))
        velocity, acceleration, jerk = np.array([*release_motion(loader, feel, angle_rad, step, samples)]).swapaxes(
            0, 1
        )
        return cls(loader, (velocity, acceleration, jerk), holding_force(loader, feel[:, 2], angle_rad))

    def some(self, which: NDArray[np.intp]) -> "_Demand":
        velocity, acceleration, jerk = (part[:, which] for part in self.motion)
        return replace(self, motion=(velocity, acceleration, jerk), held_n=self.held_n[which])

    def limits(self, share: _Array) -> NDArray[np.int8]:
        """Index in ``REASONS`` of the limit that each setting with a share of its stiffness is above; -1 if none."""
        drive, fastest = _drive(self.loader), Fastest.of(self.loader)
        paced = (part * share ** (power / 2) for power, part in enumerate(self.motion, start=1))
        of_force, of_speed = drive.moving_shares(*(part.ravel() for part in paced)).reshape(2, *self.motion[0].shape)
        force, speed = of_force.max(axis=0), of_speed.max(axis=0)
        held = drive.share(share * self.held_n, np.zeros(len(share)))
        limited = np.isfinite(fastest.speed_m_per_s) or np.isfinite(fastest.force_n)
        over = np.maximum.reduce([force, speed, np.nan_to_num(held, nan=0.0)]) > 1
        named = Limit.VOLTAGE if self.loader.drive == ELECTRIC else fastest.of_speed
        places = [REASONS.index(limit) for limit in (named, fastest.of_force)]
        return np.where(limited & over, np.where(speed > np.maximum(force, held), *places), -1).astype(np.int8)

    def allowed(self, share: _Array) -> NDArray[np.bool_]:
        """Whether each setting with a share of its stiffness is within all limits."""
        return np.asarray(self.limits(share) < 0)


@dataclass(frozen=True, eq=False)
class _Own:
    """Demand of a loader's own feel: its release, its force at the end of the travel, and the link's throw."""

    loader: Loader
    plan: Plan
    demand: _Demand

    @classmethod
    def of(cls, loader: Loader) -> "_Own":
        frequency, damping = feel_frequency(loader.si_values)
        rows = np.array([[damping, frequency, loader[STIFFNESS] / loader["feel.maximum_stiffness"]]])
        angle = SizingPlan.of(loader).release_rad
        plan = Plan(loader, {"any": None}, ListedSettings(rows), changes={}, arms=(), angle_rad=angle)
        return cls(loader, plan, _Demand.of(loader, plan.settings.feel(loader), frequency, angle))

    def limit(self, share: float) -> int:
        """Index in ``REASONS`` of the limit that the feel with a share of its stiffness is above; -1 if none."""
        of = np.array([share])
        if (reason := int(self.demand.limits(of)[0])) >= 0:
            return reason
        drive = _drive(self.loader)
        held = [demand.force_n for demand in feel_demands(SizingPlan.of(with_share(self.loader, share)))]
        if any((drive.share(force, np.zeros(len(force))) > 1).any() for force in held):
            return REASONS.index(Fastest.of(self.loader).of_force)
        return REASONS.index(THROW) if _thrown(self.plan, softened_rows(self.plan.settings.rows, of), 1)[0] else -1

    def allowed(self, share: _Array) -> NDArray[np.bool_]:
        """Whether the feel with a share of its stiffness, (1,), is within all limits."""
        return np.array([self.limit(float(share[0])) < 0])


def _drive(loader: Loader) -> Motor | Valve:
    return Motor(loader) if loader.drive == ELECTRIC else Valve(loader)


def _thrown(plan: Plan, rows: _Array, threads: int | None) -> NDArray[np.bool_]:
    """Which settings the link throws too early for any law."""
    return forbidden(replace(plan, settings=ListedSettings(rows)), threads=threads).of(THROW)


def _largest(allowed: _Allowed, count: int, ends: tuple[float, float] = (LEAST, 1.0)) -> _Array:
    """Largest allowed share of each setting between two, of which the larger is not allowed; NaN if neither is."""
    low, high = (np.full(count, end) for end in ends)
    if not count:
        return low
    never = ~allowed(low)
    for _ in range(_HALVINGS):
        middle = np.sqrt(low * high)
        fits = allowed(middle)
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    return np.where(never, np.nan, low)
