"""What a qualification came to."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import date

from forcefeel.loader import Loader
from forcefeel.qualification import Outcome, Record, ReleaseFeatures, Rules, SweepFeatures, Verdict
from forcefeel.qualification.rules import Axis
from forcefeel.qualify.given import Given
from forcefeel.qualify.programme import Trial
from forcefeel.qualify.throw import Throw
from forcefeel.units import UnitSystem

Features = ReleaseFeatures | SweepFeatures


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

    trial: Trial
    outcome: Outcome
    verdicts: tuple[Verdict, ...] = ()
    measured: Side | None = None
    reference: Side | None = None
    reason: str = ""
    remarks: tuple[str, ...] = ()

    @property
    def verified(self) -> bool:
        """Whether a person has held every tolerance that it was judged by against the document."""
        return all(self.trial.test.is_verified(one) for one in self.trial.test.tolerances)


@dataclass(frozen=True, eq=False)
class Section:
    """All tests of one law, or of the recorded simulator.

    Attributes:
        name: Of the law; ``record``.
        title: In words.
        results: In the order of the rule.
    """

    name: str
    title: str
    results: tuple[Result, ...]

    @property
    def outcome(self) -> Outcome:
        """The worst that its tests came to."""
        return worst(result.outcome for result in self.results)

    def count(self, outcome: Outcome) -> int:
        """How many tests came to that."""
        return sum(result.outcome is outcome for result in self.results)


@dataclass(frozen=True, eq=False)
class Qualification:
    """The whole.

    Attributes:
        loader: The loader, hands off.
        left_out: Rows of the loader that were left out, as the arm at the grip.
        rules: By which it was judged.
        axis: Which control.
        throw: How far it goes.
        system: Units; of the rule's two roundings of a force, that one holds.
        reference: What was the reference, in words.
        sections: One for each law, or one for the record.
        files: Files that were read, by what they were given as.
        day: When.
    """

    loader: Loader
    left_out: tuple[str, ...]
    rules: Rules
    axis: Axis
    throw: Throw
    system: UnitSystem
    reference: str
    sections: tuple[Section, ...]
    files: Mapping[str, Given] = field(default_factory=dict)
    day: date = field(default_factory=date.today)

    @property
    def outcome(self) -> Outcome:
        """The worst of the sections'."""
        return worst(section.outcome for section in self.sections)

    @property
    def qualifies(self) -> bool:
        """Whether something was evaluated, and all of that passed."""
        return self.outcome is Outcome.PASSED


def worst(outcomes: Iterable[Outcome]) -> Outcome:
    """Of several tests: failed, too close to call, passed, and not evaluated only if nothing was."""
    found = set(outcomes)
    order = (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.PASSED)
    return next((outcome for outcome in order if outcome in found), Outcome.NOT_EVALUATED)
