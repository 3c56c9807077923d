"""The setting changes while the column moves: nothing jumps, and the column is that of the feel as it changes.

Sensors without noise and steps, so that a jump is seen; the flow follows the orifice within the valve's limits.
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.flight_schedule import FlightSchedule, ScheduleAxis, design_schedule, second_order_feel
from forcefeel.simulation.inputs import Force

WITNESSED = {"rtol": 1e-8, "atol": 1e-11}
"""Of the integrator that the column is compared with to OFF: a millionth of that."""

STEP_S = 5e-4
"""The controller's period: every command is seen."""

AT_S, OVER_S, DURATION_S = 1.2, 0.5, 3.0
NEAR = slice(round((AT_S - 0.02) / STEP_S), round((AT_S + OVER_S + 0.02) / STEP_S))
"""Samples of the change, with its beginning and end."""

MOST = 2.0
"""A change may move the command from one sample to the next by so many times what the same motion without it does. Of a column that
moves all the while: one at rest under a load moves only because its feel changes, and has nothing to be held against."""

JUMP = 20.0
"""A law that is switched in one period moves it by more than so many times that."""

OFF = 0.01
"""Of the largest angle: how far the column may be from the ideal feel that changes."""

SENSORS = ("load_cell", "potentiometer", "column_sensor")
QUIET = dict.fromkeys(f"{sensor}.{row}" for sensor in SENSORS for row in ("noise", "resolution"))
PUSHED = ff.simulation.Multisine(100.0, (0.5, 1.0, 1.5, 2.5), 4.0, seed=1)
MOTIONS = {"multisine": PUSHED, "free swing": ff.Release(np.radians(8.0), 1.05)}
FORCES = {"multisine": PUSHED, "step": ff.Step(60.0, 1.0)}
WAYS = {"stiffer": (60.0, 380.0), "softer": (380.0, 60.0), "a little": (100.0, 200.0)}


@pytest.fixture(scope="module")
def schedule() -> FlightSchedule:
    loader = ff.digital_elevator().replace(QUIET, si=True)
    axis = ScheduleAxis("dynamic pressure", "lb/ft^2", (50, 100, 200, 400))
    stiffness = np.array([0.1, 0.2, 0.4, 0.8]) * loader["feel.maximum_stiffness"]
    return design_schedule(loader, [axis], second_order_feel(stiffness, [1.0, 1.2, 1.5, 2.0], 0.6))


def run(schedule: FlightSchedule, start: float, force: Force, *changes: ff.simulation.FeelChange) -> ff.simulation.Run:
    there = schedule.at(dynamic_pressure=start)
    scenario = ff.Scenario(force, DURATION_S, STEP_S, STEP_S, feel_changes=changes)
    return ff.simulate(there.loader, scenario, there.law)


def steps(found: ff.simulation.Run) -> dict[str, float]:
    """Largest change from one sample to the next, near the change: of the command, and of the programmed acceleration."""
    current, velocity = (found.history[name].values[NEAR] for name in ("valve_current_a", "feel_velocity_rad_per_s"))
    return {
        "command": float(np.abs(np.diff(current)).max()),
        "acceleration": float(np.abs(np.diff(velocity, 2)).max() / STEP_S),
    }


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("motion", MOTIONS)
def test_change_is_bumpless(schedule: FlightSchedule, motion: str, way: str) -> None:
    start, end = WAYS[way]
    change = schedule.change(AT_S, OVER_S, dynamic_pressure=end)
    changed = steps(run(schedule, start, MOTIONS[motion], change))
    natural = steps(run(schedule, start, MOTIONS[motion]))
    for what, largest in changed.items():
        assert largest <= MOST * natural[what], what


@pytest.mark.parametrize("way", WAYS)
def test_instant_law_switch_is_not_bumpless(schedule: FlightSchedule, way: str) -> None:
    """The measure of the test before would see a bump."""
    start, end = WAYS[way]
    switched = ff.simulation.FeelChange(AT_S, {}, STEP_S, schedule.at(dynamic_pressure=end).law)
    natural = max(steps(run(schedule, each, PUSHED))["command"] for each in (start, end))
    assert steps(run(schedule, start, PUSHED, switched))["command"] > JUMP * natural


