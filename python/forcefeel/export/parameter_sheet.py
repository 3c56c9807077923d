"""Parameter sheet of a law for a drive or a PLC, as CSV with SI and U.S. customary units.

| column | is |
|---|---|
| setting | number of the feel's setting, from 1; empty for a row that holds for all |
| group | feel, gain, filter, limit |
| name | row of the loader file, or of the law |
| meaning | in words |
| value (SI), unit (SI) | value of the engine, to the last bit |
| value (U.S.), unit (U.S.) | the same, to ten digits |
"""

from collections.abc import Iterable, Iterator
from itertools import product
from math import isfinite
from typing import NamedTuple

from forcefeel.export.exported import Exported
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS
from forcefeel.laws.law import ORIGINAL, Law
from forcefeel.laws.sampled.sampled_law import OF_FRICTION, SampledLaw
from forcefeel.linear.models import DESIGN_STATES
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import DIGITS, ELECTRIC, is_switch, meaning, table, unit
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import RATIO, SECONDS, Unit, UnitSystem

SHEET, OBSERVER = "{}_parameters.csv", "{}_observer.csv"
"""File names: feel, filters and limits; the numbers of a sampled law."""

COLUMNS = (
    "setting",
    "group",
    "name",
    "meaning",
    "value (SI)",
    "unit (SI)",
    "value (U.S.)",
    "unit (U.S.)",
)

_FILTERS = (
    "controller.period",
    "controller.delay",
    "controller.antiwindup",
    "controller.input_bits",
    "controller.output_bits",
    "load_cell.bandwidth",
    "potentiometer.bandwidth",
    "column_sensor.bandwidth",
    "grip_sensor.bandwidth",
    "current_loop.bandwidth",
)
_LIMITS = (
    "amplifier.current_limit",
    "valve.flow_limit",
    "current_loop.current_limit",
    "current_loop.voltage_limit",
    "controller.input_range",
    "controller.output_range",
    "column.stop_low",
    "column.stop_high",
    "feel.soft_stop_low",
    "feel.soft_stop_high",
    "feel.hard_stop_low",
    "feel.hard_stop_high",
    "feel.velocity_limit",
    "feel.trim_rate",
)

_Signals = tuple[tuple[str, Unit], ...]

_SAMPLED: _Signals = (
    ("load cell force", Unit("N", "N", "lb")),
    ("drive position", Unit("m", "m", "in")),
    ("column angle", Unit("rad", "rad", "rad")),
    ("grip force", Unit("N", "N", "lb")),
)
_FEEL: _Signals = (("feel displacement", Unit("rad", "rad", "rad")), ("feel rate", Unit("rad/s", "rad/s", "rad/s")))
"""Inputs of a sampled law's rows, without its own states; the grip force is last, if sampled."""


_CURVE = (Unit("rad", "rad", "deg"), Unit("N", "N", "lb"))


class Row(NamedTuple):
    """One number of the sheet; ``setting`` is zero for a number that holds for all."""

    setting: int
    group: str
    name: str
    meaning: str
    value: float
    unit: Unit


def parameter_sheet(exported: Exported) -> str:
    """The sheet as CSV, but for a sampled law's numbers."""
    return _csv(_rows(exported))


def observer_sheet(exported: Exported) -> str:
    """A sampled law's numbers as CSV; of gains, the head alone."""
    law, command = exported.law.sampled, "A" if exported.loader.drive == ELECTRIC else "V"
    return _csv(() if law is None else (row for k in range(law.settings) for row in _sampled(law, k, command)))


def _csv(listed: Iterable[Row]) -> str:
    rows = []
    for row in listed:
        si, us = (row.unit.from_si(row.value, system) for system in (UnitSystem.SI, UnitSystem.US))
        columns = (_text(repr(si), si), row.unit.si, _text(f"{us:.{DIGITS}g}", us), row.unit.us)
        rows.append((row.setting or "", row.group, row.name, row.meaning, *columns))
    return csv_text(COLUMNS, rows)


def _text(number: str, value: float) -> str:
    """A number as text; an infinite limit or bandwidth is ``off``."""
    return number if isfinite(value) else "off"


