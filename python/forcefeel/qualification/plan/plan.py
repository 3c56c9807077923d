"""The test plan: the tests of a rule for a control, their names, and those that are required."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from forcefeel.errors import InputError
from forcefeel.qualification import Rules
from forcefeel.qualification.rules import Axis, Kind, Test, editions, load_rules
from forcefeel.units import show

SweepName = Literal["slow", "medium", "fast"]

SIGNS = {1: "positive", -1: "negative"}
"""Directions in test names by the sign of the column's angle."""

STATIC, SURFACE, FREEPLAY, SMALL = "static", "surface", "freeplay", "small-inputs"

_BY_HAND: tuple[Kind, ...] = ("pedal steering", "trim indicator", "trim rate")
"""Tests that are judged by hand, for a simulated loader and for a record."""

OF_THE_AIRCRAFT = {
    SURFACE: "a control loader has no surface",
    SMALL: "a control loader turns no aircraft",
    "pedal-steering": "a control loader steers no wheel",
    "trim-indicator": "a control loader shows no trim",
    "trim-rate": "a control loader trims no surface",
}
"""Tests of the aircraft that cannot be simulated on a control loader, and why."""

_RELEASES: Kind = "release"
_SWEEPS: Kind = "dynamic sweep"
"""The two methods of the dynamic tests; the rule accepts either. The second is its alternate method."""


@dataclass(frozen=True)
class RuleTestCase:
    """One test of the plan.

    Attributes:
        key: Its name in files and results, such as ``release-25-positive``.
        title: Its title.
        test: The rule's row.
        share: Signed share of the throw from which the control is released; 0 for other tests.
        sweep: The required sweep; ``None`` for tests without a sweep.
    """

    key: str
    title: str
    test: Test
    share: float = 0.0
    sweep: SweepName | None = None

    @property
    def verified(self) -> bool:
        """Whether all its tolerances are verified against the document."""
        return all(self.test.is_verified(tolerance) for tolerance in self.test.tolerances)

    @property
    def demand(self) -> str:
        """The requirement of the rule that it meets: for a release its direction, because one share of the throw is enough."""
        return f"release {SIGNS[1 if self.share > 0 else -1]}" if self.share else self.key


@dataclass(frozen=True)
class RulePlan:
    """The tests that a control must pass.

    Attributes:
        trials: Tests in the order of the rule.
        outside: Tests of the rule that cannot be simulated or are judged by hand; they are neither run nor missing.
        named: Keys of the requested tests; empty for all.
    """

    trials: tuple[RuleTestCase, ...]
    outside: tuple[RuleTestCase, ...] = ()
    named: tuple[str, ...] = ()

    @property
    def made(self) -> tuple[RuleTestCase, ...]:
        """The tests that are run."""
        return tuple(trial for trial in self.trials if not self.named or trial.key in self.named)

    def missing(self, evaluated: Collection[str]) -> tuple[tuple[RuleTestCase, ...], ...]:
        """Groups of tests that the rule still requires; one test of each group is enough.

        One of the two methods of the dynamic tests is enough; if neither is complete, the releases are missing.
        """
        demands: dict[str, list[RuleTestCase]] = {}
        for trial in self.trials:
            demands.setdefault(trial.demand, []).append(trial)
        unmet = [tuple(some) for some in demands.values() if not any(trial.key in evaluated for trial in some)]
        kinds = {trial.test.kind for trial in self.trials}
        short = {some[0].test.kind for some in unmet}
        spared = _RELEASES if _SWEEPS in kinds - short else _SWEEPS if _RELEASES in kinds else None
        return tuple(some for some in unmet if some[0].test.kind != spared)