def test_instant_feel_switch_is_not_bumpless(schedule: FlightSchedule) -> None:
    start, end = WAYS["stiffer"]
    switched = schedule.change(AT_S, STEP_S, dynamic_pressure=end)
    natural = max(steps(run(schedule, each, PUSHED))["acceleration"] for each in (start, end))
    assert steps(run(schedule, start, PUSHED, switched))["acceleration"] > JUMP * natural


@pytest.mark.parametrize("motion", MOTIONS)
def test_change_to_the_same_setting_has_no_effect(schedule: FlightSchedule, motion: str) -> None:
    rounding = 1e-12  # of each signal's largest value: blends of equal numbers
    same = run(schedule, 120, MOTIONS[motion], schedule.change(AT_S, OVER_S, dynamic_pressure=120))
    without = run(schedule, 120, MOTIONS[motion])
    for name, signal in without.history.items():
        largest = np.abs(signal.values).max()
        np.testing.assert_allclose(same.history[name].values, signal.values, rtol=0, atol=rounding * largest)


def ideal(schedule: FlightSchedule, start: float, end: float, force_n: NDArray[np.float64]) -> NDArray[np.float64]:
    """``delta'' = (T - B(t) delta' - G(t) delta) / I(t)`` by SciPy.

    I(t), B(t), G(t) are such that the accelerations of the two feels blend: ``1 / I = (1 - s) / I_0 + s / I_1`` and so on with
    ``s = 3 u^2 - 2 u^3`` over the change.
    """
    time = np.arange(len(force_n)) * STEP_S
    arm = schedule.loader["column.grip_arm"]
    (i_0, b_0, g_0), (i_1, b_1, g_1) = (schedule.at(dynamic_pressure=each).feel for each in (start, end))

    def slope(t: float, x: NDArray[np.float64]) -> list[float]:
        u = np.clip((t - AT_S) / OVER_S, 0.0, 1.0)
        s = u * u * (3 - 2 * u)
        inertia = 1 / ((1 - s) / i_0 + s / i_1)
        damping, stiffness = (inertia * ((1 - s) * one / i_0 + s * two / i_1) for one, two in ((b_0, b_1), (g_0, g_1)))
        return [x[1], (arm * np.interp(t, time, force_n) - damping * x[1] - stiffness * x[0]) / inertia]

    found = solve_ivp(slope, time[[0, -1]], [0.0, 0.0], t_eval=time, **WITNESSED, max_step=0.01)
    return np.asarray(found.y[0])


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("force", FORCES)
def test_column_follows_the_changing_feel(schedule: FlightSchedule, force: str, way: str) -> None:
    start, end = WAYS[way]
    found = run(schedule, start, FORCES[force], schedule.change(AT_S, OVER_S, dynamic_pressure=end))
    sampled = FORCES[force].sample(DURATION_S, STEP_S)
    expected = ideal(schedule, start, end, np.append(sampled.start, sampled.end[-1]))
    angle = found.history.column_angle_rad.values
    largest = np.abs(expected).max()
    assert np.abs(angle - expected).max() < OFF * largest
    # What the feel of before would do is another motion, which the same bound would refuse.
    stays = run(schedule, start, FORCES[force]).history.column_angle_rad.values
    assert np.abs(angle - stays).max() > 10 * OFF * largest


def test_successive_changes_follow_the_schedule(schedule: FlightSchedule) -> None:
    """Through the knots in between, and at the end as if the last setting had always been there."""
    changes = [schedule.change(0.3 * k, 0.3, dynamic_pressure=to) for k, to in enumerate((100, 200, 400))]
    found = run(schedule, 50, PUSHED, *changes).history.column_angle_rad.values
    there = run(schedule, 400, PUSHED).history.column_angle_rad.values
    last = slice(round(2.5 / STEP_S), None)
    assert np.abs(found - there)[last].max() < 1e-3 * np.abs(there).max()  # what swung on the way has died out
