"""Units at the edge: text such as ``"2.36 in^2"`` to SI numbers, and SI numbers to what people read.

Three rules differ from a general unit library, because this field writes them so:

* ``lb`` is a pound of force (``lbf`` means the same);
* ``Hz`` is a cycle per second, so ``60 Hz`` is 377 rad/s;
* a value is one number and one unit; arithmetic such as ``"3 m + 2 m"`` is refused.
"""

import math
import re
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from typing import TYPE_CHECKING

from forcefeel.errors import InputError

if TYPE_CHECKING:
    import pint

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_VALUE = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>[^\d\s.,+-][^,+-]*(?:\^-\d[^,+-]*)*)?\s*")


class UnitSystem(StrEnum):
    """The units in which results are shown."""

    SI = "si"
    US = "us"


@dataclass(frozen=True)
class Unit:
    """One quantity's units: coherent SI inside, metric and U.S. customary for people.

    Attributes:
        si: Coherent SI unit, in which the number is held.
        metric: Unit shown under ``UnitSystem.SI``.
        us: Unit shown under ``UnitSystem.US``.
        suffix: End of a Python name that holds this quantity, without the underscore.
    """

    si: str
    metric: str
    us: str
    suffix: str = ""

    def shown(self, system: UnitSystem) -> str:
        """The unit that people read in ``system``."""
        return self.metric if system is UnitSystem.SI else self.us

    def from_si(self, value: float, system: UnitSystem) -> float:
        """``value`` in SI as a number of ``self.shown(system)``."""
        return value * factor(self.si, self.shown(system))


RATIO = Unit("", "", "")
PERCENT = Unit("", "%", "%")
SECONDS = Unit("s", "s", "s", "s")
HERTZ = Unit("rad/s", "Hz", "Hz", "rad_per_s")
RATE = Unit("1/s", "1/s", "1/s", "per_s")
ANGLE = Unit("rad", "deg", "deg", "rad")
CURRENT = Unit("A", "mA", "mA", "a")
FLOW = Unit("m^3/s", "cm^3/s", "in^3/s", "m3_per_s")
ROTARY_STIFFNESS = Unit("N m/rad", "N m/rad", "lb in/rad", "n_m_per_rad")


@cache
def _registry() -> "pint.UnitRegistry":
    import pint  # noqa: PLC0415  a fifth of a second that `forcefeel --help` need not wait for

    registry = pint.UnitRegistry(on_redefinition="ignore")
    registry.define("lb = pound_force")
    registry.define("hertz = 2 * pi * radian / second = Hz")
    return registry


@cache
def _parse_unit(text: str) -> "pint.Unit":
    try:
        return _registry().parse_units(text)
    except Exception as error:  # the parser raises half a dozen kinds, AssertionError among them
        remedy = "write products with a space and powers with ^, such as lb in s^2"
        raise InputError(f"unknown unit {text!r}: {remedy}") from error


@cache
def factor(source: str, target: str) -> float:
    """How many ``target`` units one ``source`` unit is.

    Raises:
        InputError: If a unit is unknown or the dimensions differ.
    """
    one = _registry().Quantity(1.0, _parse_unit(source))
    to = _parse_unit(target)
    if not one.is_compatible_with(to):
        raise InputError(f"unit {source!r} is no unit of the same quantity as {target!r}")
    return float(one.to(to).magnitude)


def parse(given: object, unit_si: str, example: str) -> float:
    """A value with its unit as text, in SI units.

    Args:
        given: Text such as ``"2.36 in^2"``; a bare number where ``unit_si`` is empty (a pure number).
        unit_si: The coherent SI unit of what is wanted.
        example: A good value, for the message.

    Returns:
        The number in ``unit_si``.

    Raises:
        InputError: If it is no number, not finite, has no unit or one of another dimension.
    """
    expected = f"expected {'a number' if not unit_si else 'a number with its unit'} such as {example!r}, got {given!r}"
    if isinstance(given, bool) or not isinstance(given, str | int | float):
        raise InputError(expected)
    match = _VALUE.fullmatch(given if isinstance(given, str) else repr(given))
    if match is None:
        raise InputError(expected)
    number, unit = float(match["number"]), (match["unit"] or "").strip()
    if unit_si and not unit:
        raise InputError(f"{expected}, which has no unit")
    try:
        value = number * factor(unit, unit_si)
    except InputError as error:
        raise InputError(f"{expected}: {error}") from error
    if not math.isfinite(value):
        raise InputError(f"{expected}, which is not finite")
    return value


def to_text(value: float, digits: int = 4) -> str:
    """``value`` as people write it: ``digits`` significant digits, powers of ten only where they help."""
    if not math.isfinite(value):
        return "infinite" if value > 0 else "-infinite" if value < 0 else "undefined"
    if value == 0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if -4 <= magnitude < digits + 2:
        text = f"{value:.{max(digits - 1 - magnitude, 0)}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"
