"""Feels from points of a control by formulas of the test's own: curve, rows, intervals, and the tests that they pass."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import forcefeel as ff
from forcefeel._core import feel_held_along
from forcefeel.feel.directions import Directions
from forcefeel.feel.result import Source
from tests.feel_witness import ARM_M, BUILD_UP_RAD, Control, linear, progressive, stopped
from tests.parametrization import mostly_slow

POUND_N = 4.4482216152605
CURVE_N, CURVE = POUND_N, 0.03
"""How near the feel's force comes to the aircraft's: 1 lb, or a share of it."""
LOOP = (np.array([-15, -6, 1.5, 3, 8, 14.5, 13, 6, -1.5, -3, -8, -14]), np.array([1.0] * 6 + [-1.0] * 6))
"""Angles in deg and directions of points around a loop."""
OUT = np.array([-15, -11, -7, -3, -1.5, 1.5, 3, 7, 11, 15])
"""Ten points, each on the way out."""
NOISE_N = 0.5
NEAR_N = 3 * NOISE_N
"""Three standard deviations of a single point, wider than the interval of a row that twelve points give."""
EXACT = 0.01
"""N, deg; of points without noise, where the search ends at a millionth of the unknowns and of the squares."""
MOTION = 0.05
"""Relative; of inertia and damping, which take the interval of the spring with them."""
SHAPES = [linear, progressive, stopped]
loader = ff.digital_elevator()


def fitted(points, **stated):
    return ff.feel.fit_feel(points, ff.feel.FeelPlan(loader, **stated))


def off_the_control(fit, control):
    """The largest distance of the feel from the control, as a share of what is allowed."""
    clear = np.abs(fit.angle_rad) > 2 * BUILD_UP_RAD
    shares = []
    for force, direction in ((fit.up_n, 1.0), (fit.down_n, -1.0)):
        true = control.static(fit.angle_rad, direction)
        shares.append(np.max((np.abs(force - true) / np.maximum(CURVE_N, CURVE * np.abs(true)))[clear]))
    return max(shares)


@cache
def looped(spring, seed):
    """The fit to a loop of noisy points."""
    return fitted(Control(spring).points(*LOOP, NOISE_N, seed))


@pytest.mark.parametrize("spring", mostly_slow(SHAPES))
def test_loop_of_points_gives_curve_breakout_and_friction(spring):
    control, fit = Control(spring), looped(spring, 0)
    assert off_the_control(fit, control) < 1
    assert fit.directions is Directions.STATED
    for key, true in (("feel.breakout", control.breakout_n), ("feel.coulomb_friction", control.friction_n)):
        row = fit.row(key)
        assert row.source is Source.POINTS
        assert row.value_si == pytest.approx(true, abs=NEAR_N)


@pytest.mark.slow
@pytest.mark.parametrize("spring", mostly_slow(SHAPES))
def test_ten_outward_points_with_stated_friction_give_curve_and_breakout(spring):
    control = Control(spring)
    fit = fitted(control.points(OUT, np.sign(OUT), NOISE_N, stated=False), friction_n=6.0)
    assert off_the_control(fit, control) < 1
    assert fit.directions is Directions.OUTWARD
    assert fit.row("feel.breakout").value_si == pytest.approx(8.0, abs=NEAR_N)
    assert fit.row("feel.coulomb_friction").source is Source.STATED


@pytest.mark.slow
def test_outward_points_alone_program_the_sum_as_breakout_and_say_so():
    fit = fitted(Control().points(OUT, np.sign(OUT), stated=False))
    assert fit.loader["feel.breakout"] == pytest.approx(14.0, abs=EXACT)
    assert fit.loader["feel.coulomb_friction"] == 0
    (sentence,) = (text for text in ff.feel.feel_conclusions(fit, ff.UnitSystem.SI).findings if "told apart" in text)
    assert "their sum is programmed as breakout" in sentence


@pytest.mark.slow
def test_stated_breakout_leaves_the_rest_of_outward_points_to_friction():
    fit = fitted(Control().points(OUT, np.sign(OUT), stated=False), breakout_n=8.0)
    assert fit.loader["feel.breakout"] == 8.0
    assert fit.loader["feel.coulomb_friction"] == pytest.approx(6.0, abs=EXACT)


@pytest.mark.slow
def test_recorded_sweep_of_thousands_of_points_gives_the_same_feel():
    """With time the points are in order; hysteresis, which the aircraft has not, is not programmed."""
    control = Control(progressive)
    record = control.swept(14.0, 60.0, rate=20.0)
    x, force = record.position[1:], record.force_n[1:]
    moving = np.abs(np.gradient(x)) > 1e-6  # rad a sample; where it sticks the force is not that of motion
    direction = np.sign(np.gradient(x))
    points = ff.qualification.ForcePoints(x[moving], force[moving], direction[moving], in_order=True)
    fit = fitted(points)
    assert off_the_control(fit, control) < 1
    assert fit.row("feel.hysteresis") is None
    assert fit.loader["feel.coulomb_friction"] == pytest.approx(6.0, abs=NOISE_N)


@pytest.mark.slow
def test_intervals_hold_the_true_values():
    """Of 95 % intervals, 18 leave at most one in six out; intervals of four fifths fail."""
    missed, count = 0, 0
    true = {"feel.stiffness": 6 * 180 / math.pi * ARM_M, "feel.breakout": 8.0, "feel.coulomb_friction": 6.0}
    for seed in range(6):
        fit = looped(linear, seed)
        for key, value in true.items():
            row = fit.row(key)
            missed += abs(row.value_si - value) > row.half_interval_si
            count += 1
    assert missed <= count / 6
    assert row.half_interval_si < 4 * NOISE_N


@pytest.mark.slow
def test_stated_uncertainty_weighs_the_points():
    """Three points off by 5 N, and said to be: they move the feel by less than a tenth of that."""
    points = Control().points(*LOOP)
    wrong = np.zeros(len(points.force_n))
    wrong[[2, 5, 7]] = 5.0
    known = np.where(wrong > 0, 50.0, 0.05)
    weighed = ff.qualification.ForcePoints(points.position, points.force_n + wrong, points.direction, known)
    assert fitted(weighed).loader["feel.breakout"] == pytest.approx(8.0, abs=NEAR_N / 15)


@pytest.mark.slow
def test_loop_without_directions_is_told_by_its_two_branches():
    angle = np.repeat(np.array([-14, -10, -6, -2, 2, 6, 10, 14.0]), 2)
    points = Control().points(angle, np.tile([1.0, -1.0], 8), 0.2, stated=False)
    fit = fitted(points)
    assert fit.directions is Directions.ASSIGNED
    assert fit.loader["feel.coulomb_friction"] == pytest.approx(6.0, abs=NOISE_N)
    assert fit.loader["feel.breakout"] == pytest.approx(8.0, abs=2 * NOISE_N)


@pytest.mark.slow
def test_deadband_and_preload_show():
    angle = np.array([-12, -9, -6, -3.5, -2, -1, 1, 2, 3.5, 6, 9, 12])
    force = 10.0 + 6.0 * np.sign(angle) * np.maximum(np.abs(angle) - 3.0, 0)
    fit = fitted(ff.qualification.ForcePoints(np.radians(angle), force))
    assert math.degrees(fit.loader["feel.deadband"]) == pytest.approx(3.0, abs=EXACT)
    assert fit.loader["feel.preload"] == pytest.approx(10.0, abs=EXACT)
    assert fit.loader["feel.breakout"] == 0


@pytest.mark.slow
def test_hysteresis_shows_in_the_order_of_time():
    """A play of 0.8 deg to either side, by an operator of the test's own, beside dry friction."""
    corners = [0, 12, -12, 12, 0]
    angle = np.concatenate([np.linspace(a, b, 20, endpoint=False) for a, b in pairwise(corners)])
    slider, forces, last = 0.0, [], 0.0
    for x in angle:
        slider = min(max(slider, x - 0.8), x + 0.8)
        forces.append(6 * x + 5 * (x - slider) / 0.8 + 3 * np.sign(x - last or 1))
        last = x
    direction = np.sign(np.diff(angle, prepend=-1.0))
    fit = fitted(ff.qualification.ForcePoints(np.radians(angle), np.array(forces), direction, in_order=True))
    assert fit.loader["feel.hysteresis"] == pytest.approx(5.0, abs=5 * EXACT)
    assert math.degrees(fit.loader["feel.hysteresis_travel"]) == pytest.approx(0.8, abs=2 * EXACT)
    assert fit.loader["feel.coulomb_friction"] == pytest.approx(3.0, abs=5 * EXACT)


