"""Summary of the runs of a sweep: status, spread of the measures, correlations."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, get_type_hints

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import ndtri

from forcefeel.simulation.outcome import KINDS, measures_of
from forcefeel.simulation.tables import NAMES
from forcefeel.sweep.result import STATUSES, SweepResult
from forcefeel.units import PERCENT, RATIO, Unit
from forcefeel.wilson import CONFIDENCE, wilson_interval

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Shares of the runs below each value of a spread."""

_NAMES = {"settling_time_s": "settling time"}
"""Names of measures with another common name."""

FEWEST = 3
"""Least number of runs for a correlation."""


@dataclass(frozen=True)
class Share:
    """Number of runs of one status.

    Attributes:
        status: The status.
        runs: Number of runs.
        share: Share of all runs.
        low, high: Between these lies the share of all machines that tolerances allow, with a confidence of 95 %: Wilson's
            interval. Of a grid, whose runs are no random sample, not a number.
    """

    status: str
    runs: int
    share: Annotated[float, PERCENT]
    low: Annotated[float, PERCENT]
    high: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Spread:
    """Spread of a measure over the runs that did not diverge.

    Attributes:
        measure: Name of the measure, in SI units as all numbers here.
        nominal: Its value for the nominal loader.
        runs: Number of runs that have it.
        lowest, highest: Extremes over these.
        quantiles: Quantiles at the shares ``QUANTILES``.
        unit: Display unit.
    """

    measure: str
    nominal: float
    runs: int
    lowest: float
    highest: float
    quantiles: tuple[float, ...]
    unit: Unit

    def quantile(self, share: float) -> float:
        """The value below which ``share``, one of ``QUANTILES``, of the runs lie."""
        return self.quantiles[QUANTILES.index(share)]


@dataclass(frozen=True, eq=False)
class Summary:
    """Summary of the runs.

    Attributes:
        shares: Share of each status, in the order of ``STATUSES``.
        spreads: Spread by measure.
        correlations: Spearman's rank correlation of each ``measure`` with each ``parameter`` that varied: +1 or -1 where the
            measure only rises or only falls with the parameter, 0 where it knows nothing of it. Not a number where the
            measure is the same for all. Over ``SweepResult.sample``.
        chance: Bound of the correlation of independent quantities in 95 of 100 sweeps.
    """

    shares: tuple[Share, ...]
    spreads: dict[str, Spread]
    correlations: xr.DataArray
    chance: float

    def share(self, status: str) -> Share:
        """The share of ``status``."""
        return next(share for share in self.shares if share.status == status)

    def ranking(self, measure: str) -> list[tuple[str, float]]:
        """The parameters with a significant correlation with ``measure``, the strongest first, with their correlation."""
        row = self.correlations.sel(measure=measure)
        influences = [(str(key), float(rho)) for key, rho in zip(row["parameter"].values, row.values, strict=True)]
        return sorted(
            (influence for influence in influences if abs(influence[1]) > self.chance),
            key=lambda influence: -abs(influence[1]),
        )


def summarize(result: SweepResult) -> Summary:
    """Summarize the runs of a sweep.

    Example:
        >>> found = ff.run_sweep(ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), runs=32))
        >>> sum(share.share for share in ff.sweep.summarize(found).shares) > 0.99
        True
    """
    sweep, drive = result.sweep, result.sweep.loader.drive
    measures = [name for name in measures_of(drive) if name != "diverged_at_s"]
    counts = {status: result.count(status) for status in STATUSES}
    random = bool(result.sweep.varied) and not result.sweep.axes
    return Summary(
        shares=tuple(share_of(status, count, result.sweep.total, random) for status, count in counts.items()),
        spreads={
            name: spread_of(name, result.finite(name), getattr(result.nominal, name), measure_unit(name, drive))
            for name in measures
        },
        correlations=rank_correlations(result.sample, measures, (*sweep.axes, *sweep.varied)),
        chance=chance_of(result.sample.sizes["run"]),
    )


def chance_of(runs: int) -> float:
    """Bound of the rank correlation of independent quantities in 95 of 100 sweeps of so many runs."""
    return float(ndtri((1 + CONFIDENCE) / 2)) / math.sqrt(max(runs - 1, 1))


@cache
def measure_unit(measure: str, drive: str) -> Unit:
    """The units of a measure of a drive; a share is shown in percent."""
    hint = get_type_hints(KINDS[drive], include_extras=True)[measure]
    unit: Unit = hint.__metadata__[0]
    return PERCENT if unit is RATIO and measure == "overshoot" else unit


def measure_name(measure: str) -> str:
    """Name of a measure."""
    return _NAMES.get(measure) or NAMES[measure].partition(" (")[0]


def share_of(status: str, count: int, total: int, random: bool) -> Share:
    """A share of the runs, with its interval if they are a random sample."""
    share = count / total
    if not random:
        return Share(status, count, share, math.nan, math.nan)
    return Share(status, count, share, *wilson_interval(count, total))


def spread_of(name: str, finite: NDArray[np.float64], nominal: float, measured_in: Unit) -> Spread:
    """Spread of a measure over its finite values."""
    if not len(finite):
        return Spread(name, nominal, 0, math.nan, math.nan, (math.nan,) * len(QUANTILES), measured_in)
    lowest, *quantiles, highest = np.quantile(finite, (0.0, *QUANTILES, 1.0), overwrite_input=True).tolist()
    return Spread(name, nominal, len(finite), lowest, highest, tuple(quantiles), measured_in)


def rank_correlations(runs: xr.Dataset, measures: Sequence[str], parameters: Sequence[str]) -> xr.DataArray:
    """Spearman's rank correlations over the runs that have the measure."""
    ranks: dict[bytes, NDArray[np.float64]] = {}
    table = np.full((len(measures), len(parameters)), np.nan)
    columns = np.array([runs[key].values for key in parameters])
    for row, name in zip(table, measures, strict=True):
        values = runs[name].values  # not a number for diverged and impossible runs
        finite = np.isfinite(values)
        if finite.sum() < FEWEST or np.ptp(values[finite]) == 0:
            continue
        same = np.packbits(finite).tobytes()
        if same not in ranks:
            ranks[same] = _standard(np.array([_ranks(column) for column in columns[:, finite]]))
        row[:] = ranks[same] @ _standard(_ranks(values[finite]))
    return xr.DataArray(table, {"measure": list(measures), "parameter": list(parameters)}, ("measure", "parameter"))


def _ranks(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rank of each value; equal ones share the mean of theirs. SciPy's takes half a second to import."""
    order = np.argsort(values)
    rises = np.append(True, np.diff(values[order]) > 0)
    bounds = np.append(np.flatnonzero(rises), len(values))
    ranks = np.empty(len(values))
    ranks[order] = (0.5 * (bounds[:-1] + bounds[1:] + 1))[np.cumsum(rises) - 1]
    return ranks


def _standard(ranks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of mean zero and length one; a row that is all the same is not a number."""
    centered = ranks - ranks.mean(axis=-1, keepdims=True)
    length = np.sqrt((centered**2).sum(axis=-1, keepdims=True))
    with np.errstate(invalid="ignore"):
        return np.asarray(centered / length)
