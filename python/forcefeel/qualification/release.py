"""A free response: the control is held, released, and comes to rest.

Ad initial displacement · P0 time from 0.9 Ad to the first zero crossing · P1, P2, ... the full cycles after it ·
A1, A2, ... overshoots

A figure's uncertainty combines noise and resolution of the position around its time, the difference between two polynomial
fits, and the uncertainties of steady state and held position. A time at the level ``L = s + share (x_0 - s)`` has the
uncertainty ``u(x - L) / |x'|``.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.qualification.figures import Figure, combined
from forcefeel.qualification.let_go import LetGo, check_clipping, check_rate, find_release
from forcefeel.qualification.records import PositionUnit, Record
from forcefeel.qualification.release_part import release_part
from forcefeel.qualification.rules import ReleaseRules, load_rules

_GROUPS = _core.release_feature_groups()
_ENDS = list(accumulate(count for _, count, _ in _GROUPS))

COLUMNS = {name: slice(end - count, end) for (name, count, _), end in zip(_GROUPS, _ENDS, strict=True)}
"""Columns of each group of features in the rows of the kernel, by its name."""

REST = 3.0
"""Settling criterion: time in the residual band as a multiple of the fall time from 0.9 to 0.1 Ad, at least half a period of a
swinging column."""

_REACH = 0.35
"""Half width of the smoothing as a share of the fall time from 0.9 to 0.1 Ad: 0.06 of a period of a swinging column."""
_QUIET = 1e-7
"""Noise, as a share of Ad, below which the position is not smoothed."""
_WIDER = 3.5
"""Half width, in steps, of the second fit of a noise-free record."""
_PASSED = 4.0
"""Hysteresis of a zero crossing, in standard deviations of the noise."""
_COVERAGE = 2.0
"""Standard uncertainties within which an overshoot may be on either side of the residual band."""


@dataclass(frozen=True, eq=False)
class ReleaseFeatures:
    """Features that the dynamic tests compare.

    Attributes:
        name: Name of the record.
        release_s: Time of the release.
        steady: Steady state.
        displacement: Ad with its sign: held position minus steady state.
        fall_time: Time from 0.9 Ad to 0.1 Ad.
        rise_time: Time from the release to 90 % of the steady value.
        cycles: P0, P1, P2, ..., as many as exist.
        overshoots: Sizes of A1, A2, ..., including those within the residual band.
        overshoot_times_s, crossing_times_s: Times of overshoots and zero crossings.
        count: Number of overshoots above the residual band.
        count_range: Least and largest count within the uncertainties.
        settled: Whether it came to rest.
        settled_s: Time from which it stays in the residual band.
        band: Residual band, in the position's unit.
        noise, resolution: Noise and resolution of the position, in its unit.
        position_unit: ``rad`` or ``m``.
    """

    name: str
    release_s: Figure
    steady: Figure
    displacement: Figure
    fall_time: Figure
    rise_time: Figure
    cycles: tuple[Figure, ...]
    overshoots: tuple[Figure, ...]
    overshoot_times_s: tuple[float, ...]
    crossing_times_s: tuple[float, ...]
    count: int
    count_range: tuple[int, int]
    settled: bool
    settled_s: float
    band: float
    noise: float
    resolution: float
    position_unit: PositionUnit

    @property
    def underdamped(self) -> bool:
        """Whether it overshoots by more than the residual band; otherwise fall time or rise time is compared."""
        return self.count > 0

    def aligned(self, record: Record) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Time from the release, s, and position from the steady state as a share of Ad, for comparison plots."""
        return record.time_s - self.release_s.value, (record.position - self.steady.value) / self.displacement.value


