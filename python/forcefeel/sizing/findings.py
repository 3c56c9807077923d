"""Conclusions from the sizing of a drive, in sentences."""

from collections.abc import Iterator
from math import ceil, floor, isfinite, isnan, log10

from forcefeel.conclusions import Conclusions, of_result, share_text
from forcefeel.sizing.control_forces import RULE
from forcefeel.sizing.demand import Duration
from forcefeel.sizing.motor import MotorCapability, MotorNeeds, MotorRemedy
from forcefeel.sizing.result import DemandResult, Sizing
from forcefeel.units import AREA, FORCE, LENGTH, MASS, PRESSURE, SPEED, TEMPERATURE, TORQUE, Unit, UnitSystem, to_text


def text(value: float, measured_in: Unit, units: UnitSystem) -> str:
    """A SI value with its unit, to three digits."""
    return f"{to_text(measured_in.from_si(value, units), 3)} {measured_in.shown(units)}".rstrip()


def enough(value: float, measured_in: Unit, units: UnitSystem, *, most: bool = False) -> str:
    """A SI value that is the least that does, or the most, with its unit: three digits, rounded to the side that does."""
    scaled = measured_in.from_si(value, units)
    last = 10.0 ** (floor(log10(abs(scaled))) - 2)
    places = scaled / last
    exact = abs(places - round(places)) <= _ROUNDING * abs(places)
    whole = round(places) if exact else floor(places) if most else ceil(places)
    return f"{to_text(whole * last, 3)} {measured_in.shown(units)}".rstrip()


_ROUNDING = 1e-9
"""Relative; a number of three digits that came through a change of units."""


def time_text(seconds: float) -> str:
    """A time as people say it of heat."""
    if seconds >= 2 * _HOUR:
        return f"{to_text(seconds / _HOUR, 2)} h"
    return f"{to_text(seconds / _MINUTE, 2)} min" if seconds >= 2 * _MINUTE else f"{to_text(seconds, 2)} s"


_MINUTE, _HOUR = 60.0, 3600.0


@of_result
def sizing_conclusions(sizing: Sizing, units: UnitSystem) -> Conclusions:
    """The conclusions, with numbers in ``units``; ``ok`` where the drive gives what the programmed feel asks for.

    Args:
        sizing: The sizing.
        units: The units of the numbers.

    Example:
        >>> sizing = ff.sizing.size_drive(ff.elevator())
        >>> ff.sizing.sizing_conclusions(sizing, ff.UnitSystem.US).ok
        True
    """
    lines = (
        *_remedies(sizing, units),
        *_gives(sizing, units),
        *_relief(sizing),
        _rule(sizing),
        *_heat(sizing, units),
        _mass(sizing, units),
    )
    return Conclusions(sizing.ok, _verdict(sizing, units), tuple(filter(None, (*lines, *_unknown(sizing)))))


def noun(sizing: Sizing) -> str:
    """The drive, as a sentence calls it."""
    return "motor" if isinstance(sizing.capability, MotorCapability) else "valve"


def _verdict(sizing: Sizing, units: UnitSystem) -> str:
    programmed = [demand for demand in sizing.demands if demand.programmed]
    lacking = [demand for demand in programmed if not demand.available]
    if lacking:
        worst = max(lacking, key=lambda demand: demand.of_peak)
        share = f"{share_text(worst.of_peak)} of" if isfinite(worst.of_peak) else "more than"
        return f"The {noun(sizing)} is too small for the programmed feel: {_demand_text(worst, units)}, takes {share} its limit."
    known = [demand for demand in programmed if not isnan(demand.of_peak)]
    if not known:
        return (
            "The limit of the motor is unknown: state current_loop.current_limit or current_loop.voltage_limit in the "
            "loader file."
        )
    worst = max(known, key=lambda demand: demand.of_peak)
    return (
        f"The {noun(sizing)} is large enough for the programmed feel: the largest demand, {_demand_text(worst, units)}, is "
        f"{share_text(worst.of_peak)} of its {'peak ' if isinstance(sizing.capability, MotorCapability) else ''}limit."
    )


def _demand_text(demand: DemandResult, units: UnitSystem) -> str:
    force = text(demand.force_n, FORCE, units)
    if demand.duration is not Duration.MOVING:
        return f"the {demand.name}, {force}" if not demand.name.startswith("25.") else f"{demand.name}, {force}"
    return f"the {demand.name}, up to {force} and {text(demand.speed_m_per_s, SPEED, units)}"


