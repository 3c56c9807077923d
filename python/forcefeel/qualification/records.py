"""Recorded signals of a control: position over time, and optionally force, surface position and body rate."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.tables.faults import fault
from forcefeel.units import factor, show

PositionUnit = Literal["rad", "m"]

_TAIL = 0.1
"""Share of a record at its end from which its noise is estimated."""
_THIRD = 20.0
"""Variance of the third difference of white noise of variance one: 1 + 9 + 9 + 1."""
_LATTICE = 0.5
"""Share of distinct values below which a record may be quantized."""
_OFF_LATTICE = 1e-3
"""Tolerance of quantized values, as a share of the step."""

_CHANNELS = {
    "force_n": ("force", "N"),
    "surface_rad": ("surface", "rad"),
    "body_rate_rad_per_s": ("body rate", "rad/s"),
}


@dataclass(frozen=True, eq=False)
class Record:
    """Signals of a control over time; sample times may be uneven, without gaps.

    Attributes:
        time_s: Times of the samples, s, increasing; a step above five times the median step is a gap.
        position: Position of the control, rad or m.
        force_n: Pilot's force at the grip, N.
        surface_rad: Position of the control surface, rad.
        body_rate_rad_per_s: Body rate of the aircraft, rad/s.
        position_unit: ``rad`` or ``m``.
        shown_unit: The position's unit in messages, such as that of its file; ``position_unit`` if empty.
        name: Name for messages.
        resolution: Resolution of the position's sensor; ``None``: estimated from the values.
        noise: Standard deviation of the position's noise; ``None``: estimated from the record's last tenth.
        force_resolution_n, force_noise_n: The same of the force.
        release_s: Time of the release if known, as in a simulation; ``None``: estimated from the record.
        data_hash: SHA-256 of its file, in hexadecimal; empty for a record in memory.

    Raises:
        InputError: When built, with row and time: fewer than two rows, signals of different lengths, values that are not
            finite, time that does not increase or has a gap.
    """

    time_s: NDArray[np.float64]
    position: NDArray[np.float64]
    force_n: NDArray[np.float64] | None = None
    surface_rad: NDArray[np.float64] | None = None
    body_rate_rad_per_s: NDArray[np.float64] | None = None
    position_unit: PositionUnit = "rad"
    shown_unit: str = ""
    name: str = "record"
    resolution: float | None = None
    noise: float | None = None
    force_resolution_n: float | None = None
    force_noise_n: float | None = None
    release_s: float | None = None
    data_hash: str = ""

    def __post_init__(self) -> None:
        if self.position_unit not in ("rad", "m"):
            raise InputError(f"{self.name}: position_unit: expected 'rad' or 'm', got {show(self.position_unit)}")
        fields = {"time_s": ("time", "s"), "position": ("position", self.position_unit), **_CHANNELS}
        columns, units = {}, {}
        for field, (name, unit) in fields.items():
            value = getattr(self, field)
            if value is None and field in _CHANNELS:
                continue
            values = _row(self.name, field, value)
            object.__setattr__(self, field, values)
            columns[name], units[name] = values, unit
            if values.shape != self.time_s.shape:
                came = f"{len(values)} values and {len(self.time_s)} times"
                raise InputError(f"{self.name}: expected {field} to be as long as time_s, got {came}")
        if problem := fault(columns, units):
            row_at_fault, sentence = problem
            raise InputError(f"{self.name}: row {row_at_fault}, counted from 1: {sentence}")
        for field in ("resolution", "noise", "force_resolution_n", "force_noise_n"):
            value = getattr(self, field)
            if value is not None and not 0 <= value < np.inf:
                raise InputError(f"{self.name}: {field}: expected a number of at least zero, got {show(value)}")
        if self.release_s is not None and not self.time_s[0] <= self.release_s < self.time_s[-1]:
            raise InputError(
                f"{self.name}: release_s: expected a time within the record, {self.time_s[0]:.6g} to {self.time_s[-1]:.6g} s, "
                f"got {show(self.release_s)}"
            )

    @staticmethod
    def of(  # noqa: PLR0913  a unit for each signal
        time: ArrayLike,
        position: ArrayLike,
        force: ArrayLike | None = None,
        *,
        time_unit: str = "s",
        position_unit: str = "deg",
        force_unit: str = "N",
        name: str = "record",
        resolution: float | None = None,
        noise: float | None = None,
    ) -> "Record":
        """A record of signals in other units; ``resolution`` and ``noise`` are in ``position_unit``.

        Raises:
            InputError: If a unit is unknown or of another quantity, and as when a record is built.
        """
        seconds = _scale(name, "time_unit", time_unit, "s")
        newtons = _scale(name, "force_unit", force_unit, "N")
        si, scale = _position_scale(name, position_unit)
        return Record(
            _row(name, "time", time) * seconds,
            _row(name, "position", position) * scale,
            None if force is None else _row(name, "force", force) * newtons,
            position_unit=si,
            shown_unit=position_unit,
            name=name,
            resolution=None if resolution is None else resolution * scale,
            noise=None if noise is None else noise * scale,
        )

    def shown(self, position: float) -> str:
        """A position as text in the unit of its file."""
        unit = self.shown_unit or self.position_unit
        return f"{position * factor(self.position_unit, unit):.6g} {unit}"

    def between(self, start_s: float, end_s: float) -> "Record":
        """The part of the record from ``start_s`` to ``end_s``."""
        part = (self.time_s >= start_s) & (self.time_s <= end_s)

        def cut(values: NDArray[np.float64] | None) -> NDArray[np.float64] | None:
            return None if values is None else values[part]

        return replace(
            self,
            time_s=self.time_s[part],
            position=self.position[part],
            force_n=cut(self.force_n),
            surface_rad=cut(self.surface_rad),
            body_rate_rad_per_s=cut(self.body_rate_rad_per_s),
            release_s=self.release_s if self.release_s is not None and start_s <= self.release_s < end_s else None,
        )

    @property
    def duration_s(self) -> float:
        """Time from the first sample to the last, s."""
        return float(self.time_s[-1] - self.time_s[0])

    @cached_property
    def step_s(self) -> float:
        """Median time between samples, s."""
        return float(np.median(np.diff(self.time_s)))

    @cached_property
    def position_resolution(self) -> float:
        """Resolution of the position; zero if the values are not quantized."""
        return found_resolution(self.position) if self.resolution is None else self.resolution

    @cached_property
    def position_noise(self) -> float:
        """Standard deviation of the position's noise."""
        return found_noise(self.position) if self.noise is None else self.noise

    @cached_property
    def force_uncertainty_n(self) -> float:
        """Standard uncertainty of one sample of the force, N: its noise and its resolution."""
        if self.force_n is None:
            return float("nan")
        noise = found_noise(self.force_n) if self.force_noise_n is None else self.force_noise_n
        resolution = self.force_resolution_n
        step = found_resolution(self.force_n) if resolution is None else resolution
        return float(np.hypot(noise, step / np.sqrt(12)))


