"""Units at the edge: text such as ``"2.36 in^2"`` to SI numbers, and SI numbers to what people read.

Five rules differ from a general unit library, because this field writes them so or because a slip must not pass:

* ``lb`` is a pound of force (``lbf`` means the same), ``lbm`` the pound of mass;
* ``Hz`` is a cycle per second, so ``60 Hz`` is 377 rad/s;
* an angle is a quantity: ``0.9 deg`` is no ratio. Only where a unit is per radian may the radian stay unsaid, as in
  ``lb in`` of stiffness or ``kg m^2`` of inertia;
* a value is one number and one unit; arithmetic such as ``"3 m + 2 m"`` is refused, and a power is one whole number;
* the units are those of ``data/units.txt``, so that a slip such as ``15 ma`` does not become a milliyear.
"""

import math
import re
from dataclasses import dataclass
from datetime import date, time
from enum import StrEnum
from functools import cache
from importlib import resources
from numbers import Real
from typing import TYPE_CHECKING, Any, SupportsFloat, cast

from forcefeel.errors import InputError, expect

if TYPE_CHECKING:
    import pint

_QUANTITIES = {
    "": "a ratio",
    "m": "a length",
    "m^2": "an area",
    "m^3": "a volume",
    "s": "a time",
    "m/s": "a speed",
    "kg": "a mass",
    "N": "a force",
    "Pa": "a pressure",
    "N/m": "a spring rate",
    "N s/m": "a damping coefficient",
    "J": "an energy",  # of the dimension of a torque, which is what such a unit is called
    "N m": "a torque",
    "N m/rad": "a rotary spring rate",
    "N m s/rad": "a rotary damping coefficient",
    "N m s^2": "a moment of inertia",
    "N m s^2/rad": "a moment of inertia",
    "N m s^2/rad^2": "a quadratic damping coefficient",
    "rad": "an angle",
    "1/s": "a rate",
    "1/rad": "a share per angle",
    "rad/s": "a frequency",
    "A": "a current",
    "V": "a voltage",
    "N m/A": "a torque per current",
    "rad/(s V)": "a speed per voltage",
    "V s/rad": "a voltage per speed",
    "kg m^2": "a moment of inertia",
    "ohm": "a resistance",
    "H": "an inductance",
    "degC": "a temperature",
    "1/K": "a share per difference of temperature",
    "N/s": "a change of a force in time",
    "W": "a power",
    "K/W": "a thermal resistance",
    "J/K": "a heat capacity",
    "A/V": "a current per voltage",
    "V/m": "a voltage per length",
    "V/N": "a voltage per force",
    "m^3/s": "a flow",
    "m^3/(s A)": "a flow per current",
    "m^5/(N s)": "a flow per pressure",
}

_NUMBER = r"[+-]?(?:(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|(?i:nan|inf(?:inity)?)\b)"
_UNIT = r"%|(?:(?<= )1/)?[A-Za-zµμ°(](?:[A-Za-zµμ°() */·^.0-9⁰¹²³⁴⁵⁶⁷⁸⁹⁻]|(?<=[\^*])-){0,59}"
_BARE = re.compile(r"[-+0-9.eE]*")
_VALUE = re.compile(rf"(?P<number>{_NUMBER}) ?(?P<unit>{_UNIT})?")
_SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_POWER = re.compile(
    rf"(?:(?:\^|\*\*) ?-?[0-9]{{1,2}}|⁻?[{_SUPERSCRIPTS}]{{1,2}})(?! ?(?:\^|\*\*|[0-9.{_SUPERSCRIPTS}⁻]))"
)
_NO_POWER = re.compile(rf"[0-9^{_SUPERSCRIPTS}⁻]|\*\*")
_LONGEST_SHOWN = 60


class UnitSystem(StrEnum):
    """The units in which results are shown.

    Example:
        >>> loader = ff.elevator()
        >>> "lb/in" in loader.to_toml(ff.UnitSystem.US), "lb/in" in loader.to_toml(ff.UnitSystem.SI)
        (True, False)
    """

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
        """The unit that people read in ``system``.

        Raises:
            InputError: If that is no ``UnitSystem``.
        """
        expect("units", system, UnitSystem, "UnitSystem.SI or UnitSystem.US")
        return self.metric if system is UnitSystem.SI else self.us

    def from_si(self, value: float, system: UnitSystem) -> float:
        """``value`` in SI as a number of ``self.shown(system)``."""
        return value * factor(self.si, self.shown(system))