def rule_plan(rules: Rules, axis: Axis, *, recorded: bool, named: Sequence[str] = ()) -> RulePlan:
    """The test plan of a control.

    Args:
        rules: The rule.
        axis: The control.
        recorded: Whether a simulator was recorded, with surfaces and body; false for a simulated control loader.
        named: Keys of the requested tests; all if empty.

    Raises:
        InputError: If the rule has no tests for the axis, or a requested test is not in the plan.
    """
    planned, by_hand = trials(rules, axis), _trials_by_hand(rules, axis)
    outside = () if recorded else tuple(trial for trial in planned if trial.key in OF_THE_AIRCRAFT)
    inside = tuple(trial for trial in planned if trial not in outside)
    keys = [trial.key for trial in inside]
    for name in named:
        if name in keys:
            continue
        others = f"expected some of {', '.join(keys)}"
        if any(trial.key == name for trial in by_hand):
            raise InputError(f"test: {others}, got {name}, which is judged by hand")
        if any(trial.key == name for trial in outside):
            raise InputError(
                f"test: {name} cannot be simulated: {OF_THE_AIRCRAFT[name]}; {others}; or record the simulator"
            )
        raise InputError(f"test: unknown test {show(name)}; {others}")
    return RulePlan(inside, (*outside, *by_hand), tuple(key for key in keys if key in named))


def trials(rules: Rules, axis: Axis) -> tuple[RuleTestCase, ...]:
    """The measured tests of an axis in the order of the rule: static, freeplay, releases, alternate method, small inputs.

    Raises:
        InputError: If the rule has no tests for the axis.
    """
    cases: list[RuleTestCase] = []
    if static := _test(rules, "static", axis):
        cases.append(RuleTestCase(STATIC, "Static sweep from stop to stop", static, sweep="slow"))
        if static.tolerance("surface"):
            cases.append(RuleTestCase(SURFACE, "Surface position over the control's position", static, sweep="slow"))
    if freeplay := _test(rules, "freeplay", axis):
        cases.append(RuleTestCase(FREEPLAY, "Freeplay", freeplay, sweep="slow"))
    if release := _test(rules, _RELEASES, axis):
        for share in rules.release.deflection:
            for sign, side in SIGNS.items():
                title = f"Release from {100 * share:g} % of the throw, {side}"
                cases.append(RuleTestCase(f"release-{100 * share:g}-{side}", title, release, share=sign * share))
    if dynamic := _test(rules, _SWEEPS, axis):
        cases.append(
            RuleTestCase("medium", "Alternate method: medium sweep against the slow one", dynamic, sweep="medium")
        )
        cases.append(RuleTestCase("fast", "Alternate method: fast sweep against the slow one", dynamic, sweep="fast"))
    if small := _test(rules, "small inputs", axis):
        cases.append(RuleTestCase(SMALL, "Small control inputs", small))
    if not cases:
        known = ", ".join(sorted({test.axis for test in rules.tests}))
        having = [name for name in editions() if any(test.axis == axis for test in load_rules(name).tests)]
        remedy = f"; choose a rule with some: {', '.join(having)}" if having else ""
        raise InputError(f"axis: {rules.id} has tests for {known}, none for {axis}{remedy}")
    return tuple(cases)


def _trials_by_hand(rules: Rules, axis: Axis) -> tuple[RuleTestCase, ...]:
    """The tests of an axis that are judged by hand."""
    tests = ((kind, _test(rules, kind, axis)) for kind in _BY_HAND)
    return tuple(RuleTestCase(kind.replace(" ", "-"), test.name, test) for kind, test in tests if test is not None)


def is_by_hand(trial: RuleTestCase) -> bool:
    """Whether a test is judged by hand."""
    return trial.test.kind in _BY_HAND


def duration_s(rules: Rules, name: SweepName) -> float:
    """Duration of a simulated sweep: the middle of the rule's range."""
    return sum(rules.sweep(name).duration_s) / 2


def _test(rules: Rules, kind: Kind, axis: Axis) -> Test | None:
    return next((test for test in rules.tests if (test.kind, test.axis) == (kind, axis)), None)
