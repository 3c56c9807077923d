"""A force recorded on a bench or an aircraft, and the CSV file that it comes in."""

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.inputs.sampled import ROUNDING, Grid, Sampled, through_points
from forcefeel.units import factor, show

GAP = 5.0
"""A step of more than so many times the median step is a gap in a recording."""

_HEADER = re.compile(r"(?P<name>.*?)\s*(?:\((?P<round>[^;]*)\)|\[(?P<square>[^;]*)\]|_(?P<suffix>[^_\s]+))?", re.DOTALL)
_SUFFIXES = {"n": "N", "kn": "kN"}  # names are in small letters, where these units are not
# What a column of times or forces can be in; longer powers only keep the units' parser busy.
_UNIT = re.compile(r"[A-Za-zµμ°%][A-Za-zµμ°% */()]{0,39}(?:\^[0-9])?")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
_COLUMNS = {"time": "s", "force": "N"}
_EXAMPLE = "time (s),force (lb)"


@dataclass(frozen=True, eq=False)
class Recorded:
    """A recorded force, straight between its points; they may be at any distance, but without a gap.

    Attributes:
        time_s: Times of the points, s, each above the one before; a step of more than ``GAP`` times the median is a gap.
        force_n: Forces at these times, N.
        name: What a message names.

    Raises:
        InputError: When built, with the row at fault: fewer than two rows, numbers that are not finite, time that runs
            backwards or stands still, a gap.
    """

    time_s: NDArray[np.float64]
    force_n: NDArray[np.float64]
    name: str = "Recorded"

    def __post_init__(self) -> None:
        for field in ("time_s", "force_n"):
            try:
                row = np.array(getattr(self, field), dtype=np.float64)
            except (TypeError, ValueError) as error:
                raise InputError(f"{self.name}: expected {field} to be a row of numbers ({error})") from error
            row.setflags(write=False)
            object.__setattr__(self, field, row)
        if self.time_s.ndim != 1 or self.time_s.shape != self.force_n.shape:
            came = f"shapes {self.time_s.shape} and {self.force_n.shape}"
            raise InputError(f"{self.name}: expected time_s and force_n to be rows of one length, got {came}")
        if fault := _fault(self.time_s, self.force_n):
            row_at_fault, sentence = fault
            raise InputError(f"{self.name}: row {row_at_fault}, counted from 1: {sentence}")

    def from_zero(self) -> "Recorded":
        """The same with the first point at time zero."""
        return Recorded(self.time_s - self.time_s[0], self.force_n, self.name)

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The force over a run, N; of points closer than the steps, only the line at the times of the steps is seen.

        Args:
            time_s: Length of the run; the recording must cover it from time zero.
            step_s: Step h.

        Raises:
            InputError: If the run is not a whole number of steps, or the recording begins after its start or ends before
                its end: what the force was there is not known.
        """
        grid = Grid.of(time_s, step_s)
        first, last = float(self.time_s[0]), float(self.time_s[-1])
        slack = ROUNDING * grid.step_s
        if first > slack or last < grid.end_s - slack:
            remedy = "take from_zero()" if first > slack else "simulate a shorter time"
            raise InputError(
                f"{self.name}: expected a recording of all the run, 0 s to {grid.end_s:.15g} s, got {first:.15g} s to "
                f"{last:.15g} s; {remedy} or give a file that covers it"
            )
        return through_points(self.name, grid, self.time_s, self.force_n)


def read_recorded(path: str | Path) -> Recorded:
    """Reads a recorded force from a CSV file.

    The first line names the columns, each with its unit: ``time (s),force (lb)``, ``time [s], force [N]`` or
    ``time_s,force_n``; ``lb`` is a pound of force. Other columns may stand beside them and are not read. Numbers have a
    decimal point; a comma parts the columns.

    Args:
        path: A CSV file in UTF-8.

    Returns:
        The recording in SI units, named as the file without its ending.

    Raises:
        InputError: With the file, the line, what is wrong, what was expected and the remedy: a file that cannot be read,
            is not UTF-8, is empty or has fewer than two rows; a column that is missing, stands twice, has no unit, an
            unknown one or one that measures something else; a row with another number of values, text that is no
            number, a number that is not finite; time that runs backwards or stands still; a gap.
    """
    path = Path(path)
    rows = _rows(path, _text(path))
    line, header = next(rows, (1, []))
    if not header:
        raise InputError(f"{path}: line 1: is empty; expected a header such as {_EXAMPLE!r} and rows of numbers")
    header = [" ".join(cell.split()) for cell in header]
    columns = {name: _column(header, name, f"{path}: line {line}") for name in _COLUMNS}
    lines, numbers = [line], []
    for at, row in rows:
        if len(row) != len(header):
            raise InputError(
                f"{path}: line {at}: expected {len(header)} values as in the header, got {len(row)}; "
                "write numbers with a decimal point and part them with one comma"
            )
        where = f"{path}: line {at}"
        numbers.append([_number(row[i], f"{where}: {name}") * scale for name, (i, scale) in columns.items()])
        lines.append(at)
    time_s, force_n = np.array(numbers, dtype=np.float64).reshape(-1, len(columns)).T
    if fault := _fault(time_s, force_n):
        row_at_fault, sentence = fault
        raise InputError(f"{path}: line {lines[row_at_fault]}: {sentence}")
    return Recorded(time_s, force_n, path.stem)


def _fault(time: NDArray[np.float64], force: NDArray[np.float64]) -> tuple[int, str] | None:
    """The first row at fault, counted from 1, and what is wrong with it."""
    if len(time) < 2:
        return len(time), f"expected two rows of numbers at least, got {len(time)}; record for longer"
    finite = np.isfinite(time) & np.isfinite(force)
    if not finite.all():
        i = int(np.argmin(finite))
        came = f"{time[i]:.15g} s and {force[i]:.15g} N"
        return i + 1, f"expected finite numbers, got {came}; leave the row out if the sample was lost"
    with np.errstate(over="ignore"):  # times from end to end of what a number can hold
        steps = np.diff(time)
    if not (steps > 0).all():
        i = int(np.argmin(steps > 0))
        what = f"time runs backwards from {time[i]:.15g} s to" if steps[i] < 0 else "time stands still at"
        return i + 2, f"{what} {time[i + 1]:.15g} s; expected rising times; sort the rows and leave one of each time"
    median = float(np.median(steps))
    gaps = steps > GAP * median * (1 + ROUNDING)
    if gaps.any():
        i = int(np.argmax(gaps))
        what = f"a gap of {steps[i]:.6g} s after {time[i]:.15g} s"
        return (
            i + 2,
            f"{what}; expected at most {GAP:g} times the median step of {median:.6g} s; cut the recording there",
        )
    return None


def _text(path: Path) -> str:
    """What is in the file; a byte order mark, which some editors write, is no part of the text."""
    try:
        data = path.read_bytes()
    except (OSError, ValueError) as error:  # a name with a zero byte is a ValueError
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({reason}); expected a CSV file such as {_EXAMPLE!r}") from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            f"{path}: line {line}: is not UTF-8 text (byte {error.start}); save the file as UTF-8"
        ) from error


def _rows(path: Path, text: str) -> Iterator[tuple[int, list[str]]]:
    """The rows that are not empty, each with the line it ends on."""
    reader = csv.reader(io.StringIO(text, newline=None), strict=True)
    try:
        yield from ((reader.line_num, row) for row in reader if row)
    except csv.Error as error:
        line = max(reader.line_num, 1)
        raise InputError(f"{path}: line {line}: is not CSV ({error}); expected rows as under {_EXAMPLE!r}") from error


def _column(header: list[str], name: str, where: str) -> tuple[int, float]:
    """Which column of the header is ``name``, and the SI value of one of its units."""
    wanted, example = _COLUMNS[name], f"{name} ({_COLUMNS[name]})"
    cells = [_HEADER.fullmatch(cell) for cell in header]
    found = [i for i, cell in enumerate(cells) if cell and cell["name"].lower() == name]
    came = show(",".join(header))
    if len(found) != 1:
        what = f"has no column {name!r}" if not found else f"has {len(found)} columns {name!r}"
        raise InputError(
            f"{where}: {what}; expected a header such as {_EXAMPLE!r}, got {came}; name one column {example!r}, parted by a comma"
        )
    cell = cells[found[0]]
    unit = (cell["round"] or cell["square"] or (cell["suffix"] or "").lower()).strip() if cell else ""
    if not unit:
        raise InputError(
            f"{where}: the column {name!r} has no unit; expected one such as {example!r}, got {came}; add it"
        )
    if not _UNIT.fullmatch(unit):
        raise InputError(f"{where}: {name}: unknown unit {show(unit)}; expected a column such as {example!r}")
    try:
        return found[0], factor(_SUFFIXES.get(unit, unit) if cell and cell["suffix"] else unit, wanted)
    except InputError as error:
        raise InputError(f"{where}: {name}: {error}; expected a column such as {example!r}") from error


def _number(text: str, where: str) -> float:
    text = text.strip()
    if _NUMBER.fullmatch(text):
        return float(text)
    if _NOT_FINITE.fullmatch(text):
        raise InputError(
            f"{where}: expected a finite number, got {show(text)}; leave the row out if the sample was lost"
        )
    raise InputError(f"{where}: expected a number such as '0.25', got {show(text)}; correct it or leave the row out")
