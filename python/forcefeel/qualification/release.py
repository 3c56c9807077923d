"""A free response: the control is held, let go, and comes to rest.

Ad initial displacement · P0 time from 0.9 Ad to the first zero crossing · P1, P2, ... the full cycles after it ·
A1, A2, ... overshoots

A figure's uncertainty comes from the position's noise and resolution around its instant, from what another polynomial says
there, and from how well the steady state and the held position are known: an instant at the level
``L = s + share (x_0 - s)`` is known to ``u(x - L) / |x'|``.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.qualification.figures import Figure, combined
from forcefeel.qualification.let_go import LetGo, check_clipping, check_rate, find_release
from forcefeel.qualification.records import PositionUnit, Record
from forcefeel.qualification.release_columns import COLUMNS
from forcefeel.qualification.release_part import release_part
from forcefeel.qualification.rules import ReleaseRules, load_rules

REST = 3.0
"""A control has come to rest when it has stayed in the residual band for so many times its way from 0.9 to 0.1 Ad: half a
period and more of any column that still swings."""

_REACH = 0.35
"""Share of the way from 0.9 to 0.1 Ad over which noise is smoothed, to each side: 0.06 of a period of a column that swings."""
_QUIET = 1e-7
"""Noise, as a share of Ad, below which nothing is smoothed."""
_WIDER = 3.5
"""Steps over which a record without noise is fitted a second time."""
_PASSED = 4.0
"""Standard deviations of the noise beyond zero at which the control has passed it."""
_COVERAGE = 2.0
"""Standard uncertainties within which an overshoot may be on either side of the residual band."""


@dataclass(frozen=True, eq=False)
class ReleaseFeatures:
    """What the dynamic tests compare.

    Attributes:
        name: Of the record.
        release_s: When it was let go.
        steady: Where it came to rest.
        displacement: Ad with its sign: held position less steady state.
        fall_time: From 0.9 Ad to 0.1 Ad.
        rise_time: From the release to 90 % of the steady value.
        cycles: P0, P1, P2, ..., as far as they are there.
        overshoots: A1, A2, ..., sizes, also those within the residual band.
        overshoot_times_s, crossing_times_s: When they are.
        count: Overshoots above the residual band.
        count_range: Least and largest count that the uncertainties leave open.
        settled: Whether it came to rest.
        settled_s: When it entered the residual band for good.
        band: Residual band, in the position's unit.
        noise, resolution: Of the position, in its unit.
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
        """Whether it overshoots by more than the residual band: what does not is judged by its way back."""
        return self.count > 0

    def aligned(self, record: Record) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Time from the release, s, and position from the steady state as a share of Ad, for plots over each other."""
        return record.time_s - self.release_s.value, (record.position - self.steady.value) / self.displacement.value


def measure_release(
    record: Record, *, rules: ReleaseRules | None = None, tail: float = 0.1, settle_check: bool = True
) -> ReleaseFeatures:
    """The features of a release.

    Args:
        record: Held, let go and at rest again; 50 samples a second at least. The first sample may be the release, and the way to
            the held position may stand before it.
        rules: Residual band and shares of Ad; those of the default edition if left out.
        tail: Share of the record after the release, at its end, over which the steady state is the mean.
        settle_check: Refuse a record that does not come to rest; else measure whatever is there, ``settled`` says it.

    Raises:
        InputError: With the record's name and a time: too few samples a second, no release or more than one,
            clipped, ends before its first zero crossing or before it rests.

    Example:
        >>> import forcefeel as ff
        >>> import numpy as np
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
    """A record as the kernel measured it."""

    def __init__(self, record: Record, let_go: LetGo, rules: ReleaseRules) -> None:
        self.record, self.let_go, self.rules = record, let_go, rules
        resolution = record.position_resolution / np.sqrt(12)
        noise = record.position_noise
        self.white = combined(noise, resolution)
        # Noise of half a step carries a mean below the step; without it a step is off for all samples alike.
        self.stuck = resolution if noise < 0.5 * record.position_resolution else 0.0
        rough = self._kernel(0.0)
        fall_time = float(rough[0, COLUMNS["low"].start] - rough[0, COLUMNS["high"].start])
        quiet = self.white < _QUIET * abs(let_go.displacement)
        self.detail = rough if quiet or not fall_time > 0 else self._kernel(_REACH * fall_time)
        # What six samples say and what more of them say differs by what a polynomial cannot follow.
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
        """A sentence with the record and the time at which it ends."""
        end, release = float(self.record.time_s[-1]), self.let_go.time_s
        # Any record crosses the mean of its own tail.
        crossed = self.detail[0, COLUMNS["crossings"].start] < self.record.time_s[-self.let_go.tail]
        what = "before it comes to rest" if crossed else "before its first zero crossing and before it comes to rest"
        return (
            f"{self.record.name}: ends at {end:.6g} s, {end - release:.4g} s after the release, {what}; expected it to "
            f"stay within {100 * self.rules.residual_band:g} % of the initial displacement around its steady state for "
            f"{REST:g} times its way from {self.rules.high:g} Ad to {self.rules.low:g} Ad, at the end; record for longer"
        )

    def _at(self, column: int, share: float) -> tuple[float, float, float, float]:
        """An instant at ``share`` of Ad: its time, what is its own in its uncertainty, and per steady state and held position."""
        time, slope, noise, last_term = self.detail[:, column].tolist()
        own = combined(self.white * noise, last_term, self.stuck) / abs(slope)
        if not np.isfinite(own):  # a straight line between two samples that is no polynomial's
            own = self.record.step_s / np.sqrt(12)
            slope = np.inf
        own = combined(own, self.spread[column])
        return time, own, (1 - share) / slope, share / slope

    def _lasted(self, begin: int, begin_share: float, end: int, end_share: float) -> Figure:
        """The time from one instant to another; what is common to both is so in its uncertainty."""
        t0, own0, steady0, held0 = self._at(begin, begin_share)
        t1, own1, steady1, held1 = self._at(end, end_share)
        uncertainty = combined(own0, own1, (steady1 - steady0) * self.u_steady, (held1 - held0) * self.u_held)
        return Figure(t1 - t0, uncertainty if np.isfinite(t1 - t0) else float("nan"), "s")

    @cached_property
    def fall_time(self) -> Figure:
        high, low = COLUMNS["high"].start, COLUMNS["low"].start
        return self._lasted(high, self.rules.high, low, self.rules.low)

    def _rise_time(self) -> Figure:
        time, own, steady, held = self._at(COLUMNS["low"].start, self.rules.low)
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
