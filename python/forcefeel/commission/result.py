"""What a commissioning came to, step by step; each step's outcome goes to a file and comes back from it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from forcefeel.commission.plan import CommissionPlan
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader

IDENTIFIED, CARRIED, UNSEEN = "identified", "within the others", "not seen"
AT_END, NOTHING = "at the end of its range", "none"
"""What became of a parameter."""


@dataclass(frozen=True)
class ParameterFound:
    """One parameter of the plant.

    Attributes:
        key: Its row.
        before: What the file says, SI units.
        value: What holds from here on.
        error: Standard error as a share of the value; 0 where it is not identified.
        state: ``IDENTIFIED``; ``CARRIED`` of one whose share in the data the identified ones carry; ``AT_END`` of one whose value
            in the file is the last that its row allows, and that the data would have there or beyond; ``NOTHING`` of a friction
            that is within its errors of none; ``UNSEEN`` of one that keeps the file's value and tolerance.
    """

    key: str
    before: float
    value: float
    error: float
    state: str


@dataclass(frozen=True)
class Curve:
    """One channel of the bench data beside the models, SI units; of a long record a stretch.

    Attributes:
        data: Name of the record or the response.
        channel: The channel.
        response: Whether it is a frequency response; else a record in time.
        at: Frequencies in Hz, or times in s.
        measured: Values of a record; of a response gain and phase in rad, one after the other.
        modelled: The same of the identified model.
        before: The same of the loader file's model.
    """

    data: str
    channel: str
    response: bool
    at: tuple[float, ...]
    measured: tuple[tuple[float, ...], ...]
    modelled: tuple[tuple[float, ...], ...]
    before: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Identified:
    """What the data determine.

    Attributes:
        good: Whether a loader file was written that a law may be designed for.
        verdict: In a sentence.
        findings: More.
        parameters: Each parameter of the plant.
        wanting: What is needed and not determined or not stated, a sentence each; empty if nothing.
        advice: The next experiment, a sentence each.
        noticed: What else the records show, a sentence each: nothing that forbids a law.
        curve: The data beside the identified model; ``None`` if there is no model.
    """

    good: bool
    verdict: str
    findings: tuple[str, ...] = ()
    parameters: tuple[ParameterFound, ...] = ()
    wanting: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()
    noticed: tuple[str, ...] = ()
    curve: Curve | None = None


@dataclass(frozen=True)
class LawChosen:
    """The law.

    Attributes:
        name: Which design; empty if none is eligible.
        verdict: Why, in a sentence.
        findings: Why not the others.
    """

    name: str
    verdict: str
    findings: tuple[str, ...] = ()


@dataclass(frozen=True)
class WhatIf:
    """What another machine would render, under the law of the same design made for it.

    Attributes:
        change: What is otherwise.
        passes: Share of the settings, spaced in proportion, nominal.
    """

    change: str
    passes: float


@dataclass(frozen=True)
class OutcomeMap:
    """The outcome of each setting under the law.

    Attributes:
        stiffness: Shares of ``G_max``.
        frequency: Natural frequencies in rad/s.
        damping: Damping ratios.
        kinds: Positions in ``envelope.result.COLORS``, by damping ratio, frequency and stiffness.
    """

    stiffness: tuple[float, ...]
    frequency: tuple[float, ...]
    damping: tuple[float, ...]
    kinds: tuple[tuple[tuple[int, ...], ...], ...]


@dataclass(frozen=True)
class Checked:
    """The law in the envelope.

    Attributes:
        settings: How many settings.
        passes: Share of them, spaced in proportion, that the identified loader renders.
        every_case: The same in every case: each parameter at its tolerance's ends, each arm.
        machines: How many machines were drawn from all tolerances at once.
        drawn: Share of the settings that one of them renders, on average.
        drawn_least: That of the worst of them.
        findings: What fails, and in which case.
        what_ifs: What would render more, what asks least of the machine first; empty where the asked share is reached.
        outcomes: The map of the settings.
    """

    settings: int
    passes: float
    every_case: float
    machines: int
    drawn: float
    drawn_least: float
    findings: tuple[str, ...] = ()
    what_ifs: tuple[WhatIf, ...] = ()
    outcomes: OutcomeMap | None = None


@dataclass(frozen=True)
class RuleTests:
    """The rule's tests.

    Attributes:
        fulfilled: Whether all that the rule asks of a loader pass.
        rule: The rule and its edition.
        verdict: What they came to.
        outcomes: Of each test by its name.
        reasons: Why not, of a release and of a sweep.
        findings: What else a reader must know.
    """

    fulfilled: bool
    rule: str
    verdict: str
    outcomes: Mapping[str, str] = field(default_factory=dict)
    reasons: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Commission:
    """A loader that was set up, or how far it came.

    Attributes:
        plan: What was asked.
        before: The loader as its file has it.
        identified: What the data determine.
        loader: The loader as identified; ``None`` where the data do not do.
        chosen: The law and why; ``None`` where no loader is.
        law: The law itself, for the loader's own setting and those of the grid; ``None`` where none is eligible.
        checked: What it renders; ``None`` where there is none.
        tested: What the rule's tests came to.
        folders: Folder of each step that was made, within the whole one.
        resumed: Steps that an earlier run had done.

    Example:
        >>> import forcefeel as ff
        >>> from forcefeel.commission.result import Identified
        >>> plan = ff.commission.CommissionPlan()
        >>> ff.commission.Commission(plan, ff.elevator(), Identified(False, "nothing was measured")).good
        False
    """

    plan: CommissionPlan
    before: Loader
    identified: Identified
    loader: Loader | None = None
    chosen: LawChosen | None = None
    law: Law | None = field(default=None, repr=False)
    checked: Checked | None = None
    tested: RuleTests | None = None
    folders: Mapping[str, str] = field(default_factory=dict)
    resumed: tuple[str, ...] = ()

    @property
    def reaches(self) -> bool:
        """Whether the law renders the share that was asked for, nominally and with all tolerances at once."""
        return self.checked is not None and min(self.checked.passes, self.checked.drawn) >= self.plan.share

    @property
    def good(self) -> bool:
        """Whether the law may be handed over: all that is needed is determined, it reaches the share and passes the tests."""
        determined = self.identified.good and not self.identified.wanting
        return determined and self.reaches and self.tested is not None and self.tested.fulfilled
