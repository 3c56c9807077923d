"""Frames at 60 Hz: extremes of each column since the last frame, and its last value.

A frame is little-endian: ``float64`` time of its last row in s, ``uint32`` rows in it, ``uint32`` a number that counts frames,
then ``float32`` first extreme, second extreme and last value of each column, in the units of the page.
"""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from forcefeel.live.live_session import LiveSession
from forcefeel.loader.links import Link, LinkKind
from forcefeel.loader.loader import Loader
from forcefeel.units import ANGLE, FORCE, MOTOR_CURRENT, VOLTAGE, Unit, UnitSystem

HEADER = struct.Struct("<dII")
RATE_HZ = 60.0

FOUND_OVER_S = 0.1
"""Averaging time of the estimated hand torque. Its noise at the grip of the elevator at rest is 0.85 lb r.m.s., averaged 0.007 lb.
The record contains each sample."""

_MOST_ROWS = 2000
"""Largest number of rows in a frame; a blocked server continues with the newest."""


@dataclass(frozen=True)
class Channel:
    """A displayed column.

    Attributes:
        column: Name in the history.
        label: Displayed name.
        unit: Unit.
        by: Factor on the column: an estimated torque is displayed as a force at the grip.
        over_s: Averaging time, s; zero for samples.
    """

    column: str
    label: str
    unit: Unit
    by: float = 1.0
    over_s: float = 0.0


def channels(running: LiveSession, loader: Loader, link: Link | None = None) -> tuple[Channel, ...]:
    """Displayed columns that the loop has; of an electronic link its force too."""
    electric, arm = loader.drive == "electric", 1 / loader["column.grip_arm"]
    electronic = link is not None and link.kind is LinkKind.ELECTRONIC
    command_unit = MOTOR_CURRENT if electric else VOLTAGE
    known = (
        Channel("column_angle_rad", "column", ANGLE),
        Channel("feel_angle_rad", "programmed", ANGLE),
        Channel("neutral_rad", "trim", ANGLE),
        Channel("pilot_force_n", "hand", FORCE),
        Channel("feel_torque_n_m", f"estimate of the law, mean of {FOUND_OVER_S:g} s", FORCE, arm, FOUND_OVER_S),
        *([Channel("link_torque_n_m", "link", FORCE, arm)] if electronic else []),
        Channel("law_command", "requested", command_unit),
        Channel("command", "sent", command_unit),
    )
    return tuple(channel for channel in known if channel.column in running.columns)


class Telemetry:
    """Frames of a running loop.

    Args:
        running: The loop.
        displayed: Displayed channels.
        system: Displayed units.
    """

    def __init__(self, running: LiveSession, displayed: Sequence[Channel], system: UnitSystem) -> None:
        column_of: Mapping[str, int] = {name: k for k, name in enumerate(running.columns)}
        self._running = running
        self._taken = [column_of[channel.column] for channel in displayed]
        self._scale = np.array([channel.by * channel.unit.from_si(1.0, system) for channel in displayed])
        self._time, self._cycle = column_of["time_s"], column_of["cycle"]
        self._means = {
            k: Mean(round(channel.over_s / running.period_s))
            for k, channel in enumerate(displayed)
            if channel.over_s > running.period_s
        }
        self._seen, self._number = -1, 0

    def frame(self) -> bytes | None:
        """Frame of the rows since the last frame; ``None`` without new rows."""
        # The first frame begins with the newest row: the history lags behind the loop, so there may be no row of the current cycle.
        rows = self._running.history(self._seen, 1 if self._seen < 0 else _MOST_ROWS)
        if not len(rows):
            return None
        self._seen, self._number = int(rows[-1, self._cycle]), self._number + 1
        header = HEADER.pack(rows[-1, self._time], len(rows), self._number & 0xFFFFFFFF)
        values = rows[:, self._taken] * self._scale
        for k, mean in self._means.items():
            values[:, k] = mean.of(values[:, k])
        return header + packed(values)


class Mean:
    """Moving average of a signal.

    Args:
        samples: Number of samples, at least two.
    """

    def __init__(self, samples: int) -> None:
        self._samples = samples
        self._before: NDArray[np.float64] | None = None

    def of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Averages at further samples; the first sample also stands for those before it."""
        before = np.full(self._samples - 1, values[0]) if self._before is None else self._before
        joined = np.concatenate([before, values])
        self._before = joined[1 - self._samples :]
        return np.asarray(sliding_window_view(joined, self._samples).mean(axis=1), dtype=np.float64)


def packed(values: NDArray[np.float64]) -> bytes:
    """First extreme, second extreme and last value of each column (rows, columns)."""
    each = np.arange(values.shape[1])
    clean = np.where(np.isfinite(values), values, -np.inf)
    highest = np.argmax(clean, axis=0)
    lowest = np.argmin(np.where(np.isfinite(values), values, np.inf), axis=0)
    first, second = np.minimum(lowest, highest), np.maximum(lowest, highest)
    taken = np.stack([values[first, each], values[second, each], values[-1]], axis=1)
    return taken.astype("<f4").tobytes()
