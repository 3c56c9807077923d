"""Rows of the feel that a program may tune in an exported law of one setting, each within a range.

A sampled law depends on I, B and G of the feel and on its stick shaker. Without a force sensor, on a motor, it depends on the
steepest slope of the feel too (``laws.made_for``). It holds at any value of every other row of the feel.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from forcefeel._core import Parameter
from forcefeel.errors import InputError, suggestion
from forcefeel.laws.law import Law
from forcefeel.laws.made_for import is_steep
from forcefeel.laws.sampled.sampled_law import SAMPLED, SampledLaw
from forcefeel.loader.consistency import AT_LEAST, BELOW, without_effect
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import (
    ALTERNATIVES,
    ELECTRIC,
    INDEX,
    TABLE,
    in_range,
    limits_si,
    range_text,
    value_text,
)
from forcefeel.units import ends, parse, show, to_text

_DESIGNED_FOR = {*FEEL_SETTING, *(key for key in ALTERNATIVES if key.startswith("feel."))}
_NOT_IN_THE_CODE = {"feel.maximum_stiffness", "feel.shaker_frequency"}
_SMALLER = {*(below for below, _ in BELOW), *(least for _, least in AT_LEAST)}
_SHAKER = "feel.shaker_force"


@dataclass(frozen=True)
class Tunable:
    """A row of the feel with its range.

    Attributes:
        key: The row, ``feel.name``.
        low: Least value in SI units.
        high: Greatest value in SI units.
    """

    key: str
    low: float
    high: float

    @property
    def row(self) -> Parameter:
        """The row of the parameter table."""
        return TABLE[self.key]

    @property
    def name(self) -> str:
        """Name of its number in C."""
        return self.row.name

    @property
    def place(self) -> int:
        """Its place in the parameter table."""
        return INDEX[self.key]


def tunable_rows(texts: Sequence[str], loader: Loader, law: Law) -> tuple[Tunable, ...]:
    """Rows of texts such as ``feel.breakout=0..10 lb``, or ``feel.deadband`` for the range of the parameter table.

    Raises:
        InputError: If a text is bad, the law depends on the row or has several settings, the loader's own value is out of the
            range, or two ranges contradict each other.

    Example:
        >>> from forcefeel.export.tunable import tunable_rows
        >>> loader = ff.digital_elevator()
        >>> [row.name for row in tunable_rows(["feel.breakout=0..10 lb"], loader, ff.Law.of("robust", loader))]
        ['breakout']
    """
    rows = tuple(_tunable(text, loader, law) for text in texts)
    keys = [row.key for row in rows]
    if twice := [key for key in keys if keys.count(key) > 1]:
        raise InputError(f"tunable: {twice[0]} is given twice; give it once")
    if rows and law.feel is not None and len(law.feel) > 1:
        raise InputError(f"tunable: expected a law of one setting, got {len(law.feel)}; leave knots or tunable out")
    try:
        loader.replace({row.key: row.high for row in rows}, si=True)
        # Where the rules between two rows are nearest to being broken.
        tuned(loader, {row.key: row.high if row.key in _SMALLER else row.low for row in rows})
    except InputError as error:
        raise InputError(f"tunable: somewhere in the ranges: {error}; narrow them") from error
    return rows


def tuned(loader: Loader, values: Mapping[str, float]) -> Loader:
    """The loader with SI values of tunable rows; a travel whose force is zero has no effect, and is left out."""
    idle = without_effect({**loader, **values})
    return loader.replace({**values, **dict.fromkeys(values.keys() & idle.keys())}, si=True)


def _tunable(text: str, loader: Loader, law: Law) -> Tunable:
    key, _, span = (part.strip() for part in text.partition("="))
    if reason := _refused(key, loader, law):
        raise InputError(f"tunable: {reason}")
    row = TABLE[key]
    low, high = limits_si(row)
    if span:
        try:
            low, high = (parse(end, row.unit_si, value_text(row, row.default_si)) for end in ends(span))
        except (InputError, ValueError) as error:
            raise InputError(f"tunable: {key}: expected a range such as {_example(row)}, got {show(span)}") from error
    if not (low < high and in_range(row, low) and in_range(row, high)):
        raise InputError(
            f"tunable: {key}: expected a least and a greatest value within {range_text(row)}, got {show(span)}"
        )
    value = loader[key]
    if not low <= value <= high:
        off = " (off)" if value == row.off_si else ""
        span = f"{value_text(row, low)} to {value_text(row, high)}"
        raise InputError(
            f"tunable: {key}: expected a range that holds the loader's own value, {value_text(row, value)}{off}, got {span}"
        )
    return Tunable(key, low, high)


def _example(row: Parameter) -> str:
    return repr(f"{to_text(row.default_us)}..{to_text(2 * row.default_us)} {row.unit_us}")


def _refused(key: str, loader: Loader, law: Law) -> str:
    """Why a row cannot be tuned; empty if it can."""
    if key in _DESIGNED_FOR:
        return f"{key}: {law.name} is designed for its value; export settings with knots, between which the code blends"
    if key == _SHAKER:
        return f"{key}: {law.name} is designed for its value; scale the input shaker"
    if key in _NOT_IN_THE_CODE:
        return f"{key}: the C has no such number; leave it out"
    feel = [row for row in TABLE if row.startswith("feel.")]
    if key not in feel:
        return f"{show(key)}: expected a row of the feel, such as feel.breakout{suggestion(key, feel)}"
    if loader.drive == ELECTRIC and is_steep(key) and not _reads_force(law.sampled):
        return f"{key}: {law.name} is designed for the steepest slope of the feel; use a law with a force sensor"
    return ""


def _reads_force(law: SampledLaw | None) -> bool:
    """Whether a law reads a force sensor."""
    if law is None:
        return False
    # Load cell and, where it is sampled, the grip's sensor.
    forces = [0, *range(SAMPLED, law.sampled)]
    return bool(np.any(law.input[..., forces]) or np.any(law.torque[:, law.states :][:, forces]))
