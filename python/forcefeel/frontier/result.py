"""Frontier result: bound and achieved shares, limit of each setting, gains from tolerances and parts."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import Envelope, Smallest
from forcefeel.frontier.bound import Bound
from forcefeel.frontier.friction import SmallestFriction
from forcefeel.frontier.friction_bound import FrictionBound
from forcefeel.frontier.hardware import Gain
from forcefeel.frontier.motor_limits import MotorLimits
from forcefeel.frontier.tightening import INERTIA, Tightening
from forcefeel.frontier.tolerance_levels import ToleranceLevels
from forcefeel.frontier.valve_limits import ValveLimits
from forcefeel.printable import table_html
from forcefeel.units import PERCENT


class Limit(StrEnum):
    """Limit that keeps a setting from passing in every case, the most fundamental first."""

    NONE = "rendered in every case"
    DRIVE = "forbidden by the drive"
    INERTIA = "inertia not known well enough for any linear law"
    NOMINAL = "this law, even with the nominal plant"
    LAW = "this law, with something off or an arm"


@dataclass(frozen=True, eq=False)
class Frontier:
    """A computed frontier.

    Attributes:
        levels: The law at all tolerance levels.
        bound: Bound on any linear law over the error of the inertia.
        tightening: Shares over the tolerances.
        drive: Limits of valve or motor.
        friction: Smallest friction.
        friction_bound: Bound over the error of the column's dry friction; ``None`` without friction.
        hardware: Gains from hardware changes, the largest first.
    """

    levels: ToleranceLevels
    bound: Bound
    tightening: Tightening
    drive: ValveLimits | MotorLimits
    friction: SmallestFriction
    friction_bound: FrictionBound | None
    hardware: tuple[Gain, ...]

    def __repr__(self) -> str:
        each = "; ".join(f"{share:.1%} {self.text(limit)}" for limit, share in self.limit_shares.items() if share)
        return f"<Frontier of {self.plan.given.name!r} with {self.law}, {self.plan.settings.count:,} settings: {each}>"

    def _repr_html_(self) -> str:
        rows = ((self.text(limit), f"{share:.1%}") for limit, share in self.limit_shares.items())
        return table_html(f"{self.plan.given.name} with {self.law}", ("settings", "share"), rows)

    @property
    def envelope(self) -> Envelope:
        """The envelope at the full tolerances."""
        return self.levels.full

    @property
    def plan(self) -> Plan:
        """Plan of the envelope."""
        return self.levels.full.plan

    @property
    def law(self) -> str:
        """Name of the law."""
        return self.levels.law

    @property
    def inertia_tolerance(self) -> Annotated[float, PERCENT]:
        """Relative tolerance of the column's inertia."""
        return self.levels.tolerances[INERTIA]

    @cached_property
    def possible(self) -> NDArray[np.bool_]:
        """Settings that a response renders over the tolerance of the inertia, (settings,)."""
        return self.bound.at(self.inertia_tolerance)

    @cached_property
    def limits(self) -> NDArray[np.int8]:
        """Limit of each setting (damping, frequency, stiffness): index in ``Limit``."""
        passes = self.envelope.passes(self.law)
        order = list(Limit)
        codes = np.select(
            [passes.all(axis=0), self.drive.forbidden, ~self.possible, ~passes[0]],
            [order.index(limit) for limit in (Limit.NONE, Limit.DRIVE, Limit.INERTIA, Limit.NOMINAL)],
            order.index(Limit.LAW),
        )
        return np.asarray(codes.astype(np.int8).reshape(self.plan.settings.shape))

    def text(self, limit: Limit) -> str:
        """Text of a limit, with the name of the drive."""
        return str(limit).replace("the drive", f"the {self.drive_name}")

    @property
    def drive_name(self) -> str:
        """``valve`` or ``motor``."""
        return "motor" if isinstance(self.drive, MotorLimits) else "valve"

    @property
    def limit_shares(self) -> dict[Limit, float]:
        """Share of all settings under each limit."""
        return {limit: float((self.limits == index).mean()) for index, limit in enumerate(Limit)}

    @property
    def beyond_bound(self) -> Annotated[float, PERCENT]:
        """Share of the settings that the law renders in every case although no second-order response does."""
        return float((self.envelope.passes(self.law).all(axis=0) & ~self.possible).mean())

    @property
    def smallest(self) -> Smallest:
        """Smallest inertia and stiffness rendered in every case."""
        return self.envelope.smallest(self.law, worst=True)

    @property
    def largest_stiffness(self) -> Annotated[float, PERCENT]:
        """Largest stiffness of the grid rendered in every case, as a share of G_max; NaN if no setting passes."""
        passes = self.envelope.passes(self.law).all(axis=0)
        return float(self.plan.settings.rows[passes, 2].max()) if passes.any() else float("nan")
