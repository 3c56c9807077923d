"""The report's law beside the best of those made since, on a loader with a digital controller: what both came to."""

import shlex
from dataclasses import dataclass
from typing import Annotated

from forcefeel.conclusions import share_text
from forcefeel.units import PERCENT


@dataclass(frozen=True)
class QualificationSummary:
    """What the tests of a rule came to on the loader under a law.

    Attributes:
        qualifies: Whether the programme is whole and all of it passed.
        status: ``qualifies``, ``does not qualify``, ``incomplete``.
        outcome_counts: How many tests came to what.
        reasons: Why it does not qualify, a sentence for each kind of test.
    """

    qualifies: bool
    status: str
    outcome_counts: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class EnvelopeSummary:
    """Which programmed feels the loader renders under a law, as shares of the settings that were tried.

    Attributes:
        stable: Stable with the nominal plant, hands off.
        nominal_share: Within tolerance there.
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
        summary: What it is, in a line.
        qualified: What its tests came to; ``None`` where they could not be made.
        rendered: What it renders; ``None`` where it could not be tried.

    Example:
        >>> import forcefeel as ff
        >>> ff.design.LawResult("published", "the report's", None, None).qualified_text
        'is not tested'
    """

    name: str
    summary: str
    qualified: QualificationSummary | None
    rendered: EnvelopeSummary | None

    @property
    def qualifies(self) -> bool:
        """Whether it does."""
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
        best: The best of those that are eligible, the report's among them; ``None`` where none is.
        remarks: Why it is chosen, and why none of the others, a sentence for each; the chosen one's first.
        rule: By which they were tested.
        settings: How many settings of stiffness, frequency and damping ratio were tried.
        impossible: Why the loader cannot be tested or tried; empty where it was.
        called: What a command line calls the loader: its name or file, and options that change it.

    Example:
        >>> import forcefeel as ff
        >>> report = ff.design.LawResult("published", "the report's", None, None)
        >>> tried = ff.design.LawComparison(report, None, (), "", 0, "", ("my.toml",))
        >>> tried.compare_command
        'forcefeel law my.toml --law auto --out laws'
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
        """The laws beside each other: the best first."""
        pair = (self.best, *(() if self.report == self.best else (self.report,)))
        return tuple(law for law in pair if law is not None)
