"""Rules on control forces in flight, the table ``data/flight_rules.toml``, and what a flight's quantities come to by them."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import Literal

from pydantic import BaseModel, Field, model_validator

from forcefeel.fly.control_data import ControlData
from forcefeel.loader.axes import FlightAxis
from forcefeel.qualification.tolerance import STRICT
from forcefeel.units import FORCE, Json, Unit, UnitSystem, factor, parse, quantity


class Term(BaseModel):
    """``value times / over``.

    Attributes:
        value: A number in the limit's unit.
        times: A condition of the flight, such as ``weight``, in lb.
        over: A number or a condition, such as ``n_L - 1``.
    """

    model_config = STRICT

    value: float
    times: Literal["weight"] | None = None
    over: float | Literal["n / alpha", "n_L - 1"] = 1.0

    def number(self, conditions: Mapping[str, float]) -> float:
        """The term's number in a flight."""
        over = conditions[self.over] if isinstance(self.over, str) else self.over
        return self.value * (conditions[self.times] if self.times else 1.0) / over


class Limit(BaseModel):
    """The largest of its terms, and at most its cap.

    Attributes:
        unit: Unit of the numbers.
        terms: The terms.
        cap: The largest limit.
    """

    model_config = STRICT

    unit: str
    terms: tuple[Term, ...] = Field(min_length=1)
    cap: float | None = None

    def si(self, unit_si: str, conditions: Mapping[str, float]) -> float:
        """The limit in a flight, in SI units."""
        number = max(term.number(conditions) for term in self.terms)
        return (number if self.cap is None else min(self.cap, number)) * factor(self.unit, unit_si)


class FlightTolerance(BaseModel):
    """Allowed difference of a quantity from that of the programmed feel: the larger of an amount and a share."""

    model_config = STRICT

    quantity: str
    absolute: str | None = None
    relative: float = 0.0

    def allowed(self, unit_si: str, reference: float) -> float:
        """The allowed difference in SI units."""
        share = self.relative * abs(reference)
        return share if self.absolute is None else max(parse(self.absolute, unit_si, "5 lb"), share)


class FlightRule(BaseModel):
    """A row of a rule: tolerances beside the programmed feel, or one limit of a quantity.

    Attributes:
        number, name, document: Its number, what it is about, the document.
        axis: Control that it is for.
        category, grip: Aircraft that it is for; all unless given.
        tolerances: Of a simulator.
        quantity, at_least, at_most: Of a designer.
        source: Section of the document.
        verified: Whether the row is verified against the document.
    """

    model_config = STRICT

    number: str
    name: str
    document: str
    axis: FlightAxis = "pitch"
    category: Literal["light", "transport", "military"] | None = None
    grip: Literal["wheel", "stick"] | None = None
    tolerances: tuple[FlightTolerance, ...] = ()
    quantity: str | None = None
    at_least: Limit | None = None
    at_most: Limit | None = None
    source: str
    verified: bool

    @model_validator(mode="after")
    def _check(self) -> "FlightRule":
        if [bool(self.tolerances), bool(self.at_least), bool(self.at_most)].count(True) != 1:
            raise ValueError(f"{self.number}: expected one of tolerances, at_least, at_most")
        if (self.quantity is None) != bool(self.tolerances):
            raise ValueError(f"{self.number}: expected a quantity with a limit, and only there")
        return self

    @property
    def label(self) -> str:
        """Document and number."""
        return f"{self.document} {self.number}"

    @property
    def marked_label(self) -> str:
        """Document and number, marked if the row is not verified against the document."""
        return self.label + ("" if self.verified else " (unverified)")

    @property
    def maneuver(self) -> str:
        """The maneuver of a simulator's row."""
        return self.tolerances[0].quantity.partition(":")[0] if self.tolerances else ""

    def applies(self, data: ControlData) -> bool:
        """Whether it is for a control of an aircraft."""
        return self.axis == data.axis and self.category in (None, data.category) and self.grip in (None, data.grip)


