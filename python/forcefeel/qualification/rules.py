"""The qualification rules: one table for each edition in ``data/rules``, validated when read."""

import tomllib
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Literal

from pydantic import BaseModel, Field, ValidationError, model_validator

from forcefeel.errors import InputError
from forcefeel.qualification.tolerance import STRICT, Tolerance
from forcefeel.units import show

DEFAULT_EDITION = "part60-a-2014"

Kind = Literal[
    "static", "freeplay", "release", "dynamic sweep", "small inputs", "pedal steering", "trim indicator", "trim rate"
]
Axis = Literal["pitch", "roll", "yaw", "nosewheel", "brake", "collective"]

_QUANTITIES: dict[Kind, frozenset[str]] = {
    "static": frozenset({"breakout", "force", "surface"}),
    "freeplay": frozenset({"freeplay"}),
    "release": frozenset(
        {"P0", "Pn", "A1", "An", "Ad", "first overshoot", "overshoots", "steady state", "fall time", "rise time"}
    ),
    "dynamic sweep": frozenset({"dynamic increment"}),
    "small inputs": frozenset({"body rate"}),
    "pedal steering": frozenset({"surface"}),
    "trim indicator": frozenset({"surface"}),
    "trim rate": frozenset({"trim rate"}),
}


class ReleaseRules(BaseModel):
    """Settings of a free response.

    Attributes:
        deflection: Least and largest initial share of full throw, or of the allowed deflection.
        residual_band: Share of the initial displacement; only overshoots above it count.
        high, low: Shares of the initial displacement that define the fall time.
        source: Section of the document.
        verified: Whether it is verified against the document.
    """

    model_config = STRICT

    deflection: tuple[float, float]
    residual_band: float = Field(gt=0, lt=1)
    high: float = Field(gt=0, lt=1)
    low: float = Field(gt=0, lt=1)
    source: str = Field(min_length=1)
    verified: bool

    @model_validator(mode="after")
    def _laws(self) -> "ReleaseRules":
        least, most = self.deflection
        if not (0 < least < most <= 1 and self.residual_band < self.low < self.high):
            raise ValueError("expected rising shares: of the deflection, and of the way from the residual band upwards")
        return self


class Sweep(BaseModel):
    """Duration of one of the three sweeps of the alternate method, s."""

    model_config = STRICT

    name: Literal["slow", "medium", "fast"]
    duration_s: tuple[float, float]
    source: str = Field(min_length=1)
    verified: bool

    @model_validator(mode="after")
    def _laws(self) -> "Sweep":
        if not 0 < self.duration_s[0] <= self.duration_s[1]:
            raise ValueError("expected a shortest duration below the longest")
        return self