def measure_release(
    record: Record, *, rules: ReleaseRules | None = None, tail: float = 0.1, settle_check: bool = True
) -> ReleaseFeatures:
    """The features of a release.

    Args:
        record: Record of a control that is held, released and comes to rest, with at least 50 samples a second. The first
            sample may be the release; motion to the held position may precede it.
        rules: Residual band and shares of Ad. Default: those of the default edition.
        tail: Share of the record after the release, at its end, whose mean is the steady state.
        settle_check: Refuse a record that does not come to rest; otherwise ``settled`` states it.

    Raises:
        InputError: With the record's name and a time: too few samples a second, no release or more than one, clipped, or
            ends before its first zero crossing or before it comes to rest.

    Example:
        >>> time = np.arange(0, 8, 1 / 60)
        >>> let_go = np.maximum(time - 0.5, 0)
        >>> position = 0.2 * np.exp(-2.5 * let_go) * (np.cos(12 * let_go) + 0.2 * np.sin(12 * let_go))
        >>> features = ff.qualification.measure_release(ff.qualification.Record(time, position))
        >>> f"{features.cycles[1].value:.2f} s"
        '0.52 s'
    """
    rules = rules or load_rules().release
    check_rate(record)
    record = release_part(record)
    let_go = find_release(record, tail, rules)
    check_clipping(record, let_go)
    measured = _Measured(record, let_go, rules)
    if settle_check and not measured.settled:
        raise InputError(measured.why_not_settled())
    return measured.features()