@cache
def flight_rules() -> tuple[FlightRule, ...]:
    """All rows."""
    text = resources.files("forcefeel").joinpath("data/flight_rules.toml").read_text(encoding="utf-8")
    return tuple(FlightRule.model_validate(row, strict=False) for row in tomllib.loads(text)["rules"])


class Outcome(StrEnum):
    """What a row came to."""

    MET = "met"
    NOT_MET = "not met"
    NOT_FLOWN = "not flown"


@dataclass(frozen=True)
class Compared:
    """A number through the loader and that of the programmed feel, SI."""

    label: str
    with_loader: float
    feel: float


@dataclass(frozen=True)
class Quantity:
    """What was flown of a quantity.

    Attributes:
        unit: Its unit.
        points: Its numbers, at least one.
    """

    unit: Unit
    points: tuple[Compared, ...]


@dataclass(frozen=True)
class FlightVerdict:
    """What a row came to.

    Attributes:
        rule: The row.
        quantity: The judged quantity.
        outcome: Met, not met, or not flown.
        where: Where the number is from, or why it was not flown.
        bound: ``at least``, ``at most``, or ``within`` of the programmed feel.
        unit: Unit of the numbers; none where nothing was flown.
        limit: The limit, or the allowed difference, SI.
        with_loader: The number that decides, SI.
        feel: That of the programmed feel, SI.
        loose: Whether the allowed difference of a force exceeds every force itself.
    """

    rule: FlightRule
    quantity: str
    outcome: Outcome
    where: str
    bound: str
    unit: Unit | None = None
    limit: float = 0.0
    with_loader: float = 0.0
    feel: float = 0.0
    loose: bool = False

    def as_json(self, system: UnitSystem) -> dict[str, Json]:
        """The row, the outcome, the numbers with their unit."""
        rule = self.rule.model_dump(include={"number", "name", "document", "source", "verified"})
        words = {"quantity": self.quantity, "outcome": str(self.outcome), "where": self.where, "bound": self.bound}
        numbers = {"limit": self.limit, "with_loader": self.with_loader, "feel_alone": self.feel}
        return (
            rule | words | {key: self.unit and quantity(number, self.unit, system) for key, number in numbers.items()}
        )


def judge(
    rule: FlightRule, flown: Mapping[str, Quantity | str], conditions: Mapping[str, float]
) -> Iterator[FlightVerdict]:
    """A row's verdicts, one for each of its quantities.

    Args:
        rule: The row.
        flown: Quantities by name; a sentence in place of one that was not flown.
        conditions: ``weight`` in lb, ``n / alpha`` in 1/rad, ``n_L - 1``.
    """
    for tolerance in rule.tolerances:
        measured = flown[tolerance.quantity]
        if isinstance(measured, str):
            yield FlightVerdict(rule, tolerance.quantity, Outcome.NOT_FLOWN, measured, "within")
            continue
        unit = measured.unit
        allowed = {point: tolerance.allowed(unit.si, point.feel) for point in measured.points}
        worst = max(measured.points, key=lambda point: abs(point.with_loader - point.feel) / allowed[point])
        met = abs(worst.with_loader - worst.feel) <= allowed[worst]
        outcome = Outcome.MET if met else Outcome.NOT_MET
        loose = unit is FORCE and all(abs(point.feel) <= allowed[point] for point in allowed)
        numbers = (unit, allowed[worst], worst.with_loader, worst.feel, loose)
        yield FlightVerdict(rule, tolerance.quantity, outcome, worst.label, "within", *numbers)
    limit = rule.at_least or rule.at_most
    if rule.quantity is None or limit is None:
        return
    bound, sign = ("at least", 1.0) if rule.at_least else ("at most", -1.0)
    measured = flown[rule.quantity]
    if isinstance(measured, str):
        yield FlightVerdict(rule, rule.quantity, Outcome.NOT_FLOWN, measured, bound)
        return
    worst = min(measured.points, key=lambda point: sign * point.with_loader)
    number = limit.si(measured.unit.si, conditions)
    outcome = Outcome.MET if sign * worst.with_loader >= sign * number else Outcome.NOT_MET
    yield FlightVerdict(
        rule, rule.quantity, outcome, worst.label, bound, measured.unit, number, worst.with_loader, worst.feel
    )