class Test(BaseModel):
    """One test of a rule.

    Attributes:
        number: Number in the rule.
        name: Title in the rule.
        kind: Method of measurement.
        axis: The control.
        conditions: Required conditions.
        tolerances: Tolerance of each quantity.
        source: Section of the document.
        verified: Whether its row is verified against the document; a tolerance can override it.
    """

    __test__ = False  # not a test for pytest to collect

    model_config = STRICT

    number: str = Field(min_length=1)
    name: str = Field(min_length=1)
    kind: Kind
    axis: Axis
    conditions: tuple[str, ...] = Field(min_length=1)
    source: str = Field(min_length=1)
    verified: bool
    tolerances: tuple[Tolerance, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _laws(self) -> "Test":
        kinds = [(tolerance.quantity, tolerance.surface) for tolerance in self.tolerances]
        if len(set(kinds)) != len(kinds):
            raise ValueError(f"test {self.number}: a quantity has two tolerances")
        names = {name for name, _ in kinds}
        if strangers := names - _QUANTITIES[self.kind]:
            raise ValueError(f"test {self.number}: a {self.kind} test measures no {', '.join(sorted(strangers))}")
        if missing := {tolerance.instead_of for tolerance in self.tolerances if tolerance.instead_of} - names:
            raise ValueError(f"test {self.number}: instead_of: no tolerance of {', '.join(map(str, missing))}")
        return self

    def tolerance(self, quantity: str) -> Tolerance | None:
        """The tolerance of a quantity; ``None`` if the test does not compare it."""
        return next((tolerance for tolerance in self.tolerances if tolerance.quantity == quantity), None)

    def is_verified(self, tolerance: Tolerance) -> bool:
        """Whether one of its tolerances is verified against the document."""
        return self.verified if tolerance.verified is None else tolerance.verified


class Rules(BaseModel):
    """One edition of a rule.

    Attributes:
        id: Name of its file.
        title, edition, category: Document, edition and aircraft category.
        release: Settings of free responses.
        sweeps: The sweeps of the alternate method.
        tests: Its tests.
    """

    model_config = STRICT

    id: str = Field(min_length=1)
    title: str = Field(min_length=1)
    edition: str = Field(min_length=1)
    category: Literal["aeroplane", "helicopter"]
    release: ReleaseRules
    sweeps: tuple[Sweep, ...]
    tests: tuple[Test, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _laws(self) -> "Rules":
        numbers = [test.number for test in self.tests]
        if len(set(numbers)) != len(numbers):
            raise ValueError("two tests have the same number")
        if {sweep.name for sweep in self.sweeps} != {"slow", "medium", "fast"} or len(self.sweeps) != 3:
            raise ValueError("expected a slow, a medium and a fast sweep")
        return self

    @property
    def verified(self) -> bool:
        """Whether all its rows are verified against the document."""
        rows = [test.is_verified(tolerance) for test in self.tests for tolerance in test.tolerances]
        return all(rows) and self.release.verified and all(sweep.verified for sweep in self.sweeps)

    def test(self, number: str) -> Test:
        """The test of that number.

        Raises:
            InputError: If there is no such test.
        """
        for test in self.tests:
            if test.number == number:
                return test
        known = ", ".join(test.number for test in self.tests)
        raise InputError(f"test: expected one of {self.id}: {known}; got {show(number)}")

    def of(self, kind: Kind, axis: Axis) -> Test:
        """The test of that kind for that axis.

        Raises:
            InputError: If the rule has no such test.
        """
        for test in self.tests:
            if (test.kind, test.axis) == (kind, axis):
                return test
        known = ", ".join(sorted({test.axis for test in self.tests if test.kind == kind})) or "no axis"
        raise InputError(f"axis: {self.id} has a {kind} test for {known}, none for {show(axis)}")

    def sweep(self, name: Literal["slow", "medium", "fast"]) -> Sweep:
        """One of the three sweeps."""
        return next(sweep for sweep in self.sweeps if sweep.name == name)


def _folder() -> Traversable:
    return resources.files("forcefeel").joinpath("data/rules")


@cache
def editions() -> tuple[str, ...]:
    """Names of the available editions.

    Example:
        >>> "part60-a-2014" in ff.qualification.editions()
        True
    """
    names = (file.name.removesuffix(".toml") for file in _folder().iterdir() if file.name.endswith(".toml"))
    return tuple(sorted(names))


@cache
def load_rules(edition: str = DEFAULT_EDITION) -> Rules:
    """The rules of an edition, by the name of its table.

    Raises:
        InputError: If there is no such table.

    Example:
        >>> ff.qualification.load_rules("part60-a-2014").category
        'aeroplane'
    """
    if edition not in editions():
        raise InputError(f"rule: expected one of {', '.join(editions())}; got {show(edition)}")
    return parse_rules(_folder().joinpath(f"{edition}.toml").read_text(encoding="utf-8"), edition)


def parse_rules(text: str, name: str) -> Rules:
    """Rules from the text of a table; ``name`` is used in messages and must equal ``id``.

    Raises:
        InputError: If the text is not TOML or the table is invalid, with every fault.
    """
    try:
        table = tomllib.loads(text)
        if other := table.pop("same_as", None):
            like = load_rules(other)
            table = {"release": like.release, "sweeps": like.sweeps, "tests": like.tests} | table
        rules = Rules.model_validate(table)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{name}: is not TOML ({error})") from error
    except ValidationError as error:
        problems = (
            f"{name}: {'.'.join(map(str, detail['loc'])) or 'rules'}: {detail['msg']}" for detail in error.errors()
        )
        raise InputError("\n".join(problems)) from error
    if rules.id != name:
        raise InputError(f"{name}: id: expected {name!r} as the file is called, got {show(rules.id)}")
    return rules
