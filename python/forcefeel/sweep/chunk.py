"""Computation of a chunk of a sweep, with the same numbers on any machine."""

from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from forcefeel.simulation import simulate_batch
from forcefeel.simulation.outcome import measures_of
from forcefeel.sweep.members import impossible
from forcefeel.sweep.plan import Sweep


def measure(sweep: Sweep, runs: range, threads: int | None = None) -> NDArray[np.float64]:
    """Measures of some runs of a sweep.

    Args:
        sweep: The sweep.
        runs: Which runs.
        threads: How many threads; all cores if not given.

    Returns:
        A row for each run, in the order of ``outcome.measures_of`` the drive; not numbers for an impossible machine.
    """
    data = histories(sweep, runs, (), threads)
    measures = measures_of(sweep.loader.drive)
    measured = np.full((len(runs), len(measures)), np.nan)
    measured[data["run"].values - runs.start] = columns(data, measures)
    return measured


def nominal(sweep: Sweep) -> NDArray[np.float64]:
    """Measures of the nominal loader."""
    values = sweep.loader.si_values[np.newaxis]
    run = simulate_batch(sweep.loader, sweep.scenario, values, sweep.law_of(values), threads=1)
    return np.asarray(columns(run, measures_of(sweep.loader.drive))[0])


def histories(sweep: Sweep, runs: range, keep: Sequence[str], threads: int | None = None) -> xr.Dataset:
    """Some runs of a sweep with the histories of some outputs, as ``simulate_batch`` gives them.

    Impossible machines are omitted.
    """
    values = sweep.values(runs)
    failed = np.zeros(len(runs), dtype=bool)
    for which in impossible(values).values():
        failed |= which
    # Other machines run in their place, so that the noise of each run stays the same.
    values[failed] = sweep.loader.si_values
    law = sweep.law_of(values)
    data = simulate_batch(sweep.loader, sweep.scenario, values, law, keep=keep, first_run=runs.start, threads=threads)
    return data.isel(run=~failed)


def columns(data: xr.Dataset, measures: Iterable[str]) -> NDArray[np.float64]:
    """These measures as rows."""
    return np.column_stack([data[name].values for name in measures])