def _rows(exported: Exported) -> Iterator[Row]:
    loader, law = exported.loader, exported.law
    yield from _of_loader(loader, "filter", _FILTERS)
    yield from _of_loader(loader, "limit", [*_LIMITS, *(key for key in loader.given if key.startswith("safety."))])
    nonlinear = [key for key in loader.given if key.startswith("feel.") and key not in (*FEEL_SETTING, *_LIMITS)]
    yield from _of_loader(loader, "feel", nonlinear)
    yield from _curve(loader)
    yield from _cancellation(law)
    for k, feel in enumerate(exported.settings):
        for key, value in zip(FEEL_SETTING, feel.tolist(), strict=True):
            yield _row(loader, k + 1, "feel", key, value)
        if law.sampled is None:
            yield from _gains(law, loader, k)


def _of_loader(loader: Loader, group: str, keys: tuple[str, ...] | list[str]) -> Iterator[Row]:
    """Rows of the loader file that are set."""
    for key in keys:
        if key in table(loader.drive):
            yield _row(loader, 0, group, key, loader[key])


def _curve(loader: Loader) -> Iterator[Row]:
    """Points of the feel's curve, if any."""
    if loader.force_curve is None:
        return
    for k, (angle, force) in enumerate(zip(loader.force_curve.x, loader.force_curve.y, strict=True), start=1):
        yield Row(0, "feel", f"force_curve.angle_{k}", f"angle of point {k} of the feel's curve", angle, _CURVE[0])
        yield Row(0, "feel", f"force_curve.force_{k}", f"force at the grip at point {k}", force, _CURVE[1])


def _cancellation(law: Law) -> Iterator[Row]:
    """Cogging and dry friction of the motor, which the law compensates."""
    known = law.cancellation
    if known is None:
        return
    rows = [
        ("per_travel", "angle of the motor per travel of the drive's end", known.per_travel_rad_per_m, "rad/m"),
        ("lead", "from the sample to the middle of its current", known.lead_s, "s"),
        ("friction", "current against the motor's dry friction", known.friction_a, "A"),
        ("slow_rate", "rate of the column below which it is in proportion", known.slow_rad_per_s, "rad/s"),
    ]
    for k, (current, periods, phase) in enumerate(known.cogging, start=1):
        rows += [
            (f"amplitude_{k}", f"current at the crest of harmonic {k} of the cogging", current, "A"),
            (f"periods_{k}", f"its periods a turn, harmonic {k}", periods, ""),
            (f"phase_{k}", f"its phase, harmonic {k}", phase, "rad"),
        ]
    for name, means, value, of in rows:
        us = "rad/in" if of == "rad/m" else of
        yield Row(0, "gain", f"cancellation.{name}", means, value, Unit(of, of, us))


def _row(loader: Loader, setting: int, group: str, key: str, value: float) -> Row:
    row = table(loader.drive)[key]
    # Coherent units avoid errors from mixing mA and cm with A and m.
    units = RATIO if is_switch(row) else Unit(unit(row).si, unit(row).si, unit(row).us)
    return Row(setting, group, key, meaning(row, loader.drive), value, units)


def _gains(law: Law, loader: Loader, setting: int) -> Iterator[Row]:
    """Gains c_1 .. c_7; the original loop of eq. (13) has those of the loader."""
    if law.numbers.kind == ORIGINAL:
        return
    gains = law.numbers.gain_law(loader, setting).gains
    for symbol, state, value, units in zip(GAIN_SYMBOLS, DESIGN_STATES, gains, GAIN_UNITS, strict=True):
        yield Row(
            setting + 1, "gain", f"law.{symbol}", f"command on {state}", value, Unit(units.si, units.si, units.us)
        )


def _sampled(law: SampledLaw, setting: int, command: str) -> Iterator[Row]:
    """Rows of a sampled law: [xi; y; delta; delta'; n] to torque and command, [xi; y; e] to the next xi."""
    n = law.states
    sampled = _SAMPLED[: law.input.shape[2] - 1]
    torque = Unit("N m", "N m", "lb in")
    for name, rows, of in (("command", law.command, Unit(command, command, command)), ("torque", law.torque, torque)):
        yield from _gain_rows(setting, name, rows[setting].tolist(), of, (n, sampled))
        value = float(law.neutral[setting, ("command", "torque").index(name)])
        yield Row(
            setting + 1, "gain", f"law.{name}_neutral", f"{name} on the feel's neutral", value, _per(of, _FEEL[0][1])
        )
    for row, column in product(range(n), range(n)):
        name = f"law.transition_{row + 1}_{column + 1}"
        value = float(law.transition[setting, row, column])
        yield Row(setting + 1, "gain", name, f"xi_{row + 1} on xi_{column + 1}", value, RATIO)
    entered = (*sampled, ("command", Unit(command, command, command)))
    for row, (column, (on, per)) in product(range(n), enumerate(entered)):
        name, value = f"law.input_{row + 1}_{column + 1}", float(law.input[setting, row, column])
        yield Row(setting + 1, "gain", name, f"xi_{row + 1} on {on}", value, _per(RATIO, per))
    for row, (column, (on, per)) in product(range(n), enumerate((*sampled, _FEEL[0]))):
        name, value = f"law.settled_{row + 1}_{column + 1}", float(law.settled[setting, row, column])
        yield Row(
            setting + 1, "gain", name, f"xi_{row + 1} in the closed loop's equilibrium on {on}", value, _per(RATIO, per)
        )
    if law.knows_friction:
        yield from _friction(setting, law.friction[setting].tolist(), (n, sampled))
    if law.knows_contact:
        yield from _contact(setting, law.contact[setting].tolist(), command)


