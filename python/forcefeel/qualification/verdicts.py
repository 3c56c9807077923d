"""Verdicts: how far a measured quantity is from the reference's, against the tolerance."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from forcefeel.qualification.figures import Figure
from forcefeel.qualification.tolerance import Tolerance

COVERAGE = 2.0
"""Standard uncertainties within which of its limit a difference is too close to it to be called."""


class Outcome(StrEnum):
    """What a comparison came to.

    Example:
        >>> import forcefeel as ff
        >>> [outcome.value for outcome in ff.qualification.Outcome]
        ['passed', 'failed', 'too close to call', 'not evaluated']
    """

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
        outcome: What it came to.
        measured, reference: The figures; ``None`` where there is none.
        difference: Measured less reference, in ``unit``; of a curve where it comes closest to its limit, or beyond it most.
        tolerance: Largest difference that passes.
        margin: ``tolerance - |difference|``.
        uncertainty: Standard uncertainty of the difference.
        unit: SI unit; empty for a number.
        reason: Why it was not evaluated, or what else there is to know.
        at: Position or time of a curve's worst point; ``None`` otherwise.
        rule: The tolerance's row.
        verified: Whether a person has held that row against the document.

    Example:
        >>> import forcefeel as ff
        >>> setup = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> result = ff.qualify_loader(ff.elevator(), setup).sections[0].results[0]
        >>> result.verdicts[0].outcome.value
        'failed'
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
    """The row of a table that a verdict is made by.

    Attributes:
        test: Number of the test.
        rule: The tolerance.
        verified: Whether a person has held it against the document.
        coverage: Standard uncertainties within which a difference is too close to its limit.
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
        """A verdict on a measured figure and the reference's; not evaluated if one or the limit is not known."""
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
        # A limit that was reached to the last digit is kept; what rounding adds decides nothing.
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
        """A verdict that there is none, and why."""
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
        """A verdict on whether something is there."""
        measured, reference = figures
        nan = math.nan
        return Verdict(
            self.test, quantity, outcome, measured, reference, nan, nan, nan, nan, "", reason, None, self.rule, self.verified
        )  # fmt: skip


def overall(verdicts: Iterable[Verdict]) -> Outcome:
    """Of several: failed if one failed, else too close to call if one is; passed only if there are some, and all passed."""
    outcomes = {verdict.outcome for verdict in verdicts}
    order = (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED, Outcome.PASSED)
    return next((outcome for outcome in order if outcome in outcomes), Outcome.NOT_EVALUATED)
