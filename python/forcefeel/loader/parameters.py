"""The parameter table of the Rust model, indexed by ``part.name``."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import Parameter
from forcefeel.errors import nearest
from forcefeel.units import RATIO, Unit, UnitSystem, to_text

PARTS = MappingProxyType(dict(_core.parts()))
"""Each part of a loader and what it is, in the order of figure 1; a loader has those of its drive."""

_ROWS = {f"{row.part}.{row.name}": row for row in _core.parameters()}

TABLE = MappingProxyType({key: row for key, row in _ROWS.items() if not row.instead_of})
"""The rows that make a loader, in the order of its values; rows that its drive has not are ``absent`` there."""

HYDRAULIC, ELECTRIC = DRIVES = ("hydraulic", "electric")
"""What may move a linkage."""


def absent(row: Parameter) -> float:
    """What a row holds in SI units that a loader's drive has not: off, or zero."""
    return 0.0 if row.off_si is None else row.off_si


OFF = MappingProxyType({key: row.off_si for key, row in TABLE.items() if row.off_si is not None})
"""The optional rows with the value, in SI units, that stands where a loader does not give them; some are infinite."""

ALTERNATIVES = MappingProxyType({key: row for key, row in _ROWS.items() if row.instead_of})
"""The rows that a loader file may give instead of others of the same part."""

INDEX = MappingProxyType({key: position for position, key in enumerate(TABLE)})
"""Position of each row's value."""

_WITHOUT = {"controller.period": "for an analog controller"}

_LIMIT_ROUNDING = 1e-9
"""Relative; a limit that a file states with ten digits, perhaps in the other unit system, is still the limit."""

DIGITS = 10
"""What people read of a value that is not rounded for them."""


def drive_of(values: NDArray[np.float64]) -> str:
    """The drive of a loader with these SI values: one with a motor, be its torque constant good or bad, is electric."""
    return ELECTRIC if values[INDEX["motor.torque_constant"]] != 0 else HYDRAULIC


def has(drive: str, row: Parameter) -> bool:
    """Whether a loader of that drive has the row."""
    return row.drive in (None, drive)


def a_drive(drive: str) -> str:
    """A drive with its article, for a sentence."""
    return f"a{'n' if drive == ELECTRIC else ''} {drive} drive"


def meaning(row: Parameter, drive: str) -> str:
    """What a row means, for a loader of that drive."""
    return _without_piston(row.meaning, drive)


def _without_piston(text: str, drive: str) -> str:
    """Rows that both drives have are told by the report's piston; a motor has none."""
    return text.replace("piston", "drive") if drive == ELECTRIC else text


@cache
def table(drive: str) -> Mapping[str, Parameter]:
    """The rows of ``TABLE`` that a loader of that drive has."""
    return MappingProxyType({key: row for key, row in TABLE.items() if has(drive, row)})


@cache
def required(drive: str) -> Mapping[str, Parameter]:
    """The rows that every loader of that drive states."""
    return MappingProxyType({key: row for key, row in table(drive).items() if row.off_si is None})


@cache
def parts(drive: str) -> Mapping[str, str]:
    """The parts of a loader of that drive and what each is."""
    own = {row.part for row in table(drive).values()}
    return MappingProxyType({part: _without_piston(what, drive) for part, what in PARTS.items() if part in own})


@cache
def unit(row: Parameter) -> Unit:
    """The row's units; a switch has none."""
    return RATIO if is_switch(row) else Unit(row.unit_si, row.unit_metric, row.unit_us)


def is_switch(row: Parameter) -> bool:
    """Whether the row is a yes or a no, held as 1 or 0."""
    return row.unit_si == "switch"


def limits_si(row: Parameter) -> tuple[float, float]:
    """Smallest and largest accepted value in SI units."""
    return row.minimum_si, row.maximum_si


def in_range(row: Parameter, value: float) -> bool:
    """Whether the row may be given as ``value`` in SI units; "not a number" never may."""
    low, high = limits_si(row)
    if is_switch(row):
        return value in limits_si(row)
    return low - abs(low) * _LIMIT_ROUNDING <= value <= high + abs(high) * _LIMIT_ROUNDING


def stands(row: Parameter, value: float) -> bool:
    """Whether ``value`` in SI units is in the row's range or, for an optional row, the one that switches it off."""
    return value == row.off_si or in_range(row, value)


def range_text(row: Parameter) -> str:
    """The accepted range in U.S. customary units and, where they differ, in metric ones."""
    if is_switch(row):
        return "true or false"
    shown = [
        " to ".join(to_text(unit(row).from_si(limit, system), DIGITS) for limit in limits_si(row))
        + f" {unit(row).shown(system)}".rstrip()
        for system in (UnitSystem.US, UnitSystem.SI)
    ]
    return shown[0] if shown[0] == shown[1] else f"{shown[0]} ({shown[1]})"


def with_unit(row: Parameter, value: float, system: UnitSystem, digits: int = DIGITS) -> str:
    """A SI value as text with the unit that people read; ten digits at most, so that it reads back to rounding."""
    return f"{unit(row).from_si(value, system):.{digits}g} {unit(row).shown(system)}".strip()


def value_text(row: Parameter, value: float, digits: int = DIGITS) -> str:
    """A SI value as a message shows it."""
    return with_unit(row, value, UnitSystem.US, digits)


def without(row: Parameter, how: str = "leave the row out") -> str:
    """What to do for a loader that has not what an optional row stands for; ``how`` for one that is no file."""
    return f"{how} {_WITHOUT.get(f'{row.part}.{row.name}', 'to switch it off')}"


def alternatives(part: str) -> dict[str, Parameter]:
    """The rows of ``part`` that may stand in other rows' stead."""
    return {row.name: row for row in ALTERNATIVES.values() if row.part == part}


def replaced(part: str) -> list[str]:
    """Names of the rows of ``part`` in whose stead alternatives may stand."""
    return list(dict.fromkeys(name for row in alternatives(part).values() for name in row.instead_of))


def main_rows(part: str, drive: str) -> dict[str, Parameter]:
    """The rows of ``part`` that make a loader of that drive."""
    return {row.name: row for row in table(drive).values() if row.part == part}


def did_you_mean(key: str, known: Mapping[str, Parameter] = TABLE) -> str:
    """Suggestion for a ``part.name`` that is not one of the ``known`` rows."""
    if not isinstance(key, str):
        return "name it as text, part.name"
    if key in ALTERNATIVES:
        return f"a loader file may state it; a loader holds {' and '.join(ALTERNATIVES[key].instead_of)} instead"
    if close := " or ".join(row for row in known if row.endswith(f".{key}")) or nearest(key, known):
        return f"did you mean {close}?"
    return f"the parameters are {', '.join(known)}"


_LINK_AND_COLUMN = (
    "linkage.ratio",
    "linkage.stiffness",
    "linkage.damping",
    "column.inertia",
    "column.base_arm",
    "column.grip_arm",
)

PLANT_PARAMETERS = (
    "amplifier.admittance",
    "valve.current_gain",
    "valve.pressure_gain",
    "valve.natural_frequency",
    "valve.damping_ratio",
    "actuator.area",
    "actuator.oil_volume",
    "actuator.bulk_modulus",
    *_LINK_AND_COLUMN,
)
"""Every parameter that the compensated loop of a hydraulic loader depends on, besides its gains and the programmed feel."""

MOTOR_PARAMETERS = (
    "motor.torque_constant",
    "motor.inertia",
    "current_loop.bandwidth",
    "transmission.travel",
    "transmission.stiffness",
    *_LINK_AND_COLUMN,
)
"""Those of an electric loader."""
