"""Names and units of the columns of a table."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from forcefeel.errors import InputError
from forcefeel.tables.table import Located, LocatedColumns, Table
from forcefeel.units import factor, show

DECIBEL = "dB"
"""Unit of a gain in dB, without a conversion factor."""

_LONGEST_UNIT = 40
_ROUNDING = 1e-12
"""Relative difference of equal units, due to rounding of their definitions."""
# Names are in small letters, where these units are not.
_SUFFIXES = {
    unit.lower(): unit
    for unit in ("N", "kN", "V", "mV", "A", "mA", "Pa", "kPa", "MPa", "Hz", "L/min", "N/V", "A/V", "dB")
}


@dataclass(frozen=True)
class Heading:
    """A column's name in small letters with underscores, and its unit as the file gives it; empty if it gives none."""

    name: str
    unit: str


def heading(cell: str, known: Collection[str]) -> Heading:
    """Name and unit of ``column angle (deg)``, ``Column_Angle [deg]`` or ``column_angle_deg``.

    Args:
        cell: The header's cell.
        known: Accepted names; a suffix is a unit only after one of them.
    """
    cell = cell.strip()
    for opening, closing in ("()", "[]"):
        before, opened, unit = cell[:-1].partition(opening)
        if opened and cell.endswith(closing):
            return Heading(_name(before), " ".join(unit.split()))
    name = _name(cell)
    starts = [prefix for prefix in known if name.startswith(f"{prefix}_")]
    if name in known or not starts:
        return Heading(name, "")
    longest = max(starts, key=len)
    unit = suffix_unit(name.removeprefix(f"{longest}_"))
    return Heading(longest, unit) if unit else Heading(name, "")


def suffix_unit(suffix: str) -> str:
    """The unit of a suffix: ``deg``, ``in3_per_s`` is ``in^3/s``; empty without one."""
    text = re.sub(r"(?<=[a-z])([2-9])(?![0-9])", r"^\1", suffix.lower().replace("_per_", "/").replace("_", " "))
    over, _, under = text.partition("/")
    unit = "/".join(_SUFFIXES.get(part, part) for part in (over, under) if part)
    unit = _SUFFIXES.get(unit.lower(), unit)
    try:
        return unit if unit == DECIBEL or (len(unit) <= _LONGEST_UNIT and factor(unit, unit)) else ""
    except InputError:
        return ""


def same_unit(unit: str, other: str) -> bool:
    """Whether two units are equal, whatever they are called: ``psi`` is ``lb/in^2``, ``db`` is ``dB``."""
    if unit == other or unit.lower() == other.lower() == DECIBEL.lower():
        return True
    if max(len(unit), len(other)) > _LONGEST_UNIT:
        return False
    try:
        return abs(factor(unit, other) - 1) < _ROUNDING
    except InputError:
        return False


def locate(
    table: Table,
    columns: Mapping[str, tuple[str, ...]],
    units: Mapping[str, str],
    own: Mapping[str, str],
    also: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, Located]:
    """Locate columns of a table by standard name; missing columns are omitted.

    Args:
        table: The table.
        columns: Accepted units by standard name, SI; ``""`` for a number, ``DECIBEL`` for a gain.
        units: Units by standard name or the file's own, if the header has none; see ``by_standard_name``.
        own: The file's own name of a column by standard name; see ``by_standard_name``.
        also: Standard name by second name.

    Raises:
        InputError: If a column stands twice, has no unit, a wrong unit, or another than ``units`` states.
    """
    cells = [heading(cell, (*columns, *also)) for cell in table.header]
    located: dict[str, Located] = {}
    for name, accepted in columns.items():
        if name in own:
            places = columns_called(table, own[name])
        else:
            places = [(i, cell.unit) for i, cell in enumerate(cells) if also.get(cell.name, cell.name) == name]
        if len(places) > 1:
            cells_text = " and ".join(show(table.header[i]) for i, _ in places)
            remedy = "leave one of them, or name one by the argument columns"
            raise InputError(f"{table.where}: has {len(places)} columns {name!r}, {cells_text}; {remedy}")
        for i, unit in places:
            stated = units.get(name) or units.get(own.get(name, name))
            where = f"{table.where}: {name}"
            own_unit = _agreed(where, unit, stated)
            located[name] = Located(i, *_scale(where, own_unit, accepted), own_unit)
    for name, its_own in own.items():
        if name not in located:
            raise InputError(
                f"{table.where}: has no column {show(its_own)} for {name}; the columns are {_cells(table)}"
            )
    return located


def need(table: Table, located: LocatedColumns, names: Collection[str], example: str) -> None:
    """Refuse a table without one of ``names``.

    Raises:
        InputError: With the header of the table and a valid one.
    """
    for name in names:
        if name not in located:
            raise InputError(
                f"{table.where}: has no column {name!r}; expected a header such as {example!r}, got {_cells(table)}; rename the "
                "column, or name it by the argument columns"
            )


def columns_called(table: Table, name: str) -> list[tuple[int, str]]:
    """Positions and units of the columns that the file names ``name``, with or without a unit."""
    cells = [heading(cell, (_name(name),)) for cell in table.header]
    written = [" ".join(cell.split()) == " ".join(name.split()) for cell in table.header]
    return [(i, cell.unit) for i, cell in enumerate(cells) if cell.name == _name(name) or written[i]]


def by_standard_name(
    where: str,
    argument: str,
    assigned: Mapping[str, str],
    allowed: Collection[str],
    also: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, str]:
    """The argument ``columns`` or ``units`` by standard names; ``also`` as in ``locate``.

    Raises:
        InputError: If a key is unknown, or two keys name one column.
    """
    by_name: dict[str, str] = {}
    for name, value in assigned.items():
        if name not in allowed and name not in also:
            names = ", ".join((*allowed, *also))
            raise InputError(f"{where}: the argument {argument}: unknown name {show(name)}; the names are {names}")
        if by_name.setdefault(also.get(name, name), value) != value:
            raise InputError(
                f"{where}: the argument {argument}: {also.get(name, name)} is given twice; leave one of them"
            )
    return by_name


def _name(text: str) -> str:
    return "_".join(text.strip().lower().split())


def _agreed(where: str, in_file: str, stated: str | None) -> str:
    if in_file and stated and not same_unit(in_file, stated):
        raise InputError(
            f"{where}: the header says {show(in_file)}, the argument units {show(stated)}; leave one of them out"
        )
    return in_file or stated or ""


def _scale(where: str, unit: str, accepted: tuple[str, ...]) -> tuple[str, float]:
    """The SI unit, and the SI value of one ``unit``."""
    if unit.lower() == DECIBEL.lower() and DECIBEL in accepted:
        return DECIBEL, 1.0
    if not unit and "" in accepted:
        return "", 1.0
    expected = " or ".join(unit or "no unit" for unit in accepted)
    if not unit:
        raise InputError(
            f"{where}: has no unit; expected one such as {expected}; add it to the header or by the argument units"
        )
    if len(unit) > _LONGEST_UNIT:
        raise InputError(f"{where}: unknown unit {show(unit)}; expected one such as {expected}")
    errors = []
    for si in accepted:
        if si == DECIBEL:
            continue
        try:
            return si, factor(unit, si)
        except InputError as error:
            errors.append(error)
    raise InputError(f"{where}: {errors[0]}; expected a unit such as {expected}") from errors[0]


def _cells(table: Table) -> str:
    return show(",".join(table.header))
