"""Results of a commissioning by step; each is stored in a file and read back."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from forcefeel.commission.plan import CommissionPlan
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader

IDENTIFIED, CARRIED, UNSEEN = "identified", "within the others", "not seen"
AT_END, NOTHING = "at the end of its range", "none"
"""Status of a parameter."""


@dataclass(frozen=True)
class IdentifiedParameter:
    """One parameter of the plant.

    Attributes:
        key: Its row.
        before: Value of the file, SI units.
        value: Value used from here on.
        error: Standard error as a share of the value; 0 if not identified.
        state: ``IDENTIFIED``; ``CARRIED``, equivalent to identified ones; ``AT_END``, at the end of its range
            in the file and in the data; ``NOTHING``, a friction of zero within its errors; ``UNSEEN``, with the file's value and
            tolerance.
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
        modeled: The same of the identified model.
        before: The same of the loader file's model.
    """

    data: str
    channel: str
    response: bool
    at: tuple[float, ...]
    measured: tuple[tuple[float, ...], ...]
    modeled: tuple[tuple[float, ...], ...]
    before: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Identified:
    """Result of the identification.

    Attributes:
        ok: Whether a loader file was written, for the design of a law.
        verdict: Verdict in a sentence.
        findings: Further findings.
        parameters: Each parameter of the plant.
        wanting: Missing information, a sentence each.
        advice: Further experiments, a sentence each.
        noticed: Remarks without consequence for the law, a sentence each.
        curve: The data with the identified model; ``None`` without a model.
    """

    ok: bool
    verdict: str
    findings: tuple[str, ...] = ()
    parameters: tuple[IdentifiedParameter, ...] = ()
    wanting: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()
    noticed: tuple[str, ...] = ()
    curve: Curve | None = None


@dataclass(frozen=True)
class LawChosen:
    """The law.

    Attributes:
        name: The design; empty if no law is eligible.
        verdict: Reason of the choice, in a sentence.
        findings: Reasons against the others.
    """

    name: str
    verdict: str
    findings: tuple[str, ...] = ()


@dataclass(frozen=True)
class WhatIf:
    """Share rendered by a changed machine, under its own law of the same design.

    Attributes:
        change: The change.
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
class EnvelopeResult:
    """The law in the envelope.

    Attributes:
        settings: Number of settings.
        passes: Share of them, spaced in proportion, that the identified loader renders.
        every_case: The same in every case: each parameter at its tolerance's ends, each arm.
        machines: Number of machines with joint tolerances.
        drawn: Mean share of the settings that they render.
        drawn_least: Share of the worst of them.
        findings: Failures by case.
        what_ifs: Changes that would render more, the smallest first; empty if the required share is reached.
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
        fulfilled: Whether all required tests pass.
        rule: The rule and its edition.
        verdict: Verdict in a sentence.
        outcomes: Outcome of each test by name.
        reasons: Reasons of failure, of a release and of a sweep.
        findings: Further findings.
    """

    fulfilled: bool
    rule: str
    verdict: str
    outcomes: Mapping[str, str] = field(default_factory=dict)
    reasons: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Commission:
    """Result of a commissioning, complete or up to its last step.

    Attributes:
        plan: The plan.
        before: The loader of the file.
        identified: Result of the identification.
        loader: The identified loader; ``None`` if the data are insufficient.
        chosen: The choice of the law; ``None`` without a loader.
        law: The law, for the loader's own setting and those of the grid; ``None`` if no law is eligible.
        envelope: Result of the envelope; ``None`` without a law.
        tested: Result of the rule's tests.
        folders: Folder of each finished step, within the whole one.
        bench: What was recorded first, ``the simulated machine`` or ``the machine``; empty if data were given.
        resumed: Steps from an earlier run.
    """

    plan: CommissionPlan
    before: Loader
    identified: Identified
    loader: Loader | None = None
    chosen: LawChosen | None = None
    law: Law | None = field(default=None, repr=False)
    envelope: EnvelopeResult | None = None
    tested: RuleTests | None = None
    folders: Mapping[str, str] = field(default_factory=dict)
    bench: str = ""
    resumed: tuple[str, ...] = ()

    @property
    def reaches(self) -> bool:
        """Whether the law renders the required share, nominally and with joint tolerances."""
        return self.envelope is not None and min(self.envelope.passes, self.envelope.drawn) >= self.plan.share

    @property
    def ok(self) -> bool:
        """Whether the law is accepted: the identification is complete, and the law reaches the share and passes the tests."""
        determined = self.identified.ok and not self.identified.wanting
        return determined and self.reaches and self.tested is not None and self.tested.fulfilled
