"""Result of a sweep: every run, and maps over the grid."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from forcefeel.loader.parameters import TABLE
from forcefeel.printable import table_html
from forcefeel.simulation.outcome import Measures, MotorMeasures, RunStatus, as_measures, measures_of, statuses
from forcefeel.sweep.chunk import histories, nominal
from forcefeel.sweep.members import impossible
from forcefeel.sweep.plan import Sweep

IMPOSSIBLE = "impossible"
"""Status of a run with an impossible machine: its values contradict each other."""

STATUSES = (*map(str, RunStatus), IMPOSSIBLE)
"""Possible ends of a run of a sweep."""

ENVELOPE_RUNS = 400
"""Number of runs in the band of the column's angle over time."""

BANDS = {"lowest": 0.0, "5 %": 0.05, "median": 0.5, "95 %": 0.95, "highest": 1.0}
"""The edges of the band, as shares of the runs below."""

SAMPLE_RUNS = 100_000
"""Most runs in ``SweepResult.sample``: chance moves a rank correlation over them by 0.003."""

_PIECE_RUNS = 2**20
"""Runs whose values are read from a file at a time."""

_ANGLE = "column_angle_rad"


@dataclass(frozen=True, eq=False)
class SweepResult:
    """Every run of a sweep.

    Attributes:
        sweep: The sweep.
        runs: Over ``run``: the measures, ``status`` (settled, moving, diverged or impossible), and as coordinates the varied
            values, by ``part.name``; SI units, named in ``units``.
    """

    sweep: Sweep
    runs: xr.Dataset

    def __repr__(self) -> str:
        each = ", ".join(f"{count:,} {name}" for name, count in self._counts)
        over = f" over {', '.join(self.sweep.axes)}" if self.sweep.axes else ""
        return f"<Sweep of {self.sweep.loader.name!r}{over}, {self.sweep.total:,} runs: {each}>"

    def _repr_html_(self) -> str:
        rows = ((name, f"{count:,}") for name, count in self._counts)
        return table_html(f"{self.sweep.loader.name}, {self.sweep.total:,} runs", ("ended", "runs"), rows)

    @property
    def _counts(self) -> Iterator[tuple[str, int]]:
        """Number of runs by status, without those of no run."""
        return ((status, count) for status in sorted(STATUSES) if (count := self.count(status)))

    def count(self, status: str) -> int:
        """Number of runs that ended with ``status``."""
        return int((self._status == STATUSES.index(status)).sum())

    @cached_property
    def _status(self) -> NDArray[np.int8]:
        """Place of each run's status in ``STATUSES``: ten million of them as text take a gigabyte."""
        places = np.empty(self.sweep.total, dtype=np.int8)
        for runs in self.sweep.chunks:
            text = self.runs["status"][runs.start : runs.stop].values
            for place, status in enumerate(STATUSES):
                places[runs.start : runs.stop][text == status] = place
        return places

    def finite(self, measure: str) -> NDArray[np.float64]:
        """A copy of the values of a measure that are numbers, without other copies of millions in memory."""
        values, count = np.empty(self.sweep.total), 0
        for first in range(0, self.sweep.total, _PIECE_RUNS):
            piece = self.runs[measure][first : first + _PIECE_RUNS].values
            piece = piece[np.isfinite(piece)]
            values[count : count + len(piece)] = piece
            count += len(piece)
        return values[:count]

    @cached_property
    def sample(self) -> xr.Dataset:
        """All runs, or of more than ``SAMPLE_RUNS`` as many at most, evenly spread, for what needs several values of a run."""
        return self.runs.isel(run=slice(None, None, -(-self.sweep.total // SAMPLE_RUNS)))

    @cached_property
    def nominal(self) -> Measures | MotorMeasures:
        """Measures of the nominal loader."""
        return as_measures(self.sweep.loader.drive, nominal(self.sweep).tolist())

    @cached_property
    def envelope(self) -> xr.Dataset:
        """The column's angle over time: edges of the band of the first 400 runs that did not diverge, and the nominal.

        The machines are random, so the first ones are a fair sample. With a grid they are those of its first point.
        """
        first = range(min(ENVELOPE_RUNS, self.sweep.machines))
        runs = histories(self.sweep, first, [_ANGLE])
        stayed = runs.isel(run=~np.isfinite(runs["diverged_at_s"].values))
        angle = stayed[_ANGLE].values
        edges = (
            np.quantile(angle, list(BANDS.values()), axis=0)
            if len(angle)
            else np.full((len(BANDS), angle.shape[1]), np.nan)
        )
        data = {"column_angle_rad": (("edge", "time_s"), edges, {"units": "rad"})}
        times = ("time_s", runs["time_s"].values, {"units": "s"})
        return xr.Dataset(data, {"edge": list(BANDS), "time_s": times}, {"runs": len(angle)})

    @cached_property
    def reasons(self) -> Mapping[str, int]:
        """Number of impossible machines by reason."""
        counts: Counter[str] = Counter()
        for runs in self.sweep.chunks:  # all at once may not fit in memory
            counts.update(
                {sentence: int(which.sum()) for sentence, which in impossible(self.sweep.values(runs)).items()}
            )
        return counts

    def map(self, measure: str, share: float = 0.5) -> xr.DataArray:
        """A measure over the grid.

        Args:
            measure: Name of a measure.
            share: Quantile of the machines at each point that did not diverge; default, the median.

        Returns:
            Over the parameters of the grid; not a number where every machine diverged.
        """
        return self._over_grid(self.runs[measure].values, share).assign_attrs(self.runs[measure].attrs)

    def share_map(self, status: str) -> xr.DataArray:
        """The share of the machines at each point of the grid that ended with ``status``."""
        points = (self._status == STATUSES.index(status)).reshape(*self.sweep.shape, self.sweep.machines)
        return xr.DataArray(points.mean(axis=-1), self._coordinates, tuple(self.sweep.axes))

    def _over_grid(self, values: NDArray[np.float64], share: float) -> xr.DataArray:
        points = values.reshape(*self.sweep.shape, self.sweep.machines)
        covered = np.isfinite(points).any(axis=-1)
        quantiles = np.full(self.sweep.shape, np.nan)
        quantiles[covered] = np.nanquantile(
            np.where(np.isfinite(points[covered]), points[covered], np.nan), share, axis=-1
        )
        return xr.DataArray(quantiles, self._coordinates, tuple(self.sweep.axes))

    @property
    def _coordinates(self) -> dict[str, xr.Variable]:
        return {
            key: xr.Variable(key, np.array(values), {"units": TABLE[key].unit_si})
            for key, values in self.sweep.axes.items()
        }


def as_dataset(sweep: Sweep, runs: range, measured: NDArray[np.float64]) -> xr.Dataset:
    """The dataset of some runs from their measures, a row each; contents as in ``SweepResult.runs``."""
    measures = measures_of(sweep.loader.drive).items()
    data = {name: ("run", measured[:, k], {"units": unit}) for k, (name, unit) in enumerate(measures)}
    failed = np.isnan(measured[:, -1])  # a run with a time of divergence, perhaps infinite, took place
    status = np.where(failed, IMPOSSIBLE, statuses(measured))
    coordinates = {
        key: ("run", values, {"units": TABLE[key].unit_si, "long_name": TABLE[key].meaning})
        for key, values in sweep.drawn(runs).items()
    }
    attributes = {
        "title": "forcefeel sweep",
        "loader": sweep.loader.name,
        "seed": str(sweep.seed),  # as text: it may exceed 64 bits
        "forcefeel": version("forcefeel"),
    }
    return xr.Dataset(data, coordinates, attributes).assign(status=("run", status))
