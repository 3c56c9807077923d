"""A flight schedule: feels and laws at knots and by interpolation between them; its knots from a file."""

from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.flight_schedule import (
    FlightSchedule,
    ScheduleAxis,
    check_schedule,
    design_schedule,
    read_knots,
    second_order_feel,
)
from forcefeel.flight_schedule.page.plots import gains
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.units import factor

PRESSURE = ScheduleAxis("dynamic pressure", "lb/ft^2", (50, 100, 200, 400))
FLAPS = ScheduleAxis("flaps", "deg", (0, 15, 30))
ROUNDING = 1e-12
"""Relative: sums of some products of numbers near one."""


def numbers(law: SampledLaw) -> np.ndarray:
    parts = (law.transition, law.input, law.command, law.torque)
    return np.hstack([part.reshape(law.settings, -1) for part in parts])


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.digital_elevator()


@pytest.fixture(scope="module")
def line(loader: ff.Loader) -> FlightSchedule:
    stiffness = np.array([0.1, 0.2, 0.4, 0.8]) * loader["feel.maximum_stiffness"]
    return design_schedule(loader, [PRESSURE], second_order_feel(stiffness, [1.0, 1.2, 1.5, 2.0], 0.6))


@pytest.fixture(scope="module")
def plane(loader: ff.Loader) -> FlightSchedule:
    stiffness = np.outer([0.1, 0.2, 0.4, 0.8], [1.0, 1.2, 1.5]) * loader["feel.maximum_stiffness"]
    return design_schedule(loader, [PRESSURE, FLAPS], second_order_feel(stiffness, 1.5, [0.4, 0.6, 0.8]))


def test_motor_gains_are_in_amperes() -> None:
    motor = ff.loader.electric("rudder-pedals")
    feel = second_order_feel(np.array([0.1, 0.4]) * motor["feel.maximum_stiffness"], 1.5, 0.6)
    pressure = ScheduleAxis(PRESSURE.name, PRESSURE.unit, PRESSURE.values[:2])
    drawn = gains(design_schedule(motor, [pressure], feel), 2, ff.UnitSystem.SI)
    names = [curve.name for curve in drawn.data if curve.showlegend is not False]
    assert names
    assert all(" A" in name and "piston" not in name for name in names)


def test_second_order_feel_has_the_specified_frequency_and_damping() -> None:
    inertia, damping, stiffness = second_order_feel(1000.0, 1.6, 0.3)
    roots = np.roots([inertia, damping, stiffness])
    np.testing.assert_allclose(np.abs(roots), 2 * np.pi * 1.6, rtol=ROUNDING)
    np.testing.assert_allclose(-roots.real / np.abs(roots), 0.3, rtol=ROUNDING)


def test_knot_gives_the_law_designed_there(loader: ff.Loader, plane: FlightSchedule) -> None:
    there = plane.at(dynamic_pressure=200, flaps=15)
    np.testing.assert_array_equal(there.feel, plane.feel[2, 1])
    own = LAW_DESIGNS["robust"].design(loader, [there.feel])
    np.testing.assert_array_equal(numbers(plane.laws.some(2 * 3 + 1)), numbers(there.law))
    np.testing.assert_allclose(numbers(there.law), numbers(own), rtol=1e-9, atol=1e-9)  # two Riccati solutions
    assert [there.loader[key] for key in ("feel.inertia", "feel.damping", "feel.stiffness")] == pytest.approx(
        there.feel, rel=ROUNDING
    )


def test_law_numbers_are_linear_between_two_knots(line: FlightSchedule) -> None:
    there = line.at(dynamic_pressure=125)
    np.testing.assert_allclose(there.feel, 0.75 * line.feel[1] + 0.25 * line.feel[2], rtol=ROUNDING)
    blended = line.laws.some(1).between(line.laws.some(2), 0.25)
    np.testing.assert_allclose(numbers(there.law), numbers(blended), rtol=ROUNDING, atol=ROUNDING)
    np.testing.assert_allclose(there.law.settled, blended.settled, rtol=1e-6)  # near an integrator


