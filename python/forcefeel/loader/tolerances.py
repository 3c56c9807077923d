"""Tolerances: how far a value of the machine that was built may lie from the one that its loader states.

How a loader file writes them stands in ``tolerance_text``.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel._core import Parameter
from forcefeel.errors import InputError
from forcefeel.loader import consistency
from forcefeel.loader.parameters import OFF, TABLE, a_drive, did_you_mean, in_range, is_switch, range_text, value_text
from forcefeel.units import Json, Unit, UnitSystem, quantity, show

_SAME = 1e-9
"""Relative; a value that went through another unit system is still the same."""

_WIDEST_DEVIATION = 100.0
"""Standard deviation per distance of the bounds, beyond which a normal distribution is no other than the uniform one."""

ENDS_AT = 2.0
"""Standard deviations from the mean at which a normal tolerance is said to end: 95.4 % of a normal distribution lie within."""

ASSUMED = 0.2
"""Share to either side by which a value is assumed to be off where no tolerance is stated."""

RULED = 0.01
"""The same of a length: a ruler measures it."""

LENGTHS = frozenset({"linkage.ratio", "column.base_arm", "column.grip_arm", "transmission.travel"})

ZERO = "expected bounds as values with their unit, got shares of a value that is zero"


class Distribution(StrEnum):
    """How the values are spread between the bounds."""

    UNIFORM = "uniform"
    NORMAL = "normal"
    TRIANGULAR = "triangular"


@dataclass(frozen=True)
class Tolerance:
    """How a value is spread.

    Attributes:
        distribution: Which distribution.
        low, high: Its bounds, in SI units as all numbers here.
        peak: Most frequent value: the mean of the normal distribution that is cut off, the peak of the triangular one.
            ``None`` for the uniform one.
        deviation: Standard deviation of the normal distribution before it is cut off. ``None`` for the others.
        nominal: The value of which bounds, peak and deviation are shares; ``None`` if they stand by themselves.

    Raises:
        InputError: If the bounds are not finite or not in order, the peak is not between them, the deviation is not
            above zero, ``nominal`` is zero, or one is missing or too much.

    Example:
        >>> ff.elevator().tolerances["linkage.stiffness"].distribution.value
        'uniform'
    """

    distribution: Distribution
    low: float
    high: float
    peak: float | None = None
    deviation: float | None = None
    nominal: float | None = None

    def __post_init__(self) -> None:
        try:
            object.__setattr__(self, "distribution", Distribution(self.distribution))
        except ValueError:
            known = ", ".join(Distribution)
            raise InputError(f"distribution: expected one of {known}, got {show(self.distribution)}") from None
        for field in fields(self)[1:]:
            value = getattr(self, field.name)
            if not _is_number(value) and (value is not None or field.name in {"low", "high"}):
                raise InputError(f"{field.name}: expected a finite number, got {show(value)}")
        if not self.high - self.low > _SAME * max(abs(self.low), abs(self.high)):
            raise InputError(f"expected a lower bound below the upper one, got {self.low:.10g} and {self.high:.10g}")
        self._check_shape()
        if self.nominal == 0:
            raise InputError(ZERO)

    def as_json(self, measured_in: Unit, system: UnitSystem) -> dict[str, Json]:
        """The distribution and its numbers, those that it has."""
        numbers = {name: getattr(self, name) for name in ("low", "high", "peak", "deviation")}
        given = {name: quantity(value, measured_in, system) for name, value in numbers.items() if value is not None}
        return {"distribution": str(self.distribution), **given}

    def _check_shape(self) -> None:
        peaked, normal = self.distribution is not Distribution.UNIFORM, self.distribution is Distribution.NORMAL
        for name, wanted in (("peak", peaked), ("deviation", normal)):
            if (getattr(self, name) is not None) is not wanted:
                raise InputError(
                    f"{name}: expected {'a number' if wanted else 'none'} for a {self.distribution} tolerance"
                )
        if self.peak is not None and not self.low <= self.peak <= self.high:
            between = f"between the bounds {self.low:.10g} and {self.high:.10g}"
            raise InputError(f"expected a {'mean' if normal else 'peak'} {between}, got {self.peak:.10g}")
        share = 1.0 if self.deviation is None else self.deviation / (self.high - self.low)
        if not 0 < share <= _WIDEST_DEVIATION:
            most = f"at most {_WIDEST_DEVIATION:g} times the distance of the bounds"
            raise InputError(f"expected a standard deviation above zero and {most}, got {share:.4g} times")

    @property
    def ends(self) -> tuple[float, float]:
        """From where to where it goes, where one machine at each end stands for all.

        Its bounds; of a normal one ``ENDS_AT`` standard deviations to either side of the mean, at most the bounds.
        """
        if self.deviation is None or self.peak is None:
            return self.low, self.high
        reach = ENDS_AT * self.deviation
        return max(self.low, self.peak - reach), min(self.high, self.peak + reach)

    def quantile(self, u: ArrayLike) -> NDArray[np.float64]:
        """The values below which shares ``u`` of the machines lie: the inverse of the distribution function.

        Uniform numbers between 0 and 1, random or of a sequence such as Sobol's, become values of this tolerance.

        Args:
            u: Shares from 0 to 1, any shape.

        Returns:
            Values in SI units between the bounds; shape as ``u``.

        Raises:
            InputError: If a share is not from 0 to 1.
        """
        share = np.asarray(u, dtype=np.float64)
        if not np.all((share >= 0) & (share <= 1)):
            raise InputError(f"u: expected shares from 0 to 1, got {share[~((share >= 0) & (share <= 1))].flat[0]}")
        return np.clip(self._inverse(share), self.low, self.high)

    def _inverse(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        low, high, peak = self.low, self.high, self.peak
        if peak is None:
            return low + u * (high - low)
        if self.deviation is None:
            rising = low + np.sqrt(u * (high - low) * (peak - low))
            falling = high - np.sqrt((1 - u) * (high - low) * (high - peak))
            return np.where(u * (high - low) < peak - low, rising, falling)
        from scipy.stats import truncnorm  # noqa: PLC0415  takes a second, and most loaders need none

        a, b = (low - peak) / self.deviation, (high - peak) / self.deviation
        return np.asarray(truncnorm.ppf(u, a, b, loc=peak, scale=self.deviation), dtype=np.float64)

    def sample(self, random: np.random.Generator, size: int | tuple[int, ...]) -> NDArray[np.float64]:
        """Random values, independent of each other; SI units, shape ``size``."""
        return self.quantile(random.random(size))

    def about(self, value: float) -> "Tolerance":
        """The same tolerance of another value: shares follow it, bounds that stand by themselves stay.

        Raises:
            InputError: If they would be shares of zero.
        """
        if self.nominal is None or value == self.nominal:
            return self
        if value == 0:
            raise InputError(ZERO)
        old, size = self.nominal, abs(value) / abs(self.nominal)
        low, high = (value + (bound - old) * size for bound in (self.low, self.high))
        peak = None if self.peak is None else value + (self.peak - old) * size
        deviation = None if self.deviation is None else self.deviation * size
        return replace(self, low=low, high=high, peak=peak, deviation=deviation, nominal=value)


def assumed(key: str) -> float:
    """Share to either side by which a parameter is assumed to be off: ``RULED`` of a length, ``ASSUMED`` of any other.

    Example:
        >>> from forcefeel.loader.tolerances import assumed
        >>> assumed("column.grip_arm"), assumed("column.inertia")
        (0.01, 0.2)
    """
    return RULED if key in LENGTHS else ASSUMED


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def check(tolerances: Mapping[str, Tolerance], values: Mapping[str, float]) -> list[str]:
    """A line for each tolerance that does not go with the loader's values.

    Shares may lead out of the row's range, since they follow a value that may move up to its end; ``beyond`` says where.

    Args:
        tolerances: Tolerances by ``part.name``.
        values: SI values by ``part.name``.
    """
    wrong = [complaint for key, it in tolerances.items() if (complaint := _misfit(key, it, values))]
    if wrong := wrong or beyond({key: it for key, it in tolerances.items() if it.nominal is None}):
        return wrong
    # A row that is off, but not within its tolerance, needs what it would need if it were on.
    built = {key: it.high for key, it in tolerances.items() if values[key] == OFF.get(key)}
    alone = consistency.without_effect({**values, **built})
    return [f"tolerances.{complaint}" for key, complaint in alone.items() if key in built]


def _misfit(key: str, tolerance: object, values: Mapping[str, float]) -> str | None:
    """What is wrong with one tolerance; nothing if it goes with the value."""
    if complaint := unsuited(key, {known: TABLE[known] for known in values}):
        return complaint
    row, place = TABLE[key], f"tolerances.{key}"
    if not isinstance(tolerance, Tolerance):
        return f"{place}: expected a Tolerance, got {show(tolerance)}"
    if tolerance.nominal is None:
        return None
    if nothing(row, values[key]):
        return f"{place}: {share_of_nothing(row)}"
    if not math.isclose(tolerance.nominal, values[key], rel_tol=_SAME):
        of, value = value_text(row, tolerance.nominal), value_text(row, values[key])
        return f"{place}: expected shares of the loader's value, {value}, got shares of {of}; make it with about()"
    return None


def beyond(tolerances: Mapping[str, Tolerance]) -> list[str]:
    """A line for each tolerance of which a bound is out of its row's range."""
    return [complaint for key, it in tolerances.items() if (complaint := _beyond(TABLE[key], it))]


