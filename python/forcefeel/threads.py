"""How many threads, and how many lanes of each, work on what falls into pieces."""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from forcefeel.errors import InputError

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")

LANES = 16
"""Runs that the engine's batches compute side by side on a thread; a smaller group leaves lanes empty."""

MOST_THREADS = 1024
"""Most threads that may be asked for; more than there are cores are never started."""


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads_or_cores(threads: int | None) -> int:
    """The threads that were asked for; as many as there are cores if none were.

    Raises:
        InputError: If they are none, or too many.
    """
    if threads is None:
        return cores()
    if not 1 <= threads <= MOST_THREADS:
        raise InputError(f"threads: expected 1 to {MOST_THREADS}, got {threads}; leave it out for all cores")
    return threads


def side_by_side(run: Callable[[_Item], _Result], items: Iterable[_Item], threads: int) -> Iterator[_Result]:
    """Results of ``run`` in order, of two items at a time: while the interpreter is at one, the engine's threads are at the other.

    After an interruption no further item begins.
    """
    pool = ThreadPoolExecutor(min(2, threads))
    try:
        yield from pool.map(run, items)
    finally:
        pool.shutdown(cancel_futures=True)