def test_law_is_bilinear_on_two_axes(plane: FlightSchedule) -> None:
    corners = [plane.at(dynamic_pressure=q, flaps=f) for q in (100, 200) for f in (15, 30)]
    there = plane.at(dynamic_pressure=130, flaps=27)
    weights = np.outer([0.7, 0.3], [0.2, 0.8]).ravel()
    np.testing.assert_allclose(there.feel, weights @ [corner.feel for corner in corners], rtol=ROUNDING)
    expected = weights @ np.vstack([numbers(corner.law) for corner in corners])
    np.testing.assert_allclose(numbers(there.law)[0], expected, rtol=ROUNDING, atol=ROUNDING)


def test_batched_points_match_single_points(plane: FlightSchedule) -> None:
    where = np.array([[60.0, 3.0], [400.0, 30.0], [199.0, 16.0]])
    feel, laws = plane.between(where)
    for k, (pressure, flaps) in enumerate(where):
        one = plane.at(dynamic_pressure=pressure, flaps=flaps)
        np.testing.assert_array_equal(feel[k], one.feel)
        np.testing.assert_array_equal(laws.rows()[k], one.law.rows()[0])


def test_change_includes_feel_and_law(line: FlightSchedule) -> None:
    change, there = line.change(1.0, 0.25, dynamic_pressure=300), line.at(dynamic_pressure=300)
    assert (change.at_s, change.fade_s) == (1.0, 0.25)
    assert tuple(change.changes) == ("feel.inertia", "feel.damping", "feel.stiffness")
    assert tuple(change.changes.values()) == there.feel
    assert change.law is not None
    np.testing.assert_array_equal(change.law.rows(), there.law.rows())


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ({"dynamic_pressure": 401}, "within the knots, 50 to 400 lb/ft\\^2, got 401"),
        ({"dynamic_pressure": float("nan")}, "within the knots"),
        ({"dynamic_pressure": "100"}, "within the knots"),
        ({"mach": 0.5}, "expected dynamic_pressure=..., got mach"),
        ({}, "got nothing"),
    ],
)
def test_points_outside_the_schedule_are_refused(line: FlightSchedule, where: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        line.at(**where)
    with pytest.raises(InputError, match=message):
        line.change(1.0, 0.5, **where)


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("q", (1.0,), "two or more"),
        ("q", (1.0, 1.0), "rise"),
        ("q", (1.0, np.inf), "finite"),
        ("q", ("a", "b"), "expected numbers"),
        ("q (Pa)", (1.0, 2.0), "name of words"),
        ("at_s", (1.0, 2.0), "name of words"),
    ],
)
def test_invalid_axes_raise_input_error(name: str, values: tuple[float, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ScheduleAxis(name, "Pa", values)


def test_invalid_schedules_raise_input_error(loader: ff.Loader, line: FlightSchedule) -> None:
    feel = line.feel
    with pytest.raises(InputError, match=r"the shape \(4, 3\), got \(3, 3\)"):
        design_schedule(loader, [PRESSURE], feel[:3])
    with pytest.raises(InputError, match=r"feel\.stiffness: expected .* at dynamic pressure 100 lb/ft"):
        design_schedule(loader, [PRESSURE], np.where(np.arange(12).reshape(4, 3) == 5, -1.0, feel))
    with pytest.raises(InputError, match=r"expected .*robust.*, got 'best'"):
        design_schedule(loader, [PRESSURE], feel, "best")
    with pytest.raises(InputError, match="different names"):
        design_schedule(loader, [PRESSURE, PRESSURE], feel)
    with pytest.raises(InputError, match="1 to 3"):
        design_schedule(loader, [], feel)
    with pytest.raises(InputError, match=r"controller\.period"):
        design_schedule(ff.elevator(), [PRESSURE], feel)
    with pytest.raises(InputError, match="one for each of 4 knots, got 2"):
        FlightSchedule(loader, "robust", (PRESSURE,), feel, line.laws.some([0, 1]))
    with pytest.raises(InputError, match="refine: expected a whole number from 2 to 2,000,000, got 1"):
        check_schedule(line, 1)
    with pytest.raises(InputError, match="take a smaller refine"):
        check_schedule(line, 1_000_000)


KNOTS = """flaps (deg),stiffness (lb in/rad),dynamic pressure (lb/ft^2),frequency (Hz),damping ratio
20,8000,200,1.5,0.7

0,3000,50,1,0.6
20,4000,50,1.1,0.6
0,7000,200,1.4,0.7
"""


def knots(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "knots.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_knots_are_read_in_any_order(tmp_path: Path) -> None:
    found = read_knots(knots(tmp_path, KNOTS))
    assert found.axes == (
        ScheduleAxis("flaps", "deg", (0, 20)),
        ScheduleAxis("dynamic pressure", "lb/ft^2", (50, 200)),
    )
    stiffness = np.array([[3000, 7000], [4000, 8000]]) * factor("lb in/rad", "N m/rad")
    expected = second_order_feel(stiffness, [[1.0, 1.4], [1.1, 1.5]], [0.6, 0.7])
    np.testing.assert_allclose(found.feel, expected, rtol=ROUNDING)


def test_knots_accept_i_b_g_and_a_unitless_axis(tmp_path: Path) -> None:
    text = "Mach,I (lb in s^2/rad),B (lb in s/rad),G (lb in/rad)\n0.3,60,300,4800\n0.8,60,400,9600\n"
    found = read_knots(knots(tmp_path, text))
    assert [axis.keyword for axis in found.axes] == ["mach"]
    scale = factor("lb in/rad", "N m/rad")
    np.testing.assert_allclose(found.feel, scale * np.array([[60, 300, 4800], [60, 400, 9600]]), rtol=ROUNDING)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "0,7000,200,1.4,0.7\n",
            "",
            "full grid of 2 by 2 knots, got 3; missing: flaps 0 deg, dynamic pressure 200",
        ),
        (
            "0,7000,200,1.4",
            "20,7000,200,1.4",
            "line 6: flaps 20 deg, dynamic pressure 200 lb/ft.2 is already in line 2",
        ),
        ("7000,200", "much,200", "line 6: stiffness: expected a finite number, got 'much'"),
        ("7000,200", "nan,200", "line 6: stiffness: expected a finite number"),
        ("0,7000,200,1.4,0.7", "0,7000,200,1.4", "line 6: expected 5 values as in the header, got 4"),
        ("(lb in/rad)", "", "stiffness: has no unit; write 'stiffness \\(lb in/rad\\)'"),
        ("(lb in/rad)", "(lb)", "stiffness: 'lb' measures"),
        ("damping ratio", "damping", "as stiffness, frequency and damping ratio, or as I, B and G"),
        ("flaps (deg)", "frequency (Hz)", "2 columns 'frequency'"),
        ("flaps (deg)", "flaps/gear", "name of words"),
        ("frequency (Hz)", "frequency (Hz) !", "expected a column such as"),
        (",1.4,", ",0,", "frequency_hz: expected numbers above 0"),
    ],
)
def test_invalid_knots_file_is_refused_with_its_row(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert KNOTS.count(old) == 1
    with pytest.raises(InputError, match=message) as refused:
        read_knots(knots(tmp_path, KNOTS.replace(old, new)))
    assert "knots.csv" in str(refused.value)


@pytest.mark.parametrize(("text", "message"), [("", "is empty"), (KNOTS.splitlines()[0], "rows of numbers")])
def test_file_without_knots_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_knots(knots(tmp_path, text))
    with pytest.raises(InputError, match="cannot be read"):
        read_knots(tmp_path / "none.csv")