def _friction(setting: int, numbers: list[float], on: tuple[int, _Signals]) -> Iterator[Row]:
    """Model of the column's dry friction in a law: r, b, F, beta, omega_s, U, v_s, l, parameters of learning and of rest."""
    rate, torque = Unit("rad/s", "rad/s", "rad/s"), Unit("N m", "N m", "lb in")
    n, sampled = on
    own = n + len(sampled) + len(_FEEL)
    yield from _gain_rows(setting, "friction_rate", numbers[:own], rate, on)
    for k, value in enumerate(numbers[own:-OF_FRICTION], start=1):
        yield Row(setting + 1, "gain", f"law.friction_xi_{k}", f"xi_{k} on friction", value, _per(RATIO, torque))
    learning = ("least_learnt", "most_learnt", "gain", "hand", "blur", "trust")
    stated = ("level_negative", "level_positive", "breakaway", "per_stribeck_velocity")
    names = (*stated, "uncertain", "slow_rate", "leak", *learning, "rest_rate")
    per_rate, per_torque = _per(RATIO, rate), _per(RATIO, torque)
    of_stated = (torque, torque, RATIO, per_rate)
    units = (*of_stated, torque, rate, RATIO, RATIO, RATIO, per_torque, torque, RATIO, RATIO, rate)
    for name, value, of in zip(names, numbers[-OF_FRICTION:], units, strict=True):
        yield Row(setting + 1, "gain", f"law.friction_{name}", f"{name.replace('_', ' ')} of the friction", value, of)


def _contact(setting: int, numbers: list[float], command: str) -> Iterator[Row]:
    """Part of a law for contact: alpha R_b, k_x, k_v, B_c, v_m, T_r, T_min, K_e, t_q, theta_n, theta_t."""
    radian = Unit("rad", "rad", "rad")
    units = (
        Unit("m", "m", "in"),
        Unit(f"{command}/m", f"{command}/m", f"{command}/in"),
        Unit(f"{command} s/m", f"{command} s/m", f"{command} s/in"),
        Unit("N m s/rad", "N m s/rad", "lb in s/rad"),
        Unit("rad/s", "rad/s", "rad/s"),
        Unit("N m", "N m", "lb in"),
        Unit("N m", "N m", "lb in"),
        Unit("N m/rad", "N m/rad", "lb in/rad"),
        SECONDS,
        radian,
        radian,
    )
    names = (
        "per_angle",
        "stiffness",
        "rate",
        "damping",
        "speed",
        "ripple",
        "threshold",
        "environment",
        "quick",
        "near",
        "travel",
    )
    for name, value, of in zip(names, numbers, units, strict=True):
        meaning = f"{name.replace('_', ' ')} in contact"
        yield Row(setting + 1, "gain", f"law.contact_{name}", meaning, value, of)


def _gain_rows(setting: int, name: str, row: list[float], of: Unit, states: tuple[int, _Signals]) -> Iterator[Row]:
    n, sampled = states
    on = [*((f"xi_{k + 1}", RATIO) for k in range(n)), *sampled, *_FEEL]
    for column, ((what, per), value) in enumerate(zip(on, row, strict=True)):
        yield Row(setting + 1, "gain", f"law.{name}_{column + 1}", f"{name} on {what}", value, _per(of, per))


def _per(of: Unit, per: Unit) -> Unit:
    """Unit of a gain."""

    def quotient(above: str, below: str) -> str:
        over, under = (
            f"({name})" if "/" in name or (" " in name and name is below) else name for name in (above, below)
        )
        return f"{over or 1}/{under}" if under else over

    return Unit(quotient(of.si, per.si), quotient(of.metric, per.metric), quotient(of.us, per.us))
