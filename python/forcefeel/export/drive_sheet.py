"""What a drive engineer sets: motor, scale, loop, limits, rates and supervisor, with the CiA 402 object of each where there is one.

Travel of the drive's end is ``x = r q``, ``q`` the motor's angle, and ``x = alpha R_b theta`` of the column's angle. Torques in
0x6071, 0x6072 and 0x6087 are thousandths of the drive's own rated torque, 0x6076; currents in 0x6073 of its rated current, 0x6075.

Objects: IEC 61800-7-201 (CiA 402).
"""

from collections.abc import Iterator
from math import inf, isfinite, log10, sqrt, tau
from typing import NamedTuple

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, meaning, table, unit
from forcefeel.page.render import render
from forcefeel.page.table import Cell, Table, number, words
from forcefeel.tables.csv_table import csv_text

DRIVE, DRIVE_PAGE = "{}_drive.csv", "{}_drive.html"
"""File names."""

COLUMNS = ("group", "setting", "value", "unit", "CoE object", "rows of the loader file")

_CYCLIC_TORQUE = 10
_MOST_STEPS = 255
"""Largest value of 0x60C2:1."""


class Setting(NamedTuple):
    """One setting of the drive; infinite: no limit."""

    group: str
    name: str
    value: float
    unit: str
    coe: str
    rows: str


def drive_settings(loader: Loader) -> tuple[Setting, ...]:
    """The settings of a loader's drive, and of the supervisor in front of it."""
    own = _electric(loader) if loader.drive == ELECTRIC else _hydraulic(loader)
    supervisor = (_row(loader, "supervisor", key) for key in table(loader.drive) if key.startswith("safety."))
    return (*own, *supervisor)


def _electric(loader: Loader) -> Iterator[Setting]:
    constant, lead = loader["motor.torque_constant"], loader["transmission.travel"]
    current, share = loader["current_loop.current_limit"], loader["safety.command_share"]
    phases = "motor.torque_constant, motor.three_phase"
    per_angle = loader["column.base_arm"] * loader["linkage.ratio"]
    travels = "linkage.ratio, column.base_arm, transmission.travel"
    limit = "current_loop.current_limit"
    period = loader["controller.period"]
    yield Setting("mode", "cyclic synchronous torque", _CYCLIC_TORQUE, "", "0x6060", "")
    if isfinite(period) and period > 0.0:
        steps, exponent = _cycle(period)
        yield Setting("mode", "cycle time", period, "s", f"0x60C2:1 = {steps}, :2 = {exponent}", "controller.period")
    yield Setting("motor", "torque constant, per peak ampere", constant, "N m/A", "", phases)
    if loader["motor.three_phase"]:
        yield Setting("motor", "torque constant, per r.m.s. ampere", constant * sqrt(2.0), "N m/A", "", phases)
    for key in ("winding.resistance", "winding.inductance", "motor.inertia"):
        yield _row(loader, "motor", key)
    yield Setting(
        "scale", "feed constant: travel per revolution of the motor", tau * lead, "m", "0x6092", "transmission.travel"
    )
    step = loader["potentiometer.resolution"]
    if step:
        encoder = "potentiometer.resolution, transmission.travel"
        yield Setting("scale", "encoder increments per revolution", tau * lead / step, "", "0x608F", encoder)
    yield Setting(
        "scale", "revolutions of the motor per radian of the column", per_angle / lead / tau, "1/rad", "", travels
    )
    bandwidth = loader["current_loop.bandwidth"] / tau
    yield Setting("loop", "bandwidth of the current loop", bandwidth, "Hz", "", "current_loop.bandwidth")
    yield Setting("limit", "current, peak of a phase", current, "A", "0x6073", limit)
    yield Setting(
        "limit", "torque of the motor", share * current * constant, "N m", "0x6072", f"{limit}, safety.command_share"
    )
    yield _row(loader, "limit", "current_loop.voltage_limit")
    for end, sub in (("low", 1), ("high", 2)):
        revolutions = loader[f"column.stop_{end}"] * per_angle / lead / tau
        rows = f"column.stop_{end}, {travels}"
        yield Setting(
            "limit", f"software limit of position, {end}, from neutral", revolutions, "rev", f"0x607D:{sub}", rows
        )
    speed = loader["safety.speed_limit"] * per_angle / lead * 60.0 / tau
    yield Setting("limit", "speed of the motor", speed, "1/min", "0x6080", f"safety.speed_limit, {travels}")
    rate = loader["safety.command_rate"] * current * constant
    yield Setting("rate", "torque of the motor in time", rate, "N m/s", "0x6087", f"safety.command_rate, {limit}")


def _hydraulic(loader: Loader) -> Iterator[Setting]:
    for group, keys in (
        ("scale", ("amplifier.admittance", "potentiometer.gain")),
        ("valve", ("valve.rated_current", "valve.rated_flow", "valve.supply_pressure", "valve.natural_frequency")),
        ("limit", ("amplifier.current_limit", "valve.flow_limit", "column.stop_low", "column.stop_high")),
        ("mode", ("controller.period",)),
    ):
        for key in keys:
            yield _row(loader, group, key)


def _row(loader: Loader, group: str, key: str) -> Setting:
    row = table(loader.drive)[key]
    return Setting(group, meaning(row, loader.drive), loader[key], unit(row).si, "", key)


def _cycle(period_s: float) -> tuple[int, int]:
    """A period as a whole number, at most 255, times a power of ten."""
    for exponent in range(round(log10(period_s)), -10, -1):
        steps = round(period_s / 10.0**exponent)
        if 1 <= steps <= _MOST_STEPS and abs(steps * 10.0**exponent - period_s) < 1e-9 * period_s:  # rounding
            return steps, exponent
    return round(period_s * 1e6), -6


def _value(setting: Setting) -> str:
    return "off" if abs(setting.value) == inf else f"{setting.value:.12g}"


def drive_csv(settings: tuple[Setting, ...]) -> str:
    """The settings as CSV in twelve digits, SI units."""
    return csv_text(COLUMNS, [(s.group, s.name, _value(s), s.unit, s.coe, s.rows) for s in settings])


def drive_page(loader: Loader, settings: tuple[Setting, ...], name: str) -> str:
    """The settings as a page, in six digits."""
    groups = {
        group: Table(
            (Cell("Setting"), number("Value"), Cell("Unit"), Cell("CoE object"), Cell("Rows of the loader file")),
            tuple(
                (words(s.name), number("off" if abs(s.value) == inf else f"{s.value:.6g}"), *map(words, s[3:]))
                for s in settings
                if s.group == group
            ),
        )
        for group in dict.fromkeys(setting.group for setting in settings)
    }
    return render(
        "export/drive.html.j2", command="", name=name, loader=loader, groups=groups, electric=loader.drive == ELECTRIC
    )
