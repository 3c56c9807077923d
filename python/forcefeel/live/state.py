"""Snapshot of a running loop."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core

STATES = tuple(_core.live_states())
"""States of the supervisor."""

COLUMNS = tuple(_core.live_columns())
"""Columns of a history and of a record, with SI units as suffix; ``law_command`` and ``command`` are in V at a valve's amplifier,
in A of a motor."""


@dataclass(frozen=True)
class State:
    """State of a loop.

    Attributes:
        cycle: Number of completed cycles.
        time_s: Time since the start by its clock, s.
        name: State of the supervisor, one of ``STATES``.
        trips: Names of active and latched trips.
        missed: Number of missed periods, which are not repeated.
        silent: Number of cycles without a sample.
        lost_rows: Rows missing in history and record because of a full ring.
        recorded: Bytes of the record, of a ring those of both parts.
        unrecorded_rows: Rows missing because the record ended before the loop, as on a full disk.
        record_ended: Why the record ended before the loop; empty if it did not.
        ended: Whether the loop has ended.
        drive_fault: Last fault of the drive, its bus or its samples, and its remedy; empty once trips are cleared and the drive is
            well.

    Example:
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
    drive_fault: str = ""


@dataclass(frozen=True)
class Trip:
    """Reason of a stop: name, and a sentence with cause and remedy. It stays until acknowledged.

    Example:
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
    """State of the aircraft simulator.

    Attributes:
        listens: Local address for its packets, ``address:port``.
        address: Its own address; empty before the first packet.
        packets: Number of accepted packets.
        refused: Number of rejected packets: damaged, old, out of range, of another version or sender.
        silent_s: Time since the last packet, s; ``None`` before its first.
        share: Share of its values in the feel, 0 to 1; the rest is the default feel.
        waiting: Address of another sender since it is silent, which takes over with ``session.accept_host()``; empty without one.
        softened: Number of accepted packets whose spring or damping was softened to what the loader renders.

    Example:
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
    waiting: str = ""
    softened: int = 0


def trips_of(bits: int) -> tuple[Trip, ...]:
    """Trips from a bit mask."""
    return tuple(Trip(*named) for k, named in enumerate(_core.live_trips()) if bits >> k & 1)


QUANTILE_ERROR = 1 / 64
"""Largest relative error of a quantile, the width of a bin; a quantile is never too short."""


@dataclass(frozen=True, eq=False)
class Histogram:
    """Counts of durations.

    Attributes:
        edges_us: Edges of the bins, us.
        counts: Count of each bin.
        worst_us: Longest duration, us; zero before the first.

    Example:
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
        """Total count."""
        return int(self.counts.sum())

    def quantile_us(self, share: float) -> float:
        """Quantile of the durations, us; NaN without any.

        It is the upper edge of a bin, too long by at most a share of ``QUANTILE_ERROR``, and at most the longest duration.
        """
        if not self.total:
            return float("nan")
        step = int(np.searchsorted(np.cumsum(self.counts), share * self.total))
        # The last bin also counts all longer durations.
        return self.worst_us if step >= len(self.counts) - 1 else min(float(self.edges_us[step + 1]), self.worst_us)


@dataclass(frozen=True, eq=False)
class Timing:
    """Timing of the loop's thread.

    Attributes:
        late: Wake-up latency.
        work: Working time of a cycle, including input and output.
        period_s: Period of the loop, s.

    Example:
        >>> with ff.live.start(ff.digital_elevator(), real_time=False) as running:
        ...     running.wait(100)
        ...     running.timing.period_s
        0.0005
    """

    late: Histogram
    work: Histogram
    period_s: float


def timing_of(edges_ns: list[int], late: tuple[list[int], int], work: tuple[list[int], int], period_s: float) -> Timing:
    """Timing from the loop's counts, each with the longest duration in ns."""
    edges = np.array(edges_ns) / 1e3
    first, second = (Histogram(edges, np.array(counts), worst_ns / 1e3) for counts, worst_ns in (late, work))
    return Timing(first, second, period_s)
