"""How many threads work on what falls into pieces."""

import os

from forcefeel.errors import InputError

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
