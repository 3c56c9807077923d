"""Units at the edge: factors against constants typed here and against pint's own registry; what must be refused."""

import datetime
import math
import re
from fractions import Fraction
from importlib import resources

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.errors import InputError
from forcefeel.loader.parameters import ALTERNATIVES, TABLE, is_switch
from forcefeel.units import ANGLE, HERTZ, PERCENT, RATIO, Unit, UnitSystem, factor, factor_by_pint, parse, show, to_text

INCH = 0.0254  # m, exact: international yard and pound agreement, 1959
POUND = 4.4482216152605  # N, exact: 0.45359237 kg times 9.80665 m/s^2
ROUNDING = 4e-15  # relative; a conversion multiplies about ten times, each good to 1.1e-16, some in powers

# What one unit of the table is in SI units, worked out by hand.
SI_OF = {
    "": 1.0,
    "s": 1.0,
    "ms": 1e-3,
    "1/s": 1.0,
    "1/rad": 1.0,
    "N/s": 1.0,
    "lb/s": POUND,
    "W": 1.0,
    "J": 1.0,
    "rad": 1.0,
    "deg": math.pi / 180,
    "deg/s": math.pi / 180,
    "V": 1.0,
    "kg": 1.0,
    "lbm": 0.45359237,
    "N m": 1.0,
    "lb in": POUND * INCH,
    "m": 1.0,
    "cm": 1e-2,
    "in": INCH,
    "m^2": 1.0,
    "cm^2": 1e-4,
    "in^2": INCH**2,
    "m^3": 1.0,
    "cm^3": 1e-6,
    "in^3": INCH**3,
    "rad/s": 1.0,
    "Hz": 2 * math.pi,
    "N": 1.0,
    "lb": POUND,
    "Pa": 1.0,
    "MPa": 1e6,
    "lb/in^2": POUND / INCH**2,
    "A": 1.0,
    "mA": 1e-3,
    "m^3/s": 1.0,
    "cm^3/s": 1e-6,
    "in^3/s": INCH**3,
    "m^3/(s A)": 1.0,
    "cm^3/(s mA)": 1e-3,
    "in^3/(s mA)": INCH**3 * 1e3,
    "m^5/(N s)": 1.0,
    "cm^5/(N s)": 1e-10,
    "in^5/(lb s)": INCH**5 / POUND,
    "A/V": 1.0,
    "mA/V": 1e-3,
    "V/m": 1.0,
    "V/cm": 1e2,
    "V/in": 1 / INCH,
    "V/N": 1.0,
    "V/lb": 1 / POUND,
    "N/m": 1.0,
    "N/cm": 1e2,
    "lb/in": POUND / INCH,
    "N s/m": 1.0,
    "N s/cm": 1e2,
    "lb s/in": POUND / INCH,
    "N m/rad": 1.0,
    "lb in/rad": POUND * INCH,
    "N m s/rad": 1.0,
    "lb in s/rad": POUND * INCH,
    "N m s^2/rad": 1.0,
    "lb in s^2/rad": POUND * INCH,
    "N m s^2/rad^2": 1.0,
    "lb in s^2/rad^2": POUND * INCH,
    "N m/A": 1.0,
    "lb in/A": POUND * INCH,
    "rad/(s V)": 1.0,
    "rpm/V": math.tau / 60,
    "V s/rad": 1.0,
    "V/krpm": 0.06 / math.tau,
    "kg m^2": 1.0,
    "kg cm^2": 1e-4,
    "lb in s^2": POUND * INCH,
    "ohm": 1.0,
    "H": 1.0,
    "mH": 1e-3,
    "degC": 1.0,
    "1/K": 1.0,
    "K/W": 1.0,
    "J/K": 1.0,
}
MEASURED = {key: row for key, row in (TABLE | ALTERNATIVES).items() if not is_switch(row)}


def test_rust_table_converts_defaults_exactly() -> None:
    expected = {key: row.default_us * SI_OF[row.unit_us] for key, row in MEASURED.items()}
    assert {key: row.default_si for key, row in MEASURED.items()} == pytest.approx(expected, rel=ROUNDING)
    assert {key for key, row in MEASURED.items() if SI_OF[row.unit_si] != 1.0} == set()


UNITS = {(row.unit_si, shown) for row in MEASURED.values() for shown in (row.unit_si, row.unit_metric, row.unit_us)}


