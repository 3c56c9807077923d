"""What a qualification came to."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import date
from enum import StrEnum

from forcefeel.loader.loader import Loader
from forcefeel.printable import table_html
from forcefeel.qualification import Outcome, Record, Rules, Verdict
from forcefeel.qualification.plan.plan import RulePlan, RuleTestCase
from forcefeel.qualification.plan.records_given import Given
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.rules import Axis
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.qualification.throw import Throw
from forcefeel.units import UnitSystem

Features = ReleaseFeatures | SweepFeatures


class QualificationStatus(StrEnum):
    """What all tests together come to, the worst first."""

    DOES_NOT_QUALIFY = "does not qualify"
    """A test failed."""
    INCOMPLETE = "incomplete"
    """None failed, but some of the programme are missing: not evaluated, not asked for, or too close to call."""
    QUALIFIES = "qualifies"
    """The programme is whole, and all that was evaluated passed."""


def worst_status(of: Iterable[QualificationStatus]) -> QualificationStatus:
    """What several come to together."""
    return min(of, key=[*QualificationStatus].index)


@dataclass(frozen=True, eq=False)
class Side:
    """One of the two that are compared.

    Attributes:
        record: What was recorded or simulated.
        features: What was measured on it; ``None`` of a record that is compared sample by sample.
        slow: Features of the slow sweep that a medium or fast one is held against.
    """

    record: Record
    features: Features | None = None
    slow: SweepFeatures | None = None


@dataclass(frozen=True, eq=False)
class Result:
    """A test that was made, or could not be.

    Attributes:
        trial: Which.
        outcome: What it came to.
        verdicts: Of each quantity.
        measured, reference: What was compared; ``None`` where there is none.
        reason: Why it was not evaluated, or failed without being measured.
        remarks: What else a reader must know.
    """

    trial: RuleTestCase
    outcome: Outcome
    verdicts: tuple[Verdict, ...] = ()
    measured: Side | None = None
    reference: Side | None = None
    reason: str = ""
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Section:
    """All tests of one law, or of the recorded simulator.

    Attributes:
        name: Of the law; ``record``.
        title: In words.
        results: Of the tests that were made, in the order of the rule.
        test_plan: The tests that it has to pass.
        law_remark: That the law was made for another loader; empty where it was not: ``Law.made_for_another``.
    """

    name: str
    title: str
    results: tuple[Result, ...]
    test_plan: RulePlan
    law_remark: str = ""

    @property
    def status(self) -> QualificationStatus:
        """What its tests come to."""
        if self.count(Outcome.FAILED):
            return QualificationStatus.DOES_NOT_QUALIFY
        return QualificationStatus.INCOMPLETE if self.missing else QualificationStatus.QUALIFIES

    @property
    def missing(self) -> tuple[tuple[RuleTestCase, ...], ...]:
        """What a whole programme lacks: of each group one test will do."""
        evaluated = {result.trial.key for result in self.results if result.outcome is not Outcome.NOT_EVALUATED}
        undecided = ((result.trial,) for result in self.results if result.outcome is Outcome.TOO_CLOSE)
        return *undecided, *self.test_plan.missing(evaluated)

    @property
    def fulfilled(self) -> bool:
        """Whether it qualifies, or passed every test where only some were asked for."""
        passed = self.count(Outcome.PASSED) == len(self.results)
        return self.status is QualificationStatus.QUALIFIES or (bool(self.test_plan.named) and passed)

    def count(self, outcome: Outcome) -> int:
        """How many tests came to that."""
        return sum(result.outcome is outcome for result in self.results)


@dataclass(frozen=True, eq=False)
class Qualification:
    """The whole.

    Attributes:
        loader: The loader, hands off.
        omitted: Rows of the loader that were left out, as the arm at the grip.
        rules: By which it was judged.
        axis: Which control.
        throw: How far it goes.
        system: Units; of the rule's two roundings of a force, that one holds.
        reference: What was the reference, in words.
        test_plan: The tests to pass.
        sections: One for each law, or one for the record.
        files: Files that were read, by what they were given as.
        simulator, operator: Which was tested, and by whom; blank lines of the page where nobody says.
        day: When.

    Example:
        >>> import forcefeel as ff
        >>> setup = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> ff.qualify_loader(ff.elevator(), setup).qualifies
        False
    """

    loader: Loader
    omitted: tuple[str, ...]
    rules: Rules
    axis: Axis
    throw: Throw
    system: UnitSystem
    reference: str
    test_plan: RulePlan
    sections: tuple[Section, ...]
    files: Mapping[str, Given] = field(default_factory=dict)
    simulator: str = ""
    operator: str = ""
    day: date = field(default_factory=date.today)

    def __repr__(self) -> str:
        each = "; ".join(
            f"{section.title} {section.status}, {section.count(Outcome.PASSED)} of {len(section.results)} tests passed"
            for section in self.sections
        )
        return f"<Qualification of {self.loader.name!r}, {self.axis}, by {self.rules.id}: {each}>"

    def _repr_html_(self) -> str:
        rows = ((section.title, section.status, *map(section.count, Outcome)) for section in self.sections)
        return table_html(f"{self.loader.name}, {self.axis}, {self.rules.id}", ("", "status", *map(str, Outcome)), rows)

    @property
    def status(self) -> QualificationStatus:
        """The worst of the sections'."""
        return worst_status(section.status for section in self.sections)

    @property
    def qualifies(self) -> bool:
        """Whether every section does."""
        return self.status is QualificationStatus.QUALIFIES

    @property
    def fulfilled(self) -> bool:
        """Whether every section qualifies, or passed every test where only some were asked for."""
        return all(section.fulfilled for section in self.sections)
