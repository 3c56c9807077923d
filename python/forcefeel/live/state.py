"""What is seen of a running loop at once."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core

STATES = tuple(_core.live_states())
"""The supervisor's states."""

COLUMNS = tuple(_core.live_columns())
"""The columns of a history and of a record, with their SI units at the end; ``law_command`` and ``command`` are in V at a valve's
amplifier, in A of a motor."""


@dataclass(frozen=True)
class State:
    """How a loop does.

    Attributes:
        cycle: Cycles worked out.
        time_s: Time since the start, by the beats of its clock.
        name: The supervisor's state, one of ``STATES``.
        trips: Names of the trips that are there or latched.
        missed: Beats that were missed, and not made up for.
        silent: Cycles without a sample.
        lost_rows: Rows that the history and the record lack, because nobody took them in time.
        recorded: Bytes of the record.
        unrecorded_rows: Rows that the record lacks because it ended before the loop, as on a full disk.
        record_ended: Why the record ended before the loop; empty if it did not.
        ended: Whether the loop has ended.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), real_time=False) as running:
        ...     running.wait(100)
        ...     running.state.missed
        0
    """

    cycle: int
    time_s: float
    name: str
    trips: tuple[str, ...]
    missed: int
    silent: int
    lost_rows: int
    recorded: int
    unrecorded_rows: int
    record_ended: str
    ended: bool


@dataclass(frozen=True)
class Trip:
    """What stopped a loader: its name, and what happened and what to do. It stays until it is acknowledged.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), "robust", real_time=False) as running:
        ...     running.on()
        ...     running.wait(4000)
        ...     running.stop()
        ...     running.wait(200)
        ...     [trip.name for trip in running.trips]
        ['emergency stop']
    """

    name: str
    sentence: str


@dataclass(frozen=True)
class HostState:
    """An aircraft simulator as it is heard.

    Attributes:
        listens: Where its packets come to, ``address:port``.
        address: Where they come from; empty before the first.
        packets: Those that were taken.
        refused: Those that were left out: damaged, old, out of range, of another version or sender.
        silent_s: Seconds since the last; ``None`` before the first.
        share: Share of its values in the feel, 0 to 1; the default feel has the rest.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), real_time=False, host=0) as running:
        ...     running.wait(100)
        ...     running.host.packets
        0
    """

    listens: str
    address: str
    packets: int
    refused: int
    silent_s: float | None
    share: float


def trips_of(bits: int) -> tuple[Trip, ...]:
    """The trips of these bits."""
    return tuple(Trip(*named) for k, named in enumerate(_core.live_trips()) if bits >> k & 1)


QUANTILE_ERROR = 1 / 64
"""By how much of itself a quantile of durations may be stated too long: the width of a step. None is stated too short."""


@dataclass(frozen=True, eq=False)
class Histogram:
    """Counts of durations.

    Attributes:
        edges_us: Least duration of each step, and the end of the last; us.
        counts: How often a duration fell in it.
        worst_us: The longest duration itself, us; zero before the first.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), real_time=False) as running:
        ...     running.wait(100)
        ...     running.timing.work.total >= 100
        True
    """

    edges_us: NDArray[np.float64]
    counts: NDArray[np.int64]
    worst_us: float

    @cached_property
    def total(self) -> int:
        """How many there are."""
        return int(self.counts.sum())

    def quantile_us(self, share: float) -> float:
        """The duration, us, that this share of them does not exceed; not a number where there are none.

        It is the upper end of a step, at most ``QUANTILE_ERROR`` of itself too long; never longer than the worst.
        """
        if not self.total:
            return float("nan")
        step = int(np.searchsorted(np.cumsum(self.counts), share * self.total))
        # What is longer than any step has been counted in the last.
        return self.worst_us if step >= len(self.counts) - 1 else min(float(self.edges_us[step + 1]), self.worst_us)


@dataclass(frozen=True, eq=False)
class Timing:
    """When the loop's thread did its work.

    Attributes:
        late: How late it woke.
        work: How long a cycle took, input and output included.
        period_s: The period.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), real_time=False) as running:
        ...     running.wait(100)
        ...     running.timing.period_s
        0.0005
    """

    late: Histogram
    work: Histogram
    period_s: float


def timing_of(edges_ns: list[int], late: tuple[list[int], int], work: tuple[list[int], int], period_s: float) -> Timing:
    """The timing of the loop's counts, each with the longest duration in ns."""
    edges = np.array(edges_ns) / 1e3
    first, second = (Histogram(edges, np.array(counts), worst_ns / 1e3) for counts, worst_ns in (late, work))
    return Timing(first, second, period_s)
