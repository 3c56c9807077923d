"""Results of a qualification."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import date
from enum import StrEnum

from forcefeel.loader.loader import Loader
from forcefeel.printable import table_html
from forcefeel.qualification import ForcePoints, Outcome, Record, Rules, Verdict
from forcefeel.qualification.plan.input_records import InputRecord
from forcefeel.qualification.plan.plan import RulePlan, RuleTestCase
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.rules import Axis
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.qualification.throw import Throw
from forcefeel.units import UnitSystem

Features = ReleaseFeatures | SweepFeatures


class QualificationStatus(StrEnum):
    """Overall status of all tests, the worst first."""

    DOES_NOT_QUALIFY = "does not qualify"
    """A test failed."""
    INCOMPLETE = "incomplete"
    """No test failed, but some are missing: not evaluated, not requested, or too close to call."""
    QUALIFIES = "qualifies"
    """The test plan is complete, and all evaluated tests passed."""


def worst_status(of: Iterable[QualificationStatus]) -> QualificationStatus:
    """The worst of several statuses."""
    return min(of, key=[*QualificationStatus].index)


@dataclass(frozen=True, eq=False)
class Side:
    """One of the two compared records.

    Attributes:
        record: The recorded or simulated signals; points of force over position where they are the reference.
        features: Measured features; ``None`` for a record that is compared sample by sample.
        slow: Features of the slow sweep with which a medium or fast one is compared.
    """

    record: Record | ForcePoints
    features: Features | None = None
    slow: SweepFeatures | None = None

    @property
    def signals(self) -> Record:
        """The record, where it is not of points."""
        assert isinstance(self.record, Record)  # points are the reference of a static test alone
        return self.record


@dataclass(frozen=True, eq=False)
class Result:
    """The result of a test, evaluated or not.

    Attributes:
        trial: The test.
        outcome: Its outcome.
        verdicts: Verdict on each quantity.
        measured, reference: The compared records; ``None`` where a record is missing.
        reason: Why the test was not evaluated, or failed without a measurement.
        remarks: Further remarks.
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
        name: Name of the law, or ``record``.
        title: Title for sentences.
        results: Results of the tests, in the order of the rule.
        test_plan: The tests to pass.
        law_remark: Remark that the law was designed for another loader, else empty: ``Law.made_for_another``.
    """

    name: str
    title: str
    results: tuple[Result, ...]
    test_plan: RulePlan
    law_remark: str = ""

    @property
    def status(self) -> QualificationStatus:
        """Overall status of its tests."""
        if self.count(Outcome.FAILED):
            return QualificationStatus.DOES_NOT_QUALIFY
        return QualificationStatus.INCOMPLETE if self.missing else QualificationStatus.QUALIFIES

    @property
    def missing(self) -> tuple[tuple[RuleTestCase, ...], ...]:
        """Missing groups of tests; one test of each group is enough."""
        evaluated = {result.trial.key for result in self.results if result.outcome is not Outcome.NOT_EVALUATED}
        undecided = ((result.trial,) for result in self.results if result.outcome is Outcome.TOO_CLOSE)
        return *undecided, *self.test_plan.missing(evaluated)

    @property
    def fulfilled(self) -> bool:
        """Whether it qualifies, or passed all requested tests where only some were requested."""
        passed = self.count(Outcome.PASSED) == len(self.results)
        return self.status is QualificationStatus.QUALIFIES or (bool(self.test_plan.named) and passed)

    def count(self, outcome: Outcome) -> int:
        """Number of tests with that outcome."""
        return sum(result.outcome is outcome for result in self.results)


@dataclass(frozen=True, eq=False)
class Qualification:
    """Result of a qualification.

    Attributes:
        loader: The loader, hands off.
        omitted: Rows of the loader that were omitted, such as the arm at the grip.
        rules: The rule.
        axis: The control.
        throw: Its travel.
        system: Unit system; it also selects the rule's rounding of forces.
        reference: Description of the reference.
        test_plan: The tests to pass.
        sections: One for each law, or one for the record.
        files: Input records by kind and test.
        simulator, operator: Tested simulator and tester; blank lines on the page if empty.
        day: Date.
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
    files: Mapping[str, InputRecord] = field(default_factory=dict)
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
        """The worst status of the sections."""
        return worst_status(section.status for section in self.sections)

    @property
    def qualifies(self) -> bool:
        """Whether every section qualifies."""
        return self.status is QualificationStatus.QUALIFIES

    @property
    def fulfilled(self) -> bool:
        """Whether every section qualifies, or passed all requested tests where only some were requested."""
        return all(section.fulfilled for section in self.sections)