def test_factors_of_the_table_units() -> None:
    for unit_si, shown in sorted(UNITS):
        assert factor(shown, unit_si) == pytest.approx(SI_OF[shown], rel=ROUNDING)
        assert factor(unit_si, shown) == pytest.approx(1 / SI_OF[shown], rel=ROUNDING)
        assert parse(f"-2.5e1 {shown}", unit_si, "1") == pytest.approx(-25 * SI_OF[shown], rel=ROUNDING)


def test_factors_match_default_pint_registry() -> None:
    registry = pint.UnitRegistry[float]()
    for text, expected in SI_OF.items():
        if text == "degC":
            continue  # a point of a scale; it is never converted
        # pint: lb is a mass, Hz is 1/s
        words = re.sub(r"\blb\b", "lbf", text).replace("lbm", "lb")
        quantity = registry.Quantity(1.0, words).to_base_units()
        cycles = 2 * math.pi if "Hz" in text else 1.0
        assert quantity.magnitude * cycles == pytest.approx(expected, rel=ROUNDING), text


@pytest.mark.parametrize(
    ("text", "unit_si", "expected"),
    [
        ("2.36 in^2", "m^2", 2.36 * INCH**2),
        ("2.36in^2", "m^2", 2.36 * INCH**2),
        ("2.36 in²", "m^2", 2.36 * INCH**2),
        ("2.36 in**2", "m^2", 2.36 * INCH**2),
        (" 2.36\tin^2 \n", "m^2", 2.36 * INCH**2),
        ("2.36\u00a0in^2", "m^2", 2.36 * INCH**2),  # no-break space, as copied from a web page
        ("15.22 cm^2", "m^2", 15.22e-4),
        ("60 Hz", "rad/s", 376.99111843077515),  # 120 pi
        ("0.06 kHz", "rad/s", 376.99111843077515),
        ("60 cps", "rad/s", 376.99111843077515),
        ("3600 rpm", "rad/s", 376.99111843077515),
        ("60 rev/s", "rad/s", 376.99111843077515),
        ("21600 deg/s", "rad/s", 376.99111843077515),
        ("377 rad s^-1", "rad/s", 377.0),
        ("100 1/s", "1/s", 100.0),
        ("6000 1/min", "1/s", 100.0),
        ("50 lb in s^2/rad^2", "N m s^2/rad^2", 50 * POUND * INCH),
        ("377 rad s⁻¹", "rad/s", 377.0),
        ("96 lb", "N", 96 * POUND),
        ("96 lbf", "N", 96 * POUND),
        ("96 lbs", "N", 96 * POUND),
        ("96 pounds", "N", 96 * POUND),
        ("0.096 kip", "N", 96 * POUND),
        ("1 kN", "N", 1000.0),
        ("10 kgf", "N", 98.0665),
        ("1 lbm", "kg", 0.45359237),
        ("1 slug", "kg", POUND / 0.3048),
        ("1200 psi", "Pa", 1200 * POUND / INCH**2),
        ("1.2 ksi", "Pa", 1200 * POUND / INCH**2),
        ("1.7 GPa", "Pa", 1.7e9),
        ("210 bar", "Pa", 2.1e7),
        ("10 N m/deg", "N m/rad", 1800 / math.pi),
        ("10 N·m/deg", "N m/rad", 1800 / math.pi),
        ("10 N*m/deg", "N m/rad", 1800 / math.pi),
        ("10 Nm/deg", "N m/rad", 1800 / math.pi),
        ("10 N m/°", "N m/rad", 1800 / math.pi),
        ("5 ft lb/deg", "N m/rad", 5 * 12 * INCH * POUND * 180 / math.pi),
        ("9600 lb in", "N m/rad", 9600 * POUND * INCH),  # per radian, unsaid
        ("4.2 kg m^2", "N m s^2/rad", 4.2),
        ("4.2 kg m^2/s", "N m s/rad", 4.2),
        ("60 lbm ft^2", "N m s^2/rad", 60 * 0.45359237 * 0.3048**2),
        ("2 slug ft^2", "N m s^2/rad", 2 * POUND * 0.3048),
        ("10 gpm", "m^3/s", 10 * 231 * INCH**3 / 60),
        ("10 L/min", "m^3/s", 1e-2 / 60),
        ("3 cc/s", "m^3/s", 3e-6),
        ("3 in^3/s/mA", "m^3/(s A)", 3e3 * INCH**3),
        ("7 V/µm", "V/m", 7e6),
        ("7 V/um", "V/m", 7e6),
        ("20 %", "", 0.2),
        ("20%", "", 0.2),
        ("0.5 in/ft", "", 0.5 / 12),
        ("0.9", "", 0.9),
        (".9", "", 0.9),
        ("+9.e-1", "", 0.9),
        ("-0.0 in", "m", 0.0),
        (0.9, "", 0.9),
        (1, "", 1.0),
        (np.float32(0.5), "", 0.5),
        (np.int64(2), "", 2.0),
        (Fraction(1, 2), "", 0.5),
    ],
)
def test_common_unit_text_is_read(text: object, unit_si: str, expected: float) -> None:
    assert parse(text, unit_si, "1") == pytest.approx(expected, rel=ROUNDING, abs=0)


