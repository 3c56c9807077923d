"""The programme: which tests of a rule are made of a control, what each one is called, and which of them must be there."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from forcefeel.errors import InputError
from forcefeel.qualification import Rules
from forcefeel.qualification.rules import Axis, Kind, Test
from forcefeel.units import show

SweepName = Literal["slow", "medium", "fast"]

SIGNS = {1: "positive", -1: "negative"}
"""Directions by the sign of the column's angle, as test names have them."""

STATIC, SURFACE, FREEPLAY, SMALL = "static", "surface", "freeplay", "small-inputs"

_BY_HAND: tuple[Kind, ...] = ("pedal steering", "trim indicator", "trim rate")
"""Tests that nothing is measured of here, neither on a simulated loader nor on a record."""

OF_THE_AIRCRAFT = {
    SURFACE: "a control loader has no surface",
    SMALL: "a control loader turns no aircraft",
    "pedal-steering": "a control loader steers no wheel",
    "trim-indicator": "a control loader shows no trim",
    "trim-rate": "a control loader trims no surface",
}
"""Tests that a simulated control loader cannot be given, and why: they are of what it moves."""

_RELEASES: Kind = "release"
_SWEEPS: Kind = "dynamic sweep"
"""The two methods of the dynamic tests. The rule takes either: the second is its alternate one."""


@dataclass(frozen=True)
class RuleTestCase:
    """One test to be made.

    Attributes:
        key: What files and results call it: ``release-25-positive``.
        title: In words.
        test: The rule's row.
        share: Share of the throw, signed, from which a release is made; 0 otherwise.
        sweep: Which sweep it needs; ``None`` for a release and where no sweep is made.
    """

    key: str
    title: str
    test: Test
    share: float = 0.0
    sweep: SweepName | None = None

    @property
    def verified(self) -> bool:
        """Whether a person has held every tolerance that it is judged by against the document."""
        return all(self.test.is_verified(tolerance) for tolerance in self.test.tolerances)

    @property
    def demand(self) -> str:
        """What of the rule it meets: of a release its direction, since any share of the throw within the rule's limits will do."""
        return f"release {SIGNS[1 if self.share > 0 else -1]}" if self.share else self.key


@dataclass(frozen=True)
class RulePlan:
    """The tests that a control has to pass.

    Attributes:
        trials: In the order of the rule.
        outside: Tests of the rule that what is tested cannot be given, or that nothing is measured of here; they are neither made
            nor missed.
        named: Keys of the tests that alone are made; all are if there are none.
    """

    trials: tuple[RuleTestCase, ...]
    outside: tuple[RuleTestCase, ...] = ()
    named: tuple[str, ...] = ()

    @property
    def made(self) -> tuple[RuleTestCase, ...]:
        """The tests that are made."""
        return tuple(trial for trial in self.trials if not self.named or trial.key in self.named)

    def missing(self, evaluated: Collection[str]) -> tuple[tuple[RuleTestCase, ...], ...]:
        """What the rule asks for beyond the tests that were evaluated: of each group one test will do.

        Of the two methods of the dynamic tests one is enough; if neither is whole, the releases are missing.
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
    """The programme of a control.

    Args:
        rules: The rule.
        axis: Which control.
        recorded: A simulator that was recorded, which has surfaces and a body; else a simulated control loader.
        named: Keys of the tests that alone are made.

    Raises:
        InputError: If the rule has none for that axis, or a name is of no test of the programme.
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
            raise InputError(f"test: nothing is measured of {name} here; judge it by hand; {others}")
        if any(trial.key == name for trial in outside):
            raise InputError(
                f"test: {name} is outside the programme of a simulated loader: {OF_THE_AIRCRAFT[name]}; {others}; or record the "
                "simulator"
            )
        raise InputError(f"test: unknown test {show(name)}; {others}")
    return RulePlan(inside, (*outside, *by_hand), tuple(key for key in keys if key in named))


def trials(rules: Rules, axis: Axis) -> tuple[RuleTestCase, ...]:
    """The tests of an axis that are made, in the order of the rule: static, freeplay, releases, alternate method, small inputs.

    Raises:
        InputError: If the rule has none for that axis.
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
        raise InputError(f"axis: {rules.id} has tests for {known}, none for {axis}")
    return tuple(cases)


def _trials_by_hand(rules: Rules, axis: Axis) -> tuple[RuleTestCase, ...]:
    """The tests of an axis that nothing is measured of."""
    tests = ((kind, _test(rules, kind, axis)) for kind in _BY_HAND)
    return tuple(RuleTestCase(kind.replace(" ", "-"), test.name, test) for kind, test in tests if test is not None)


def is_by_hand(trial: RuleTestCase) -> bool:
    """Whether nothing is measured of a test here."""
    return trial.test.kind in _BY_HAND


def duration_s(rules: Rules, name: SweepName) -> float:
    """How long a sweep is made to last: the middle of what the rule asks for."""
    return sum(rules.sweep(name).duration_s) / 2


def _test(rules: Rules, kind: Kind, axis: Axis) -> Test | None:
    return next((test for test in rules.tests if (test.kind, test.axis) == (kind, axis)), None)
