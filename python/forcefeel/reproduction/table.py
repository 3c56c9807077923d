"""One row of the comparison, and how a printed number is judged."""

import math
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum

from forcefeel.units import to_text


class Verdict(StrEnum):
    """How a computed value stands to the printed one.

    Example:
        >>> import forcefeel as ff
        >>> [verdict.value for verdict in ff.reproduction.Verdict]
        ['agrees', 'differs, explained', 'does not hold', 'differs']
    """

    AGREES = "agrees"
    """To the printed digits, or the claim holds."""
    EXPLAINED = "differs, explained"
    """It differs and the reason is known."""
    REFUTED = "does not hold"
    """The claim does not follow from the report's own model."""
    OPEN = "differs"
    """It differs and the reason is not known."""


NOTHING = 1e-6
"""A change or an error below this is rounding and stopping tolerance, different on every machine."""


@dataclass(frozen=True)
class Row:
    """One number or claim.

    Attributes:
        item: What it is.
        where: Where the report says it.
        printed: As printed.
        computed: What the models give, as text with the digits worth showing.
        value: The same as a number, in ``unit``.
        unit: Unit of both.
        verdict: How they stand to each other.
        reason: Why, where they differ; a remark otherwise.

    Example:
        >>> import forcefeel as ff
        >>> row = ff.reproduction.Row("k", "Table I", "6108", "6108", 6108.0, "lb/in", ff.reproduction.Verdict.AGREES)
        >>> row.verdict.value
        'agrees'
    """

    item: str
    where: str
    printed: str
    computed: str
    value: float
    unit: str
    verdict: Verdict
    reason: str = ""


@dataclass(frozen=True)
class Section:
    """Rows that belong together.

    Example:
        >>> import forcefeel as ff
        >>> row = ff.reproduction.Row("k", "Table I", "6108", "6108", 6108.0, "lb/in", ff.reproduction.Verdict.AGREES)
        >>> ff.reproduction.Section("Linkage", (row,)).title
        'Linkage'
    """

    title: str
    rows: tuple[Row, ...]


def agrees_to_digits(printed: str, value: float) -> bool:
    """Whether ``value`` rounds to the printed digits: it lies within half a unit of the last one."""
    number = Decimal(printed)
    exponent = number.as_tuple().exponent
    half_unit = 0.5 * 10.0 ** int(exponent)
    return abs(value - float(number)) <= half_unit * (1 + 1e-9)  # a half itself may be off by rounding


@dataclass(frozen=True)
class Reason:
    """Why a printed number differs from the computed one.

    Attributes:
        text: The reason in words.
        predicts: What was printed, worked out from the reason: it has to come out to the printed digits.
    """

    text: str
    predicts: float


def number(item: str, where: str, printed: str, value: float, unit: str, reason: Reason | None = None) -> Row:
    """A row for a printed number; where it differs, a ``reason`` explains it only if it gives the printed digits."""
    verdict, text = Verdict.OPEN, ""
    if agrees_to_digits(printed, value):
        verdict = Verdict.AGREES
    elif reason is not None and agrees_to_digits(printed, reason.predicts):
        verdict, text = Verdict.EXPLAINED, reason.text
    digits = max(4, sum(c.isdigit() for c in printed.lstrip("-0.")) + 1)
    return Row(item, where, printed, to_text(value, digits), float(value), unit, verdict, text)


def cut(value: float, decimals: int) -> float:
    """``value`` cut, not rounded, after so many decimals."""
    scale = float(10**decimals)
    return math.trunc(value * scale) / scale


def claim(item: str, where: str, value: float, unit: str, *, holds: bool, reason: str) -> Row:
    """A row for a claim without a number: what speaks for or against it."""
    verdict = Verdict.AGREES if holds else Verdict.REFUTED
    computed = to_text(value) if abs(value) >= NOTHING else f"less than {NOTHING:g}"
    return Row(item, where, "claimed", computed, float(value), unit, verdict, reason)


def about(item: str, where: str, printed: str, value: float, unit: str, *, holds: bool, reason: str) -> Row:
    """A row for a number that the report gives as approximate: whether it holds is judged by the caller."""
    return Row(
        item, where, printed, to_text(value), float(value), unit, Verdict.AGREES if holds else Verdict.EXPLAINED, reason
    )
