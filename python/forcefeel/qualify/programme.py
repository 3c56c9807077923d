"""The programme: which tests of a rule are made of a control, and what each one is called."""

from dataclasses import dataclass
from typing import Literal

from forcefeel.errors import InputError
from forcefeel.qualification import Rules, Test
from forcefeel.qualification.rules import Axis, Kind

SweepName = Literal["slow", "medium", "fast"]

SIGNS = {1: "positive", -1: "negative"}
"""Directions by the sign of the column's angle, as test names have them."""

STATIC, SURFACE, SMALL = "static", "surface", "small-inputs"


@dataclass(frozen=True)
class Trial:
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


def trials(rules: Rules, axis: Axis) -> tuple[Trial, ...]:
    """The tests of an axis, in the order of the rule: static, releases, alternate method, small inputs.

    Raises:
        InputError: If the rule has none for that axis.
    """
    found: list[Trial] = []
    if static := _test(rules, "static", axis):
        found.append(Trial(STATIC, "Static sweep from stop to stop", static, sweep="slow"))
        if static.tolerance("surface"):
            found.append(Trial(SURFACE, "Surface position over the control's position", static, sweep="slow"))
    if release := _test(rules, "release", axis):
        for share in rules.release.deflection:
            for sign, side in SIGNS.items():
                title = f"Release from {100 * share:g} % of the throw, {side}"
                found.append(Trial(f"release-{100 * share:g}-{side}", title, release, share=sign * share))
    if dynamic := _test(rules, "dynamic sweep", axis):
        found.append(Trial("medium", "Alternate method: medium sweep against the slow one", dynamic, sweep="medium"))
        found.append(Trial("fast", "Alternate method: fast sweep against the slow one", dynamic, sweep="fast"))
    if small := _test(rules, "small inputs", axis):
        found.append(Trial(SMALL, "Small control inputs", small))
    if not found:
        known = ", ".join(sorted({test.axis for test in rules.tests}))
        raise InputError(f"axis: {rules.id} has tests for {known}, none for {axis}")
    return tuple(found)


def duration_s(rules: Rules, name: SweepName) -> float:
    """How long a sweep is made to last: the middle of what the rule asks for."""
    return sum(rules.sweep(name).duration_s) / 2


def _test(rules: Rules, kind: Kind, axis: Axis) -> Test | None:
    return next((test for test in rules.tests if (test.kind, test.axis) == (kind, axis)), None)
