"""A sweep, carried out: here on threads or on a cluster, in pieces that are kept as they finish."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, expect
from forcefeel.sweep.chunk import measure
from forcefeel.sweep.folder import Folder
from forcefeel.sweep.plan import Sweep
from forcefeel.sweep.result import SweepResult
from forcefeel.threads import threads_or_cores

Progress = Callable[[int, int], None]
"""Is told how many runs are done, of how many."""


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
    """Carries out a sweep.

    Its numbers depend on the sweep alone: not on threads, workers, or how often it was interrupted.

    Args:
        sweep: What to sweep.
        folder: Where to keep finished pieces as it goes, and ``runs.nc`` at the end. Not given, nothing is kept.
        scheduler: Address of a Dask scheduler whose workers compute, such as ``tcp://host:8786``.
        threads: How many threads compute here; all cores if not given.
        resume: Go on with the finished pieces of this very sweep in ``folder``; begin it if there are none.
        replace: Let this sweep take the place of one in ``folder``.
        progress: Is told how many runs are done, of how many, first those that were kept.

    Returns:
        Every run; one that failed is a status.

    Raises:
        InputError: If the folder cannot be used or holds another sweep, or the cluster fails; what is finished stays.
        KeyboardInterrupt: As it comes; what is finished stays in the folder.

    Example:
        >>> import forcefeel as ff
        >>> result = ff.run_sweep(ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), runs=32))
        >>> len(result.runs.to_dataframe())
        32
    """
    expect("sweep", sweep, Sweep, "a Sweep, which says of which loader and scenario")
    if threads is not None and scheduler is not None:
        raise InputError("threads: are for runs on this machine, and a cluster has its own; leave them out")
    threads = threads_or_cores(threads)
    if folder is None and (resume or replace):
        raise InputError("resume, replace: are about a folder, and there is none; name it")
    store = None if folder is None else Folder(Path(folder), sweep)
    if store is not None:
        store.open(resume=resume, replace=replace)
    measures = store.kept() if store is not None else {}
    missing = [index for index in range(len(sweep.chunks)) if index not in measures]
    done = sum(map(len, measures.values()))
    report = progress or (lambda _done, _total: None)
    report(done, sweep.total)
    with closing(_computed(sweep, missing, scheduler, threads)) as chunks:
        for index, measured in chunks:
            measures[index] = measured
            if store is not None:
                store.keep(index, measured)
            done += len(measured)
            report(done, sweep.total)
    result = SweepResult.of(sweep, np.concatenate([measures[index] for index in range(len(sweep.chunks))]))
    if store is not None and not store.finished:
        store.finish(result.runs)
    return result


def _computed(
    sweep: Sweep, chunks: Sequence[int], scheduler: str | None, threads: int | None
) -> Generator[tuple[int, NDArray[np.float64]], None, None]:
    """Index and measures of each chunk, as they are done."""
    if scheduler is not None and chunks:
        from forcefeel.sweep import cluster  # noqa: PLC0415  an optional extra

        yield from cluster.compute(sweep, chunks, scheduler)
        return
    for index in chunks:
        yield index, measure(sweep, sweep.chunks[index], threads)
