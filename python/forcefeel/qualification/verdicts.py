"""Verdicts: the difference between a measured quantity and the reference, compared with the tolerance."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from forcefeel.qualification.figures import Figure
from forcefeel.qualification.tolerance import Tolerance

COVERAGE = 2.0
"""Standard uncertainties around the limit within which a difference is too close to call."""


class Outcome(StrEnum):
    """Outcome of a comparison."""

    PASSED = "passed"
    FAILED = "failed"
    TOO_CLOSE = "too close to call"
    NOT_EVALUATED = "not evaluated"


@dataclass(frozen=True)
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
    difference: float
    tolerance: float
    margin: float
    uncertainty: float
    unit: str
    reason: str
    at: float | None
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
        return Verdict(
            self.test,
            quantity,
            outcome,
            measured,
            reference,
            difference.value,
            limit,
            margin,
            difference.uncertainty,
            difference.unit,
            reason,
            at,
            self.rule,
            self.verified,
        )

    def not_evaluated(self, quantity: str, reason: str, figures: tuple[Figure, Figure] | None = None) -> Verdict:
        """A verdict of a quantity that was not evaluated, with the reason."""
        measured, reference = (figure if figure.known else None for figure in figures) if figures else (None, None)
        nan, unit = math.nan, figures[0].unit if figures else ""
        outcome = Outcome.NOT_EVALUATED
        return Verdict(
            self.test,
            quantity,
            outcome,
            measured,
            reference,
            nan,
            nan,
            nan,
            nan,
            unit,
            reason,
            None,
            self.rule,
            self.verified,
        )

    def stated(self, quantity: str, outcome: Outcome, figures: tuple[Figure, Figure], reason: str) -> Verdict:
        """A verdict with a known outcome, without a comparison of numbers."""
        measured, reference = figures
        nan = math.nan
        return Verdict(
            self.test, quantity, outcome, measured, reference, nan, nan, nan, nan, "", reason, None, self.rule, self.verified
        )  # fmt: skip


def overall(verdicts: Iterable[Verdict]) -> Outcome:
    """Overall outcome: the worst of the verdicts; not evaluated if there are none."""
    outcomes = {verdict.outcome for verdict in verdicts}
    order = (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED, Outcome.PASSED)
    return next((outcome for outcome in order if outcome in outcomes), Outcome.NOT_EVALUATED)
