"""Comparison of the report's law with the best newer law on a loader with a digital controller."""

import shlex
from dataclasses import dataclass
from typing import Annotated

from forcefeel.conclusions import share_text
from forcefeel.units import PERCENT


@dataclass(frozen=True)
class QualificationSummary:
    """Result of the tests of a rule on the loader under a law.

    Attributes:
        qualifies: Whether the test plan is complete and passed.
        status: ``qualifies``, ``does not qualify``, ``incomplete``.
        outcome_counts: Number of tests by outcome.
        reasons: Why it does not qualify, a sentence for each kind of test.
    """

    qualifies: bool
    status: str
    outcome_counts: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class EnvelopeSummary:
    """Programmed feels that the loader renders under a law, as shares of the evaluated settings.

    Attributes:
        stable: Stable with the nominal plant, hands off.
        nominal_share: Within tolerance with the nominal plant.
        worst_case_share: Within tolerance in every case: each part off by its tolerance, each pilot's arm.
    """

    stable: Annotated[float, PERCENT]
    nominal_share: Annotated[float, PERCENT]
    worst_case_share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class LawResult:
    """One law.

    Attributes:
        name: Its name, as ``--law`` takes it.
        summary: A one-line description.
        qualified: Result of its tests; ``None`` if they could not be run.
        rendered: Its envelope; ``None`` if it could not be evaluated.

    Example:
        >>> ff.design.LawResult("published", "the report's", None, None).qualified_text
        'is not tested'
    """

    name: str
    summary: str
    qualified: QualificationSummary | None
    rendered: EnvelopeSummary | None

    @property
    def qualifies(self) -> bool:
        """Whether it qualifies."""
        return self.qualified is not None and self.qualified.qualifies

    @property
    def qualified_text(self) -> str:
        """``qualifies: 7 of 7 tests passed``."""
        if self.qualified is None:
            return "is not tested"
        return f"{'is ' if self.qualified.status == 'incomplete' else ''}{self.qualified.status}: {self.qualified.outcome_counts}"

    @property
    def rendered_text(self) -> str:
        """``renders 95.8 % within tolerance, 37.5 % in every case, and is stable at 100 %``."""
        if self.rendered is None:
            return "is not tried"
        shares = (self.rendered.nominal_share, self.rendered.worst_case_share, self.rendered.stable)
        nominal, worst, stable = map(share_text, shares)
        return f"renders {nominal} within tolerance, {worst} in every case, and is stable at {stable}"


@dataclass(frozen=True)
class LawComparison:
    """The report's law and the best one.

    Attributes:
        report: The report's law; ``None`` for a motor, which cannot take it.
        best: The best eligible law, including the report's; ``None`` if no law is eligible.
        remarks: Reasons for the choice and against the others, one sentence each; that of the chosen law first.
        rule: The rule of the tests.
        settings: Number of evaluated settings of stiffness, frequency and damping ratio.
        impossible: Why the loader cannot be tested or evaluated; empty if it was.
        called: The loader on a command line: its name or file, and options that change it.
    """

    report: LawResult | None
    best: LawResult | None
    remarks: tuple[str, ...]
    rule: str
    settings: int
    impossible: str
    called: tuple[str, ...]

    @property
    def compare_command(self) -> str:
        """The command that tries every law on more settings."""
        return self._command("law", "--law", "auto", "--out", "laws")

    def commands(self, law: LawResult) -> tuple[str, ...]:
        """The commands that qualify a law and compute its envelope, each with a page of its own."""
        folders = ("tests", "map") if law == self.best else (f"tests-{law.name}", f"map-{law.name}")
        verbs = zip(("qualify", "envelope"), folders, strict=True)
        return tuple(self._command(verb, "--law", law.name, "--out", folder) for verb, folder in verbs)

    def _command(self, verb: str, *options: str) -> str:
        return shlex.join(("forcefeel", verb, *self.called, *options))

    @property
    def laws(self) -> tuple[LawResult, ...]:
        """The compared laws, the best first."""
        pair = (self.best, *(() if self.report == self.best else (self.report,)))
        return tuple(law for law in pair if law is not None)