def _beyond(row: Parameter, tolerance: Tolerance) -> str | None:
    for bound in (tolerance.low, tolerance.high):
        if not in_range(row, bound):
            came = f"out of range: expected bounds within {range_text(row)}, got {value_text(row, bound)}"
            return f"tolerances.{row.part}.{row.name}: {came}; narrow it"
    return None


def unsuited(key: str, known: Mapping[str, Parameter]) -> str | None:
    """Why there can be no tolerance of ``key`` in a loader that has the ``known`` rows; nothing if there can."""
    if key not in TABLE:
        return f"tolerances: unknown parameter {show(key)}; {did_you_mean(key, known)}"
    if key not in known:
        return f"tolerances.{key}: is of a loader with {a_drive(str(TABLE[key].drive))}; this one has the other; leave it out"
    if is_switch(TABLE[key]):
        return f"tolerances.{key}: a switch is on or off; leave its tolerance out"
    return None


def nothing(row: Parameter, value: float) -> bool:
    """Whether ``value`` is one of an optional row that is off, of which there are no shares."""
    return value == row.off_si and (value == 0 or math.isinf(value))


def share_of_nothing(row: Parameter) -> str:
    """What is wrong with a share of a row that is off, and what to do."""
    low, high = (value_text(row, share * row.default_si or share) for share in (0.5, 1.5))
    key = f"{row.part}.{row.name}"
    remedy = f'give {key}, or state bounds as values, such as {{ uniform = ["{low}", "{high}"] }}'
    return f"a share of {key}, which is off, says nothing; {remedy}"
