"""Identification of the force sensor at the grip, after that of the loader.

``F_g`` its reading · ``F_p`` force of the hand · ``K_g`` gain · ``m_o`` mass outboard of it · ``F_0`` offset

    F_g = K_g F_p - K_g m_o R_p theta'' + F_0

With hands off it shows only the inertial force of the outboard mass. The motion is simulated: the identified loader under the
recorded drive, because no encoder measures acceleration. The model (``crates/model/src/grip_sensor.rs``) gives the readings for a
hand alone and for a mass of 1 kg. The record then determines ``K_g m_o`` and ``F_0`` by least squares, and ``K_g`` under a measured
force of the hand. Standard errors are by jackknife over pieces of the record, because the residual is not white.

A share ``c`` of the link's force in the reading, cross-talk, is identified with them. The column obeys
``alpha R_b F / R_p = J theta'' / R_p - F_p``, dry friction aside, so the sensor reads as one with ``K_g - c`` and
``K_g m_o - c J / R_p^2``, whatever moves or holds the column. A law for these rows needs no row for ``c``; what is left is ``c``
times the friction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from forcefeel import _core
from forcefeel.bench.channels import GRIP_FORCE
from forcefeel.bench.clipping import clipped
from forcefeel.bench.experiments import Drive
from forcefeel.bench.identification.misfit import UNEXPLAINED, runs_on_and_jumps
from forcefeel.bench.identification.record_run import RecordRun
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.bench.stated import drive_channel
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE, limits_si, value_text
from forcefeel.loader.sensors import (
    GRIP_SENSOR,
    has_grip_sensor,
    sample_variance,
    sensors_of,
    without_grip_sensor,
)

GAIN, MASS, OFFSET = (f"{GRIP_SENSOR}.{name}" for name in ("gain", "mass", "offset"))

_PIECES = 20
"""Number of pieces of a record for the jackknife."""

_SURE = 2.0
"""Standard errors within which a number counts as zero."""

_CLEAR = 6.0
"""Least size of the file's value, in standard errors, for a contradiction."""

_LEAST_MASS = 0.02
"""Least mass of a grip, kg."""

_FAR = {GAIN: 1.5, MASS: 4.0}
"""Largest factor from the file's value: a gain is calibrated, an outboard mass guessed; pounds read as newtons give 4.4."""

_NOISIER = 2.0
"""Largest factor of the noise over the declared noise."""

_NOISE_WIDTH = 6.0
"""Standard deviations from the lowest to the highest value of noise, at least."""


@dataclass(frozen=True)
class GripSensorEstimate:
    """Result of the identification of the sensor.

    Attributes:
        rows: Value and standard error of each row that the record determines, SI units.
        noise: Residual of its record, r.m.s., N; ``None`` without a record.
        wrong: Reasons why no law may use it.
        notes: Further remarks.
        advice: Experiments that would determine the rest.
    """

    rows: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    noise: float | None = None
    wrong: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()


def find_grip_sensor(loader: Loader, data: Sequence[Response | BenchRecord], law: Law | None) -> GripSensorEstimate:
    """Identify the sensor of an identified loader, with the sensor's rows of its file, from records.

    ``law`` is that of the bench for records of the whole loader, without the sensor, which is not yet identified.
    """
    records = [record for record in data if isinstance(record, BenchRecord) and GRIP_FORCE in record.channels]
    if not has_grip_sensor(loader):
        moving = any(np.ptp(record.channels[GRIP_FORCE]) > 0 for record in records)
        sentence = (
            f"The records hold {GRIP_FORCE}, but the loader file has no grip_sensor: the channel is ignored. State "
            "grip_sensor.gain, 1 if calibrated, for a law that uses the sensor."
        )
        return GripSensorEstimate(notes=(sentence,) * moving)
    used = [record for record in records if record.experiment.drive is not Drive.RELEASE]
    if not used:
        sentence = (
            f"No record{' but a release' * bool(records)} holds {GRIP_FORCE}: the rows of grip_sensor keep the file's values "
            "and were not tested."
        )
        return GripSensorEstimate(notes=(sentence,), advice=(_RECORD_IT,))
    best = max(used, key=lambda record: record.experiment.drive is Drive.PILOT_FORCE)
    return _SensorRecord.of(best, loader, law).estimate()


_RECORD_IT = (
    f"Record {GRIP_FORCE} beside the other channels; and once under a measured pull at the grip, a weight or a spring balance, "
    "recorded as pilot_force (experiment: loader pilot_force)."
)


