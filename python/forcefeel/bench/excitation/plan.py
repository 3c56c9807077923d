"""Requirements of an excitation: kind, length, band, measured channels and their noise."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import floor, log10
from types import MappingProxyType
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import OUTPUTS, outputs
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC, a_drive
from forcefeel.loader.timing import WHOLE
from forcefeel.simulation.inputs.sampled import check_number
from forcefeel.units import show

Kind = Literal["multisine", "chirp"]

SAMPLES_PER_CYCLE = 4
"""Least number of samples per cycle of the highest line: two by the sampling theorem, four for an anti-aliasing filter."""

FEWEST_PERIODS = 6
"""Least number of whole periods; the first is transient."""

RAMP = 0.25
"""Length of the ramps of a multisine, as a share of a period."""

MOST_SAMPLES = 5_000_000
"""Longest excitation, as the longest run."""

MEASURED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        HYDRAULIC: ("column_angle", "piston_position", "load_pressure"),
        ELECTRIC: ("column_angle", "drive_position", "load_cell_force", "motor_current"),
    }
)
"""Default recorded channels of each drive."""

_MOST_LINES = 160  # 4 % apart over three decades: finer than a resonance with a damping ratio of 0.02
_FEWEST_LINES = 8
_ROUND = (8.0, 5.0, 4.0, 2.5, 2.0, 1.0)


@dataclass(frozen=True)
class ExcitationPlan:
    """Requirements of an excitation.

    Attributes:
        signal: A multisine, or a chirp.
        time_s: Length, above 0.
        rate_hz: Samples per second, above 0.
        from_hz: Lowest frequency; default one cycle per period, 4 Hz for an open motor.
        to_hz: Highest frequency; default, the lowest of the valve's natural frequency or the current loop's bandwidth, a quarter
            of the rate, and a quarter of the controller's rate.
        measured: Recorded channels, of ``bench.channels.OUTPUTS``; default ``MEASURED``.
        noise_share: White noise of each measured channel, as a share of its r.m.s. under even lines that reach the limits.
        noise: The same in SI units for channels of known noise.
        limits: Limits in place of the loader's: ``current`` (A), ``travel`` (rad, of the column), ``force`` (N, at the load cell)
            and ``drive`` (V of the test signal, A of a test current or N at the grip); of a motor also ``voltage`` (V) and
            ``speed`` (rad/s).

    Raises:
        InputError: When built, if a number is not above 0, or a name is unknown or stands twice.

    Example:
        >>> ff.bench.ExcitationPlan(time_s=20.0, limits={"travel": 0.1, "current": 5e-3}).signal
        'multisine'
    """

    signal: Kind = "multisine"
    time_s: float = 60.0
    rate_hz: float = 1000.0
    from_hz: float | None = None
    to_hz: float | None = None
    measured: tuple[str, ...] | None = None
    noise_share: float = 0.01
    noise: Mapping[str, float] = field(default_factory=dict)
    limits: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.signal not in get_args(Kind):
            raise InputError(f"signal: expected {' or '.join(get_args(Kind))}, got {show(self.signal)}")
        numbers = {name: getattr(self, name) for name in ("time_s", "rate_hz", "noise_share", "from_hz", "to_hz")}
        optional = ("from_hz", "to_hz")
        numbers |= {f"noise of {name}": value for name, value in self.noise.items()}
        for name, value in numbers.items():
            if not (name in optional and value is None):
                check_number("excitation", name, value, "number above 0")
        measured = self.measured
        if measured is not None and (not measured or len(set(measured)) < len(measured)):
            raise InputError(f"measure: expected each channel once, one at least, got {', '.join(measured) or 'none'}")
        for name in (*(measured or ()), *self.noise):
            if name not in OUTPUTS:
                raise InputError(f"measure: expected channels out of {', '.join(OUTPUTS)}, got {show(name)}")
        if measured is not None:
            _check_noise(self.noise, measured)
        if self.time_s * self.rate_hz > MOST_SAMPLES:
            raise InputError(
                f"time: expected at most {MOST_SAMPLES:,} samples, got {self.time_s:g} s at {self.rate_hz:g} Hz; "
                "take a shorter time or a lower rate"
            )

    def of(self, loader: Loader) -> "ExcitationPlan":
        """The same with the measured channels of this loader.

        Raises:
            InputError: If its drive lacks a channel, or a channel with stated noise is not measured.
        """
        measured, loader_outputs = (
            MEASURED[loader.drive] if self.measured is None else self.measured,
            outputs(loader.drive),
        )
        for name in measured:
            if name not in loader_outputs:
                raise InputError(
                    f"measure: {name} is no channel of {a_drive(loader.drive)}; expected some of {', '.join(loader_outputs)}"
                )
        _check_noise(self.noise, measured)
        return replace(self, measured=measured)

    @property
    def channels(self) -> tuple[str, ...]:
        """The measured channels, if stated."""
        return self.measured or ()


def _check_noise(noise: Mapping[str, float], measured: tuple[str, ...]) -> None:
    if strange := [name for name in noise if name not in measured]:
        raise InputError(f"noise: {strange[0]} is not measured; measure it too, or leave its noise out")


@dataclass(frozen=True)
class Timing:
    """An excitation in samples.

    Attributes:
        rate_hz: Samples per second.
        samples: In the whole excitation.
        period: In a period.
        periods: Whole periods, the transient first one among them.
        ramp: Samples of the ramp up, and of the ramp down after the last period.
    """

    rate_hz: float
    samples: int
    period: int
    periods: int
    ramp: int

    @property
    def period_s(self) -> float:
        """Length of a period."""
        return self.period / self.rate_hz

    @property
    def times_s(self) -> NDArray[np.float64]:
        """Times of the samples."""
        return np.arange(self.samples) / self.rate_hz


def timing(plan: ExcitationPlan) -> Timing:
    """The longest period of round length that fits at least six times, with the final ramp.

    Raises:
        InputError: If the time is too short for the lowest frequency.
    """
    samples = floor(plan.time_s * plan.rate_hz * (1 + WHOLE))
    longest = samples / (FEWEST_PERIODS + RAMP)
    period = _round_period(longest / plan.rate_hz, plan.rate_hz) or floor(longest)
    lowest = plan.rate_hz / period if period else np.inf
    if plan.from_hz is not None and plan.from_hz < lowest * (1 - WHOLE):
        whole = floor(longest)
        if not whole or plan.from_hz < plan.rate_hz / whole * (1 - WHOLE):
            needed = (FEWEST_PERIODS + RAMP) / plan.from_hz
            raise InputError(
                f"time: expected {FEWEST_PERIODS} whole periods of {1 / plan.from_hz:.6g} s at least, {needed:.6g} s for a lowest "
                f"frequency of {plan.from_hz:g} Hz, got {plan.time_s:g} s; take a longer time or begin higher"
            )
        period = whole
    if period < 2 * SAMPLES_PER_CYCLE:
        raise InputError(
            f"time: expected time for {FEWEST_PERIODS} periods of some samples, got {samples} samples in all"
        )
    ramp = floor(RAMP * period)
    return Timing(plan.rate_hz, samples, period, (samples - ramp) // period, ramp)


def _round_period(longest_s: float, rate_hz: float) -> int | None:
    """Samples of the longest period such as 8 s, 2.5 s or 0.1 s that is no longer and a whole number of samples."""
    if not longest_s * rate_hz >= 1:
        return None
    decade = 10.0 ** floor(log10(longest_s))
    for seconds in (*(mark * decade for mark in _ROUND), *(mark * decade / 10 for mark in _ROUND)):
        count = seconds * rate_hz
        if seconds <= longest_s * (1 + WHOLE) and abs(count - round(count)) < WHOLE * count and round(count):
            return round(count)
    return None


def spectral_lines(plan: ExcitationPlan, times: Timing, loader: Loader) -> NDArray[np.float64]:
    """Candidate frequencies, Hz: whole multiples of one over the period, evenly spread over the logarithm.

    Raises:
        InputError: If the rate is too low for the band, or the band holds too few lines.
    """
    top = plan.rate_hz / SAMPLES_PER_CYCLE
    if plan.to_hz is None:
        period = loader["controller.period"]
        samples = 1 / period / SAMPLES_PER_CYCLE if period else np.inf
        fastest = loader["current_loop.bandwidth" if loader.drive == ELECTRIC else "valve.natural_frequency"]
        to_hz = min(fastest / (2 * np.pi), top, samples)
    elif plan.to_hz > top * (1 + WHOLE):
        raise InputError(
            f"rate: expected {SAMPLES_PER_CYCLE} samples in a cycle of the highest frequency at least, "
            f"{SAMPLES_PER_CYCLE * plan.to_hz:g} Hz for {plan.to_hz:g} Hz, got {plan.rate_hz:g} Hz; raise it or end lower"
        )
    else:
        to_hz = plan.to_hz
    first = max(int(np.ceil((plan.from_hz or 0.0) * times.period_s * (1 - WHOLE))), 1)
    last = floor(to_hz * times.period_s * (1 + WHOLE))
    if last - first + 1 < _FEWEST_LINES:
        raise InputError(
            f"band: expected {_FEWEST_LINES} lines at least, which are {1 / times.period_s:.6g} Hz apart, got "
            f"{max(last - first + 1, 0)} from {first / times.period_s:.6g} to {to_hz:.6g} Hz; take a longer time or a wider band"
        )
    harmonics = np.unique(np.rint(np.geomspace(first, last, _MOST_LINES)).astype(np.int64))
    return np.asarray(harmonics * plan.rate_hz / times.period)
