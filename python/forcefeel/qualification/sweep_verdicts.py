"""Static tests, the alternate method of the dynamic tests, and small inputs: comparison of curves with the reference."""

from collections.abc import Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.figures import Figure, combined
from forcefeel.qualification.records import Record
from forcefeel.qualification.rules import Test
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.qualification.verdicts import COVERAGE, Row, Verdict, check_kind, check_unit
from forcefeel.units import UnitSystem

_COVERED = 0.9
"""Least share of the reference's curve that both curves must cover."""
_SAME_DURATION = 0.2
"""Largest relative difference in duration of two compared sweeps."""
_ENDS = 1.5
"""Steps of the reference by which a record may exceed it."""

_SIDES: tuple[Literal["positive", "negative"], ...] = ("positive", "negative")

_Array = NDArray[np.float64]


def judge_sweep(
    measured: SweepFeatures,
    reference: SweepFeatures,
    test: Test,
    *,
    system: UnitSystem = UnitSystem.US,
    coverage: float = COVERAGE,
) -> tuple[Verdict, ...]:
    """Verdicts on a static sweep: breakout, force in both directions, surface, freeplay; neutral positions are aligned.

    Args:
        measured: Features of the sweep.
        reference: Features of the reference.
        test: A static or a freeplay test of a rule.
        system: Unit system that selects the rule's rounding of forces.
        coverage: Standard uncertainties around the limit within which a difference is too close to call.

    Raises:
        InputError: If one position is an angle and the other a length, or the test is of another kind.

    Example:
        >>> time = np.linspace(0.0, 60.0, 3001)
        >>> angle = 0.3 * np.interp(time, [0, 15, 45, 60], [0.0, 1.0, -1.0, 0.0])
        >>> same = ff.qualification.measure_sweep(ff.qualification.Record(time, angle, 600.0 * angle))
        >>> test = ff.qualification.load_rules().of("static", "pitch")
        >>> sorted({verdict.outcome.value for verdict in ff.qualification.judge_sweep(same, same, test)})
        ['not evaluated', 'passed']
    """
    check_kind(test, "static", "freeplay")
    check_unit(measured, reference)
    verdicts: list[Verdict] = []
    for rule in test.tolerances:
        row = Row(test.number, rule, test.is_verified(rule), coverage)
        if rule.quantity == "breakout":
            for side in _SIDES:
                figures = measured.breakout(side), reference.breakout(side)
                limit = float(rule.limit(figures[1].value, system=system))
                verdicts.append(row.decide(f"breakout, {side}", figures, limit))
        elif rule.quantity == "freeplay":
            figures = measured.freeplay, reference.freeplay
            if measured.position_unit == "m":
                verdicts.append(row.decide("freeplay", figures, float(rule.limit(figures[1].value))))
            else:
                reason = "the tolerance is a length, and the position an angle"
                verdicts.append(row.not_evaluated("freeplay", reason, figures))
        else:
            verdicts.extend(_curves(row, rule, measured, reference, system))
    return tuple(verdicts)


def judge_dynamic_sweep(
    measured: SweepFeatures,
    slow: SweepFeatures,
    reference: SweepFeatures,
    reference_slow: SweepFeatures,
    test: Test,
    *,
    system: UnitSystem = UnitSystem.US,
) -> tuple[Verdict, ...]:
    """Verdicts on a medium or a fast sweep: its force minus that of the slow one, compared with the reference.

    Args:
        measured: The medium or the fast sweep.
        slow: The slow one.
        reference: The reference's sweep of the same duration.
        reference_slow: The reference's slow one.
        test: A dynamic sweep of a rule.
        system: Unit system that selects the rule's rounding of forces.

    Raises:
        InputError: If durations differ by more than a fifth, one position is an angle and another a length, or the test is
            of another kind.
    """
    check_kind(test, "dynamic sweep")
    for first, second in ((measured, reference), (slow, reference_slow), (measured, slow)):
        check_unit(first, second)
    for first, second in ((measured, reference), (slow, reference_slow)):
        if abs(first.duration_s - second.duration_s) > _SAME_DURATION * second.duration_s:
            lasted = f"{first.name} lasts {first.duration_s:.4g} s, {second.name} {second.duration_s:.4g} s"
            raise InputError(f"expected sweeps of the same duration within {100 * _SAME_DURATION:g} %; {lasted}")
    (rule,) = test.tolerances
    row = Row(test.number, rule, test.is_verified(rule))
    verdicts = []
    for direction in ("up", "down"):
        at = reference.position - reference.neutral
        increments, known = [], []
        for sweep, still in ((measured, slow), (reference, reference_slow)):
            increments.append(_curve_at(sweep, direction, at) - _curve_at(still, direction, at))
            known.append(combined(sweep.force_uncertainty_n, still.force_uncertainty_n))
        limit = rule.limit(increments[1], system=system)
        verdicts.append(_worst(row, f"dynamic increment, {direction}", at, increments, known, limit, "N"))
    return tuple(verdicts)