class _Measured:
    """Measurement of a record by the kernel."""

    def __init__(self, record: Record, let_go: LetGo, rules: ReleaseRules) -> None:
        self.record, self.let_go, self.rules = record, let_go, rules
        resolution = record.position_resolution / np.sqrt(12)
        noise = record.position_noise
        self.white = combined(noise, resolution)
        # With noise above half a step, a mean resolves less than a step; without it all samples share one error.
        self.stuck = resolution if noise < 0.5 * record.position_resolution else 0.0
        rough = self._kernel(0.0)
        fall_time = float(rough[0, COLUMNS["low"].start] - rough[0, COLUMNS["high"].start])
        quiet = self.white < _QUIET * abs(let_go.displacement)
        self.detail = rough if quiet or not fall_time > 0 else self._kernel(_REACH * fall_time)
        # The difference between fits of six and of more samples estimates the error of the polynomial.
        other = self._kernel(_WIDER * record.step_s)[0] if quiet else self.detail[0]
        values = self.detail[0]
        self.spread = np.nan_to_num(np.abs(other - values))
        self.steady, self.displacement = (float(values[COLUMNS[name].start]) for name in ("steady", "displacement"))
        deviation = float(values[COLUMNS["tail_deviation"].start])
        swing = max(deviation - _PASSED * self.white, 0.0) / np.sqrt(3)
        self.u_steady = combined(self.white / np.sqrt(let_go.tail), self.stuck, swing)
        self.u_held = combined(
            self.white / np.sqrt(let_go.held), self.stuck, max(let_go.wander - _PASSED * self.white, 0.0)
        )

    def _kernel(self, reach: float) -> NDArray[np.float64]:
        let_go, record = self.let_go, self.record
        measuring = _core.ReleaseMeasuring(
            record.time_s,
            (self.rules.residual_band, self.rules.high, self.rules.low),
            tail=let_go.tail,
            held=let_go.held,
            free=let_go.free,
            reach=reach,
            hysteresis=_PASSED * self.white,
        )
        return measuring.details(record.position)

    @cached_property
    def settled(self) -> bool:
        fall_time, at = self.fall_time.value, float(self.detail[0, COLUMNS["settled"].start])
        return bool(self.record.time_s[-1] - at >= REST * fall_time)

    def why_not_settled(self) -> str:
        """A sentence with the record's name and its end."""
        end, release = float(self.record.time_s[-1]), self.let_go.time_s
        # Any record crosses the mean of its own tail.
        crossed = self.detail[0, COLUMNS["crossings"].start] < self.record.time_s[-self.let_go.tail]
        what = "before it comes to rest" if crossed else "before its first zero crossing and before it comes to rest"
        return (
            f"{self.record.name}: ends at {end:.6g} s, {end - release:.4g} s after the release, {what}; expected it to "
            f"stay within {100 * self.rules.residual_band:g} % of the initial displacement around its steady state for "
            f"{REST:g} times its fall time from {self.rules.high:g} Ad to {self.rules.low:g} Ad; record for longer"
        )

    def _crossing(self, column: int, share: float) -> tuple[float, float, float, float]:
        """Time at ``share`` of Ad, its own uncertainty, and its sensitivities to steady state and held position."""
        time, slope, noise, last_term = self.detail[:, column].tolist()
        own = combined(self.white * noise, last_term, self.stuck) / abs(slope)
        if not np.isfinite(own):  # linear interpolation between two samples, without a polynomial
            own = self.record.step_s / np.sqrt(12)
            slope = np.inf
        own = combined(own, self.spread[column])
        return time, own, (1 - share) / slope, share / slope

    def _lasted(self, begin: int, begin_share: float, end: int, end_share: float) -> Figure:
        """Time between two instants, with correlated parts of their uncertainties."""
        t0, own0, steady0, held0 = self._crossing(begin, begin_share)
        t1, own1, steady1, held1 = self._crossing(end, end_share)
        uncertainty = combined(own0, own1, (steady1 - steady0) * self.u_steady, (held1 - held0) * self.u_held)
        return Figure(t1 - t0, uncertainty if np.isfinite(t1 - t0) else float("nan"), "s")

    @cached_property
    def fall_time(self) -> Figure:
        high, low = COLUMNS["high"].start, COLUMNS["low"].start
        return self._lasted(high, self.rules.high, low, self.rules.low)

    def _rise_time(self) -> Figure:
        time, own, steady, held = self._crossing(COLUMNS["low"].start, self.rules.low)
        known = combined(own, steady * self.u_steady, held * self.u_held, self.let_go.time_uncertainty_s)
        return Figure(time - self.let_go.time_s, known, "s")

    def _overshoots(self) -> tuple[Figure, ...]:
        columns = COLUMNS["overshoots"]
        sizes = np.vstack([self.detail[:, columns], self.spread[columns]]).T
        unit = self.record.position_unit
        return tuple(
            Figure(size, combined(self.white * noise, last_term, self.stuck, self.u_steady, spread), unit)
            for size, _, noise, last_term, spread in sizes.tolist()
            if np.isfinite(size)
        )

    def features(self) -> ReleaseFeatures:
        values, unit = self.detail[0], self.record.position_unit
        crossings = range(COLUMNS["crossings"].start, COLUMNS["crossings"].stop, 2)
        cycles = [self._lasted(COLUMNS["high"].start, self.rules.high, crossings[0], 0.0)]
        cycles += [self._lasted(begin, 0.0, other, 0.0) for begin, other in pairwise(crossings)]
        overshoots, band = self._overshoots(), self.rules.residual_band * abs(self.displacement)
        least = sum(overshoot.value - _COVERAGE * overshoot.uncertainty > band for overshoot in overshoots)
        most = sum(overshoot.value + _COVERAGE * overshoot.uncertainty > band for overshoot in overshoots)
        return ReleaseFeatures(
            name=self.record.name,
            release_s=Figure(self.let_go.time_s, self.let_go.time_uncertainty_s, "s"),
            steady=Figure(self.steady, self.u_steady, unit),
            displacement=Figure(self.displacement, combined(self.u_steady, self.u_held), unit),
            fall_time=self.fall_time,
            rise_time=self._rise_time(),
            cycles=tuple(cycle for cycle in cycles if cycle.known),
            overshoots=overshoots,
            overshoot_times_s=_finite(values[COLUMNS["overshoot_times"]]),
            crossing_times_s=_finite(values[COLUMNS["crossings"]]),
            count=int(values[COLUMNS["count"].start]),
            count_range=(least, most),
            settled=self.settled,
            settled_s=float(values[COLUMNS["settled"].start]),
            band=band,
            noise=self.record.position_noise,
            resolution=self.record.position_resolution,
            position_unit=unit,
        )


def _finite(values: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(values[np.isfinite(values)].tolist())
