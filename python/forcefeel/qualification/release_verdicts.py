"""The dynamic tests: comparison of a release with the reference, by quantity."""

from collections.abc import Iterator
from typing import Literal

from forcefeel.errors import InputError
from forcefeel.qualification.figures import Figure
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.rules import Test
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.qualification.verdicts import COVERAGE, Outcome, Row, Verdict, check_kind, check_unit
from forcefeel.units import UnitSystem

Overdamped = Literal["fall time", "rise time"]
"""Quantity compared for a response without overshoots: time from 0.9 to 0.1 Ad, or to 90 % of the steady value."""


def judge_release(
    measured: ReleaseFeatures,
    reference: ReleaseFeatures,
    test: Test,
    *,
    travel: float | None = None,
    overdamped: Overdamped = "fall time",
    system: UnitSystem = UnitSystem.US,
    coverage: float = COVERAGE,
) -> tuple[Verdict, ...]:
    """Verdicts on a release; all quantities are relative to each record's own steady state.

    The reference determines the compared quantities:

    - It overshoots by more than the residual band: P0; the full cycles that end at an overshoot above the band and whose
      tolerance is below the cycle itself; every overshoot above the band, up to the sixteenth.
    - It does not: fall time or rise time, as ``overdamped`` selects.
    - In both cases: number of overshoots, and displacement from the held position to the steady state.

    Args:
        measured: Features of the record.
        reference: Features of the reference.
        test: A release test of a rule.
        travel: Total travel of the control, in the position's unit, where a tolerance is a share of it.
        overdamped: Quantity compared where the reference has no overshoot.
        system: Unit system that selects the rule's rounding of forces.
        coverage: Standard uncertainties around the limit within which a difference is too close to call.

    Raises:
        InputError: If the records differ in unit or direction, or the test is not a release test.

    Example:
        >>> time = np.arange(0, 8, 1 / 60)
        >>> let_go = np.maximum(time - 0.5, 0)
        >>> position = 0.2 * np.exp(-2.5 * let_go) * (np.cos(12 * let_go) + 0.2 * np.sin(12 * let_go))
        >>> same = ff.qualification.measure_release(ff.qualification.Record(time, position))
        >>> test = ff.qualification.load_rules().of("release", "pitch")
        >>> sorted({verdict.outcome.value for verdict in ff.qualification.judge_release(same, same, test)})
        ['passed']
    """
    check_kind(test, "release")
    check_same_way(measured, reference)
    return tuple(_Judging(measured, reference, test, travel, system, coverage).verdicts(overdamped))


def check_same_way(measured: ReleaseFeatures, reference: ReleaseFeatures) -> None:
    """Refuses two releases that cannot be compared.

    Raises:
        InputError: If one is an angle and the other a length, or they are released on opposite sides.
    """
    check_unit(measured, reference)
    if measured.displacement.value * reference.displacement.value < 0:
        sides = " and ".join(
            f"{features.name} at {features.release_s.value:.6g} s from {features.displacement.value:+.4g} {features.position_unit}"
            for features in (measured, reference)
        )
        raise InputError(f"expected releases from the same side of the steady state, got {sides}; give the other one")