def test_engine_along_a_path_is_the_formula_of_the_test():
    control = Control()
    stiffness = 6 * 180 / math.pi * ARM_M
    rows = {"feel.stiffness": stiffness, "feel.breakout": 8.0, "feel.coulomb_friction": 6.0}
    angle, direction = np.radians([-10, -0.05, 0, 0.05, 3.0]), np.array([1.0, -1.0, 0.0, 1.0, -1.0])
    force = feel_held_along(loader.replace(rows, si=True).si_values, angle, direction)
    assert force == pytest.approx(control.static(angle, direction), abs=1e-9)  # rounding


def test_points_on_one_side_are_mirrored_and_said():
    angle = np.array([2, 4, 6, 8, 10, 12.0])
    fit = fitted(Control().points(angle, 1.0, stated=False), friction_n=6.0)
    assert any("mirrors the other side" in text for text in ff.feel.feel_conclusions(fit, ff.UnitSystem.SI).findings)
    assert fit.loader["feel.breakout"] == pytest.approx(8.0, abs=EXACT)


@pytest.mark.slow
def test_positions_as_lengths_are_angles_of_the_grip():
    points = Control().points(*LOOP)
    length = ff.qualification.ForcePoints(
        points.position * loader["column.grip_arm"], points.force_n, points.direction, position_unit="m"
    )
    stiffness = 6 * 180 / math.pi * ARM_M
    assert fitted(length).loader["feel.stiffness"] == pytest.approx(stiffness, rel=EXACT / 6)  # EXACT N/deg of 6


