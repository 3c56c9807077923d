"""Curves of the feel: the laws that their points obey, what runs between and beyond them, and how a file states them."""

import dataclasses
import math
import pickle
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.built_in import elevator
from forcefeel.loader.curves import CURVES, MOST_POINTS, Curve, CurveRow
from forcefeel.loader.loader import Loader, load

ROUNDING = (
    1e-12  # relative to the largest y; a cubic in pieces a millionth as wide as the curve loses six digits at worst
)
TEN_DIGITS = 5.1e-10  # relative; half a unit of the tenth digit at worst, and a conversion
DEGREE, POUND, SQUARE_FOOT = math.pi / 180, 4.4482216152605, 0.3048**2  # rad, N, m^2

steps = st.lists(st.floats(0.01, 10), min_size=1, max_size=MOST_POINTS - 1)


@st.composite
def curves(draw: st.DrawFn) -> Curve:
    widths = draw(steps)
    rises = draw(st.lists(st.floats(0, 10), min_size=len(widths), max_size=len(widths)))
    start = draw(st.tuples(st.floats(-20, 20), st.floats(-20, 20)))
    x, y = (np.cumsum([first, *others]) for first, others in zip(start, (widths, rises), strict=True))
    return Curve(x, y)


def dense(curve: Curve) -> np.ndarray:
    """Many places on the curve and as far beyond its ends."""
    span = curve.x[-1] - curve.x[0]
    return np.linspace(curve.x[0] - span, curve.x[-1] + span, 3001)


@given(curves())
def test_curve_passes_through_points_and_is_monotonic(curve: Curve) -> None:
    largest = max(1.0, *map(abs, curve.y))
    assert curve.at(curve.x) == pytest.approx(np.array(curve.y), abs=ROUNDING * largest)
    assert np.all(np.diff(curve.at(dense(curve))) >= -ROUNDING * largest * 3)


@given(curves())
def test_curve_is_extrapolated_with_end_slope(curve: Curve) -> None:
    largest = max(1.0, *map(abs, curve.y))
    for end, slope, sign in zip((0, -1), curve.end_slopes, (-1, 1), strict=True):
        far = np.array([0.5, 1.0, 7.0])
        expected = curve.y[end] + slope * sign * far
        assert curve.at(curve.x[end] + sign * far) == pytest.approx(expected, abs=ROUNDING * (largest + 7 * slope))
        assert curve.held(curve.x[end] + sign * far) == pytest.approx([curve.y[end]] * 3, abs=ROUNDING * largest)
        small = 1e-6 * (curve.x[1] - curve.x[0] if end == 0 else curve.x[-1] - curve.x[-2])
        inside = (curve.at(curve.x[end] - sign * small) - curve.y[end]) / (-sign * small)
        assert inside == pytest.approx(slope, rel=1e-4, abs=1e-4)  # a secant of a millionth of the piece


@given(curves())
def test_coefficients_match_scipy_row_per_piece(curve: Curve) -> None:
    assert np.array_equal(curve.coefficients, PchipInterpolator(curve.x, curve.y).c.T)
    assert curve.coefficients.shape == (len(curve.x) - 1, 4)
    assert not curve.coefficients.flags.writeable


def test_slopes_are_those_of_fritsch_and_carlson() -> None:
    # Secants 1 and 1/2 over widths 1 and 2: (w_1 + w_2) / (w_1 / 1 + w_2 / (1/2)) with w_1 = 2*2 + 1, w_2 = 2 + 2*1
    curve = Curve((0, 1, 3), (0, 1, 2))
    assert curve.coefficients[1, 2] == pytest.approx(9 / (5 / 1 + 4 / 0.5))
    # At the ends a parabola through three points: ((2 h_1 + h_2) d_1 - h_1 d_2) / (h_1 + h_2), here 7/6; and 1/6
    assert curve.end_slopes == pytest.approx(((4 * 1 - 1 * 0.5) / 3, ((4 + 1) * 0.5 - 2 * 1) / 3))


def test_two_points_are_a_straight_line() -> None:
    curve = Curve((0, 2), (1, 5))
    assert curve.at([-1, 0, 1, 2, 3]) == pytest.approx([-1, 1, 3, 5, 7])
    assert curve.held([-1, 0, 1, 2, 3]) == pytest.approx([1, 1, 3, 5, 5])
    assert curve.end_slopes == (2, 2)
    assert curve.at(1.0).shape == ()
    assert curve.at(np.ones((2, 3))).shape == (2, 3)


