"""What records tell of the force sensor at the grip, once the loader is identified.

``F_g`` force that it shows · ``F_p`` force of the hand · ``K_g`` gain · ``m_o`` mass outboard of it · ``F_0`` offset

    F_g = K_g F_p - K_g m_o R_p theta'' + F_0

With nobody's hand on the grip it shows what moves the mass outboard of it, and no more. The motion is that of the identified loader
under what drove the record, since no encoder shows an acceleration; what the sensor shows of it is the model's own
(``crates/model/src/grip_sensor.rs``) for a hand alone and for a mass of 1 kg. So the record gives ``K_g m_o`` and ``F_0`` by least
squares, and where a measured force of the hand drives it ``K_g`` too. Standard errors are those of the jackknife, a piece of the
record left out at a time, since what is left is not white.
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
"""Of a record, for the jackknife."""

_SURE = 2.0
"""Standard errors within which a number is nothing."""

_CLEAR = 6.0
"""Standard errors that what the file promises has to be large, for the record to contradict it."""

_LEAST_MASS = 0.02
"""kg: no grip is lighter."""

_FAR = {GAIN: 1.5, MASS: 4.0}
"""Times what the file promises: a gain is calibrated, a mass outboard guessed; pounds taken for newtons are 4.4."""

_NOISIER = 2.0
"""Times its declared noise, from which on the sensor is not the declared one."""

_NOISE_WIDTH = 6.0
"""Deviations of noise from its lowest to its highest value, at least."""


@dataclass(frozen=True)
class GripSensorFound:
    """What became of the sensor.

    Attributes:
        rows: Value and standard error of each row that the record determines, SI units.
        noise: What is left of its record, r.m.s., N; ``None`` without a record.
        wrong: Why no law may use it.
        said: What else is to be known.
        advice: The experiments that would determine the rest.
    """

    rows: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    noise: float | None = None
    wrong: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()


def find_grip_sensor(loader: Loader, data: Sequence[Response | BenchRecord], law: Law | None) -> GripSensorFound:
    """What the records tell of the sensor.

    Args:
        loader: As identified, with the rows of the sensor as its file has them.
        data: Records and responses.
        law: Of the bench, where the record is of the whole loader; one that does not use the sensor, which is yet to be tried.
    """
    records = [one for one in data if isinstance(one, BenchRecord) and GRIP_FORCE in one.channels]
    if not has_grip_sensor(loader):
        moving = any(np.ptp(one.channels[GRIP_FORCE]) > 0 for one in records)
        sentence = (
            f"The records hold {GRIP_FORCE}, and the loader file has no grip_sensor: it is left out. State grip_sensor.gain, 1 as "
            "calibrated, for a law that measures the hand by it."
        )
        return GripSensorFound(said=(sentence,) * moving)
    used = [one for one in records if one.experiment.drive is not Drive.RELEASE]
    if not used:
        sentence = (
            f"No record{' but a release' * bool(records)} holds {GRIP_FORCE}: the rows of grip_sensor stand as the file "
            "has them, and nothing was tried of it."
        )
        return GripSensorFound(said=(sentence,), advice=(_RECORD_IT,))
    best = max(used, key=lambda one: one.experiment.drive is Drive.PILOT_FORCE)
    return _Shown.of(best, loader, law).found()


_RECORD_IT = (
    f"Record {GRIP_FORCE} beside the other channels; and once under a measured pull at the grip, a weight or a spring balance, "
    "recorded as pilot_force (experiment: loader pilot_force)."
)


def moments(record: BenchRecord, loader: Loader, law: Law | None) -> NDArray[np.float64]:
    """``F_p, theta, theta', theta''`` of a loader under what drove a record, at its times, (samples, 4)."""
    drive = drive_channel(record.experiment)
    driven = {} if drive is None else {drive: record.channels[drive]}
    blank = dict.fromkeys(("column_angle", "column_velocity"), np.zeros_like(record.time_s))
    run = RecordRun(replace(record, channels={**driven, **blank}), without_grip_sensor(loader), law)
    angle, rate = run.at(loader.si_values, ()).value
    hand = driven.get(Drive.PILOT_FORCE, np.zeros_like(angle))
    return np.column_stack([hand, angle, rate, CubicSpline(run.time_s, rate)(run.time_s, 1)])