@pytest.mark.timeout(20)  # a tower of powers takes for ever to work out
@pytest.mark.parametrize(
    "text",
    [
        "", " ", "in^2", "in^2 3", ".", "e5 in^2", "two in^2", "- 3 in^2", "--3 in^2", "3 3 in^2",
        "3 in^2 + 2 in^2", "3 in^2 - 2 in^2", "3-2 in^2", "2*3 in^2", "1/2 in^2", "3 1/", "3 1/2 in", "3 * in^2", "3 /in^2",
        "1,200 in^2", "1.200,5 in^2", "1_200 in^2", "0x10 in^2", "1 200 in^2",
        "١٢ in^2", "１２ in^2", "²in", "3 in^²", "∞ in^2", "3 in^2²", "3 in-in",
        "3 in^2; import os", "3 __import__('os').getcwd()", "3 in^2 # comment", "3 in^2\\n", "3 {in}", "3 'in^2'",
        "3 in^2\0", "3 in^2)", "3 (in^2", "3 in^", "3 in^in", "3 in^2.5", "3 in^0", "3 in 2", "3 5 in^2", "3 in^^2",
        "3 in^2//s", "3 in^2 %", "3 %", "3 %%", "3 in²²", "3 in^99999999999999999999999999999999", "3 in**1e300",
        "3 in^2^2", "3 e in^2", "3 E", "3 k", "3 mm m m", "3 ma", "3 M", "3 IN^2", "3 In^2", "3 furlong^2", "3 degC",
        "3 in^9^9^9^9", "3 in**9**9**9**9", "3 in^9 ^9 ^9 ^9", "3 in^(9^9^9^9)", "3 in^9⁹⁹⁹⁹⁹⁹⁹⁹", "3 in⁹^9^9^9", "3 in^9**9^9",
        "3 in 9^9^9^9", "3 (in 9^9^9)^9", "9**9**9**9", "9^9^9^9 in^2", "3 in^999999999", "3 in⁹⁹⁹⁹⁹⁹⁹⁹⁹", "1e999999999 in^2",
        "9" * 100_000 + "$", "9" * 1_000_000 + " in^2", "3 in^" + "9" * 1_000_000,
        "3 " + "m" * 100_000, "3 " + "m " * 50_000, "3 " + "(" * 100_000, "3" + " " * 100_000 + "$", "3 m/" + "m/" * 9,
        "nan in^2", "NaN in^2", "inf in^2", "-inf in^2", "Infinity in^2", "nan", "1e999 in^2", "-1e999 in^2",
        "9" * 5000 + " in^2", "1e308 kip", "3 dB",
    ],
    ids=lambda text: re.sub(r"[^ -~]", "?", text)[:30],
)  # fmt: skip
def test_invalid_area_text_error_states_expected_and_got(text: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(text, "m^2", "2.36 in^2")
    message = str(caught.value)
    assert message.startswith(f"expected a number with its unit such as '2.36 in^2', got {show(text)}")
    assert "\n" not in message
    assert len(message) < 400  # two lines of a terminal and a list of units


@pytest.mark.parametrize(
    ("given", "unit_si", "remark"),
    [
        ("2.36 lb", "m^2", ": 'lb' measures a force, not an area"),
        ("2.36 in", "m^2", ": 'in' measures a length, not an area"),
        ("12 in deg", "m", ": 'in deg' does not measure a length"),
        ("0.9 rad", "", ": 'rad' measures an angle, not a ratio"),
        ("12 deg", "", ": 'deg' measures an angle, not a ratio"),
        ("60 kg", "N", ": 'kg' measures a mass, not a force"),
        ("20 %", "m", ": '%' measures a ratio, not a length"),
        ("100 Hz", "1/s", ": 'Hz' measures a frequency, not a rate"),
        ("31/s", "1/s", ""),
        ("50 lb in s", "N m s^2/rad^2", ": 'lb in s' does not measure a quadratic damping coefficient"),
        ("377 s^-1", "rad/s", ": 's^-1' measures a bare rate (say rad/s or Hz), not a frequency"),
        ("60 N m s/rad", "N m/rad", ": 'N m s/rad' measures a rotary damping coefficient, not a rotary spring rate"),
        ("60 lb in", "N m s^2/rad", ": 'lb in' measures a torque, not a moment of inertia"),
        ("10 N m deg", "N m/rad", ": 'N m deg' does not measure a rotary spring rate"),
        ("2.36", "m^2", ", which has no unit"),
        (2.36, "m^2", ", which has no unit"),
        (236, "m^2", ", which has no unit"),
        ("nan in^2", "m^2", ", which is not finite"),
        (math.nan, "", ", which is not finite"),
        (-math.inf, "m^2", ", which is not finite"),
        pytest.param(10**400, "", ", which is not finite", id="10^400"),
        pytest.param(16**9000, "", ", which is not finite", id="16^9000"),
        (True, "", ""),
        (False, "m^2", ""),
        (None, "", ""),
        ([2.36], "m^2", ""),
        ({"value": 2.36}, "m^2", ""),
        (b"2.36 in^2", "m^2", ""),
        (2.36 + 0j, "", ""),
        (datetime.date(2024, 1, 1), "m^2", ""),
    ],
)  # fmt: skip
def test_error_message_gives_reason(given: object, unit_si: str, remark: str) -> None:
    what = "a number with its unit" if unit_si else "a number"
    with pytest.raises(InputError) as caught:
        parse(given, unit_si, "2.36 in^2")
    assert str(caught.value) == f"expected {what} such as '2.36 in^2', got {show(given)}{remark}"


@pytest.mark.parametrize("stated", ["km^99 km^99 km^99/m^99/m^99/m^98", "nm^99 nm^99 nm^99 nm^99/m^99/m^99/m^99/m^98"])
def test_unit_with_unrepresentable_factor_is_refused(stated: str) -> None:
    with pytest.raises(InputError, match=r"is too many powers of ten away from 'm'$"):
        parse(f"1 {stated}", "m", "1 m")


def test_nested_powers_error_shows_valid_notation() -> None:
    with pytest.raises(InputError, match=r"write a power as one whole number of one or two digits, such as s\^2$"):
        parse("1 s^9^9^9^9", "s", "1 s")


def test_unknown_unit_error_lists_valid_units() -> None:
    with pytest.raises(InputError) as caught:
        parse("60 hz", "rad/s", "377 rad/s")
    assert "unknown unit 'hz'; units are m, in, ft," in str(caught.value)
    assert " Hz," in str(caught.value)
    assert str(caught.value).endswith("write products with a space and powers with ^, such as lb in s^2")


def test_every_quantity_of_the_table_has_a_name_for_messages() -> None:
    for row in MEASURED.values():
        with pytest.raises(InputError, match=r"'lb\^7' does not measure an? [a-z ]+$"):
            factor("lb^7", row.unit_si)


def test_factors_between_unlike_units_are_refused() -> None:
    with pytest.raises(InputError, match="'m' measures a length, not an area"):
        factor("m", "m^2")
    with pytest.raises(InputError, match=r"'m' measures a length, not what 'kg\^3' does"):
        factor("m", "kg^3")
    with pytest.raises(InputError, match="unknown unit 'parsec'"):
        factor("m", "parsec")


def finite_or_refused(text: str) -> bool:
    """Whether each try to read ``text`` ends in a finite number or an input error; other errors pass through."""
    for unit_si in ("", "m^2", "N m/rad"):
        try:
            if not math.isfinite(parse(text, unit_si, "1")):
                return False
        except InputError:
            continue
    return True


@given(st.text())
def test_random_text_is_finite_number_or_input_error(text: str) -> None:
    assert finite_or_refused(text)


@given(st.text(alphabet="09.eE+-*/^()% °²⁻minlbsradHzkgNPVA", max_size=30))
def test_random_unit_text_is_finite_number_or_input_error(text: str) -> None:
    assert finite_or_refused(f"7 {text}")


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(sorted(SI_OF)))
def test_full_precision_number_is_read_exactly(number: float, text: str) -> None:
    rows = MEASURED.values()
    unit_si = next(row.unit_si for row in rows if text in (row.unit_si, row.unit_metric, row.unit_us))
    expected = number * factor(text, unit_si)
    if math.isfinite(expected):
        assert parse(f"{number!r} {text}", unit_si, "1") == expected


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.0, 4, "0"),
        (-0.0, 4, "0"),
        (1.0, 4, "1"),
        (0.1 + 0.2, 4, "0.3"),
        (6107.855999999999, 4, "6108"),
        (6107.855999999999, 6, "6107.86"),
        (-31.375, 4, "-31.38"),
        (-31.375, 5, "-31.375"),
        (250_000.0, 4, "250000"),
        (999_949.4, 4, "999949"),
        (999_999.4, 4, "1e6"),
        (1e-20, 1, "1e-20"),
        (1_234_567.0, 4, "1.235e6"),
        (1e8, 4, "1e8"),
        (1e8, 10, "100000000"),
        (1e-4, 4, "0.0001"),
        (0.00012345678, 4, "0.0001235"),
        (9.9999e-5, 4, "0.0001"),
        (-1.5e-7, 4, "-1.5e-7"),
        (5e-324, 4, "4.941e-324"),
        (1.7976931348623157e308, 4, "1.798e308"),
        (9.9996, 4, "10"),
        (0.5, 1, "0.5"),
        (20.0, 1, "20"),
        (2e9, 1, "2e9"),
        (math.inf, 4, "infinite"),
        (-math.inf, 4, "-infinite"),
        (math.nan, 4, "undefined"),
    ],
)
def test_common_number_notations_are_read(value: float, digits: int, text: str) -> None:
    assert to_text(value, digits) == text


