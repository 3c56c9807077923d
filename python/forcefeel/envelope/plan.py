"""Inputs of an envelope: loader, settings, laws, rule, deviations and arms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite, radians
from types import MappingProxyType
from typing import Annotated, TypedDict, Unpack

from forcefeel.envelope.cases import REFERENCE_ARMS, Case, Kind, PilotArm, make_cases
from forcefeel.envelope.contact import CONTACT_TIME, CONTACTS, Contact
from forcefeel.envelope.deviations import Deviation, chosen_deviations
from forcefeel.envelope.draws import NO_DRAWS, Draws
from forcefeel.envelope.machines import feel_json
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError, expect, expect_number
from forcefeel.laws.law import NAMED_LAWS, LawLike, check_given, named
from forcefeel.loader.axes import rule_axis, usual_axis
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.qualification import DEFAULT_EDITION, Rules, load_rules
from forcefeel.qualification.rules import Axis, Test
from forcefeel.qualification.throw import Throw
from forcefeel.units import ANGLE, show

_LARGEST_ANGLE = radians(90.0)

SMALLER = tuple(map(radians, (10.0, 5.0, 2.0, 1.0, 0.5)))
"""Further release angles with a stated share."""

_USUAL_SHARES = {Kind.PLANT: 0.25, Kind.DRAWN: 0.4}
"""Usual share of the settings that are run in an inferred case; machines with all tolerances at once fail at more of them."""

STABILITY_TIME = 0.12
"""Usual time of finding whether a setting is stable, as a share of a release, for progress."""

_USUAL_CONTACT_SHARE = 0.32
"""The same in a contact, by time: of 0.24, in small batches."""

_BELOW = 0.99
"""Share of the release angle; larger angles count as the same."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Plan of an envelope.

    Attributes:
        given: The input loader. Its own feel and arm are not used.
        laws: Laws by name: names of ``law.NAMED_LAWS``, or your own laws.
        settings: Grid of settings.
        rule: Edition of the rule with the required release test.
        changes: Deviations of the plant parameters, or shares to either side; default: ``deviations_of`` the loader.
        arms: Arms at the grip, in addition to hands off.
        angle_rad: Release angle; default: the rule's largest share of the throw, of its shorter side.
        draws: Machines drawn with all tolerances at once; default: none.
        smaller_rad: Further release angles for the nominal plant, hands off; default: none.
        contacts: What the column touches, with the nominal plant; default: nothing.
        full: Whether to run every setting of every case and contact, instead of inferring most from their neighbors:
            ``refinement``.
        soften: Whether to soften settings that the drive forbids, and to release them with the nominal plant (``softening``).
        axis: Control axis of the rule; default: that of a built-in loader with the same name, else pitch.
        loader: The loader with only I, B and G as its feel.
        omitted: Rows of feel and arm that the envelope omits.
        deviations: Deviation of each parameter, with its source.
        cases: The nominal case, then the deviations, then the arms.
        machines: The drawn machines.
        rules: The rule.
        test: Its release test.
        throw: Travel of the column, for the release and for tolerances that are shares of the travel.

    Raises:
        InputError: If an argument is invalid.
    """

    given: Loader
    laws: Mapping[str, LawLike]
    settings: Settings
    rule: str = DEFAULT_EDITION
    changes: Mapping[str, float | Deviation] | None = None
    arms: Sequence[PilotArm] = REFERENCE_ARMS
    angle_rad: Annotated[float, ANGLE] | None = None
    draws: Draws = NO_DRAWS
    smaller_rad: Sequence[float] = ()
    contacts: Sequence[Contact] = ()
    full: bool = False
    soften: bool = False
    axis: Axis | None = None
    loader: Loader = field(init=False)
    omitted: tuple[str, ...] = field(init=False)
    deviations: Mapping[str, Deviation] = field(init=False)
    cases: tuple[Case, ...] = field(init=False)
    machines: tuple[Case, ...] = field(init=False, repr=False)
    rules: Rules = field(init=False)
    test: Test = field(init=False)
    throw: Throw = field(init=False)

    def __post_init__(self) -> None:
        loader, omitted = feel_json(self.given)
        rules = load_rules(self.rule)
        expect("full", self.full, bool, "true or false")
        expect("soften", self.soften, bool, "true or false")
        expect("draws", self.draws, Draws, "Draws such as ff.envelope.Draws(100, seed=1)")
        if self.angle_rad is not None:
            _check_angle("angle_rad", self.angle_rad)
        for angle in self.smaller_rad:
            _check_angle("smaller_rad", angle)
        if not self.laws:
            raise InputError(f"laws: expected at least one, such as {', '.join(NAMED_LAWS)}")
        deviations = chosen_deviations(loader, self.changes)
        derived = {
            "loader": loader,
            "omitted": omitted,
            "deviations": deviations,
            "cases": make_cases(deviations, self.arms),
            "machines": self.draws.machines(deviations),
            "rules": rules,
            "test": rules.of("release", self.axis or rule_axis(usual_axis(self.given.name))),
            "throw": Throw.of(self.given),
            "laws": MappingProxyType(dict(self.laws)),
        }
        for name, value in derived.items():
            object.__setattr__(self, name, value)

    @property
    def release_rad(self) -> float:
        """Release angle."""
        if self.angle_rad is not None:
            return self.angle_rad
        return self.throw.release_rad(self.rules)

    def with_smaller_releases(self) -> "Plan":
        """The plan with the angles of ``SMALLER`` below its own; unchanged if releases are linear."""
        if self.linear:
            return self
        return replace(self, smaller_rad=tuple(angle for angle in SMALLER if angle < _BELOW * self.release_rad))

    def with_contacts(self) -> "Plan":
        """The plan with ``CONTACTS``."""
        return replace(self, contacts=CONTACTS)

    @property
    def inferring(self) -> bool:
        """Whether outcomes of settings are inferred from their neighbors: of simulated loaders on fine grids, unless ``full``."""
        return not self.full and not self.linear and self.settings.fine

    def infers(self, case: Case) -> bool:
        """Whether most outcomes of a case are inferred.

        The nominal case is run whole. So is a case with an arm, where the rule's figures jump at single settings.
        """
        return self.inferring and case.kind in {Kind.PLANT, Kind.DRAWN}

    @cached_property
    def releases(self) -> int:
        """Usual number of releases, for progress; stability and contacts count by their time."""
        each = sum(map(self.usual_releases, (*self.cases, *self.machines)))
        each += len(self.smaller_rad) * self.usual_releases(self.cases[0]) + len(self.contacts) * self.contact_releases
        return len(self.laws) * each

    def usual_releases(self, case: Case) -> int:
        """Usual number of releases that take as long as a case: as its runs and, for a simulated loader, its stability."""
        share = _USUAL_SHARES[case.kind] if self.infers(case) else 1.0
        return round(self.settings.count * (share + (0.0 if self.linear else STABILITY_TIME)))

    @property
    def contact_releases(self) -> int:
        """Usual number of releases that take as long as the settings that are run in one contact."""
        return round(self.settings.count * CONTACT_TIME * (_USUAL_CONTACT_SHARE if self.inferring else 1.0))

    @cached_property
    def linear(self) -> bool:
        """Whether the loader has no optional rows, so that releases are exact."""
        return not self.loader.given

    @property
    def rule_verified(self) -> bool:
        """Whether every tolerance of the release test and its measuring method are verified against the document."""
        rows = [self.test.is_verified(tolerance) for tolerance in self.test.tolerances]
        return all(rows) and self.rules.release.verified


class PlanOptions(TypedDict, total=False):
    """Options of ``Plan``, for functions that take them as keywords; see ``Plan``."""

    rule: str
    changes: Mapping[str, float | Deviation] | None
    arms: Sequence[PilotArm]
    angle_rad: float | None
    draws: Draws
    smaller_rad: Sequence[float]
    contacts: Sequence[Contact]
    full: bool
    soften: bool
    axis: Axis | None


def _check_angle(name: str, angle: float) -> None:
    expect_number(name, angle)
    if not (isfinite(angle) and 0 < angle <= _LARGEST_ANGLE):
        raise InputError(f"{name}: expected an angle above 0 and up to 90 deg, got {show(angle)} rad")


def make_plan(
    loader: Loader,
    laws: Sequence[str] | Mapping[str, LawLike] = ("original", "published", "converged"),
    grid: Mapping[str, str | Sequence[float]] | None = None,
    **options: Unpack[PlanOptions],
) -> Plan:
    """Make a plan from names and text.

    Args:
        loader: The loader.
        laws: Names of ``law.NAMED_LAWS``, or laws by name.
        grid: Axes, as in ``Settings.of``.
        options: ``rule``, ``changes``, ``arms``, ``angle_rad``, ``draws``, ``smaller_rad``, ``contacts``,
            ``full``, ``soften``, ``axis`` of ``Plan``.

    Raises:
        InputError: If an argument is invalid.

    Example:
        >>> ff.envelope.make_plan(ff.loader.electric("rudder-pedals"), ["robust"]).test.number
        '2.b.3'
    """
    check_loader(loader)
    if isinstance(laws, str) or not isinstance(laws, Sequence | Mapping):
        raise InputError(f"laws: expected a list of names or laws by name, got {show(laws)}")
    chosen = dict(laws) if isinstance(laws, Mapping) else named(tuple(laws), loader)
    for name, law in chosen.items():
        check_given(law, f"laws: {name}")
    expect("grid", grid or {}, Mapping, 'values by axis such as {"stiffness": "1..100 %:40:log"}')
    return Plan(loader, chosen, Settings.of(grid or {}), **options)
