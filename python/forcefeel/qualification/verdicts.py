"""Verdicts: the difference between a measured quantity and the reference, compared with the tolerance."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Protocol

from forcefeel.errors import InputError
from forcefeel.qualification.figures import Figure
from forcefeel.qualification.rules import Test
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.units import show

COVERAGE = 2.0
"""Standard uncertainties around the limit within which a difference is too close to call."""


class Outcome(StrEnum):
    """Outcome of a comparison."""

    PASSED = "passed"
    FAILED = "failed"
    TOO_CLOSE = "too close to call"
    NOT_EVALUATED = "not evaluated"


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """One quantity against its tolerance.

    Attributes:
        test: Number of the test.
        quantity: Such as ``P1``, ``A2`` or ``force``.
        outcome: Outcome of the comparison.
        measured, reference: The figures; ``None`` where a figure is missing.
        difference: Measured minus reference, in ``unit``; for a curve at its worst point.
        tolerance: Largest difference that passes.
        margin: ``tolerance - |difference|``.
        uncertainty: Standard uncertainty of the difference.
        unit: SI unit; empty for a number.
        reason: Why it was not evaluated, or a remark.
        at: Position or time of a curve's worst point; ``None`` otherwise.
        rule: The tolerance's row.
        verified: Whether that row is verified against the document.
    """

    test: str
    quantity: str
    outcome: Outcome
    measured: Figure | None
    reference: Figure | None
    difference: float = math.nan
    tolerance: float = math.nan
    margin: float = math.nan
    uncertainty: float = math.nan
    unit: str = ""
    reason: str
    at: float | None = None
    rule: Tolerance
    verified: bool


@dataclass(frozen=True)
class Row:
    """The row of a rule's table for a verdict.

    Attributes:
        test: Number of the test.
        rule: The tolerance.
        verified: Whether it is verified against the document.
        coverage: Standard uncertainties around the limit within which a difference is too close to call.
    """

    test: str
    rule: Tolerance
    verified: bool
    coverage: float = COVERAGE

    def decide(
        self,
        quantity: str,
        figures: tuple[Figure, Figure],
        limit: float,
        *,
        at: float | None = None,
        reason: str = "",
    ) -> Verdict:
        """A verdict on a measured figure and the reference; not evaluated if a figure or the limit is unknown."""
        measured, reference = figures
        difference = measured.less(reference)
        unknown = next(
            (name for name, figure in zip(("measured", "reference"), figures, strict=True) if not figure.known), ""
        )
        if unknown or math.isnan(limit):
            return self.not_evaluated(
                quantity, reason or f"the {f'{unknown} figure' if unknown else 'tolerance'} is not known", figures
            )
        margin = limit - abs(difference.value)
        # A difference equal to the limit passes; rounding must not decide.
        rounding = 1e-12 * max(abs(measured.value), abs(reference.value), limit)
        if abs(margin) < self.coverage * difference.uncertainty:
            outcome = Outcome.TOO_CLOSE
        else:
            outcome = Outcome.PASSED if margin >= -rounding else Outcome.FAILED
        return replace(
            self.stated(quantity, outcome, figures, reason),
            difference=difference.value,
            tolerance=limit,
            margin=margin,
            uncertainty=difference.uncertainty,
            unit=difference.unit,
            at=at,
        )

    def not_evaluated(self, quantity: str, reason: str, figures: tuple[Figure, Figure] | None = None) -> Verdict:
        """A verdict of a quantity that was not evaluated, with the reason."""
        known = (figure if figure and figure.known else None for figure in figures or (None, None))
        stated = self.stated(quantity, Outcome.NOT_EVALUATED, (next(known), next(known)), reason)
        return replace(stated, unit=figures[0].unit) if figures else stated

    def stated(
        self, quantity: str, outcome: Outcome, figures: tuple[Figure | None, Figure | None], reason: str
    ) -> Verdict:
        """A verdict with a known outcome, without a comparison of numbers."""
        return Verdict(
            test=self.test,
            quantity=quantity,
            outcome=outcome,
            measured=figures[0],
            reference=figures[1],
            reason=reason,
            rule=self.rule,
            verified=self.verified,
        )


def check_kind(test: Test, *kinds: str) -> None:
    """Refuses a test of another kind.

    Raises:
        InputError: With the kinds that are expected.
    """
    if test.kind not in kinds:
        raise InputError(f"test: expected a {' or '.join(kinds)} test, got {show(test.number)}, a {test.kind} test")


class _Measured(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def position_unit(self) -> str: ...


def check_unit(measured: _Measured, reference: _Measured) -> None:
    """Refuses two records of which one is of an angle and the other of a length.

    Raises:
        InputError: With their names and units.
    """
    if measured.position_unit != reference.position_unit:
        came = f"{measured.name} is in {measured.position_unit}, {reference.name} in {reference.position_unit}"
        raise InputError(f"expected both positions to be angles or both to be lengths; {came}")


def overall(verdicts: Iterable[Verdict]) -> Outcome:
    """Overall outcome: the worst of the verdicts; not evaluated if there are none."""
    outcomes = {verdict.outcome for verdict in verdicts}
    order = (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED, Outcome.PASSED)
    return next((outcome for outcome in order if outcome in outcomes), Outcome.NOT_EVALUATED)