def _remedies(sizing: Sizing, units: UnitSystem) -> Iterator[str]:
    """Remedies for a drive that is too small, the largest of each kind."""
    for programmed, long in ((True, False), (False, False), (False, True)):
        lacking = [
            demand
            for demand in sizing.demands
            if demand.remedy and (demand.programmed, demand.duration is Duration.LONG) == (programmed, long)
        ]
        if lacking:
            yield _remedy(sizing, max(lacking, key=lambda demand: demand.force_n), units)
    for demand in sizing.demands:
        if demand.duration is Duration.MOVING and not demand.available:
            yield _too_fast(sizing, demand, units)


def _remedy(sizing: Sizing, demand: DemandResult, units: UnitSystem) -> str:
    remedy, capability = demand.remedy, sizing.capability
    what, loader = _demand_text(demand, units), sizing.loader
    what = what[:1].upper() + what[1:]
    if isinstance(remedy, MotorRemedy) and isinstance(capability, MotorCapability):
        long = demand.duration is Duration.LONG
        torque = capability.continuous_torque_n_m if long else capability.peak_torque_n_m
        sentence = (
            f"{what}, takes {enough(remedy.torque_n_m, TORQUE, units)} at the motor; its {'continuous' if long else 'peak'} "
            "limit is "
            f"{text(torque, TORQUE, units)}. Remedy: a motor of that torque"
        )
        if isnan(remedy.travel_m):
            return f"{sentence}."
        now = text(loader["transmission.travel"], LENGTH, units)
        faster = loader["transmission.travel"] / remedy.travel_m
        turns = f"{to_text(faster, 3)} times as fast" if faster >= _TWICE else f"{share_text(faster - 1)} faster"
        travel = enough(remedy.travel_m, LENGTH, units, most=True)
        return (
            f"{sentence}, or a transmission.travel of {travel} per radian in place of {now}, with which "
            f"the rotor adds {text(remedy.added_mass_kg, MASS, units)} at the grip and the motor turns {turns}."
        )
    if remedy is None or isinstance(remedy, MotorRemedy) or isinstance(capability, MotorCapability):
        return ""
    return (
        f"{what}, takes a load pressure of {enough(remedy.pressure_pa, PRESSURE, units)}; the limit of the valve is "
        f"{text(capability.peak_pressure_pa, PRESSURE, units)}. Remedy: that pressure of the supply and "
        f"the relief, or an actuator.area of {enough(remedy.area_m2, AREA, units)} in place of "
        f"{text(loader['actuator.area'], AREA, units)}, with proportionally more flow."
    )


_TWICE = 2.0
"""From so many times as fast on it is told so, below in per cent."""


def _too_fast(sizing: Sizing, demand: DemandResult, units: UnitSystem) -> str:
    needs, what = demand.needs, _demand_text(demand, units)
    what = what[:1].upper() + what[1:]
    if isinstance(needs, MotorNeeds):
        volts, amperes = (to_text(value, 3) for value in (needs.voltage_v, needs.current_a))
        limits = [sizing.loader[f"current_loop.{name}_limit"] for name in ("voltage", "current")]
        available = " and ".join(
            f"{to_text(limit, 3)} {unit}" for limit, unit in zip(limits, "VA", strict=True) if isfinite(limit)
        )
        return f"{what}, takes {volts} V and {amperes} A; the limit is {available}."
    fastest = text(sizing.capability.fastest_m_per_s, SPEED, units)
    return f"{what}, is beyond the valve's flow at that load; without load the grip moves at {fastest}."


def _gives(sizing: Sizing, units: UnitSystem) -> Iterator[str]:
    capability = sizing.capability
    if not isinstance(capability, MotorCapability):
        yield (
            f"Limits of the valve at the grip: {text(capability.peak_force_n, FORCE, units)} continuously at rest, "
            f"{text(capability.fastest_m_per_s, SPEED, units)} without load. The compliance of oil and link is neglected."
        )
        return
    if not isfinite(capability.peak_force_n):
        return
    continuous = (
        f"{text(capability.continuous_force_n, FORCE, units)} ({text(capability.continuous_torque_n_m, TORQUE, units)}) "
        "continuously"
        if not isnan(capability.continuous_force_n)
        else "an unknown force continuously"
    )
    speed = f", {text(capability.fastest_m_per_s, SPEED, units)} without load"
    yield (
        f"Limits of the motor at the grip: {text(capability.peak_force_n, FORCE, units)} "
        f"({text(capability.peak_torque_n_m, TORQUE, units)}) for a short time, "
        f"{continuous}{speed if isfinite(capability.fastest_m_per_s) else ''}. Cogging is neglected."
    )


