"""A loader: the machine of one axis, as a frozen set of checked numbers in SI units."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.loader_file import read, write
from forcefeel.parameters import ALTERNATIVES, INDEX, TABLE, in_range, range_text, unit
from forcefeel.units import UnitSystem, parse, show, to_text

_REPORT = "NASA Langley, Analysis and Compensation of an Aircraft Simulator Control Loading System, October 1974"


FEEL_SETTING = ("feel.inertia", "feel.damping", "feel.stiffness")
"""The computer setting I, B, G."""


@dataclass(frozen=True)
class Loader:
    """The numbers of one loader.

    Attributes:
        name: What the loader is called in results.
        source: Where its numbers come from.
        values: SI values, one per row of ``forcefeel.parameters.TABLE``, in that order; read-only.

    ``loader["linkage.stiffness"]`` is one value in SI units.

    Raises:
        InputError: If there are not as many values as rows, or one is not finite or out of its row's range.
    """

    name: str
    source: str
    values: NDArray[np.float64] = field(repr=False)

    def __post_init__(self) -> None:
        values = np.array(self.values, dtype=np.float64)
        if values.shape != (len(TABLE),):
            raise InputError(f"values: expected {len(TABLE)}, one per parameter, got shape {values.shape}")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)
        for key, value in zip(TABLE, values, strict=True):
            _check_range(key, float(value))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Loader)
            and (self.name, self.source) == (other.name, other.source)
            and np.array_equal(self.values, other.values)
        )

    def __hash__(self) -> int:
        return hash((self.name, self.source, *self.values.tolist()))

    def __reduce__(self) -> tuple[Callable[..., "Loader"], tuple[str, str, NDArray[np.float64]]]:
        return _unchecked, (self.name, self.source, self.values)  # so that a copy is read-only too

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
            position = _position(key)
            values[position] = _value(key, given)
        return replace(self, values=values)

    def scale_feel(self, scale: float) -> "Loader":
        """I, B, G and the pilot's force multiplied by ``scale``: frequency, damping ratio and programmed deflection stay.

        Unlike ``replace`` this does not check the range, for settings beyond what one would build.
        """
        values = self.values.copy()
        for key in (*FEEL_SETTING, "pilot.force"):
            values[INDEX[key]] *= scale
        return _unchecked(self.name, self.source, values)

    def to_toml(self, units: UnitSystem = UnitSystem.US) -> str:
        """The loader as a commented loader file."""
        return write(self.name, self.source, dict(zip(TABLE, self.values.tolist(), strict=True)), units)


def _unchecked(name: str, source: str, values: NDArray[np.float64]) -> Loader:
    """A loader whose values may lie beyond the ranges of the parameter table."""
    loader = object.__new__(Loader)
    values.setflags(write=False)
    for attribute, value in (("name", name), ("source", source), ("values", values)):
        object.__setattr__(loader, attribute, value)
    return loader


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


def _check_range(key: str, value: float) -> None:
    """Refuses a value (SI) outside the range of the parameter table."""
    row = TABLE[key]
    if not in_range(row, value):
        got = f"{unit(row).from_si(value, UnitSystem.US):.10g} {row.unit_us}".strip()
        raise InputError(f"{key}: expected {range_text(row)}, got {got}")


def _value(key: str, given: str | float) -> float:
    """``given`` as a SI number; a number without a unit is one already."""
    row = TABLE[key]
    example = f"{to_text(row.default_us)} {row.unit_us}".strip()
    try:
        return parse(given, row.unit_si if isinstance(given, str) else "", example)
    except InputError as error:
        raise InputError(f"{key}: {error}") from error


def _position(key: str) -> int:
    try:
        return INDEX[key]
    except KeyError:
        if key in ALTERNATIVES:
            hint = f"a loader file may state it; a loader holds {' and '.join(ALTERNATIVES[key].instead_of)} instead"
        elif close := [known for known in TABLE if known.endswith(f".{key}")] or get_close_matches(key, TABLE, n=1):
            hint = f"did you mean {' or '.join(close)}?"
        else:
            hint = f"the parameters are {', '.join(TABLE)}"
        raise InputError(f"unknown parameter {show(key)}; {hint}") from None
