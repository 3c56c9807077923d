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


def columns(sizing: Sizing, units: UnitSystem) -> tuple[Column[DemandResult], ...]:
    """The columns that go with the drive."""
    needs = partial(_needs, units=units)
    at_grip = (
        Column("force", lambda demand: text(demand.force_n, FORCE, units)),
        Column(
            "speed",
            lambda demand: text(demand.speed_m_per_s, SPEED, units) if demand.duration is Duration.MOVING else NONE,
        ),
    )
    if not isinstance(sizing.capability, MotorCapability):
        return (
            *at_grip,
            Column("pressure", needs("pressure_pa", PRESSURE)),
            Column("flow", needs("flow_m3_per_s", FLOW)),
            Column("of the limit", lambda demand: _share(demand.of_peak)),
        )
    return (
        *at_grip,
        Column("torque", needs("torque_n_m", TORQUE)),
        Column("current", needs("current_a", MOTOR_CURRENT), detail=True),
        Column("voltage", needs("voltage_v", VOLTAGE), detail=True),
        Column("of the peak limit", lambda demand: _share(demand.of_peak)),
        Column("of the continuous limit", lambda demand: _share(demand.of_continuous)),
        Column("final winding temperature", needs("winding_degc", TEMPERATURE), detail=True),
        Column("can be held", _held),
    )


def axis_columns(units: UnitSystem) -> tuple[Column[Sizing], ...]:
    """The columns of the table over the axes, whatever moves them."""
    return (
        Column("loader", lambda sizing: sizing.loader.name),
        Column("drive", lambda sizing: sizing.loader.drive, detail=True),
        Column("peak limit", lambda sizing: text(sizing.capability.peak_force_n, FORCE, units)),
        Column("continuous limit", lambda sizing: _force(_continuous(sizing), units)),
        Column("feel, of the peak", lambda sizing: _share(_most(sizing, programmed=True, duration=None))),
        Column("rule, short", lambda sizing: _share(_most(sizing, programmed=False, duration=Duration.SHORT))),
        Column("rule, long", lambda sizing: _share(_most(sizing, programmed=False, duration=Duration.LONG))),
        Column("rotor at the grip", lambda sizing: text(sizing.added_mass_kg, MASS, units), detail=True),
    )


def _continuous(sizing: Sizing) -> float:
    capability = sizing.capability
    return capability.continuous_force_n if isinstance(capability, MotorCapability) else capability.peak_force_n


def _force(force: float, units: UnitSystem) -> str:
    return text(force, FORCE, units) if isfinite(force) else NONE


def _most(sizing: Sizing, *, programmed: bool, duration: Duration | None) -> float:
    """The largest share that is asked for; of the continuous force where it is asked for long."""
    rows = [
        demand for demand in sizing.demands if demand.programmed is programmed and duration in (None, demand.duration)
    ]
    shares = [row.of_continuous if duration is Duration.LONG else row.of_peak for row in rows]
    return max((share for share in shares if not isnan(share)), default=nan)


def _needs(name: str, measured_in: Unit, units: UnitSystem) -> Callable[[DemandResult], str]:
    def cell(demand: DemandResult) -> str:
        value = getattr(demand.needs, name)
        return NONE if isnan(value) else "no end" if isinf(value) else text(value, measured_in, units)

    return cell


def _share(share: float) -> str:
    return share_text(share) if isfinite(share) else NONE if isnan(share) else "beyond"


def _held(demand: DemandResult) -> str:
    needs = demand.needs
    if not isinstance(needs, MotorNeeds) or demand.of_peak > 1 or isnan(needs.derates_after_s):
        return "no" if demand.of_peak > 1 else NONE
    return "continuously" if isinf(needs.derates_after_s) else time_text(needs.derates_after_s)