def test_a_curve_is_frozen_and_compared_by_value() -> None:
    curve = Curve(np.array([0.0, 1.0]), [0, 1])
    assert curve == Curve((0.0, 1.0), (0.0, 1.0)) != Curve((0.0, 1.0), (0.0, 2.0))
    assert hash(curve) == hash(Curve((-0.0, 1.0), (0.0, 1.0)))
    assert pickle.loads(pickle.dumps(curve)) == curve
    with pytest.raises(dataclasses.FrozenInstanceError):
        curve.x = (0.0, 2.0)  # type: ignore[misc]


TOO_CLOSE = "expected points at least a millionth of the largest x apart, got"


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([], [], "expected 2 to 32 points, got 0"),
        ([1], [1], "expected 2 to 32 points, got 1"),
        (range(33), range(33), "expected 2 to 32 points, got 33"),
        ([0, 1], [0, 1, 2], "expected as many y as x, got 2 x and 3 y"),
        ([0, 1, 1], [0, 1, 2], "expected x to rise from point to point, got point 2 [1, 1] and point 3 [1, 2]"),
        ([0, 2, 1, 0], [0, 1, 2, 3], "expected x to rise from point to point, got point 2 [2, 1] and point 3 [1, 2]"),
        ([0, 1, 2], [0, 3, 2], "expected y never to fall from point to point, got point 2 [1, 3] and point 3 [2, 2]"),
        ([0, 1, 1 + 1e-7], [0, 1, 2], f"{TOO_CLOSE} point 2 [1, 1] and point 3 [1.0000001, 2]"),
        ([0, 1e-300, 1], [0, 1, 2], f"{TOO_CLOSE} point 1 [0, 0] and point 2 [1e-300, 1]"),
        ([0, math.nan], [0, 1], "expected finite x, got nan at point 2"),
        ([0, 1], [-math.inf, 1], "expected finite y, got -inf at point 1"),
        (
            [0, 1e-300],
            [0, 1e300],
            "expected numbers that a cubic can be put through, got numbers too large or too small",
        ),
        ("ab", [0, 1], "expected x to be numbers, got 'ab'"),
        (5, [0, 1], "expected x to be numbers, got 5"),
        ([0, 1], [[0], [1, 2]], "expected y to be numbers, got an array"),
        ([0, 1], None, "expected y to be numbers, got None"),
        ([0, 10**400], [0, 1], "expected x to be numbers, got an array"),
    ],
)
def test_invalid_points_are_refused(x: object, y: object, message: str) -> None:
    with pytest.raises(InputError) as caught:
        Curve(x, y)  # type: ignore[arg-type]
    assert str(caught.value) == message


# In a loader


@pytest.mark.parametrize("row", CURVES.values(), ids=CURVES)
def test_example_of_every_curve_is_valid(tmp_path: Path, row: CurveRow) -> None:
    for units in ff.UnitSystem:
        lines = elevator().to_toml(units).splitlines()
        start = lines.index(f"# [{row.key}]")
        lines[start : start + 3] = [line.removeprefix("# ") for line in lines[start : start + 3]]
        (tmp_path / "my.toml").write_text("\n".join(lines), encoding="utf-8")
        curve = getattr(load(tmp_path / "my.toml"), row.name)
        shown = [axis.unit.from_si(value, units) for axis, value in ((row.x, curve.x[-1]), (row.y, curve.y[-1]))]
        if units is ff.UnitSystem.US:
            assert shown == pytest.approx(row.example[-1])


def with_curve(text: str) -> str:
    """The built-in loader's file with a table of a curve."""
    return f"{elevator().to_toml()}\n{text}"


FORCE = '[feel.force_curve]\nunits = ["deg", "lb"]\npoints = [[-20, -60], [-5, -20], [0, 0], [5, 18], [20, 75]]\n'
FACTOR = '[feel.stiffness_factor]\nunits = ["lb/ft^2", ""]\npoints = [[0, 0.4], [100, 1.0], [300, 2.2]]\n'


def read(tmp_path: Path, text: str) -> Loader:
    path = tmp_path / "my.toml"
    path.write_text(text, encoding="utf-8")
    return load(path)


