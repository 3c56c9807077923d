"""What holds the programmed feel: beside a slow push and pull of the engine, row by row, and beside a sum written out here.

Every row of the feel is in play, with the value that the parameter table gives as an example, and each once more with another one:
a row that joins the feel without its statics fails here.
"""

from dataclasses import replace
from math import degrees, radians

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.loader.curves import Curve
from forcefeel.loader.parameters import OFF, TABLE
from forcefeel.simulation.inputs import Recorded, Release, Schedule
from forcefeel.sizing.demand import hardest_angle, programmed_force
from tests.parametrization import mostly_slow

POUND_N, DEG = 4.4482216152605, radians(1)
ROUNDING = 1e-9  # relative; a sum of ten forces
NEAR_N = 0.6
"""Of 300 N: what still swings behind the knees of breakout and detent."""
QUIET = dict.fromkeys(
    f"{one}.{row}" for one in ("load_cell", "potentiometer", "column_sensor") for row in ("noise", "resolution")
)
ELEVATOR = ff.digital_elevator().replace(QUIET, si=True)
DAMPED = ELEVATOR.replace({"feel.damping": 5 * ELEVATOR["feel.damping"]}, si=True)
"""So that little swings behind a knee."""
NOT_IN_A_SWEEP = {"feel.static_friction", "feel.shaker_force", "feel.shaker_frequency"}
"""What acts on a control that rests, or while the shaker is on: tests of their own."""
EVERY = {key: TABLE[key].default_si for key in OFF if key.startswith("feel.") and key not in NOT_IN_A_SWEEP}
ROWS = sorted(key for key in TABLE if key.startswith("feel.") and key not in NOT_IN_A_SWEEP)
OTHER = 0.8
"""Times the example."""
SWEEP_S, SAMPLE_S = 60.0, 0.01
PROBES_DEG = np.array([-16.0, -13.0, -8.0, -3.0, 3.0, 5.5, 6.5, 8.0, 13.0, 16.0])
"""Where nothing has a knee; the outer ones are in the soft stops."""


def swept(loader, most_n):
    """Force and programmed angle of a push to one end, a pull to the other and back, as slow as can be."""
    times, forces = np.array([0.0, 0.25, 0.75, 1.0]) * SWEEP_S, np.array([0.0, 1.0, -1.0, 0.0]) * most_n
    time = np.linspace(0.0, SWEEP_S, 6001)
    force = Recorded(time, np.interp(time, times, forces))
    run = ff.simulate(loader, ff.Scenario(force, SWEEP_S, sample_s=SAMPLE_S), "robust").history
    return run.time_s.values, np.interp(run.time_s.values, times, forces), run.feel_position_rad.values


def at_angles(loader, force, angle, probes):
    """Force at which the angle comes by each of the probes, without what its motion takes: eq. (11)."""
    rate = np.gradient(angle, SAMPLE_S)
    moved = loader["feel.inertia"] * np.gradient(rate, SAMPLE_S) + loader["feel.damping"] * rate
    moved += loader["feel.quadratic_damping"] * rate * np.abs(rate)
    held, order = force - moved / loader["column.grip_arm"], np.argsort(angle)
    return np.interp(probes, angle[order], held[order])


@pytest.mark.parametrize("row", mostly_slow(ROWS, 4))
def test_slow_push_and_pull_match_holding_force(row):
    loader = DAMPED.replace(EVERY | {row: OTHER * EVERY.get(row, DAMPED[row])}, si=True)
    probes = PROBES_DEG * DEG
    within = (probes > loader["feel.hard_stop_low"]) & (probes < loader["feel.hard_stop_high"])
    told = ff._core.feel_held_between(loader.si_values, probes)
    time, force, angle = swept(loader, 1.3 * np.abs(told).max())
    up = (time > 0.75 * SWEEP_S) | (time < 0.25 * SWEEP_S)
    outwards = at_angles(loader, force[up], angle[up], probes)
    back = at_angles(loader, force[~up], angle[~up], probes)
    np.testing.assert_allclose(outwards[within], told[within, 1], atol=NEAR_N)
    np.testing.assert_allclose(back[within], told[within, 0], atol=NEAR_N)


ANGLES = ("_angle", "_travel", "deadband", "_low", "_high")


def sum_of_forces(rows, phi, way):
    """Force in lb at an angle in rad, hysteresis and friction against ``way``, of rows in lb, in and rad."""
    of = rows.get
    u = (phi - of("detent_angle", 0.0)) / of("detent_travel", DEG)
    stop = of("soft_stop_stiffness", 5e4) * (phi - min(max(phi, of("soft_stop_low", -9.0)), of("soft_stop_high", 9.0)))
    spring = 9600.0 * np.sign(phi) * max(abs(phi) - of("deadband", 0.0), 0.0)
    held = of("breakout", 0.0) * min(max(phi / of("breakout_travel", 0.1 * DEG), -1.0), 1.0) + of("preload", 0.0)
    held += of("detent_force", 0.0) * np.sign(u) * max(min(abs(u), 2 - abs(u)), 0.0)
    sided = (
        of("hysteresis", 0.0) + max(of("coulomb_friction", 0.0), of("static_friction", 0.0)) + of("shaker_force", 0.0)
    )
    return (spring + stop) / 31.375 + held + way * sided