@given(st.floats(-1e300, 1e300), st.integers(min_value=1, max_value=12))  # beyond, rounding may end at infinity
def test_number_text_has_exactly_needed_digits(value: float, digits: int) -> None:
    text = to_text(value, digits)
    half_unit = 5 * 10.0**-digits * (1 + 1e-9)  # of the last digit, relative at worst; a few last bits beside it
    if value == 0 or abs(value) > 1e-300:  # below, floats themselves have fewer digits
        assert float(text) == pytest.approx(value, rel=half_unit, abs=0)
    significant = re.sub(r"e.*|[-.]", "", text).lstrip("0")
    assert len(significant) <= digits + 2  # whole numbers up to 999999 are shown in full at four digits
    assert to_text(float(text), digits) == text  # what has been shown is shown again
    assert not text.endswith(".")
    assert text != "-0"


@pytest.mark.parametrize(
    ("unit", "value", "metric", "us"),
    [
        (Unit("m", "cm", "in"), INCH, 2.54, 1.0),
        (Unit("Pa", "MPa", "psi"), POUND / INCH**2, POUND / INCH**2 / 1e6, 1.0),
        (HERTZ, 2 * math.pi, 1.0, 1.0),
        (ANGLE, math.pi, 180.0, 180.0),
        (PERCENT, 0.5, 50.0, 50.0),
        (RATIO, 0.5, 0.5, 0.5),
    ],
)
def test_numbers_are_formatted_for_display(unit: Unit, value: float, metric: float, us: float) -> None:
    assert unit.from_si(value, UnitSystem.SI) == pytest.approx(metric, rel=ROUNDING)
    assert unit.from_si(value, UnitSystem.US) == pytest.approx(us, rel=ROUNDING)
    assert (unit.shown(UnitSystem.SI), unit.shown(UnitSystem.US)) == (unit.metric, unit.us)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ("2.36 in^2", "'2.36 in^2'"),
        ("a\nb", r"'a\nb'"),
        (True, "true"),
        (2.5, "2.5"),
        ({}, "a table"),
        ([], "an array"),
        pytest.param(10**5000, "a huge number", id="10^5000"),
        (datetime.date(2024, 1, 2), "the date or time 2024-01-02"),
        (datetime.datetime(2024, 1, 2, 3, 4), "the date or time 2024-01-02 03:04:00"),
        (datetime.time(3, 4), "the date or time 03:04:00"),
        ("x" * 1000, f"'{'x' * 55}...'"),
    ],
)
def test_refused_value_is_shown_in_one_line(given: object, text: str) -> None:
    assert show(given) == text


def test_common_factors_match_pint():
    """`make docs` writes it; a loader then need not wait for Pint."""
    text = (resources.files("forcefeel") / "data" / "factors.csv").read_text(encoding="utf-8")
    rows = [row.split(",") for row in text.splitlines()[1:]]
    assert len(rows) > 50
    assert [float(number) for _, _, number in rows] == [factor_by_pint(one, other) for one, other, _ in rows]
    for row in (TABLE | ALTERNATIVES).values():
        if not is_switch(row):
            assert [row.unit_us, row.unit_si] in [pair[:2] for pair in rows]
