"""Run of a sweep on local threads or on a cluster, in chunks that are stored as they finish."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, expect
from forcefeel.sweep.chunk import measure
from forcefeel.sweep.folder import Folder
from forcefeel.sweep.plan import Sweep
from forcefeel.sweep.result import SweepResult, as_dataset
from forcefeel.threads import side_by_side, threads_or_cores

Progress = Callable[[int, int], None]
"""Called with the number of finished runs and of all."""


def run_sweep(
    sweep: Sweep,
    folder: str | Path | None = None,
    *,
    scheduler: str | None = None,
    threads: int | None = None,
    resume: bool = False,
    replace: bool = False,
    progress: Progress | None = None,
) -> SweepResult:
    """Run a sweep.

    Its numbers depend only on the sweep, not on threads, workers or interruptions.

    Args:
        sweep: The sweep.
        folder: Folder for finished chunks, and ``runs.nc`` at the end; default, none, and all runs stay in memory.
        scheduler: Address of a Dask scheduler, such as ``tcp://host:8786``.
        threads: Number of local threads; default, all cores.
        resume: Continue with the finished chunks of this sweep in ``folder``, if any.
        replace: Replace the sweep in ``folder``.
        progress: Called with the number of finished runs and of all, first with the stored ones.

    Returns:
        Every run; one that failed is a status. With a folder, values are read from it as they are used.

    Raises:
        InputError: If the folder cannot be used or holds another sweep, or the cluster fails; finished chunks stay.
        KeyboardInterrupt: On interruption; finished chunks stay in the folder.

    Example:
        >>> result = ff.run_sweep(ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), runs=32))
        >>> len(result.runs.to_dataframe())
        32
    """
    expect("sweep", sweep, Sweep, "a Sweep, which says of which loader and scenario")
    if threads is not None and scheduler is not None:
        raise InputError("threads: apply to local runs only, and a cluster has its own; leave them out")
    threads = threads_or_cores(threads)
    if folder is None and (resume or replace):
        raise InputError("resume, replace: require a folder; name it")
    store = None if folder is None else Folder(Path(folder), sweep)
    if store is not None:
        store.open(resume=resume, replace=replace)
    kept = store.kept() if store is not None else set()
    missing = [index for index in range(len(sweep.chunks)) if index not in kept]
    done = sum(len(sweep.chunks[index]) for index in kept)
    measures: dict[int, NDArray[np.float64]] = {}
    report = progress or (lambda _done, _total: None)
    report(done, sweep.total)
    with closing(_computed(sweep, missing, scheduler, threads)) as chunks:
        for index, measured in chunks:
            if store is not None:
                store.keep(index, measured)
            else:
                measures[index] = measured
            done += len(measured)
            report(done, sweep.total)
    if store is None:
        measured = np.concatenate([measures[index] for index in range(len(sweep.chunks))])
        return SweepResult(sweep, as_dataset(sweep, range(sweep.total), measured))
    if not store.finished:
        store.finish()
    return store.result()


def _computed(
    sweep: Sweep, chunks: Sequence[int], scheduler: str | None, threads: int
) -> Generator[tuple[int, NDArray[np.float64]], None, None]:
    """Index and measures of each chunk, as they are done."""
    if scheduler is not None and chunks:
        from forcefeel.sweep import cluster  # noqa: PLC0415  an optional extra

        yield from cluster.compute(sweep, chunks, scheduler)
        return
    yield from side_by_side(lambda index: (index, measure(sweep, sweep.chunks[index], threads)), chunks, threads)