@pytest.mark.parametrize(
    "rows",
    [
        {"detent_force": 20.0, "detent_angle": 9 * DEG},
        {"breakout": 4.0, "breakout_travel": 2 * DEG, "preload": -3.0, "deadband": DEG},
        {"hysteresis": 2.0, "coulomb_friction": 1.0, "static_friction": 3.0, "shaker_force": 10.0},
        {"soft_stop_low": -4 * DEG, "soft_stop_high": 6 * DEG, "soft_stop_stiffness": 2e4},
    ],
)
def test_holding_force_is_sum_of_feel_forces(rows):
    def text(key, value):
        return value if key.endswith(ANGLES) else f"{value!r} {'lb in/rad' if key.endswith('stiffness') else 'lb'}"

    given = {f"feel.{key}": text(key, value) for key, value in rows.items()}
    loader, angles = ELEVATOR.replace(given, si=True), np.linspace(-11.0, 11.0, 45) * DEG
    told = ff._core.feel_held_between(loader.si_values, angles) / POUND_N
    expected = [[sum_of_forces(rows, phi, way) for way in (-1, 1)] for phi in angles]
    np.testing.assert_allclose(told, expected, rtol=ROUNDING, atol=ROUNDING)
    np.testing.assert_allclose(programmed_force(loader, angles), np.abs(told).max(axis=1) * POUND_N)


def test_control_at_rest_breaks_away_at_holding_force():
    loader = ELEVATOR.replace({"feel.coulomb_friction": "2 lb", "feel.static_friction": "6 lb"})
    time, force, angle = swept(loader, 200.0)
    moves = int(np.argmax(np.abs(angle) > 1e-9))
    (held,) = ff._core.feel_held_between(loader.si_values, np.zeros(1))[:, 1]
    assert held == pytest.approx(6 * POUND_N, rel=ROUNDING)
    assert 0 < moves < len(time)
    assert force[moves] == pytest.approx(held, abs=2 * 200.0 * 4 / SWEEP_S * SAMPLE_S)  # a sample or two


def test_shaker_widens_holding_force_by_its_amplitude():
    """So slow that the control follows: at its turns, the constant force is what holds it against the full swing."""
    loader = ELEVATOR.replace({"feel.shaker_force": "10 lb", "feel.shaker_frequency": "0.1 Hz"})
    scenario = ff.Scenario(ff.Step(100.0), 40.0, shaker=Schedule((0.0, 40.0), (1.0, 1.0)))
    angle = ff.simulate(loader, scenario, "robust").history.feel_position_rad.values[20_000:]
    low, high = ff._core.feel_held_between(loader.si_values, np.array([angle.max(), angle.min()])).diagonal()
    assert low == pytest.approx(100.0, abs=NEAR_N)
    assert high == pytest.approx(100.0, abs=NEAR_N)


def test_curve_replaces_spring_and_largest_factor_applies():
    curve = Curve((radians(-20), 0.0, radians(20)), (-300.0, 0.0, 200.0))
    loader = replace(ELEVATOR, force_curve=curve, stiffness_factor=Curve((0.0, 5e3), (0.4, 2.2)))
    angles = np.array([-15.0, -5.0, 5.0, 25.0]) * DEG
    np.testing.assert_allclose(programmed_force(loader, angles), 2.2 * np.abs(curve.at(angles)), rtol=ROUNDING)


DETENT = ff.digital_elevator().replace({"feel.detent_force": "20 lb", "feel.detent_angle": "9 deg"})


def test_feel_demand_matches_engine_holding_force():
    """With a detent on the way: under the force of the demand the engine's programmed control stands where the demand says."""
    (demand,) = (one for one in ff.sizing.size_drive(DETENT).demands if one.name == "feel at 10 deg")
    loader = DETENT.replace(QUIET, si=True)
    run = ff.simulate(loader, ff.Scenario(Release(radians(10), 0.1), 0.2), "robust").history
    held, angle = float(run.pilot_force_n[0]), float(run.feel_position_rad[0])
    # The law is off by so much, on the steepest side of the detent.
    assert degrees(angle) == pytest.approx(10.0, abs=0.1)
    assert programmed_force(loader, angle) == pytest.approx(held, rel=ROUNDING)
    assert demand.force_n == pytest.approx(9600 * radians(10) / 31.375 * POUND_N + 20 * POUND_N, rel=ROUNDING)


def test_feel_demand_is_largest_force_along_travel():
    """A detent of 100 lb at 3 deg takes more at its largest than the feel at the stop; beyond it there is less."""
    stops = {"column.stop_low": "-12 deg", "column.stop_high": "12 deg"}
    loader = ELEVATOR.replace(stops | {"feel.detent_force": "100 lb", "feel.detent_angle": "3 deg"})
    assert degrees(hardest_angle(loader, radians(-12), radians(12))) == pytest.approx(4.0, rel=ROUNDING)
    (demand,) = (one for one in ff.sizing.size_drive(loader).demands if one.name.startswith("feel"))
    assert demand.name == "feel at 4 deg"
    assert demand.force_n == pytest.approx((9600 * radians(4) / 31.375 + 100) * POUND_N, rel=ROUNDING)
