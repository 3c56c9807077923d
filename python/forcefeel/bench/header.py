"""What the columns of bench data are called and what they are measured in."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from forcefeel.bench.channels import CHANNELS, channel
from forcefeel.bench.tables import Found, Table
from forcefeel.errors import InputError
from forcefeel.units import factor, show

DECIBEL = "dB"
"""Of a gain: no unit that multiplies, so that no factor belongs to it."""

_LONGEST_UNIT = 40
_ROUNDING = 1e-12
"""Relative; equal units that are defined by other products differ by some roundings."""
_BRACKETS = re.compile(r"(?P<name>.*?)\s*(?:\((?P<round>.*)\)|\[(?P<square>[^\]]*)\])", re.DOTALL)
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
        known: Names that are looked for; a suffix is a unit only after one of them.
    """
    if bracketed := _BRACKETS.fullmatch(cell.strip()):
        unit = bracketed["round"] if bracketed["round"] is not None else bracketed["square"]
        return Heading(_name(bracketed["name"]), " ".join(unit.split()))
    name = _name(cell)
    before = [it for it in known if name.startswith(f"{it}_")]
    if name in known or not before:
        return Heading(name, "")
    longest = max(before, key=len)
    unit = suffix_unit(name.removeprefix(f"{longest}_"))
    return Heading(longest, unit) if unit else Heading(name, "")


def suffix_unit(suffix: str) -> str:
    """The unit that a suffix stands for: ``deg``, ``in3_per_s`` is ``in^3/s``; empty if it is none."""
    text = re.sub(r"(?<=[a-z])([2-9])(?![0-9])", r"^\1", suffix.lower().replace("_per_", "/").replace("_", " "))
    over, _, under = text.partition("/")
    unit = "/".join(_SUFFIXES.get(part, part) for part in (over, under) if part)
    unit = _SUFFIXES.get(unit.lower(), unit)
    try:
        return unit if unit == DECIBEL or (len(unit) <= _LONGEST_UNIT and factor(unit, unit)) else ""
    except InputError:
        return ""


def same_unit(one: str, other: str) -> bool:
    """Whether two units are equal, whatever they are called: ``psi`` is ``lb/in^2``, ``db`` is ``dB``."""
    if one == other or one.lower() == other.lower() == DECIBEL.lower():
        return True
    if max(len(one), len(other)) > _LONGEST_UNIT:
        return False
    try:
        return abs(factor(one, other) - 1) < _ROUNDING
    except InputError:
        return False


def locate(
    table: Table, wanted: Mapping[str, tuple[str, ...]], units: Mapping[str, str], own: Mapping[str, str]
) -> dict[str, tuple[int, str, float]]:
    """Which columns of a table those that are wanted are; one that is missing is left out.

    Args:
        table: The table.
        wanted: Units by name in which a column may be, SI; ``""`` for a number, ``DECIBEL`` for a gain.
        units: Units by name, wanted or the file's own, where the header has none.
        own: The file's own name of a wanted column.

    Raises:
        InputError: If one stands twice, has no unit, one that does not measure it, or another than ``units`` says.
    """
    found: dict[str, tuple[int, str, float]] = {}
    for name, accepted in wanted.items():
        places = _places(table, name, wanted, own.get(name))
        if len(places) > 1:
            cells = " and ".join(show(table.header[i]) for i, _ in places)
            raise InputError(f"{table.where}: has {len(places)} columns {name!r}, {cells}; leave one of them")
        for i, unit in places:
            given = units.get(name) or units.get(own.get(name, name))
            where = f"{table.where}: {name}"
            found[name] = (i, *_scale(where, _agreed(where, unit, given), accepted))
    for name, its_own in own.items():
        if name not in found:
            raise InputError(
                f"{table.where}: has no column {show(its_own)} for {name}; the columns are {_cells(table)}"
            )
    return found


def need(table: Table, found: Found, names: Collection[str], example: str) -> None:
    """Refuses a table without one of ``names``.

    Raises:
        InputError: With what the table has and a good header.
    """
    for name in names:
        if name not in found:
            raise InputError(f"{table.where}: has no column {name!r}; expected {example!r}, got {_cells(table)}")


def channel_and_unit(text: str) -> tuple[str, str]:
    """Channel and unit of ``test_signal (V)``; the unit is empty where none is given.

    Raises:
        InputError: If there is no such channel.
    """
    found = heading(text, CHANNELS)
    return channel(found.name), found.unit


def _name(text: str) -> str:
    return "_".join(text.strip().lower().split())


def _places(table: Table, name: str, known: Collection[str], own: str | None) -> list[tuple[int, str]]:
    """Where a column stands and its unit there."""
    if own is None:
        cells = [heading(cell, known) for cell in table.header]
        return [(i, cell.unit) for i, cell in enumerate(cells) if cell.name == name]
    cells = [heading(cell, (_name(own),)) for cell in table.header]
    written = [" ".join(cell.split()) == " ".join(own.split()) for cell in table.header]  # with its unit, perhaps
    return [(i, cell.unit) for i, cell in enumerate(cells) if cell.name == _name(own) or written[i]]


def _agreed(where: str, in_file: str, given: str | None) -> str:
    if in_file and given and not same_unit(in_file, given):
        raise InputError(
            f"{where}: the header says {show(in_file)}, the argument units {show(given)}; leave one of them out"
        )
    return in_file or given or ""


def _scale(where: str, given: str, accepted: tuple[str, ...]) -> tuple[str, float]:
    """The SI unit, and the SI value of one ``given``."""
    if given.lower() == DECIBEL.lower() and DECIBEL in accepted:
        return DECIBEL, 1.0
    if not given and "" in accepted:
        return "", 1.0
    expected = " or ".join(unit or "no unit" for unit in accepted)
    if not given:
        raise InputError(
            f"{where}: has no unit; expected one such as {expected}; add it to the header or by the argument units"
        )
    if len(given) > _LONGEST_UNIT:
        raise InputError(f"{where}: unknown unit {show(given)}; expected one such as {expected}")
    errors = []
    for si in accepted:
        if si == DECIBEL:
            continue
        try:
            return si, factor(given, si)
        except InputError as error:
            errors.append(error)
    raise InputError(f"{where}: {errors[0]}; expected a unit such as {expected}") from errors[0]


def _cells(table: Table) -> str:
    return show(",".join(table.header))
