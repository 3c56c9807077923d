"""The parameter table of the Rust model, indexed by ``part.name``."""

from types import MappingProxyType

from forcefeel import _core
from forcefeel._core import Parameter
from forcefeel.units import Unit, factor

PARTS = MappingProxyType(dict(_core.parts()))
"""Each part of a loader and what it is, in the order of figure 1."""

_ROWS = {f"{row.part}.{row.name}": row for row in _core.parameters()}

TABLE = MappingProxyType({key: row for key, row in _ROWS.items() if not row.instead_of})
"""The rows that make a loader, in the order of its values."""

ALTERNATIVES = MappingProxyType({key: row for key, row in _ROWS.items() if row.instead_of})
"""The rows that a loader file may give instead of others of the same part."""

INDEX = MappingProxyType({key: position for position, key in enumerate(TABLE)})
"""Position of each row's value."""


def unit(row: Parameter) -> Unit:
    """The row's units."""
    return Unit(row.unit_si, row.unit_metric, row.unit_us)


def limits_si(row: Parameter) -> tuple[float, float]:
    """Smallest and largest accepted value in SI units."""
    scale = factor(row.unit_us, row.unit_si)
    return row.minimum_us * scale, row.maximum_us * scale


def alternatives(part: str) -> dict[str, Parameter]:
    """The rows of ``part`` that may stand in other rows' stead."""
    return {row.name: row for row in ALTERNATIVES.values() if row.part == part}


def replaced(part: str) -> list[str]:
    """Names of the rows of ``part`` in whose stead the alternatives may stand."""
    return next((row.instead_of for row in ALTERNATIVES.values() if row.part == part), [])


def main_rows(part: str) -> dict[str, Parameter]:
    """The rows of ``part`` that make a loader."""
    return {row.name: row for row in TABLE.values() if row.part == part}