def moments(record: BenchRecord, loader: Loader, law: Law | None) -> NDArray[np.float64]:
    """``F_p, theta, theta', theta''`` of a loader under the drive of a record, at its times, (samples, 4)."""
    drive = drive_channel(record.experiment)
    driven = {} if drive is None else {drive: record.channels[drive]}
    blank = dict.fromkeys(("column_angle", "column_velocity"), np.zeros_like(record.time_s))
    run = RecordRun(replace(record, channels={**driven, **blank}), without_grip_sensor(loader), law)
    angle, rate = run.at(loader.si_values, ()).value
    hand = driven.get(Drive.PILOT_FORCE, np.zeros_like(angle))
    return np.column_stack([hand, angle, rate, CubicSpline(run.time_s, rate)(run.time_s, 1)])


def grip_force(loader: Loader, moments_at: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the sensor of a loader shows at ``moments``, offset left out, N."""
    return np.asarray(_core.grip_force(loader.si_values, np.ascontiguousarray(moments_at)))


@dataclass(frozen=True, eq=False)
class _SensorRecord:
    """A record of the sensor with the predicted readings for a hand and for a mass of 1 kg."""

    loader: Loader
    name: str
    measured: NDArray[np.float64]
    promised: NDArray[np.float64]
    of_hand: NDArray[np.float64]
    of_mass: NDArray[np.float64]

    @classmethod
    def of(cls, record: BenchRecord, loader: Loader, law: Law | None) -> "_SensorRecord":
        at = moments(record, loader, law)
        hand, loaded = (grip_force(loader.replace({GAIN: 1.0, MASS: mass}, si=True), at) for mass in (None, 1.0))
        return cls(loader, record.name, record.channels[GRIP_FORCE], grip_force(loader, at), hand, loaded - hand)

    @property
    def declared(self) -> float:
        """Declared noise of a sample, resolution included, r.m.s., N."""
        return float(np.sqrt(sample_variance(self.loader)[sensors_of(self.loader).index(GRIP_SENSOR)]))

    def estimate(self) -> GripSensorEstimate:
        """The sensor estimated from this record."""
        if sentence := self._stopped():
            return GripSensorEstimate(wrong=(sentence,))
        by_hand = [GAIN] if np.ptp(self.of_hand) > 0 else []
        columns = np.column_stack([*(self.of_hand for _ in by_hand), self.of_mass, np.ones_like(self.of_mass)])
        value, deviation = _jackknife(columns, self.measured)
        residual = self.measured - columns @ value
        residual_rms = float(np.std(residual))
        numbers = dict(zip((*by_hand, MASS, OFFSET), zip(value.tolist(), deviation.tolist(), strict=True), strict=True))
        tried = [self._contradicts(key, *numbers[key]) for key in (*by_hand, MASS)]
        rows = self._rows(numbers)
        sentences = [sentence for sentence in (*tried, self._out_of_range(rows)) if sentence]
        if wrong := tuple(sentences or self._unexplained(residual)):
            return GripSensorEstimate(noise=residual_rms, wrong=wrong)
        return GripSensorEstimate(
            rows, residual_rms, (), self._notes(residual_rms, rows), () if GAIN in rows else (_PULL,)
        )

    def _rows(self, numbers: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
        """The rows that are determined, of ``K_g``, ``K_g m_o`` and ``F_0``."""
        determined = {key: numbers[key] for key in (GAIN, MASS) if key in numbers and _is_determined(*numbers[key])}
        if MASS in determined:
            gain = determined[GAIN][0] if GAIN in determined else self.loader[GAIN]
            determined[MASS] = (determined[MASS][0] / gain, determined[MASS][1] / gain)
        value, deviation = numbers[OFFSET]
        return determined | ({OFFSET: (value, deviation)} if abs(value) > _SURE * deviation else {})

    def _out_of_range(self, rows: Mapping[str, tuple[float, float]]) -> str:
        for key, (value, _) in rows.items():
            least, most = limits_si(TABLE[key])
            if not least <= value <= most:
                return f"{self.name}: by {GRIP_FORCE} {key} is {value_text(TABLE[key], value, 3)}: {_LOOK}"
        return ""

    def _stopped(self) -> str:
        """Message if the channel is constant or clipped."""
        noise, step = (self.loader[f"{GRIP_SENSOR}.{row}"] for row in ("noise", "resolution"))
        swing = float(np.ptp(self.measured))
        if not swing:
            moves = max(float(np.ptp(self.promised)), _NOISE_WIDTH * noise)
            shows = value_text(TABLE[OFFSET], float(self.measured[0]), 3)
            return (
                f"{self.name}: {GRIP_FORCE} shows {shows} from the first sample to the last: {_LOOK}"
                if moves > step
                else ""
            )
        if clipping := clipped(self.measured, None):
            return (
                f"{self.name}: {GRIP_FORCE} is clipped at {value_text(TABLE[OFFSET], float(self.measured[clipping.begin]), 3)}; "
                "expected the whole swing; take a larger range, or drive less"
            )
        return ""

    def _contradicts(self, key: str, value: float, deviation: float) -> str:
        """Message if the reading is absent, of opposite sign or of another size than predicted by the file."""
        cause = "the hand's force" if key == GAIN else "the force of the mass outboard of it"
        promised = self.loader[GAIN] * (1.0 if key == GAIN else max(self.loader[MASS], _LEAST_MASS))
        if value < -_CLEAR * deviation:
            return f"{self.name}: {GRIP_FORCE} shows {cause} with the wrong sign: reverse the polarity of the sensor or channel"
        # Noise alone exceeds two deviations once in twenty times, so a value far below the prediction counts as zero too.
        low = not _is_determined(value, deviation) and value + _SURE * deviation < promised / _FAR[key]
        if (low or value <= _SURE * deviation) and promised > _CLEAR * deviation:
            swing = float(np.std(promised * (self.of_hand if key == GAIN else self.of_mass)))
            should = value_text(TABLE[OFFSET], swing, 2)
            return (
                f"{self.name}: {GRIP_FORCE} shows nothing of {cause}, which would be {should} r.m.s. at least: {_LOOK}"
            )
        stated = key == GAIN or self.loader[MASS] > 0
        if stated and _is_determined(value, deviation) and not 1 / _FAR[key] < value / promised < _FAR[key]:
            return (
                f"{self.name}: {GRIP_FORCE} shows {value / promised:.2g} times as much of {cause} as the file predicts: check "
                f"its unit, {GAIN} and {MASS} in the file, and that it is that sensor's signal"
            )
        return ""

    def _unexplained(self, residual: NDArray[np.float64]) -> list[str]:
        """Message if the smooth part of the residual is too large a share of the reading."""
        missed, _ = runs_on_and_jumps(residual)
        moves = float(np.std(self.measured))
        if missed <= max(UNEXPLAINED * moves, _NOISIER * self.declared):
            return []
        return [
            f"{self.name}: {missed / moves:.0%} of {GRIP_FORCE} is neither the hand's recorded force nor that of the mass "
            f"outboard of it, {value_text(TABLE[OFFSET], missed, 2)} r.m.s.: the signal is clipped, drops out, drifts or is "
            "another one, or a hand was on the grip"
        ]

    def _notes(self, residual_rms: float, rows: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
        lines = []
        if self.loader[f"{GRIP_SENSOR}.noise"] and residual_rms > _NOISIER * self.declared:
            lines.append(
                f"{self.name}: {GRIP_FORCE} is {value_text(TABLE[OFFSET], residual_rms, 2)} r.m.s. off its prediction, but the "
                f"file states {value_text(TABLE[OFFSET], self.declared, 2)}: correct its noise in the file."
            )
        if GAIN not in rows and MASS not in rows:
            lines.append(
                f"{self.name}: hands off, the signal of the grip's sensor is too small to test its gain; the file's value is kept."
            )
        return tuple(lines)


_LOOK = "it is stuck, not connected, or another signal; look at the sensor, its cable and the column's name"

_PULL = (
    "Pull at the grip with a force that is measured, a weight or a spring balance, and record it as pilot_force beside grip_force "
    "(experiment: loader pilot_force): it determines the gain of the grip's sensor."
)


def _is_determined(value: float, deviation: float) -> bool:
    """Whether the 95 % interval lies within half of the value, as for any determined parameter."""
    return value > 2 * _SURE * deviation


def _jackknife(
    columns: NDArray[np.float64], measured: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least squares and their standard errors: ``s^2 = (n - 1) / n sum_k (b_(k) - mean)^2``, piece k of n left out."""
    scale = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    pieces = np.array_split(np.arange(len(measured)), _PIECES)
    square = np.array([columns[piece].T @ columns[piece] for piece in pieces]) / np.outer(scale, scale)
    right = np.array([columns[piece].T @ measured[piece] for piece in pieces]) / scale
    solution = np.linalg.pinv(square.sum(axis=0)) @ right.sum(axis=0)
    others = np.array(
        [np.linalg.pinv(square.sum(axis=0) - a) @ (right.sum(axis=0) - b) for a, b in zip(square, right, strict=True)]
    )
    spread = others - others.mean(axis=0)
    return solution / scale, np.sqrt((_PIECES - 1) / _PIECES * (spread**2).sum(axis=0)) / scale
