"""Reading and replay of records of live runs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.files import read_input
from forcefeel.tables.table import MOST_BYTES

_Answer = TypeVar("_Answer")


@dataclass(frozen=True, eq=False)
class LiveRecord:
    """A record of a live run.

    Attributes:
        about: Metadata: loader, law, versions.
        columns: Column names with SI units as suffix.
        rows: A row for each cycle.
        requests: First cycle of each request, name, numbers.
        broken: Where and why the file is truncated, empty for a complete file; ``rows`` contains all data before.
        ended: Why the record ended: "with the run", or earlier, as on a full disk; empty if the writing process was killed.
    """

    about: Mapping[str, str]
    columns: tuple[str, ...]
    rows: NDArray[np.float64] = field(repr=False)
    requests: tuple[tuple[int, str, list[float]], ...] = field(repr=False)
    broken: str
    ended: str

    def column(self, name: str) -> NDArray[np.float64]:
        """A column by name.

        Raises:
            InputError: If the column does not exist.
        """
        if name not in self.columns:
            raise InputError(f"column: expected one of {', '.join(self.columns)}, got {name!r}")
        return self.rows[:, self.columns.index(name)]


@dataclass(frozen=True)
class Replayed:
    """Result of a replay of a record through the controller.

    Attributes:
        cycles: Number of replayed cycles.
        difference: First difference: cycle, column, recorded and replayed value; ``None`` if every bit is the same.
        gap: First missing cycle of a gap; ``None`` without a gap.
        broken, ended: As in ``LiveRecord``.
    """

    cycles: int
    difference: tuple[int, str, float, float] | None
    gap: int | None
    broken: str
    ended: str

    @property
    def same(self) -> bool:
        """Whether there are cycles and all have the same bits."""
        return self.cycles > 0 and self.difference is None and self.gap is None


def read_live_record(path: str | Path, axis: str | None = None) -> LiveRecord:
    """Read a record; of a truncated one all data up to there.

    Args:
        path: The file.
        axis: The axis of a cockpit's record.

    Raises:
        InputError: If the file cannot be read, or has not that axis.

    Example:
        >>> with ff.live.start(ff.digital_elevator(), real_time=False, record="run.mcap") as running:
        ...     running.wait(100)
        >>> record = ff.live.read_live_record("run.mcap")
        >>> len(record.column("column_angle_rad")) >= 100
        True
    """
    about, columns, rows, requests, broken, ended = _answer_of(path, lambda data: _core.live_record(data, axis))
    return LiveRecord(about, tuple(columns), rows, tuple(requests), broken or "", ended or "")


def replay(path: str | Path, axis: str | None = None) -> Replayed:
    """Run a record's samples and requests through law, feel and supervisor again, and compare every bit of the results.

    Args:
        path: The file.
        axis: The axis of a cockpit's record.

    Raises:
        InputError: If the file cannot be read, has another version, or has not that axis.

    Example:
        >>> with ff.live.start(ff.digital_elevator(), real_time=False, record="run.mcap") as running:
        ...     running.on()
        ...     running.wait(100)
        >>> ff.live.replay("run.mcap").same
        True
    """
    cycles, difference, gap, broken, ended = _answer_of(path, lambda data: _core.live_replay(data, axis))
    return Replayed(cycles, difference, gap, broken or "", ended or "")


def _answer_of(path: str | Path, question: Callable[[bytes], _Answer]) -> _Answer:
    data = read_input(Path(path), MOST_BYTES, "a record of a live run (.mcap)")
    try:
        return question(data)
    except _core.ArgumentError as error:
        raise InputError(f"{path}: {error}; expected a record of a live run (.mcap)") from error
