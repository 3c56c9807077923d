"""The columns of the tables of what is asked: one list for the terminal and the page."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import isfinite, isinf, isnan, nan
from typing import Generic, TypeVar

from forcefeel.conclusions import share_text
from forcefeel.sizing.demand import Duration
from forcefeel.sizing.findings import text, time_text
from forcefeel.sizing.motor import MotorCapability, MotorNeeds
from forcefeel.sizing.result import DemandResult, Sizing
from forcefeel.units import (
    FLOW,
    FORCE,
    MASS,
    MOTOR_CURRENT,
    PRESSURE,
    SPEED,
    TEMPERATURE,
    TORQUE,
    VOLTAGE,
    Unit,
    UnitSystem,
)

NONE = "–"
"""Stands where there is no number."""


Row = TypeVar("Row", DemandResult, Sizing)
"""What a row is of: a demand, or an axis of a cockpit."""


@dataclass(frozen=True)
class Column(Generic[Row]):
    """One column.

    Attributes:
        title: Its head.
        text: What it says of a row's demand or axis.
        detail: Whether a narrow terminal can do without.
    """

    title: str
    text: Callable[[Row], str]
    detail: bool = False


def columns(found: Sizing, units: UnitSystem) -> tuple[Column[DemandResult], ...]:
    """The columns that go with the drive."""
    needs = partial(_needs, units=units)
    at_grip = (
        Column("force", lambda one: text(one.force_n, FORCE, units)),
        Column("speed", lambda one: text(one.speed_m_per_s, SPEED, units) if one.duration is Duration.MOVING else NONE),
    )
    if not isinstance(found.capability, MotorCapability):
        return (
            *at_grip,
            Column("pressure", needs("pressure_pa", PRESSURE)),
            Column("flow", needs("flow_m3_per_s", FLOW)),
            Column("of the limit", lambda one: _share(one.of_peak)),
        )
    return (
        *at_grip,
        Column("torque", needs("torque_n_m", TORQUE)),
        Column("current", needs("current_a", MOTOR_CURRENT), detail=True),
        Column("voltage", needs("voltage_v", VOLTAGE), detail=True),
        Column("of the peak limit", lambda one: _share(one.of_peak)),
        Column("of the continuous limit", lambda one: _share(one.of_continuous)),
        Column("final winding temperature", needs("winding_degc", TEMPERATURE), detail=True),
        Column("can be held", _held),
    )


def axis_columns(units: UnitSystem) -> tuple[Column[Sizing], ...]:
    """The columns of the table over the axes, whatever moves them."""
    return (
        Column("loader", lambda one: one.loader.name),
        Column("drive", lambda one: one.loader.drive, detail=True),
        Column("peak limit", lambda one: text(one.capability.peak_force_n, FORCE, units)),
        Column("continuous limit", lambda one: _force(_continuous(one), units)),
        Column("feel, of the peak", lambda one: _share(_most(one, programmed=True, duration=None))),
        Column("rule, short", lambda one: _share(_most(one, programmed=False, duration=Duration.SHORT))),
        Column("rule, long", lambda one: _share(_most(one, programmed=False, duration=Duration.LONG))),
        Column("rotor at the grip", lambda one: text(one.added_mass_kg, MASS, units), detail=True),
    )


def _continuous(found: Sizing) -> float:
    capability = found.capability
    return capability.continuous_force_n if isinstance(capability, MotorCapability) else capability.peak_force_n


def _force(force: float, units: UnitSystem) -> str:
    return text(force, FORCE, units) if isfinite(force) else NONE


def _most(found: Sizing, *, programmed: bool, duration: Duration | None) -> float:
    """The largest share that is asked for; of the continuous force where it is asked for long."""
    rows = [one for one in found.demands if one.programmed is programmed and duration in (None, one.duration)]
    shares = [one.of_continuous if duration is Duration.LONG else one.of_peak for one in rows]
    return max((share for share in shares if not isnan(share)), default=nan)


def _needs(name: str, measured_in: Unit, units: UnitSystem) -> Callable[[DemandResult], str]:
    def found(one: DemandResult) -> str:
        value = getattr(one.needs, name)
        return NONE if isnan(value) else "no end" if isinf(value) else text(value, measured_in, units)

    return found


def _share(share: float) -> str:
    return share_text(share) if isfinite(share) else NONE if isnan(share) else "beyond"


def _held(one: DemandResult) -> str:
    needs = one.needs
    if not isinstance(needs, MotorNeeds) or one.of_peak > 1 or isnan(needs.derates_after_s):
        return "no" if one.of_peak > 1 else NONE
    return "continuously" if isinf(needs.derates_after_s) else time_text(needs.derates_after_s)
