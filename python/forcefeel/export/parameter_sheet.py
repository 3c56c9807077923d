"""What the parameter sheet of a drive or a PLC wants of a law, as CSV: each number in SI and in U.S. customary units.

| column | is |
|---|---|
| setting | number of the feel's setting, from 1; empty where the row holds for all |
| group | feel, gain, filter, limit |
| name | row of the loader file, or of the law |
| meaning | in words |
| value (SI), unit (SI) | as the engine has it, to the last bit |
| value (U.S.), unit (U.S.) | the same, to ten digits |
"""

import csv
import io
from collections.abc import Iterator
from itertools import product
from math import isfinite
from typing import NamedTuple

from forcefeel.export.exported import Exported
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_compensator import OF_FRICTION, SampledCompensator
from forcefeel.linear.models import DESIGN_STATES
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import DIGITS, ELECTRIC, is_switch, meaning, table, unit
from forcefeel.units import RATIO, Unit, UnitSystem

SHEET = "{}_parameters.csv"
"""Name of the file."""

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

_ON = ("load cell force", "drive position", "column angle", "feel displacement", "feel rate")
_ON_UNITS = (
    Unit("N", "N", "lb"),
    Unit("m", "m", "in"),
    *(Unit("rad", "rad", "rad"),) * 2,
    Unit("rad/s", "rad/s", "rad/s"),
)
"""What a sampled law's rows act on, beside its states in coordinates of its own."""


class Row(NamedTuple):
    """One number of the sheet; ``setting`` is zero for all."""

    setting: int
    group: str
    name: str
    meaning: str
    value: float
    unit: Unit


def parameter_sheet(exported: Exported) -> str:
    """The sheet as CSV."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in _rows(exported):
        si, us = (row.unit.from_si(row.value, system) for system in (UnitSystem.SI, UnitSystem.US))
        shown = (_text(repr(si), si), row.unit.si, _text(f"{us:.{DIGITS}g}", us), row.unit.us)
        writer.writerow((row.setting or "", row.group, row.name, row.meaning, *shown))
    return text.getvalue()


def _text(number: str, value: float) -> str:
    """A number as text; a limit or a bandwidth that is infinite is off."""
    return number if isfinite(value) else "off"


def _rows(exported: Exported) -> Iterator[Row]:
    loader, law = exported.loader, exported.law
    yield from _of_loader(loader, "filter", _FILTERS)
    yield from _of_loader(loader, "limit", _LIMITS)
    nonlinear = [key for key in loader.given if key.startswith("feel.") and key not in (*FEEL_SETTING, *_LIMITS)]
    yield from _of_loader(loader, "feel", nonlinear)
    for place, feel in enumerate(exported.settings):
        for key, value in zip(FEEL_SETTING, feel.tolist(), strict=True):
            yield _row(loader, place + 1, "feel", key, value)
        if law.sampled is not None:
            yield from _sampled(law.sampled, place, "A" if loader.drive == ELECTRIC else "V")
        else:
            yield from _gains(law, loader, place)


def _of_loader(loader: Loader, group: str, keys: tuple[str, ...] | list[str]) -> Iterator[Row]:
    """Rows of the loader file, those that it has."""
    for key in keys:
        if key in table(loader.drive):
            yield _row(loader, 0, group, key, loader[key])


def _row(loader: Loader, setting: int, group: str, key: str, value: float) -> Row:
    row = table(loader.drive)[key]
    # Coherent units: a sheet in mA and cm beside one in A and m would be one more place for a slip.
    units = RATIO if is_switch(row) else Unit(unit(row).si, unit(row).si, unit(row).us)
    return Row(setting, group, key, meaning(row, loader.drive), value, units)


def _gains(law: Law, loader: Loader, place: int) -> Iterator[Row]:
    """Gains c_1 .. c_7; the original loop of eq. (13) has the loader's own."""
    fixed = law.single(loader, place).fixed
    if fixed is None:
        return
    for symbol, state, value, units in zip(GAIN_SYMBOLS, DESIGN_STATES, fixed.gains, GAIN_UNITS, strict=True):
        yield Row(place + 1, "gain", f"law.{symbol}", f"command on {state}", value, Unit(units.si, units.si, units.us))


def _sampled(law: SampledCompensator, place: int, command: str) -> Iterator[Row]:
    """The rows of a sampled law: [xi; y; delta; delta'] to torque and command, [xi; y; e] to the next xi."""
    n = law.states
    torque = Unit("N m", "N m", "lb in")
    for name, rows, of in (("command", law.command, Unit(command, command, command)), ("torque", law.torque, torque)):
        yield from _on(place, name, rows[place].tolist(), of, [f"xi_{k + 1}" for k in range(n)])
    for row, column in product(range(n), range(n)):
        name = f"law.transition_{row + 1}_{column + 1}"
        value = float(law.transition[place, row, column])
        yield Row(place + 1, "gain", name, f"xi_{row + 1} on xi_{column + 1}", value, RATIO)
    entered = (*_ON_UNITS[:3], Unit(command, command, command))
    for row, column in product(range(n), range(4)):
        on = (*_ON[:3], "command")[column]
        name, value = f"law.input_{row + 1}_{column + 1}", float(law.input[place, row, column])
        yield Row(place + 1, "gain", name, f"xi_{row + 1} on {on}", value, _per(RATIO, entered[column]))
    for row, column in product(range(n), range(4)):
        name, value = f"law.settled_{row + 1}_{column + 1}", float(law.settled[place, row, column])
        meaning = f"xi_{row + 1} at rest on {_ON[column]}"
        yield Row(place + 1, "gain", name, meaning, value, _per(RATIO, _ON_UNITS[column]))
    if law.knows_friction:
        yield from _friction(place, law.friction[place].tolist(), n)


def _friction(place: int, numbers: list[float], n: int) -> Iterator[Row]:
    """What a law knows of the column's dry friction: r, b, F, M, v_s, l, and how it learns."""
    rate, torque = Unit("rad/s", "rad/s", "rad/s"), Unit("N m", "N m", "lb in")
    states = [f"xi_{k + 1}" for k in range(n)]
    yield from _on(place, "friction_rate", numbers[: n + len(_ON)], rate, states)
    for state, value in zip(states, numbers[n + len(_ON) : -OF_FRICTION], strict=True):
        yield Row(place + 1, "gain", f"law.friction_{state}", f"{state} on friction", value, _per(RATIO, torque))
    units = (torque, torque, rate, RATIO, torque, torque, RATIO, torque, RATIO, RATIO)
    names = ("level", "margin", "slow_rate", "leak", "least_learnt", "most_learnt", "gain", "hand", "blur", "trust")
    for name, value, of in zip(names, numbers[-OF_FRICTION:], units, strict=True):
        yield Row(place + 1, "gain", f"law.friction_{name}", f"{name.replace('_', ' ')} of the friction", value, of)


def _on(place: int, name: str, row: list[float], of: Unit, states: list[str]) -> Iterator[Row]:
    on = [*((state, RATIO) for state in states), *zip(_ON, _ON_UNITS, strict=True)]
    for column, ((what, per), value) in enumerate(zip(on, row, strict=True)):
        yield Row(place + 1, "gain", f"law.{name}_{column + 1}", f"{name} on {what}", value, _per(of, per))


def _per(of: Unit, per: Unit) -> Unit:
    """Units of a gain."""

    def one(above: str, below: str) -> str:
        over, under = (f"({it})" if "/" in it or (" " in it and it is below) else it for it in (above, below))
        return f"{over or 1}/{under}" if under else over

    return Unit(one(of.si, per.si), one(of.metric, per.metric), one(of.us, per.us))
