"""The result: a loader with the fitted feel, its rows with their intervals, and the feel along the points."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from forcefeel.feel.directions import Directions
from forcefeel.feel.plan import FeelPlan
from forcefeel.feel.shape import Shape
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ALTERNATIVES, TABLE, unit
from forcefeel.qualification import ForcePoints, Record
from forcefeel.units import Json, UnitSystem, quantity

_Array = NDArray[np.float64]


class Source(StrEnum):
    """Where the value of a row comes from."""

    POINTS = "points"
    RELEASE = "release"
    STATED = "stated"
    LOADER = "loader"
    """Kept from the loader, because the data leave it open."""
    ASSUMED = "assumed"


@dataclass(frozen=True)
class FittedRow:
    """A row of the feel.

    Attributes:
        key: The row, ``feel.name``.
        value_si: Its value.
        half_interval_si: Half the interval that holds the true value with 95 %; ``None`` for a value that was not fitted.
        source: Where it comes from.
    """

    key: str
    value_si: float
    half_interval_si: float | None
    source: Source

    def as_json(self, system: UnitSystem) -> dict[str, Json]:
        """Value and interval with their unit."""
        measured_in = unit((TABLE | ALTERNATIVES)[self.key])
        half = self.half_interval_si
        return {
            "value": quantity(self.value_si, measured_in, system),
            "half_interval": None if half is None else quantity(half, measured_in, system),
            "source": str(self.source),
        }


@dataclass(frozen=True, eq=False)
class ReleaseFit:
    """Frequency and damping from a recorded release.

    Attributes:
        record: The record.
        frequency_rad_per_s, damping_ratio: Natural frequency and damping ratio, with halves of their intervals; ``None`` where
            the value was stated.
        offset_rad: Position of the record at the neutral of the feel.
        time_s, angle_rad: The programmed feel's release, in the record's time and positions.
        scatter_rad: Standard deviation of the record about it.
    """

    record: Record
    frequency_rad_per_s: tuple[float, float | None]
    damping_ratio: tuple[float, float | None]
    offset_rad: float
    time_s: _Array = field(repr=False)
    angle_rad: _Array = field(repr=False)
    scatter_rad: float


@dataclass(frozen=True, eq=False)
class FeelFit:
    """A feel fitted to measurements.

    Attributes:
        plan: The request.
        loader: The loader with the fitted feel.
        points: The points, positions as angles of the column; of a record, means.
        directions: How the directions of the points are known.
        shape: The chosen shape.
        rows: The rows of the feel with their intervals.
        curve_half_intervals_n: Half the interval of each point of the force curve; empty without one.
        residual_n: Measured force minus that of the feel (points,).
        angle_rad, up_n, down_n: The feel's force while the position rises and falls, over the travel of the points.
        inseparable: Pairs of rows that the points hardly tell apart.
        release: The fit of the release; ``None`` without one.
        replaced: Rows of the loader's former feel that were given and are off now.
    """

    plan: FeelPlan
    loader: Loader
    points: ForcePoints
    directions: Directions
    shape: Shape
    rows: tuple[FittedRow, ...]
    curve_half_intervals_n: tuple[float, ...]
    residual_n: _Array = field(repr=False)
    angle_rad: _Array = field(repr=False)
    up_n: _Array = field(repr=False)
    down_n: _Array = field(repr=False)
    inseparable: tuple[tuple[str, str], ...]
    release: ReleaseFit | None
    replaced: tuple[str, ...]

    @property
    def scatter_n(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residual_n**2)))

    def row(self, key: str) -> FittedRow | None:
        """A row by its key; ``None`` if it is off."""
        return next((row for row in self.rows if row.key == key), None)
