"""The flight state over time, in which the loader's surface has its hinge moment."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.surface import has_surface
from forcefeel.simulation.inputs.sampled import Grid, Sampled, through_points
from forcefeel.tables.faults import fault
from forcefeel.tables.signals import Signals
from forcefeel.tables.table_file import open_table

FLIGHT_UNITS = {
    "dynamic_pressure": "Pa",
    "true_airspeed": "m/s",
    "angle_of_attack": "rad",
    "sideslip": "rad",
    "roll_rate": "rad/s",
    "pitch_rate": "rad/s",
    "yaw_rate": "rad/s",
    "load_factor": "",
    "mach": "",
    "tab": "rad",
}
"""A flight state's numbers with their SI units, in the order of ``_core.hinge_moment``."""

WITHOUT = {"load_factor": 1.0}
"""A number that is not given is zero, but for these."""

_SIGNALS = Signals(
    {"time": ("s",), **{name: (unit,) for name, unit in FLIGHT_UNITS.items()}},
    needed=("time", "dynamic_pressure", "true_airspeed"),
    example="time (s),dynamic pressure (Pa),true airspeed (m/s),angle of attack (deg)",
)


@dataclass(frozen=True, eq=False)
class Flight:
    """A flight state over time, linear between its points.

    At each step the engine takes the hinge moment of the loader's surface in these states, where the programmed control stands, as
    a live loop does (``crates/model/src/surface.rs``).

    Attributes:
        time_s: Times of the points, s, rising.
        states: Columns by the names of ``FLIGHT_UNITS``, SI units, each as long; what is not given is zero, the load factor 1.
        name: Name for messages.

    Raises:
        InputError: When built: an unknown name, columns of another length, numbers that are not finite, time that does not rise.

    Example:
        >>> states = {"dynamic_pressure": [1500.0, 2500.0], "true_airspeed": [50.0, 64.0]}
        >>> flight = ff.simulation.Flight(np.array([0.0, 2.0]), states)
        >>> surface = {"surface.area": 1.0, "surface.chord": 0.4, "surface.gearing": 1.0, "surface.per_deflection": -0.3}
        >>> loader = ff.digital_elevator().replace(surface, si=True)
        >>> flight.pairs(loader, 1.0, 1e-3)["dynamic_pressure"][0].tolist()
        [1500.0, 1500.5]
    """

    time_s: NDArray[np.float64]
    states: Mapping[str, NDArray[np.float64]] = field(repr=False)
    name: str = "Flight"

    def __post_init__(self) -> None:
        if unknown := sorted(set(self.states) - set(FLIGHT_UNITS)):
            raise InputError(f"{self.name}: expected names out of {', '.join(FLIGHT_UNITS)}, got {unknown[0]!r}")
        columns = {"time": self.time_s, **self.states}
        try:
            rows = {name: np.array(column, dtype=np.float64) for name, column in columns.items()}
        except (TypeError, ValueError) as error:
            raise InputError(f"{self.name}: expected rows of numbers ({error})") from error
        if any(row.shape != rows["time"].shape or row.ndim != 1 for row in rows.values()):
            raise InputError(f"{self.name}: expected columns of one length, got {[row.shape for row in rows.values()]}")
        if problem := fault(rows, {"time": "s", **FLIGHT_UNITS}):
            row_at_fault, sentence = problem
            raise InputError(f"{self.name}: row {row_at_fault}, counted from 1: {sentence}")
        object.__setattr__(self, "time_s", rows.pop("time"))
        object.__setattr__(self, "states", rows)

    def pairs(self, loader: Loader, time_s: float, step_s: float) -> dict[str, NDArray[np.float64]]:
        """The states at start and end of each step of a run, (steps, 2) each, by name.

        Raises:
            InputError: If the loader has no surface, or the flight does not last as long as the run.
        """
        if not has_surface(loader):
            raise InputError(
                "flight: the loader has no surface on which it could act; give surface.area, surface.chord and "
                "surface.gearing with the coefficients, or leave the flight out"
            )
        grid = Grid.of(time_s, step_s)
        first, last = float(self.time_s[0]), float(self.time_s[-1])
        if first > 0 or last < grid.end_s * (1 - 1e-9):
            raise InputError(
                f"{self.name}: expected a flight of all the run, 0 s to {grid.end_s:g} s, got {first:g} s to {last:g} s; "
                "simulate a shorter time"
            )
        still = np.zeros(grid.steps)
        columns = {
            name: through_points(name, grid, self.time_s, self.states[name])
            if name in self.states
            else Sampled(still + WITHOUT.get(name, 0.0), still + WITHOUT.get(name, 0.0))
            for name in FLIGHT_UNITS
        }
        return {name: column.pairs for name, column in columns.items()}


def read_flight(path: str | Path) -> Flight:
    r"""Reads a flight from a ``.csv``, ``.parquet`` or ``.mat`` file, by the ending of its name.

    Columns ``time``, ``dynamic pressure`` and ``true airspeed``, and of ``angle of attack``, ``sideslip``, ``roll rate``,
    ``pitch rate``, ``yaw rate``, ``load factor``, ``mach`` and ``tab`` what there is, each with its unit but for the ratios.

    Raises:
        InputError: With the file and what is wrong with it, as for ``read_recorded``.

    Example:
        >>> size = Path("flight.csv").write_text("time (s),dynamic pressure (kPa),true airspeed (kn)\n0,1.5,100\n1,2.0,115\n")
        >>> ff.simulation.read_flight("flight.csv").states["dynamic_pressure"].tolist()
        [1500.0, 2000.0]
    """
    table = open_table(path, _SIGNALS.example)
    read = dict(_SIGNALS.read(table, None, None).values)
    return Flight(read.pop("time"), read, table.path.stem)