def _relief(sizing: Sizing) -> Iterator[str]:
    for demand in sizing.demands:
        if demand.law and demand.of_peak > demand.of_motion:
            yield (
                f"The {demand.name} takes {share_text(demand.of_peak)} in simulation under {demand.law}, "
                "including the holding force before it "
                f"and the unloading of the link; the motion alone takes {share_text(demand.of_motion)}."
            )


def _rule(sizing: Sizing) -> str:
    rows = [row for row in sizing.demands if not row.programmed]
    if not rows:
        return f"{RULE} has no limits for a {sizing.plan.axis}: they are for wheels and pedals."
    beyond = [demand.name.removeprefix("25.143(d) ") for demand in rows if not demand.available]
    unknown = [
        demand.name.removeprefix("25.143(d) ")
        for demand in rows
        if isnan(demand.of_continuous if demand.duration is Duration.LONG else demand.of_peak)
    ]
    forces = f"every force but {' and '.join((*beyond, *unknown))}" if beyond or unknown else "every force"
    forces = f"{forces} of {RULE} in {sizing.plan.axis}"
    forces += f"; {' and '.join(unknown)} {'are' if len(unknown) > 1 else 'is'} unknown" if unknown else ""
    unread = (
        "" if all(demand.verified for demand in rows) else " The table of forces is not verified against the document."
    )
    return f"The {noun(sizing)} can make {forces}.{unread}"


def _heat(sizing: Sizing, units: UnitSystem) -> Iterator[str]:
    limit = sizing.loader["thermal.derating_from"] if isinstance(sizing.capability, MotorCapability) else 0.0
    for demand in sizing.demands:
        needs = demand.needs
        if not isinstance(needs, MotorNeeds) or not demand.programmed or demand.duration is Duration.MOVING:
            continue
        held = _demand_text(demand, units)
        if needs.current_a > (continuous := sizing.loader["current_loop.continuous_current"]):
            yield (
                f"The drive gives {to_text(needs.current_a, 3)} A for {time_text(sizing.loader['current_loop.peak_time'])}, "
                f"{to_text(continuous, 3)} A continuously: {held}, cannot be held longer."
            )
        if isnan(needs.winding_degc) or needs.derates_after_s == sizing.loader["current_loop.peak_time"]:
            continue
        if needs.winding_degc <= limit:
            yield f"Held continuously, {held}, brings the winding to {text(needs.winding_degc, TEMPERATURE, units)}."
        elif not isnan(needs.derates_after_s):
            yield (
                f"Held for {time_text(needs.derates_after_s)} from cold, {held}, brings the winding to "
                f"{text(limit, TEMPERATURE, units)}, where derating of the current begins."
            )


def _mass(sizing: Sizing, units: UnitSystem) -> str:
    if not isinstance(sizing.capability, MotorCapability):
        return ""
    share = share_text(sizing.added_mass_kg / sizing.column_mass_kg)
    return (
        f"The rotor adds {text(sizing.added_mass_kg, MASS, units)} at the grip, J (F/T)², {share} of the column's own "
        f"{text(sizing.column_mass_kg, MASS, units)}; the law must compensate for it."
    )


def _unknown(sizing: Sizing) -> Iterator[str]:
    heat = [row for row in sizing.missing if row.startswith("thermal.")]
    if heat:
        known = isfinite(sizing.loader["current_loop.continuous_current"])
        what = (
            "heat of the winding, below which the drive's continuous current may lie," if known else "continuous torque"
        )
        yield f"The {what} is unknown: state {', '.join(heat)} in the loader file."
    for row in sizing.missing:
        if row in heat:
            continue
        what = "torque" if "current" in row.partition(".")[2] else "speed"
        yield f"The limit of the {what} is unknown: state {row} in the loader file."
