"""The parameter table of the Rust model, indexed by ``part.name``."""

from types import MappingProxyType

from forcefeel import _core
from forcefeel._core import Parameter
from forcefeel.units import Unit, UnitSystem, to_text

PARTS = MappingProxyType(dict(_core.parts()))
"""Each part of a loader and what it is, in the order of figure 1."""

_ROWS = {f"{row.part}.{row.name}": row for row in _core.parameters()}

TABLE = MappingProxyType({key: row for key, row in _ROWS.items() if not row.instead_of})
"""The rows that make a loader, in the order of its values."""

ALTERNATIVES = MappingProxyType({key: row for key, row in _ROWS.items() if row.instead_of})
"""The rows that a loader file may give instead of others of the same part."""

INDEX = MappingProxyType({key: position for position, key in enumerate(TABLE)})
"""Position of each row's value."""

_LIMIT_ROUNDING = 1e-9
"""Relative; a limit that a file states with ten digits, perhaps in the other unit system, is still the limit."""

_LIMIT_DIGITS = 10


def unit(row: Parameter) -> Unit:
    """The row's units."""
    return Unit(row.unit_si, row.unit_metric, row.unit_us)


def limits_si(row: Parameter) -> tuple[float, float]:
    """Smallest and largest accepted value in SI units."""
    return row.minimum_si, row.maximum_si


def in_range(row: Parameter, value: float) -> bool:
    """Whether the row accepts ``value`` in SI units; "not a number" never is."""
    low, high = limits_si(row)
    return low * (1 - _LIMIT_ROUNDING) <= value <= high * (1 + _LIMIT_ROUNDING)


def range_text(row: Parameter) -> str:
    """The accepted range in U.S. customary units and, where they differ, in metric ones."""
    shown = [
        " to ".join(to_text(unit(row).from_si(limit, system), _LIMIT_DIGITS) for limit in limits_si(row))
        + f" {unit(row).shown(system)}".rstrip()
        for system in (UnitSystem.US, UnitSystem.SI)
    ]
    return shown[0] if shown[0] == shown[1] else f"{shown[0]} ({shown[1]})"


def alternatives(part: str) -> dict[str, Parameter]:
    """The rows of ``part`` that may stand in other rows' stead."""
    return {row.name: row for row in ALTERNATIVES.values() if row.part == part}


def replaced(part: str) -> list[str]:
    """Names of the rows of ``part`` in whose stead the alternatives may stand."""
    return next((row.instead_of for row in ALTERNATIVES.values() if row.part == part), [])


def main_rows(part: str) -> dict[str, Parameter]:
    """The rows of ``part`` that make a loader."""
    return {row.name: row for row in TABLE.values() if row.part == part}
