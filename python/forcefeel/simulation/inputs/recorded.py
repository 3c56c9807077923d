"""A force recorded on a bench or an aircraft, and its file."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.simulation.inputs.sampled import ROUNDING, Grid, Sampled, through_points
from forcefeel.tables.faults import fault
from forcefeel.tables.signals import Signals
from forcefeel.tables.table_file import open_table

_SIGNALS = Signals(
    {"time": ("s",), "force": ("N",)},
    needed=("time", "force"),
    example="time (s),force (lb)",
    also={"pilot_force": "force"},  # name in bench records
)
_UNITS = {"time": "s", "force": "N"}


@dataclass(frozen=True, eq=False)
class Recorded:
    """A recorded force, linear between its points, which may be uneven but without gaps.

    Attributes:
        time_s: Times of the points, s, each above the one before; a step of more than ``faults.GAP`` times the median is a gap.
        force_n: Forces at these times, N.
        name: Name for messages.

    Raises:
        InputError: When built, with the row: fewer than two rows, values that are not finite, time that does not increase,
            or a gap.

    Example:
        >>> time = np.linspace(0.0, 1.0, 1001)
        >>> force = ff.Recorded(time, 50.0 * np.sin(2 * np.pi * time))
        >>> ff.simulate(ff.elevator(), ff.Scenario(force, duration_s=1.0)).history.sizes["time_s"]
        1001
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
        if problem := fault({"time": self.time_s, "force": self.force_n}, _UNITS):
            row_at_fault, sentence = problem
            raise InputError(f"{self.name}: row {row_at_fault}, counted from 1: {sentence}")

    def from_zero(self) -> "Recorded":
        """The same with the first point at time zero."""
        return Recorded(self.time_s - self.time_s[0], self.force_n, self.name)

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The force over a run, N; points closer than the steps are sampled at the steps.

        Args:
            time_s: Length of the run; the recording must cover it from time zero.
            step_s: Step h.

        Raises:
            InputError: If the run is not a whole number of steps, or the recording begins after its start or ends before
                its end.
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


def read_recorded(
    path: str | Path, *, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> Recorded:
    r"""Reads a recorded force from a ``.csv``, ``.parquet`` or ``.mat`` file, by the ending of its name.

    The columns are ``time`` and ``force`` or ``pilot force``, each with its unit: ``time (s),force (lb)``, ``time [s], force [N]``
    or ``time_s,force_n``; ``lb`` is a pound of force. Others may stand beside them and are not read.

    Args:
        path: The file.
        columns: The file's own names of ``time`` and ``force``: ``{"force": "F1"}``.
        units: Units where the header has none, by these names or the file's own: ``{"F1": "lb"}``.

    Returns:
        The recording in SI units, named as the file without its ending.

    Raises:
        InputError: With the file, the line or row, what is wrong, what was expected and the remedy: a file that cannot be read or
            is no table; a column that is missing, stands twice, has no unit, an unknown one or one that measures something else;
            a row with another number of values, text that is no number, a number that is not finite; fewer than two rows; time
            that runs backwards or stands still; a gap.

    Example:
        >>> size = Path("force.csv").write_text("time (s),force (lb)\n0,0\n1,10\n2,0\n")
        >>> f"{ff.simulation.read_recorded('force.csv').force_n[1]:.2f} N"
        '44.48 N'
    """
    table = open_table(path, _SIGNALS.example)
    read = _SIGNALS.read(table, columns, units)
    return Recorded(read.values["time"], read.values["force"], table.path.stem)