RATIO = Unit("", "", "")
PERCENT = Unit("", "%", "%")
LOAD_FACTOR = Unit("g", "g", "g")
SECONDS = Unit("s", "s", "s", "s")
HERTZ = Unit("rad/s", "Hz", "Hz", "rad_per_s")
RATE = Unit("1/s", "1/s", "1/s", "per_s")
LENGTH = Unit("m", "cm", "in", "m")
ANGLE = Unit("rad", "deg", "deg", "rad")
CURRENT = Unit("A", "mA", "mA", "a")
MOTOR_CURRENT = Unit("A", "A", "A", "a")
VOLTAGE = Unit("V", "V", "V", "v")
SPEED = Unit("m/s", "cm/s", "in/s", "m_per_s")
AIRSPEED = Unit("m/s", "m/s", "kt", "m_per_s")
ALTITUDE = Unit("m", "m", "ft", "m")
ANGULAR_VELOCITY = Unit("rad/s", "deg/s", "deg/s", "rad_per_s")
AREA = Unit("m^2", "cm^2", "in^2", "m2")
MASS = Unit("kg", "kg", "lbm", "kg")
TORQUE = Unit("N m", "N m", "lb in", "n_m")
TEMPERATURE = Unit("degC", "degC", "degC", "degc")
PRESSURE = Unit("Pa", "MPa", "lb/in^2", "pa")
FLOW = Unit("m^3/s", "cm^3/s", "in^3/s", "m3_per_s")
FORCE = Unit("N", "N", "lb", "n")
INERTIA = Unit("N m s^2/rad", "N m s^2/rad", "lb in s^2/rad", "n_m_s2_per_rad")
ROTARY_STIFFNESS = Unit("N m/rad", "N m/rad", "lb in/rad", "n_m_per_rad")
ROTARY_DAMPING = Unit("N m s/rad", "N m s/rad", "lb in s/rad", "n_m_s_per_rad")
VOLTAGE_RATE = Unit("V/s", "V/s", "V/s", "v_per_s")

BY_SI = {
    unit.si: unit
    for unit in (
        *(SECONDS, ANGLE, ANGULAR_VELOCITY, LENGTH, FORCE, PRESSURE, FLOW),
        *(CURRENT, VOLTAGE, VOLTAGE_RATE, TEMPERATURE, RATIO),
    )
}
"""Units of a signal by its SI unit; a current is that of a valve, ``MOTOR_CURRENT`` is that of a motor."""


@cache
def _registry() -> "pint.UnitRegistry[float]":
    import pint  # noqa: PLC0415  a quarter of a second that `forcefeel --help` need not wait for

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(None)
    registry.load_definitions(_definitions())
    return registry


@cache
def _definitions() -> list[str]:
    return resources.files("forcefeel").joinpath("data/units.txt").read_text(encoding="utf-8").splitlines()


def _known() -> str:
    """Symbols of the units, for a message."""
    return ", ".join(line.split(" = ")[2] for line in _definitions() if line.count(" = ") > 1 and "- =" not in line)


@cache
def _parse_unit(text: str) -> "pint.Unit":
    # The parser would work out s^9^9^9^9 to the last digit, which does not end.
    if _NO_POWER.search(_POWER.sub("", text.removeprefix("1/"))):
        raise InputError(f"unknown unit {text!r}; write a power as one whole number of one or two digits, such as s^2")
    if "%" in text and text.strip() != "%":
        raise InputError(f"unknown unit {text!r}; a percent is a unit by itself, of a ratio")
    try:
        return _registry().parse_units(text)
    except Exception as error:  # the parser raises half a dozen kinds, AssertionError among them
        remedy = "write products with a space and powers with ^, such as lb in s^2"
        raise InputError(f"unknown unit {text!r}; units are {_known()}, also as kN or mA; {remedy}") from error


@cache
def _names() -> "dict[pint.util.UnitsContainer, str]":
    return {_parse_unit(text).dimensionality: name for text, name in _QUANTITIES.items()}


def dimensions(text: str) -> dict[str, int]:
    """The powers of the base quantities in a unit, by names such as ``[length]``; force and voltage are among them.

    Raises:
        InputError: If the unit is unknown.
    """
    return {name: cast("int", power) for name, power in _parse_unit(text).dimensionality.items()}


@cache
def factor(source: str, target: str) -> float:
    """How many ``target`` units one ``source`` unit is.

    Raises:
        InputError: If a unit is unknown or the dimensions differ.
    """
    if (source, target) in _ready():
        return _ready()[source, target]
    return factor_by_pint(source, target)