def judge_small_inputs(record: Record, reference: Record, test: Test) -> tuple[Verdict, ...]:
    """Verdict on the body rate after a small input, over time from each record's start.

    The sampling rates may differ: the curves are compared at the samples of both, through cubic splines.

    Args:
        record: Record with a body rate; without it the test is not evaluated.
        reference: The reference's record.
        test: A small-inputs test of a rule.

    Raises:
        InputError: If the reference is shorter than the record, or the test is of another kind.
    """
    check_kind(test, "small inputs")
    (rule,) = test.tolerances
    row = Row(test.number, rule, test.is_verified(rule))
    from scipy.interpolate import CubicSpline  # noqa: PLC0415  only here

    rate, reference_rate = record.body_rate_rad_per_s, reference.body_rate_rad_per_s
    if rate is None or reference_rate is None:
        name = record.name if rate is None else reference.name
        return (row.not_evaluated("body rate", f"{name} has no body rate"),)
    if record.duration_s > reference.duration_s + _ENDS * reference.step_s:
        raise InputError(
            f"{reference.name}: lasts {reference.duration_s:.6g} s, {record.name} {record.duration_s:.6g} s; expected a reference "
            f"that covers the record; cut {record.name} at {record.time_s[0] + reference.duration_s:.6g} s"
        )
    splines = [
        CubicSpline(source.time_s - source.time_s[0], values)
        for source, values in ((record, rate), (reference, reference_rate))
    ]
    time = np.union1d(*(spline.x for spline in splines))
    time = time[time <= min(spline.x[-1] for spline in splines)]
    turns = splines[1].derivative().roots(extrapolate=False)
    peak = np.max(np.abs(splines[1](np.concatenate([time, turns[np.isfinite(turns)]]))))
    limit = rule.limit(np.full_like(time, peak))
    rates = [np.asarray(spline(time)) for spline in splines]
    return (_worst(row, "body rate", time, rates, [0.0, 0.0], limit, "rad/s"),)


def _curves(
    row: Row, rule: Tolerance, measured: SweepFeatures, reference: SweepFeatures, system: UnitSystem
) -> Iterator[Verdict]:
    surface = rule.quantity == "surface"
    if surface and (measured.surface_up_rad is None or reference.surface_up_rad is None):
        name = measured.name if measured.surface_up_rad is None else reference.name
        yield row.not_evaluated(str(rule.surface), f"{name} has no surface position")
        return
    at = reference.position - reference.neutral
    for direction in ("up", "down"):
        both = [_curve_at(sweep, direction, at, surface=surface) for sweep in (measured, reference)]
        known = [0.0, 0.0] if surface else [measured.force_uncertainty_n, reference.force_uncertainty_n]
        limit = rule.limit(both[1], system=system)
        name = f"{rule.surface if surface else rule.quantity}, {direction}"
        yield _worst(row, name, at, both, known, limit, "rad" if surface else "N")


def _curve_at(sweep: SweepFeatures, direction: str, at: _Array, *, surface: bool = False) -> _Array:
    """A curve of a sweep at distances from neutral; NaN beyond its ends."""
    curves = {
        ("up", False): sweep.force_up_n,
        ("down", False): sweep.force_down_n,
        ("up", True): sweep.surface_up_rad,
        ("down", True): sweep.surface_down_rad,
    }
    curve, x = curves[direction, surface], sweep.position - sweep.neutral
    rounding = 1e-9 * (x[-1] - x[0])
    if curve is None:
        return np.full_like(at, np.nan)
    inside = (at >= x[0] - rounding) & (at <= x[-1] + rounding)
    return np.where(inside, np.interp(at, x, curve), np.nan)


def _worst(
    row: Row, name: str, at: _Array, curves: list[_Array], known: list[float], limit: _Array, unit: str
) -> Verdict:
    """The verdict at the point of the largest difference relative to the limit."""
    measured, reference = curves
    required, known_in_both = np.isfinite(reference), np.isfinite(measured) & np.isfinite(reference)
    if not required.any() or known_in_both.sum() < _COVERED * required.sum():
        share = 100 * known_in_both.sum() / max(int(required.sum()), 1)
        return row.not_evaluated(name, f"the curves overlap over {share:.3g} % of the reference's")
    ratio = np.where(known_in_both, np.abs(measured - reference) / limit, -np.inf)
    worst = int(np.argmax(ratio))
    figures = Figure(float(measured[worst]), known[0], unit), Figure(float(reference[worst]), known[1], unit)
    return row.decide(name, figures, float(limit[worst]), at=float(at[worst]))
