"""One row of the comparison, and the verdict on a printed number."""

import math
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum

from forcefeel.units import to_text


class Verdict(StrEnum):
    """Agreement of a computed value with the printed one."""

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
        item: The number or claim.
        where: Its location in the report.
        printed: The printed value.
        computed: The computed value as text.
        value: The same as a number, in ``unit``.
        unit: Unit of both.
        verdict: Their agreement.
        reason: Reason of a difference; otherwise a remark.

    Example:
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
    """Rows that belong together."""

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
        predicts: The printed value as predicted by the reason; it must match the printed digits.
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
    """A row for a claim without a number."""
    verdict = Verdict.AGREES if holds else Verdict.REFUTED
    computed = to_text(value) if abs(value) >= NOTHING else f"less than {NOTHING:g}"
    return Row(item, where, "claimed", computed, float(value), unit, verdict, reason)


def about(item: str, where: str, printed: str, value: float, unit: str, *, holds: bool, reason: str) -> Row:
    """A row for an approximate number; the caller states whether it holds."""
    return Row(
        item, where, printed, to_text(value), float(value), unit, Verdict.AGREES if holds else Verdict.EXPLAINED, reason
    )
