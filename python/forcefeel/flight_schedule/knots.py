"""Knots of a flight schedule from a CSV file: a column for each axis, and three columns for the setting."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.files import MOST_TEXT_BYTES, read_input
from forcefeel.flight_schedule.axes import MOST_AXES, ScheduleAxis, place_text
from forcefeel.flight_schedule.schedule import second_order_feel
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.tables.csv_table import csv_rows, text_lines
from forcefeel.units import INERTIA, RATIO, Unit, factor, show

EXAMPLE = "dynamic pressure (lb/ft^2),stiffness (lb in/rad),frequency (Hz),damping ratio"
"""Example of a header."""

_B, _G = unit(TABLE["feel.damping"]), unit(TABLE["feel.stiffness"])
_SECOND_ORDER: Mapping[str, Unit] = MappingProxyType(
    {"stiffness": _G, "frequency": Unit("Hz", "Hz", "Hz"), "damping ratio": RATIO}
)
_COEFFICIENTS: Mapping[str, Unit] = MappingProxyType({"i": INERTIA, "b": _B, "g": _G})
_HEADER = re.compile(r"(?P<name>[^()]*?)\s*(?:\((?P<unit>[^()]*)\))?")


@dataclass(frozen=True)
class _Heading:
    name: str
    unit: str


@dataclass(frozen=True, eq=False)
class Knots:
    """Content of a file of knots.

    Attributes:
        axes: Axes in the order of their columns, values rising.
        feel: I, B, G in SI units, (values of each axis ..., 3), for ``design_schedule``.
    """

    axes: tuple[ScheduleAxis, ...]
    feel: NDArray[np.float64]


def read_knots(path: str | Path) -> Knots:
    r"""Read a file of knots.

    Args:
        path: CSV in UTF-8. The setting is in the columns ``stiffness``, ``frequency`` and ``damping ratio``, or ``I``, ``B`` and
            ``G``, each with its unit in parentheses; every other column is an axis. The rows, in any order, are a full grid of
            the axes' values, each knot once.

    Raises:
        InputError: With file, line, error, expected content and remedy.

    Example:
        >>> text = "mach,I (lb in s^2/rad),B (lb in s/rad),G (lb in/rad)\n0.3,60,400,4800\n0.6,60,500,7200\n"
        >>> size = Path("knots.csv").write_text(text)
        >>> ff.flight_schedule.read_knots("knots.csv").axes[0].values
        (0.3, 0.6)
    """
    file = Path(path)
    lines = _lines(file)
    head = [_heading(cell, file, lines[0][0]) for cell in lines[0][1]]
    setting = _setting(head, file)
    places = [k for k, heading in enumerate(head) if heading.name.lower() not in setting]
    if not 1 <= len(places) <= MOST_AXES:
        raise InputError(
            f"{file}: expected 1 to {MOST_AXES} axes beside {', '.join(setting)}, got {len(places)}; a header such as {EXAMPLE!r}"
        )
    table = np.array([_numbers(file, line, cells, head) for line, cells in lines[1:]])
    if not len(table):
        raise InputError(f"{file}: expected rows of numbers under the header, got none; give each knot a row")
    axes = tuple(_axis(file, head[k], table[:, k]) for k in places)
    order = _grid(file, axes, table[:, places], [line for line, _ in lines[1:]])
    names = [heading.name.lower() for heading in head]
    columns = [table[order, names.index(name)] * _scale(file, head[names.index(name)], setting) for name in setting]
    shape = tuple(len(axis.values) for axis in axes)
    return Knots(axes, _feel(file, setting, columns).reshape(*shape, 3))


def _lines(file: Path) -> list[tuple[int, list[str]]]:
    """Nonempty rows, the header first, each with its line number."""
    data = read_input(file, MOST_TEXT_BYTES, f"a CSV file such as {EXAMPLE!r}")
    rows = csv_rows(file, text_lines(file, data), EXAMPLE)
    lines = [(line, [" ".join(cell.split()) for cell in row]) for row, line in rows if any(row)]
    if not lines:
        raise InputError(f"{file}: is empty; expected a header such as {EXAMPLE!r} and a row for each knot")
    return lines


def _heading(cell: str, file: Path, line: int) -> _Heading:
    match = _HEADER.fullmatch(cell)
    if not match or not match["name"]:
        raise InputError(f"{file}: line {line}: expected a column such as 'flaps (deg)', got {show(cell)}")
    return _Heading(match["name"], (match["unit"] or "").strip())


def _setting(head: Sequence[_Heading], file: Path) -> Mapping[str, Unit]:
    """Columns of the setting, with their units."""
    names = [heading.name.lower() for heading in head]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{file}: has {names.count(name)} columns {name!r}; name each column once")
    forms = [each for each in (_SECOND_ORDER, _COEFFICIENTS) if set(each) & set(names)]
    if len(forms) != 1 or not set(forms[0]) <= set(names):
        raise InputError(
            f"{file}: expected the setting as stiffness, frequency and damping ratio, or as I, B and G, got the columns "
            f"{', '.join(heading.name for heading in head)}; a header such as {EXAMPLE!r}"
        )
    return forms[0]


def _scale(file: Path, heading: _Heading, setting: Mapping[str, Unit]) -> float:
    """SI value of one unit of a column of the setting."""
    unit = setting[heading.name.lower()]
    if not heading.unit and unit.us:
        raise InputError(f"{file}: {heading.name}: has no unit; write '{heading.name} ({unit.us})'")
    try:
        return factor(heading.unit, unit.si)
    except InputError as error:
        raise InputError(f"{file}: {heading.name}: {error}; write '{heading.name} ({unit.us})'") from error


def _numbers(file: Path, line: int, cells: Sequence[str], head: Sequence[_Heading]) -> list[float]:
    if len(cells) != len(head):
        raise InputError(f"{file}: line {line}: expected {len(head)} values as in the header, got {len(cells)}")
    numbers = []
    for cell, heading in zip(cells, head, strict=True):
        try:
            value = float(cell)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise InputError(f"{file}: line {line}: {heading.name}: expected a finite number, got {show(cell)}")
        numbers.append(value)
    return numbers


def _axis(file: Path, heading: _Heading, values: NDArray[np.float64]) -> ScheduleAxis:
    try:
        return ScheduleAxis(heading.name, heading.unit, tuple(np.unique(values).tolist()))
    except InputError as error:
        raise InputError(f"{file}: {error}") from error


def _grid(
    file: Path, axes: Sequence[ScheduleAxis], where: NDArray[np.float64], lines: Sequence[int]
) -> NDArray[np.intp]:
    """Indices of the rows in the order of the grid; the last axis runs fastest."""
    shape = tuple(len(axis.values) for axis in axes)
    steps = [np.searchsorted(axis.values, where[:, k]) for k, axis in enumerate(axes)]
    order = np.ravel_multi_index(steps, shape)
    seen: dict[int, int] = {}
    for knot, line, point in zip(order.tolist(), lines, where, strict=True):
        if knot in seen:
            raise InputError(
                f"{file}: line {line}: {place_text(axes, point)} is already in line {seen[knot]}; give each knot one row"
            )
        seen[knot] = line
    missing = np.setdiff1d(np.arange(np.prod(shape)), order)
    if len(missing):
        steps_there = np.unravel_index(missing[0], shape)
        point = [axis.values[int(step)] for axis, step in zip(axes, steps_there, strict=True)]
        sides = " by ".join(map(str, shape))
        raise InputError(
            f"{file}: expected a full grid of {sides} knots, got {len(order)}; missing: "
            f"{place_text(axes, point)}; add its row"
        )
    return np.argsort(order)


def _feel(file: Path, setting: Mapping[str, Unit], columns: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    if setting is _COEFFICIENTS:
        return np.column_stack(columns)
    try:
        return second_order_feel(*columns)
    except InputError as error:
        raise InputError(f"{file}: {error}") from error