class _Judging:
    def __init__(
        self,
        measured: ReleaseFeatures,
        reference: ReleaseFeatures,
        test: Test,
        travel: float | None,
        system: UnitSystem,
        coverage: float,
    ) -> None:
        self.measured, self.reference, self.test = measured, reference, test
        self.travel, self.system, self.coverage = travel, system, coverage

    def verdicts(self, overdamped: Overdamped) -> Iterator[Verdict]:
        swings = self.reference.underdamped
        for rule in self.test.tolerances:
            if not (self.measured.settled and self.reference.settled):
                name = self.measured.name if not self.measured.settled else self.reference.name
                yield self._row(rule).not_evaluated(rule.quantity, f"{name} does not come to rest")
                continue
            match rule.quantity:
                case "P0" | "Pn" | "A1" | "An" | "first overshoot" if not swings:
                    continue
                case "fall time" | "rise time" if swings or rule.quantity != overdamped:
                    continue
                case "P0":
                    yield self._cycle(rule, 0)
                case "Pn":
                    whole = (n for n in range(1, self.reference.count // 2 + 1) if rule.limit(1.0, n=n) < 1)
                    yield from (self._cycle(rule, n) for n in whole)
                case "A1" | "An":
                    yield from self._overshoots(rule)
                case "first overshoot":
                    yield self._first(rule)
                case "overshoots":
                    yield self._number(rule)
                case "steady state" | "Ad":
                    yield self._compared(rule, self.measured.displacement, self.reference.displacement)
                case "fall time":
                    yield self._compared(rule, self.measured.fall_time, self.reference.fall_time)
                case "rise time":
                    yield self._compared(rule, self.measured.rise_time, self.reference.rise_time)

    def _row(self, rule: Tolerance) -> Row:
        return Row(self.test.number, rule, self.test.is_verified(rule), self.coverage)

    def _limit(self, rule: Tolerance, itself: Figure, n: int = 0) -> float:
        scales = {"A1": self.reference.overshoots[:1], "Amax": self.reference.overshoots}
        sizes = scales.get(
            rule.relative_to or "", (self.reference.displacement,) if rule.relative_to == "Ad" else (itself,)
        )
        scale = max(abs(size.value) for size in sizes)
        return float(rule.limit(scale, n=n, system=self.system, travel=self.travel))

    def _compared(self, rule: Tolerance, measured: Figure, reference: Figure) -> Verdict:
        return self._row(rule).decide(rule.quantity, (measured, reference), self._limit(rule, reference))

    def _cycle(self, rule: Tolerance, n: int) -> Verdict:
        row, name, reference_cycles = self._row(rule), f"P{n}", self.reference.cycles
        if n >= len(reference_cycles):
            return row.not_evaluated(name, f"{self.reference.name} has too few zero crossings")
        if n >= len(self.measured.cycles):
            none = Figure(float("nan"), float("nan"), "s")
            return row.stated(
                name, Outcome.FAILED, (none, reference_cycles[n]), f"{self.measured.name} has no such cycle"
            )
        return row.decide(
            name, (self.measured.cycles[n], reference_cycles[n]), self._limit(rule, reference_cycles[n], n)
        )

    def _overshoots(self, rule: Tolerance) -> Iterator[Verdict]:
        kept = self.reference.overshoots[: self.reference.count]
        first_apart = self.test.tolerance("A1") is not None
        for k, reference in enumerate(kept):
            if first_apart and (k == 0) is not (rule.quantity == "A1"):
                continue
            known, fades = k < len(self.measured.overshoots), ""
            # An overshoot that was not sought any more is far within the residual band.
            measured = (
                self.measured.overshoots[k] if known else Figure(0.0, self.measured.steady.uncertainty, reference.unit)
            )
            if not known:
                fades = f"{self.measured.name} has faded by then"
            yield self._row(rule).decide(f"A{k + 1}", (measured, reference), self._limit(rule, reference), reason=fades)

    def _first(self, rule: Tolerance) -> Verdict:
        measured, reference = self.measured, self.reference
        none = Figure(0.0, measured.steady.uncertainty, measured.position_unit)
        figures = (measured.overshoots[0] if measured.overshoots else none, reference.overshoots[0])
        if measured.count_range[0] > 0:
            return self._row(rule).stated(rule.quantity, Outcome.PASSED, figures, "")
        sure = measured.count_range[1] == 0 and reference.count_range[0] > 0
        outcome = Outcome.FAILED if sure else Outcome.TOO_CLOSE
        reason = "no overshoot above the residual band" if sure else "at the edge of the residual band"
        return self._row(rule).stated(rule.quantity, outcome, figures, reason)

    def _number(self, rule: Tolerance) -> Verdict:
        (least, most), (fewest, greatest) = self.measured.count_range, self.reference.count_range
        figures = Figure(self.measured.count, 0.0, ""), Figure(self.reference.count, 0.0, "")
        limit = float(rule.limit(1.0))
        row = self._row(rule)
        verdict = row.decide(rule.quantity, figures, limit)
        extremes = {abs(count - other) <= limit for count in (least, most) for other in (fewest, greatest)}
        if len(extremes) == 1:
            return verdict
        reason = "an overshoot is at the edge of the residual band"
        return row.stated(rule.quantity, Outcome.TOO_CLOSE, figures, reason)