@pytest.mark.slow
def test_loader_qualifies_against_the_aircraft_and_its_points():
    """7 of 7: against sweeps and releases that the test integrates, and against the ten points."""
    control = Control(progressive, damping=25.0)
    points = control.points(OUT, np.sign(OUT), NOISE_N, stated=False)
    release = control.released(8.0, noise_deg=0.02)
    fit = fitted(points, friction_n=6.0, release=release)
    assert fit.loader["feel.inertia"] == pytest.approx(control.inertia, rel=MOTION)
    assert fit.loader["feel.damping"] == pytest.approx(control.damping, rel=MOTION)
    throw = 16.0
    aircraft = {"static": control.swept(0.97 * throw, 100), "medium": control.swept(0.97 * throw, 9.0)}
    aircraft["fast"] = control.swept(0.97 * throw, 4.0)
    for sign, side in ((1, "positive"), (-1, "negative")):
        aircraft |= {f"release-{share}-{side}": control.released(sign * share / 100 * throw) for share in (25, 50)}
    for references in (aircraft, {"static": points}):
        setup = ff.qualification.QualificationSetup(
            laws=("robust",), references=references, throw_rad=math.radians(throw)
        )
        (section,) = ff.qualify_loader(fit.loader, setup).sections
        assert [str(result.outcome) for result in section.results] == ["passed"] * 7


@pytest.mark.slow
def test_soft_stop_qualifies_with_the_damping_ratio_of_the_spring():
    control = Control(stopped, damping=25.0)
    points = control.points(OUT, np.sign(OUT), NOISE_N, stated=False)
    fit = fitted(points, friction_n=6.0, release=control.released(7.0, noise_deg=0.02))
    assert math.degrees(fit.loader["feel.soft_stop_high"]) == pytest.approx(8.0, abs=20 * EXACT)
    assert fit.row("feel.soft_stop_damping").source is Source.ASSUMED
    setup = ff.qualification.QualificationSetup(
        laws=("robust",), references={"static": points}, throw_rad=math.radians(16)
    )
    (section,) = ff.qualify_loader(fit.loader, setup).sections
    assert [str(result.outcome) for result in section.results] == ["passed"] * 7


@pytest.mark.slow
def test_points_fail_a_feel_whose_breakout_is_off():
    control = Control(damping=14.0)
    points = control.points(OUT, np.sign(OUT), stated=False)
    fit = fitted(points, friction_n=6.0)
    harder = fit.loader.replace({"feel.breakout": "22 N"})
    setup = ff.qualification.QualificationSetup(laws=("robust",), references={"static": points}, tests=("static",))
    (section,) = ff.qualify_loader(harder, setup).sections
    assert str(section.results[0].outcome) == "failed"
    assert {verdict.quantity for verdict in section.results[0].verdicts if str(verdict.outcome) == "failed"} >= {
        "breakout, positive",
        "breakout, negative",
    }
