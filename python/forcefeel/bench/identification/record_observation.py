"""Time records against the nonlinear model.

The residual of a sample is measured less simulated over the channel's expected deviation. A constant for each channel, the sensor's
offset, is removed as the mean; so is a linear drift of an open piston, and a quadratic drift of an open motor. A release has one
unknown of its own: the delay of the release after its detected time.

Friction by direction is a symmetric friction and a constant force, ``F (sgn v + a_F) = F sgn v + a_F F``, which looks like an
offset of the load cell. Where ``a_F`` is fitted, the load cell's constant is kept: its offset counts as friction, for which a law
for that loader corrects as well.

Of a record of the whole loader the start is simulated and not compared. At rest friction holds the column anywhere within it, and
the noise of the sensors decides when it breaks away. Until the motion has forgotten that, two runs of one machine differ by more
than their size.
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
"""Initial noise, as a share of the channel's r.m.s.; the fit estimates it."""

_COARSE_S = 8.0
"""Length of the beginning of a record in a coarse search, s."""

_START_S, _START_SHARE = 4.0, 0.25
"""Time that a column under its law takes to forget where friction held it, s, and the most of a record that is left out for it."""

_ASYMMETRY, _LOAD_CELL = "column.friction_asymmetry", "load_cell_force"

_LATER_S = 1e-3
"""Scale of the delay of a release after its detected time."""

_DRIFTS = {Loop.SERVO_OPEN: 1, Loop.MOTOR_OPEN: 2}
"""Power of time of the drift of an open loop: a valve's null offset gives a flow, a current's offset a force."""

_MOST_CLUSTERS, _FEWEST_CLUSTERS, _CLUSTER_S = 40, 8, 0.5
"""Number of pieces of a record with independent errors, and their least length."""


@dataclass(frozen=True, eq=False)
class RecordObservation:
    """A record and the runs for its comparison.

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
        samples = len(self._time_s)
        return tuple(slice(k * samples, (k + 1) * samples) for k in range(len(self.run.channels)))

    @cached_property
    def clusters(self) -> NDArray[np.int64]:
        """Pieces of time, the same in all channels."""
        time_s = self._time_s
        duration_s = float(time_s[-1] - time_s[0])
        pieces = int(np.clip(duration_s / _CLUSTER_S, _FEWEST_CLUSTERS, _MOST_CLUSTERS))
        piece = np.minimum((time_s - time_s[0]) / duration_s * pieces, pieces - 1).astype(np.int64)
        return np.tile(piece, len(self.run.channels))

    @property
    def own(self) -> NDArray[np.float64]:
        """Delay of the release after its detected time, ms."""
        return np.zeros(1) if self.run.released else np.empty(0)

    def compare(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Compared:
        """Channel by channel."""
        modeled = self._modeled(values, own, self.keys)
        slopes = [*modeled.slopes, -_LATER_S * modeled.rate] if self.run.released else list(modeled.slopes)
        weight = 1 / self._expected[:, np.newaxis]
        residual = self._without_offset(self._measured - modeled.value) * weight
        by = [-self._without_offset(slope) * weight for slope in slopes]
        return Compared(residual.ravel(), np.array([slope.ravel() for slope in by]).T)

    def residual(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
        """Channel by channel, from one run."""
        modeled = self._modeled(values, own, ())
        return self._residual(modeled.value)

    def residuals(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Sequence[NDArray[np.float64]]:
        """The same for several loaders, in parallel if the record's samples are the engine's."""
        if not self.run.on_samples:
            return [self.residual(*pair) for pair in zip(values, own, strict=True)]
        runs = self.run.together(self.run.loader.rows(self.keys, values))
        return [self._residual(value) for value in runs[..., self._first :]]

    def curves(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> tuple[Curve, ...]:
        """The measured and simulated channels, offsets included."""
        modeled = self._modeled(values, own, ()).value
        offset = (self._measured - modeled) - self._without_offset(self._measured - modeled)
        at = self.data.time_s[self.run.used][self._first :]
        rows = zip(self.run.channels, self._measured, modeled + offset, self._expected, strict=True)
        return tuple(Curve(name, at, measured, modeled, float(e)) for name, measured, modeled, e in rows)

    def simulated_noise(self, values: NDArray[np.float64]) -> Sequence[float]:
        """Channel by channel, from a run with the noise of the controller's sensors and finer steps."""
        row = self.run.loader.rows(self.keys, values[np.newaxis])[0]
        difference = self._without_offset(self.run.noise_and_step_error(row)[:, self._first :])
        return tuple(float(rms) for rms in np.sqrt(np.mean(difference**2, axis=1)))

    def coarse(self) -> "RecordObservation":
        """The beginning of a long record in longer steps; a release is kept whole."""
        record = self.data
        early = record.time_s - record.time_s[0] <= _COARSE_S + self.run.time_s[self._first]
        if not (self.run.released or early.all()):
            channels = {name: values[early] for name, values in record.channels.items()}
            record = replace(record, time_s=record.time_s[early], channels=channels)
        return replace(self, run=replace(self.run, record=record, longest_step_s=COARSE_STEP_S))

    def _residual(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        """Residual of a run."""
        return np.ravel(self._without_offset(self._measured - value) / self._expected[:, np.newaxis])

    @cached_property
    def _first(self) -> int:
        """The first compared sample of the run."""
        if self.run.released or self.data.experiment.loop is not Loop.LOADER:
            return 0
        time_s = self.run.time_s
        return int(np.searchsorted(time_s, min(_START_S, _START_SHARE * time_s[-1])))

    @cached_property
    def _time_s(self) -> NDArray[np.float64]:
        """Times of the compared samples from the start of the run."""
        return self.run.time_s[self._first :]

    @cached_property
    def _measured(self) -> NDArray[np.float64]:
        return np.array([self.data.channels[name][self.run.used][self._first :] for name in self.run.channels])

    @cached_property
    def _expected(self) -> NDArray[np.float64]:
        return np.asarray(_EXPECTED * np.std(self._measured, axis=1))

    @cached_property
    def _offsets(self) -> NDArray[np.float64]:
        """Orthonormal columns of the removed offset and drift, (samples, columns)."""
        if self.run.released:
            return np.empty((len(self._time_s), 0))
        degree = _DRIFTS.get(self.data.experiment.loop, 0)
        return np.linalg.qr(np.vander(self._time_s - self._time_s.mean(), degree + 1))[0]

    @cached_property
    def _with_offset(self) -> NDArray[np.bool_]:
        """Channels with an offset of their own, (channels, 1)."""
        kept = _ASYMMETRY in self.keys and self.data.experiment.loop not in _DRIFTS
        return np.array([[not (kept and name == _LOAD_CELL)] for name in self.run.channels])

    def _without_offset(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(invalid="ignore"):  # a run that diverged is infinite, and no number without its offset
            return np.asarray(rows - np.where(self._with_offset, (rows @ self._offsets) @ self._offsets.T, 0.0))

    def _modeled(self, values: NDArray[np.float64], own: NDArray[np.float64], keys: Sequence[str]) -> Histories:
        row = self.run.loader.rows(self.keys, values[np.newaxis])[0]
        histories = self.run.at(row, keys, _LATER_S * float(own[0]) if self.run.released else 0.0)
        return Histories(*(part[..., self._first :] for part in (histories.value, histories.slopes, histories.rate)))
