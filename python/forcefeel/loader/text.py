"""A loader file, as it is written."""

import math
from collections.abc import Mapping
from functools import cache

from forcefeel._core import Parameter
from forcefeel.loader import bus, curve_text, tolerance_text
from forcefeel.loader.contents import Contents
from forcefeel.loader.curves import CURVES
from forcefeel.loader.parameters import (
    ALTERNATIVES,
    DIGITS,
    DRIVES,
    ELECTRIC,
    TABLE,
    alternatives,
    is_switch,
    limits_si,
    main_rows,
    meaning,
    parts,
    range_text,
    with_unit,
)
from forcefeel.loader.tolerances import nothing
from forcefeel.templating import environment
from forcefeel.units import UnitSystem

_SAME = 1e-9
"""Relative; a value that was written in the other unit system is still the same."""

_EXAMPLE_DIGITS = 4
"""An example in the other unit system is as good rounded."""


def write(contents: Contents, units: UnitSystem) -> str:
    """A commented loader file."""
    values, curves, tolerances = contents.values, contents.curves, contents.tolerances
    template = environment(html=False, toml=_toml_string).get_template("loader/loader.toml.j2")
    return template.render(
        name=contents.name,
        source=contents.source,
        drive=contents.drive,
        drives=DRIVES,
        parts=parts(contents.drive),
        rows=lambda part: main_rows(part, contents.drive),
        meaning_of=lambda row: meaning(row, contents.drive),
        stated=lambda row: _stated(row, values).name,
        alternatives=lambda part: _alternatives(part, values),
        value=lambda row: toml_value(row, values[f"{row.part}.{row.name}"], units),
        example=lambda row: toml_value(row, row.default_si, units, _EXAMPLE_DIGITS),
        limits=lambda row: _limits(row, units),
        source_of=lambda row: _source(row, contents.values[f"{row.part}.{row.name}"]),
        optional=lambda part: _optional(contents, part, units),
        curves=lambda part: [
            curve_text.write(row, curves.get(row.name), units) for row in CURVES.values() if part == "feel"
        ],
        tolerances=[f"{key} = {tolerance_text.write(TABLE[key], it, units)}" for key, it in tolerances.items()],
        bus=bus.write(contents.bus, units) if contents.bus or contents.drive == ELECTRIC else [],
    )


def _stated(row: Parameter, values: Mapping[str, float]) -> Parameter:
    """The row by which a value stands in the file: the torque constant of three phases says by which ampere."""
    of_three = row.part == "motor" and row.name == "torque_constant" and values["motor.three_phase"]
    return ALTERNATIVES["motor.torque_constant_peak"] if of_three else row


def _alternatives(part: str, values: Mapping[str, float]) -> dict[str, list[Parameter]]:
    """The rows of a part that could stand in the stead of others, by the names of those as they stand."""
    groups: dict[str, list[Parameter]] = {}
    for row in alternatives(part).values():
        stated = [_stated(TABLE[f"{part}.{name}"], values).name for name in row.instead_of]
        if row.name not in stated:
            groups.setdefault(" and ".join(stated), []).append(row)
    return groups


def _optional(contents: Contents, part: str, units: UnitSystem) -> list[str]:
    """A line for each optional row of a part: as a comment with an example where it is not given."""
    lines, values = [], contents.values
    for row in main_rows(part, contents.drive).values():
        if row.off_si is None:
            continue
        value = values[f"{row.part}.{row.name}"]
        given = value != row.off_si
        shown = toml_value(row, value, units) if given else toml_value(row, row.default_si, units, _EXAMPLE_DIGITS)
        statement = f"{row.name} = {shown}" if given else f"# {row.name} = {shown}"
        stands = "" if nothing(row, row.off_si) else f"; {with_unit(row, row.off_si, units)} unless given"
        lines.append((statement, f"{row.symbol}: {meaning(row, contents.drive)} ({_limits(row, units)}{stands})"))
    width = max((len(statement) for statement, _ in lines), default=0)
    return [f"{statement:{width}}  # {comment}" for statement, comment in lines]


def _source(row: Parameter, value: float) -> str:
    """Where the table has the value from, if it is the table's; what a loader of its own says is in its own source."""
    return f" · source {row.source}" if math.isclose(value, row.default_si, rel_tol=_SAME) else ""


def toml_value(row: Parameter, value: float, units: UnitSystem, digits: int = DIGITS) -> str:
    """A SI value as the file has it."""
    return str(bool(value)).lower() if is_switch(row) else _toml_string(with_unit(row, value, units, digits))


@cache
def _limits(row: Parameter, units: UnitSystem) -> str:
    """The accepted range; the unit stands once."""
    low, high = (with_unit(row, limit, units) for limit in limits_si(row))
    return range_text(row) if is_switch(row) else f"{low.split()[0]} to {high}"


def _toml_string(text: str) -> str:
    """A TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'
