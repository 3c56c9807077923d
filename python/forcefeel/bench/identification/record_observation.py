"""Records in time against the nonlinear model.

The residual of a sample is measured less simulated over the channel's expected deviation. A constant for each channel, the sensor's
offset, is fitted by leaving means out; so is a straight drift where no loop holds the piston, and one that grows with the square of
time where none holds the motor. A release has one unknown of its own: how much later than it seems the grip was let go.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.experiments import Loop
from forcefeel.bench.identification.observations import Compared, Curve
from forcefeel.bench.identification.record_run import COARSE_STEP_S, Histories, RecordRun
from forcefeel.bench.records import BenchRecord

_EXPECTED = 0.01
"""Of the channel's r.m.s.: its noise as a first guess; the fit finds how large it is."""

_COARSE_S = 8.0
"""A search from afar looks at so much of the beginning of a record."""

_LATER_S = 1e-3
"""Scale of the time by which a grip is let go later than it seems."""

_DRIFTS = {Loop.SERVO_OPEN: 1, Loop.MOTOR_OPEN: 2}
"""Power of time with which an open loop's rest drifts: a valve's null lets oil through, a current's offset pushes a mass."""

_MOST_CLUSTERS, _FEWEST_CLUSTERS, _CLUSTER_S = 40, 8, 0.5
"""Pieces of a record whose errors are taken as independent of each other, and how long they should last at least."""


@dataclass(frozen=True, eq=False)
class RecordObservation:
    """A record, and the runs that it is compared with.

    Attributes:
        run: The runs.
        keys: The unknowns.
    """

    run: RecordRun
    keys: Sequence[str]

    @property
    def data(self) -> BenchRecord:
        """The record."""
        return self.run.record

    @property
    def groups(self) -> tuple[slice, ...]:
        """The samples of each channel."""
        samples = len(self.run.time_s)
        return tuple(slice(k * samples, (k + 1) * samples) for k in range(len(self.run.channels)))

    @cached_property
    def clusters(self) -> NDArray[np.int64]:
        """Pieces of time, the same in all channels."""
        time_s = self.run.time_s
        lasts = float(time_s[-1] - time_s[0])
        pieces = int(np.clip(lasts / _CLUSTER_S, _FEWEST_CLUSTERS, _MOST_CLUSTERS))
        piece = np.minimum((time_s - time_s[0]) / lasts * pieces, pieces - 1).astype(np.int64)
        return np.tile(piece, len(self.run.channels))

    @property
    def own(self) -> NDArray[np.float64]:
        """When the grip was let go, in ms later than it seems."""
        return np.zeros(1) if self.run.released else np.empty(0)

    def compare(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Compared:
        """Channel by channel."""
        found = self._modelled(values, own, self.keys)
        slopes = [*found.slopes, -_LATER_S * found.rate] if self.run.released else list(found.slopes)
        weight = 1 / self._expected[:, np.newaxis]
        residual = self._without_offset(self._measured - found.value) * weight
        by = [-self._without_offset(slope) * weight for slope in slopes]
        return Compared(residual.ravel(), np.array([slope.ravel() for slope in by]).T)

    def residual(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
        """Channel by channel, from one run."""
        found = self._modelled(values, own, ())
        return self._left(found.value)

    def residuals(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Sequence[NDArray[np.float64]]:
        """The same for several loaders, whose runs stand side by side where the record's samples are the engine's."""
        if not self.run.on_samples:
            return [self.residual(*pair) for pair in zip(values, own, strict=True)]
        return [self._left(value) for value in self.run.together(self.run.loader.rows(self.keys, values))]

    def curves(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> tuple[Curve, ...]:
        """The channels beside the simulated ones, offsets included."""
        found = self._modelled(values, own, ()).value
        offset = (self._measured - found) - self._without_offset(self._measured - found)
        at = self.data.time_s[self.run.used]
        rows = zip(self.run.channels, self._measured, found + offset, self._expected, strict=True)
        return tuple(Curve(name, at, measured, modelled, float(e)) for name, measured, modelled, e in rows)

    def simulated_noise(self, values: NDArray[np.float64]) -> Sequence[float]:
        """Channel by channel, from a run with the noise of the controller's sensors and finer steps."""
        row = self.run.loader.rows(self.keys, values[np.newaxis])[0]
        difference = self._without_offset(self.run.noise_and_step_error(row))
        return tuple(float(rms) for rms in np.sqrt(np.mean(difference**2, axis=1)))

    def coarse(self) -> "RecordObservation":
        """The beginning of a long record in longer steps; a release is looked at whole."""
        record = self.data
        early = record.time_s - record.time_s[0] <= _COARSE_S
        if not (self.run.released or early.all()):
            channels = {name: values[early] for name, values in record.channels.items()}
            record = replace(record, time_s=record.time_s[early], channels=channels)
        return replace(self, run=replace(self.run, record=record, longest_step_s=COARSE_STEP_S))

    def _left(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        """What a run leaves of the record."""
        return np.ravel(self._without_offset(self._measured - value) / self._expected[:, np.newaxis])

    @cached_property
    def _measured(self) -> NDArray[np.float64]:
        return np.array([self.data.channels[name][self.run.used] for name in self.run.channels])

    @cached_property
    def _expected(self) -> NDArray[np.float64]:
        return np.asarray(_EXPECTED * np.std(self._measured, axis=1))

    @cached_property
    def _offsets(self) -> NDArray[np.float64]:
        """What is fitted of each channel by leaving it out, as orthonormal columns, (samples, columns)."""
        if self.run.released:
            return np.empty((len(self.run.time_s), 0))
        degree = _DRIFTS.get(self.data.experiment.loop, 0)
        return np.linalg.qr(np.vander(self.run.time_s - self.run.time_s.mean(), degree + 1))[0]

    def _without_offset(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(invalid="ignore"):  # a run that diverged is infinite, and no number without its offset
            return np.asarray(rows - (rows @ self._offsets) @ self._offsets.T)

    def _modelled(self, values: NDArray[np.float64], own: NDArray[np.float64], keys: Sequence[str]) -> Histories:
        row = self.run.loader.rows(self.keys, values[np.newaxis])[0]
        return self.run.at(row, keys, _LATER_S * float(own[0]) if self.run.released else 0.0)
