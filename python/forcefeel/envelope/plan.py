"""What an envelope is made of: a loader, the settings, the laws, the rule, what is off its value, the arms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, radians
from types import MappingProxyType
from typing import Annotated, TypedDict, Unpack

from forcefeel.envelope.cases import REFERENCE_ARMS, Case, PilotArm, make_cases
from forcefeel.envelope.deviations import Deviation, chosen_deviations
from forcefeel.envelope.draws import NO_DRAWS, Draws
from forcefeel.envelope.machines import feel_json
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError, expect, expect_number
from forcefeel.laws.law import DEFAULTS, NAMED_LAWS, LawLike, check_given, named
from forcefeel.loader.axes import rule_axis, usual_axis
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.qualification import DEFAULT_EDITION, Rules, load_rules
from forcefeel.qualification.rules import Axis, Test
from forcefeel.qualification.throw import Throw
from forcefeel.units import ANGLE, show

_LARGEST_ANGLE = radians(90.0)

SMALLER = tuple(map(radians, (10.0, 5.0, 2.0, 1.0, 0.5)))
"""Releases from which a share is stated beside its own."""

_BELOW = 0.99
"""Share of the angle; what is nearer is the same."""


@dataclass(frozen=True, eq=False)
class Plan:
    """An envelope to be computed.

    Attributes:
        given: The loader as it was given. Its own feel and arm are not used.
        laws: The laws by name: names of ``law.NAMED_LAWS``, or laws of one's own.
        settings: The grid of settings.
        rule: Edition of the rule whose release test it must pass.
        changes: How far each parameter of the plant is off: shares to either side, or deviations; ``deviations_of`` the loader if
            not given.
        arms: The arms at the grip, beside none.
        angle_rad: Angle of the release; if not given, the rule's largest share of the throw, of its shorter side.
        draws: How many machines are drawn from all tolerances at once; none if not given.
        smaller_rad: Further angles of release at which the nominal plant is tried, hands off; none if not given.
        axis: Which control of the rule; that of a built-in loader of its name, else pitch, if not given.
        loader: The loader with a feel of I, B and G alone.
        omitted: Rows of the feel and the arm that the loader has and the envelope leaves out.
        deviations: How far each parameter may be off, and who says so.
        cases: The nominal case, then what is off, then the arms.
        machines: The machines that are drawn.
        rules: The rule.
        test: Its release test.
        throw: How far the column goes, for the release and for tolerances that are shares of the travel.

    Raises:
        InputError: If a part of it is bad.

    Example:
        >>> import forcefeel as ff
        >>> plan = ff.envelope.make_plan(ff.elevator(), ["original"], {"stiffness": "10..100 %:3:log"})
        >>> plan.settings.stiffness[0], plan.test.number
        (0.1, '2.b.1')
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
        """Angle of the release."""
        if self.angle_rad is not None:
            return self.angle_rad
        return self.throw.release_rad(self.rules)

    def with_smaller_releases(self) -> "Plan":
        """The plan with those of ``SMALLER`` that are below its own angle; as it is where releases are linear."""
        if self.linear:
            return self
        return replace(self, smaller_rad=tuple(angle for angle in SMALLER if angle < _BELOW * self.release_rad))

    @property
    def releases(self) -> int:
        """How many releases it has in all."""
        cases = len(self.cases) + len(self.machines) + len(self.smaller_rad)
        return len(self.laws) * cases * self.settings.count

    @property
    def linear(self) -> bool:
        """Whether the loader has no optional rows: its releases are exact."""
        return not self.loader.given

    @property
    def rule_verified(self) -> bool:
        """Whether every tolerance of the release test, and how it is read, has been held against the document."""
        rows = [self.test.is_verified(tolerance) for tolerance in self.test.tolerances]
        return all(rows) and self.rules.release.verified


class PlanOptions(TypedDict, total=False):
    """The options of ``Plan``, for functions that take them as keywords; what each means stands there."""

    rule: str
    changes: Mapping[str, float | Deviation] | None
    arms: Sequence[PilotArm]
    angle_rad: float | None
    draws: Draws
    smaller_rad: Sequence[float]
    axis: Axis | None


def _check_angle(name: str, angle: float) -> None:
    expect_number(name, angle)
    if not (isfinite(angle) and 0 < angle <= _LARGEST_ANGLE):
        raise InputError(f"{name}: expected an angle above 0 and up to 90 deg, got {show(angle)} rad")


def usual_law(loader: Loader) -> str:
    """The law of an envelope for which none is named."""
    return DEFAULTS[ELECTRIC] if loader.drive == ELECTRIC else "published"


def make_plan(
    loader: Loader,
    laws: Sequence[str] | Mapping[str, LawLike] = ("original", "published", "converged"),
    grid: Mapping[str, str | Sequence[float]] | None = None,
    **options: Unpack[PlanOptions],
) -> Plan:
    """A plan from names and text.

    Args:
        loader: The loader.
        laws: Names of ``law.NAMED_LAWS``, or laws by name.
        grid: Axes as ``Settings.of`` takes them.
        options: ``rule``, ``changes``, ``arms``, ``angle_rad``, ``draws``, ``smaller_rad``, ``axis`` of ``Plan``.

    Raises:
        InputError: If one of them is bad.

    Example:
        >>> import forcefeel as ff
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