def test_curves_of_a_file_are_in_si_units(tmp_path: Path) -> None:
    loader = read(tmp_path, with_curve(FORCE + FACTOR))
    assert loader.force_curve is not None
    assert loader.stiffness_factor is not None
    assert loader.force_curve.x == pytest.approx([DEGREE * x for x in (-20, -5, 0, 5, 20)])
    assert loader.force_curve.y == pytest.approx([POUND * y for y in (-60, -20, 0, 18, 75)])
    assert loader.stiffness_factor.x == pytest.approx([POUND / SQUARE_FOOT * x for x in (0, 100, 300)])
    assert loader.stiffness_factor.y == (0.4, 1.0, 2.2)
    assert list(loader.curves) == ["force_curve", "stiffness_factor"]
    assert elevator().curves == {}


@pytest.mark.parametrize("units", list(ff.UnitSystem))
def test_curves_round_trip_through_file(tmp_path: Path, units: ff.UnitSystem) -> None:
    loader = read(tmp_path, with_curve(FORCE + FACTOR))
    once = read(tmp_path, loader.to_toml(units))
    for name, curve in loader.curves.items():
        assert once.curves[name].x == pytest.approx(curve.x, rel=TEN_DIGITS)
        assert once.curves[name].y == pytest.approx(curve.y, rel=TEN_DIGITS)
    assert read(tmp_path, once.to_toml(units)) == once


@given(curves(), st.sampled_from(list(ff.UnitSystem)))
def test_random_curve_round_trips_through_file(
    tmp_path_factory: pytest.TempPathFactory, curve: Curve, units: ff.UnitSystem
) -> None:
    span = max(map(abs, (*curve.x, *curve.y)))
    small = Curve([x / span for x in curve.x], [y / span for y in curve.y])
    path = tmp_path_factory.getbasetemp() / "curve.toml"
    path.write_text(dataclasses.replace(elevator(), force_curve=small).to_toml(units), encoding="utf-8")
    back = load(path).force_curve
    assert back is not None
    # Below 1e-300 floats themselves have fewer digits.
    assert (*back.x, *back.y) == pytest.approx((*small.x, *small.y), rel=TEN_DIGITS, abs=1e-300)


def test_curves_are_part_of_a_loader(tmp_path: Path) -> None:
    loader = read(tmp_path, with_curve(FORCE + FACTOR))
    assert loader != read(tmp_path, with_curve(FORCE)) != read(tmp_path, with_curve(""))
    assert pickle.loads(pickle.dumps(loader)) == loader
    assert hash(pickle.loads(pickle.dumps(loader))) == hash(loader)
    assert loader.replace({"linkage.stiffness": "7000 lb/in"}).curves == loader.curves
    assert dataclasses.replace(loader, force_curve=None, stiffness_factor=None).curves == {}


def test_a_scaled_feel_has_a_scaled_curve(tmp_path: Path) -> None:
    loader = read(tmp_path, with_curve(FORCE + FACTOR))
    scaled = loader.scale_feel(0.5)
    assert loader.force_curve is not None
    assert scaled.force_curve == Curve(loader.force_curve.x, [y / 2 for y in loader.force_curve.y])
    assert scaled.stiffness_factor == loader.stiffness_factor