def grip_force(loader: Loader, at: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the sensor of a loader shows at ``moments``, offset left out, N."""
    return np.asarray(_core.grip_force(loader.si_values, np.ascontiguousarray(at)))


@dataclass(frozen=True, eq=False)
class _Shown:
    """A record of the sensor beside what it should show of a hand and of a mass of 1 kg."""

    loader: Loader
    name: str
    measured: NDArray[np.float64]
    promised: NDArray[np.float64]
    of_hand: NDArray[np.float64]
    of_mass: NDArray[np.float64]

    @classmethod
    def of(cls, record: BenchRecord, loader: Loader, law: Law | None) -> "_Shown":
        at = moments(record, loader, law)
        hand, loaded = (grip_force(loader.replace({GAIN: 1.0, MASS: mass}, si=True), at) for mass in (None, 1.0))
        return cls(loader, record.name, record.channels[GRIP_FORCE], grip_force(loader, at), hand, loaded - hand)

    @property
    def declared(self) -> float:
        """Noise of a sample by the file, its steps included, r.m.s., N."""
        return float(np.sqrt(sample_variance(self.loader)[sensors_of(self.loader).index(GRIP_SENSOR)]))

    def found(self) -> GripSensorFound:
        """The sensor by this record."""
        if sentence := self._stopped():
            return GripSensorFound(wrong=(sentence,))
        by_hand = [GAIN] if np.ptp(self.of_hand) > 0 else []
        columns = np.column_stack([*(self.of_hand for _ in by_hand), self.of_mass, np.ones_like(self.of_mass)])
        value, deviation = _jackknife(columns, self.measured)
        residual = self.measured - columns @ value
        left = float(np.std(residual))
        numbers = dict(zip((*by_hand, MASS, OFFSET), zip(value.tolist(), deviation.tolist(), strict=True), strict=True))
        tried = [self._contradicts(key, *numbers[key]) for key in (*by_hand, MASS)]
        rows = self._rows(numbers)
        told = [sentence for sentence in (*tried, self._out_of_range(rows)) if sentence]
        if wrong := tuple(told or self._unexplained(residual)):
            return GripSensorFound(noise=left, wrong=wrong)
        return GripSensorFound(rows, left, (), self._said(left, rows), () if GAIN in rows else (_PULL,))

    def _rows(self, numbers: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
        """The rows that are determined, of ``K_g``, ``K_g m_o`` and ``F_0``."""
        told = {key: numbers[key] for key in (GAIN, MASS) if key in numbers and _is_told(*numbers[key])}
        if MASS in told:
            gain = told[GAIN][0] if GAIN in told else self.loader[GAIN]
            told[MASS] = (told[MASS][0] / gain, told[MASS][1] / gain)
        value, deviation = numbers[OFFSET]
        return told | ({OFFSET: (value, deviation)} if abs(value) > _SURE * deviation else {})

    def _out_of_range(self, rows: Mapping[str, tuple[float, float]]) -> str:
        for key, (value, _) in rows.items():
            least, most = limits_si(TABLE[key])
            if not least <= value <= most:
                return f"{self.name}: by {GRIP_FORCE} {key} is {value_text(TABLE[key], value, 3)}: {_LOOK}"
        return ""

    def _stopped(self) -> str:
        """Whether it shows one value alone, or is cut off."""
        noise, step = (self.loader[f"{GRIP_SENSOR}.{row}"] for row in ("noise", "resolution"))
        reach = float(np.ptp(self.measured))
        if not reach:
            moves = max(float(np.ptp(self.promised)), _NOISE_WIDTH * noise)
            shows = value_text(TABLE[OFFSET], float(self.measured[0]), 3)
            return (
                f"{self.name}: {GRIP_FORCE} shows {shows} from the first sample to the last: {_LOOK}"
                if moves > step
                else ""
            )
        if at := clipped(self.measured, None):
            return (
                f"{self.name}: {GRIP_FORCE} is cut off at {value_text(TABLE[OFFSET], float(self.measured[at.begin]), 3)}: expected "
                "the whole swing; take a larger range, or drive less"
            )
        return ""

    def _contradicts(self, key: str, value: float, deviation: float) -> str:
        """Whether the sensor shows nothing, the contrary, or quite another size, of what it must by the file."""
        what = "the hand's force" if key == GAIN else "what moves the mass outboard of it"
        promised = self.loader[GAIN] * (1.0 if key == GAIN else max(self.loader[MASS], _LEAST_MASS))
        if value < -_CLEAR * deviation:
            return f"{self.name}: {GRIP_FORCE} shows {what} with the wrong sign: turn the sensor's polarity, or that of the channel"
        # Noise alone is beyond two deviations once in twenty times: what is far below the promise is nothing too.
        low = not _is_told(value, deviation) and value + _SURE * deviation < promised / _FAR[key]
        if (low or value <= _SURE * deviation) and promised > _CLEAR * deviation:
            swing = float(np.std(promised * (self.of_hand if key == GAIN else self.of_mass)))
            should = value_text(TABLE[OFFSET], swing, 2)
            return (
                f"{self.name}: {GRIP_FORCE} shows nothing of {what}, which would be {should} r.m.s. at least: {_LOOK}"
            )
        stated = key == GAIN or self.loader[MASS] > 0
        if stated and _is_told(value, deviation) and not 1 / _FAR[key] < value / promised < _FAR[key]:
            return (
                f"{self.name}: {GRIP_FORCE} shows {value / promised:.2g} times as much of {what} as the file promises: look at its "
                f"unit, at {GAIN} and {MASS} in the file, and whether it is that sensor's signal"
            )
        return ""

    def _unexplained(self, left: NDArray[np.float64]) -> list[str]:
        """Whether it shows something else beside: what is left runs on, and is too much of all that it shows, as of any channel."""
        missed, _ = runs_on_and_jumps(left)
        moves = float(np.std(self.measured))
        if missed <= max(UNEXPLAINED * moves, _NOISIER * self.declared):
            return []
        return [
            f"{self.name}: {missed / moves:.0%} of what {GRIP_FORCE} shows is neither the hand's recorded force nor what moves the "
            f"mass outboard of it, {value_text(TABLE[OFFSET], missed, 2)} r.m.s.: it is cut off, drops out, drifts, is another "
            "signal, or a hand was on the grip"
        ]

    def _said(self, left: float, rows: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
        lines = []
        if self.loader[f"{GRIP_SENSOR}.noise"] and left > _NOISIER * self.declared:
            lines.append(
                f"{self.name}: {GRIP_FORCE} is {value_text(TABLE[OFFSET], left, 2)} r.m.s. off what it should show, and "
                f"{value_text(TABLE[OFFSET], self.declared, 2)} by the file: state the noise that it has."
            )
        if GAIN not in rows and MASS not in rows:
            lines.append(
                f"{self.name}: hands off the grip's sensor has too little to show for its gain to be tried: the file's stands."
            )
        return tuple(lines)


_LOOK = "it is stuck, not connected, or another signal; look at the sensor, its cable and the column's name"

_PULL = (
    "Pull at the grip with a force that is measured, a weight or a spring balance, and record it as pilot_force beside grip_force "
    "(experiment: loader pilot_force): it tells the gain of the grip's sensor."
)


def _is_told(value: float, deviation: float) -> bool:
    """Whether the 95 % interval lies within half of the value, as of any parameter that gets a number."""
    return value > 2 * _SURE * deviation


def _jackknife(
    columns: NDArray[np.float64], measured: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least squares and their standard errors: ``s^2 = (n - 1) / n sum_k (b_(k) - mean)^2``, piece k of n left out."""
    scale = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    pieces = np.array_split(np.arange(len(measured)), _PIECES)
    square = np.array([columns[at].T @ columns[at] for at in pieces]) / np.outer(scale, scale)
    right = np.array([columns[at].T @ measured[at] for at in pieces]) / scale
    told = np.linalg.pinv(square.sum(axis=0)) @ right.sum(axis=0)
    others = np.array(
        [np.linalg.pinv(square.sum(axis=0) - a) @ (right.sum(axis=0) - b) for a, b in zip(square, right, strict=True)]
    )
    spread = others - others.mean(axis=0)
    return told / scale, np.sqrt((_PIECES - 1) / _PIECES * (spread**2).sum(axis=0)) / scale