def found_noise(values: NDArray[np.float64]) -> float:
    """Standard deviation of white noise, from the third differences of the last tenth, where a slow signal has none."""
    tail = values[-max(int(len(values) * _TAIL), min(20, len(values))) :]
    if len(tail) < 8:
        return 0.0
    third = np.diff(tail, 3)
    return float(np.sqrt(np.mean(third**2) / _THIRD))


def found_resolution(values: NDArray[np.float64]) -> float:
    """Resolution of a quantized signal; zero if the signal is not quantized."""
    different = np.unique(values)
    if not 2 < len(different) < _LATTICE * len(values):
        return 0.0
    gaps = np.diff(different)
    step = float(gaps[gaps > 1e-9 * (different[-1] - different[0])].min(initial=np.inf))
    if not np.isfinite(step):
        return 0.0
    steps = gaps / step
    return step if np.all(np.abs(steps - np.round(steps)) < _OFF_LATTICE * np.maximum(steps, 1.0)) else 0.0


def _row(name: str, field: str, raw: object) -> NDArray[np.float64]:
    try:
        values = np.array(raw, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: expected {field} to be a row of numbers ({error})") from error
    if values.ndim != 1:
        raise InputError(f"{name}: expected {field} to be a row of numbers, got shape {values.shape}")
    values.setflags(write=False)
    return values


def _scale(name: str, argument: str, unit: str, si: str) -> float:
    try:
        return factor(unit, si)
    except InputError as error:
        raise InputError(f"{name}: {argument}: {error}") from error


def _position_scale(name: str, unit: str) -> tuple[PositionUnit, float]:
    """SI unit of a position and the SI value of one ``unit``."""
    try:
        return "rad", factor(unit, "rad")
    except InputError as error:
        try:
            return "m", factor(unit, "m")
        except InputError:
            raise InputError(f"{name}: position_unit: {error}; or give a length such as 'cm'") from error