@cache
def _ready() -> dict[tuple[str, str], float]:
    """The factors of the units that the program writes itself, as Pint gives them: a loader need not wait half a second for it."""
    rows = resources.files("forcefeel").joinpath("data/factors.csv").read_text(encoding="utf-8").splitlines()[1:]
    split = (row.split(",") for row in rows)
    return {(source, target): float(number) for source, target, number in split}


def factor_by_pint(source: str, target: str) -> float:
    """``factor``, worked out.

    Raises:
        InputError: As ``factor``.
    """
    given, wanted = _parse_unit(source), _parse_unit(target)
    radian = _parse_unit("rad")
    unsaid = wanted.dimensionality.get("[angle]") == -1 and "[angle]" not in given.dimensionality
    if unsaid and "[voltage]" not in wanted.dimensionality:  # a data sheet's mV min is per revolution
        given = given / radian  # what is per radian may leave it unsaid
    if given.dimensionality != wanted.dimensionality:
        name, other = _names().get(wanted.dimensionality), _names().get(_parse_unit(source).dimensionality)
        if (name, other) == ("a frequency", "a rate"):
            other = "a bare rate (say rad/s or Hz)"
        measures = f"measures {other}, not" if other else "does not measure"
        raise InputError(f"{source!r} {measures} {name or f'what {target!r} does'}")
    try:
        factor = float(_registry().Quantity(1.0, given).to(wanted).magnitude)
    except OverflowError:
        factor = math.inf
    if not 0 < factor < math.inf:
        raise InputError(f"{source!r} is too many powers of ten away from {target!r}")
    return factor


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
    what = "a number with its unit" if unit_si else "a number"
    expected = f"expected {what} such as {example!r}, got {show(given)}"
    if isinstance(given, bool) or not isinstance(given, str | Real):
        raise InputError(expected)
    number, unit = _split(given)
    if number is None:
        raise InputError(expected)
    if not math.isfinite(number):
        raise InputError(f"{expected}, which is not finite")
    if unit_si and not unit:
        raise InputError(f"{expected}, which has no unit")
    try:
        value = number * factor(unit, unit_si)
    except InputError as error:
        raise InputError(f"{expected}: {error}") from error
    if not math.isfinite(value):
        raise InputError(f"{expected}, which is not finite")
    return value


def ends(span: str) -> tuple[str, str]:
    """Both ends of a range such as ``1 lb..5 lb`` or ``1..5 lb`` with their units; the first may take that of the last.

    Example:
        >>> ends("1..5 lb")
        ('1 lb', '5 lb')
    """
    low, high = (part.strip() for part in span.partition("..")[::2])
    unit = _BARE.sub("", high, count=1).strip() if _BARE.fullmatch(low) and low else ""
    return f"{low} {unit}".strip(), high


def _split(given: str | Real) -> tuple[float | None, str]:
    """The number, if there is one, and the unit."""
    if not isinstance(given, str):
        return as_float(given), ""
    match = _VALUE.fullmatch(" ".join(given.split()))
    return (float(match["number"]), match["unit"] or "") if match else (None, "")


def as_float(number: SupportsFloat) -> float:
    """A number as a file may hold it; infinite beyond every float, and so refused where a finite one is expected."""
    try:
        return float(number)
    except OverflowError:
        return math.inf


Json = dict[str, Any] | list[Any] | str | float | int | bool | None


def quantity(value: float, measured_in: Unit, system: UnitSystem) -> dict[str, Json]:
    """``{"value": ..., "unit": ...}``; an infinite or undefined value is text, because JSON has no number for it."""
    return {"value": number_json(measured_in.from_si(value, system)), "unit": measured_in.shown(system)}


def number_json(value: float) -> float | str:
    """A number as JSON has it; text for an infinite or undefined one."""
    return value if math.isfinite(value) else to_text(value)


def show(given: object) -> str:
    """A user's value as a message quotes it: one line, not too long, in the words of TOML."""
    match given:
        case bool():
            return str(given).lower()
        case dict():
            return "a table"
        case list():
            return "an array"
        case date() | time():
            return f"the date or time {given}"
        case int() if abs(given) > 10**_LONGEST_SHOWN:
            return "a huge number"
    text = repr(given)
    return text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 4]}...{text[-1]}"


def to_text(value: float, digits: int = 4) -> str:
    """``value`` as people write it: ``digits`` significant digits, powers of ten only where they help."""
    if not math.isfinite(value):
        return "infinite" if value > 0 else "-infinite" if value < 0 else "undefined"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    magnitude = int(exponent)  # of the rounded value: 9.9996 is 10 to four digits
    if -4 <= magnitude < digits + 2:
        text = f"{value:.{max(digits - 1 - magnitude, 0)}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{magnitude}"