STATED = 'expected units = ["deg", "lb"] and points = [[-20, -60], [-5, -20], [0, 0], ...]'
POINT = "points: expected a pair of numbers such as [20, 75] as point"
UNITS = 'units: expected the two units of a point, such as ["deg", "lb"], got'


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('units = ["deg", "lb"]', f"{STATED}; points missing"),
        ("points = [[0, 0], [1, 1]]", f"{STATED}; units missing"),
        ("", f"{STATED}; units and points missing"),
        ('units = ["deg", "lb"]\npoints = []\nx = 1', f"{STATED}, got the key 'x'"),
        ('units = ["deg", "lb"]\npoints = []', "expected 2 to 32 points, got 0"),
        ('units = ["deg", "lb"]\npoints = [[0, 0]]', "expected 2 to 32 points, got 1"),
        ('units = ["deg", "lb"]\npoints = 5', "points: expected pairs of numbers, got 5"),
        ('units = ["deg", "lb"]\npoints = [0, 1]', f"{POINT} 1, got 0"),
        ('units = ["deg", "lb"]\npoints = [[0, 0], [1]]', f"{POINT} 2, got [1]"),
        ('units = ["deg", "lb"]\npoints = [[0, 0], [1, 2, 3]]', f"{POINT} 2, got [1, 2, 3]"),
        ('units = ["deg", "lb"]\npoints = [[0, 0], [1, "2 lb"]]', f"{POINT} 2, got [1, '2 lb']"),
        ('units = ["deg", "lb"]\npoints = [[0, 0], [1, true]]', f"{POINT} 2, got [1, true]"),
        ('units = ["deg", "lb"]\npoints = [[0, 0], [1, nan]]', "expected finite y, got nan at point 2"),
        ('units = ["deg", "lb"]\npoints = [[0, 0], [inf, 1]]', "expected finite x, got inf at point 2"),
        (
            'units = ["deg", "lb"]\npoints = [[0, 0], [5, 1], [5, 2]]',
            "expected x to rise from point to point, got point 2 [5, 1] and point 3 [5, 2]",
        ),
        (
            'units = ["deg", "lb"]\npoints = [[0, 0], [5, 18], [20, 17]]',
            "expected y never to fall from point to point, got point 2 [5, 18] and point 3 [20, 17]",
        ),
        (
            'units = ["deg", "lb"]\npoints = [[0, 0], [181, 1]]',
            "angle out of range: expected -180 to 180 deg, got 181 deg",
        ),
        (
            'units = ["deg", "kip"]\npoints = [[0, 0], [1, 11]]',
            "force out of range: expected -10000 to 10000 lb, got 11000 lb",
        ),
        ('units = ["deg"]\npoints = []', f"{UNITS} ['deg']"),
        ('units = "deg"\npoints = []', f"{UNITS} 'deg'"),
        ("units = [1, 2]\npoints = []", f"{UNITS} [1, 2]"),
        ('units = ["deg", "kg"]\npoints = []', "units: force: 'kg' measures a mass, not a force"),
        ('units = ["lb", "deg"]\npoints = []', "units: angle: 'lb' measures a force, not an angle"),
    ],
)
def test_bad_force_curve_gives_one_line_error(tmp_path: Path, table: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, with_curve(f"[feel.force_curve]\n{table}"))
    assert str(caught.value) == f"{tmp_path / 'my.toml'}: feel.force_curve: {message}"


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ("[[0, 0.0], [100, 1]]", "factor out of range: expected 0.001 to 1000, got 0"),
        ("[[0, -0.5], [100, 1]]", "factor out of range: expected 0.001 to 1000, got -0.5"),
        ("[[-1, 0.5], [100, 1]]", "dynamic pressure out of range: expected 0 to 100000 lb/ft^2, got -1 lb/ft^2"),
    ],
)
def test_bad_stiffness_factor_gives_one_line_error(tmp_path: Path, points: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, with_curve(f'[feel.stiffness_factor]\nunits = ["lb/ft^2", ""]\npoints = {points}'))
    assert str(caught.value) == f"{tmp_path / 'my.toml'}: feel.stiffness_factor: {message}"


def test_non_table_or_misplaced_curve_raises_input_error(tmp_path: Path) -> None:
    text = elevator().to_toml().replace("\n[feel]\n", "\n[feel]\nforce_curve = 5\n")
    with pytest.raises(InputError, match=r"feel\.force_curve: expected units = .+, got 5$"):
        read(tmp_path, text)
    with pytest.raises(InputError, match=r"column\.force_curve: unknown key; it belongs in the table \[feel\]$"):
        read(tmp_path, with_curve(FORCE.replace("feel", "column")))
    with pytest.raises(InputError, match=r"feel\.force_curv: unknown key; did you mean force_curve\?$"):
        read(tmp_path, with_curve(FORCE.replace("force_curve", "force_curv")))


def test_invalid_curve_of_loader_raises_input_error() -> None:
    with pytest.raises(InputError, match=r"^feel\.force_curve: expected a Curve, got 5$"):
        dataclasses.replace(elevator(), force_curve=5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^feel\.stiffness_factor: factor out of range: .+, got 0$"):
        dataclasses.replace(elevator(), stiffness_factor=Curve((0, 1), (0, 1)))


def test_the_file_of_a_loader_with_curves_is_plain_toml(tmp_path: Path) -> None:
    document = tomllib.loads(read(tmp_path, with_curve(FORCE)).to_toml())
    assert document["feel"]["force_curve"] == tomllib.loads(FORCE)["feel"]["force_curve"]
    assert "stiffness_factor" not in document["feel"]
