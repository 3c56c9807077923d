"""A loader: the machine of one axis, as a frozen set of checked numbers in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.loader_file import read, write
from forcefeel.parameters import INDEX, TABLE, limits_si, unit
from forcefeel.units import UnitSystem, parse, to_text

_REPORT = "NASA Langley, Analysis and Compensation of an Aircraft Simulator Control Loading System, October 1974"


@dataclass(frozen=True)
class Loader:
    """The numbers of one loader.

    Attributes:
        name: What the loader is called in results.
        source: Where its numbers come from.
        values: SI values, one per row of ``forcefeel.parameters.TABLE``, in that order; read-only.

    ``loader["linkage.stiffness"]`` is one value in SI units.

    Raises:
        InputError: If a value is not finite or out of the range of the parameter table.
    """

    name: str
    source: str
    values: NDArray[np.float64] = field(repr=False)

    def __post_init__(self) -> None:
        values = np.array(self.values, dtype=np.float64)
        values.setflags(write=False)
        object.__setattr__(self, "values", values)
        for key, value in zip(TABLE, values, strict=True):
            check_range(key, float(value))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Loader)
            and (self.name, self.source) == (other.name, other.source)
            and np.array_equal(self.values, other.values)
        )

    def __hash__(self) -> int:
        return hash((self.name, self.source, self.values.tobytes()))

    def __getitem__(self, key: str) -> float:
        return float(self.values[_position(key)])

    def replace(self, changes: Mapping[str, str | float]) -> "Loader":
        """A copy with some values changed.

        Args:
            changes: New values by ``part.name``, as text with a unit or as SI numbers.

        Raises:
            InputError: If a key is unknown or a value bad.

        Example:
            ``loader.replace({"linkage.stiffness": "7000 lb/in"})``
        """
        values = self.values.copy()
        for key, given in changes.items():
            row = TABLE[list(TABLE)[_position(key)]]
            example = f"{to_text(row.default_us)} {row.unit_us}"
            value = parse(given, row.unit_si, example) if isinstance(given, str) else float(given)
            values[_position(key)] = value
        return replace(self, values=values)

    def scale_feel(self, scale: float) -> NDArray[np.float64]:
        """Values with I, B and G multiplied by ``scale``, so that frequency and damping ratio stay.

        Unlike ``replace`` this does not check the range, for searches that go beyond what one would build.
        """
        values = self.values.copy()
        for name in ("inertia", "damping", "stiffness"):
            values[INDEX[f"feel.{name}"]] *= scale
        return values

    def to_toml(self, units: UnitSystem = UnitSystem.US) -> str:
        """The loader as a commented loader file."""
        return write(self.name, self.source, dict(zip(TABLE, self.values.tolist(), strict=True)), units)


def elevator() -> Loader:
    """The elevator loader of the 1974 report, from the appendix's U.S. customary column."""
    return Loader("elevator", _REPORT, np.array([row.default_si for row in TABLE.values()]))


def load(path: str | Path) -> Loader:
    """Reads a loader file.

    Args:
        path: A TOML file as ``forcefeel new`` writes it.

    Raises:
        InputError: With a line for each thing that is wrong: the file, the key, what was expected and what came.
    """
    name, source, values = read(Path(path))
    return Loader(name, source, np.array([values[key] for key in TABLE]))


def check_range(key: str, value: float) -> None:
    """Refuses a value (SI) outside the range of the parameter table."""
    row = TABLE[key]
    low, high = limits_si(row)
    # A limit that went through a unit and back may be off by rounding.
    if not low * (1 - 1e-12) <= value <= high * (1 + 1e-12):
        us = unit(row).from_si(value, UnitSystem.US)
        limits = f"{to_text(row.minimum_us)} to {to_text(row.maximum_us)} {row.unit_us}".strip()
        raise InputError(f"{key}: expected {limits}, got {to_text(us, 6)} {row.unit_us}".strip())


def _position(key: str) -> int:
    try:
        return INDEX[key]
    except KeyError:
        raise InputError(f"unknown parameter {key!r}; the parameters are {', '.join(TABLE)}") from None
