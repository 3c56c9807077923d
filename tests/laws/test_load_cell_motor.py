"""The load cell's loop of a motor: its regulator, its rest, the witness, and what a saturated motor starts from."""

import math

import numpy as np
import pytest
import scipy.linalg

from forcefeel.laws.law import Law
from forcefeel.laws.sampled import load_cell_motor
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.loader.built_in import BUILT_IN, ELECTRIC_AXES
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loops import sampled_loops
from forcefeel.loops.command_loop import command_loops
from forcefeel.loops.margins import loop_margins
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded, Release
from tests import electric_witness as witness

QUIET = {
    f"{part}.{row}": None for part in ("load_cell", "potentiometer", "column_sensor") for row in ("noise", "resolution")
}
YOKE = BUILT_IN["desktop-yoke"]().replace(QUIET, si=True)

AGREES = 1e-4
"""Of the travel."""
HELD = {False: 1e-9, True: 0.01}
"""Of the feel's angle under a steady hand, without and with a breakout. Measured: 3e-12, 0.0084."""
LEFT = 0.02
"""Of a force at the start of a run whose column is not where the feel is by so much."""
RATE = 0.02
"""Of a pole: the column's velocity is a difference and not a state. Measured: 0.006."""


@pytest.mark.parametrize("name", ELECTRIC_AXES)
def test_load_cell_law_has_margins_at_the_default_setting(name):
    loader = BUILT_IN[name]()
    margins = loop_margins(command_loops(loader, Law.of("load-cell", loader), own_feel(loader))[0])
    assert margins.gain_up > 2
    assert margins.phase_rad > math.radians(25)


def test_feel_poles_match_the_optimal_feedback():
    """The stable eigenvalues of the symplectic pencil, which knows no gains: motor and link as their equations have them."""
    g = YOKE.__getitem__
    inertia, damping, stiffness = own_feel(YOKE)[0]
    period, r, alpha, arm = g("controller.period"), g("transmission.travel"), g("linkage.ratio"), g("column.base_arm")
    link = np.array([g("linkage.stiffness"), g("linkage.damping"), 0, 0, 0])
    link -= [0, 0, 0, alpha * g("linkage.stiffness"), alpha * g("linkage.damping")]
    a = np.zeros((6, 6))
    a[0, 1] = a[3, 4] = 1.0
    a[1, :5], a[1, 2] = -link * r**2 / g("motor.inertia"), g("motor.torque_constant") * r / g("motor.inertia")
    a[2, 2], a[2, 5] = -g("current_loop.bandwidth"), g("current_loop.bandwidth")
    a[4, :5] = alpha * arm**2 / g("column.inertia") * link
    whole = scipy.linalg.expm(a * period)  # the delay is a period: the command under way acts through it
    share = inertia / (inertia - g("column.inertia"))
    feel = scipy.linalg.expm(
        np.array([[0, 1, 0], [-stiffness / inertia, -damping / inertia, 1 / inertia], [0, 0, 0]]) * period
    )
    heard = np.zeros(8)
    heard[:5], heard[6:] = -alpha * arm * share * link, ((1 - share) * stiffness, (1 - share) * damping)
    plant, b = np.zeros((8, 8)), np.eye(8)[5]
    plant[:5, :6] = whole[:5]
    plant[6:] = feel[:2, 2:] * heard
    plant[6:, 6:] += feel[:2, :2]
    plant[5, :5] = r / g("motor.torque_constant") * link  # the force is fed to the motor
    error = np.zeros(8)
    error[3], error[6] = 1 / arm, -1.0
    weight = load_cell_motor.command_weight(YOKE, SampledPlant.of(YOKE)) / g("current_loop.current_limit") ** 2
    left = np.block([[plant, np.zeros((8, 8))], [-np.outer(error, error), np.eye(8)]])
    right = np.block([[np.eye(8), np.outer(b, b) / weight], [np.zeros((8, 8)), plant.T]])
    best = scipy.linalg.eigvals(left, right)
    slow = best[(np.abs(best) < 1) & (np.abs(best - 1) < 0.02)]
    assert len(slow) == 2
    poles = sampled_loops(YOKE, "load-cell").poles[0]
    for pole in slow:
        assert np.abs(poles - pole).min() < RATE * abs(pole - 1)


@pytest.mark.parametrize("name", ELECTRIC_AXES)
def test_steady_force_holds_the_column_at_the_feel_position(name):
    """Fed to the motor, the load cell's force leaves the position loop next to nothing to hold."""
    loader = BUILT_IN[name]().replace(QUIET, si=True)
    force = 0.3 * loader["pilot.force"]
    run = simulate(loader, Scenario(Recorded([0.0, 1.0], [force, force]), 0.01), "load-cell")
    column, feel = (run.history[key].values[0] for key in ("column_angle_rad", "feel_position_rad"))
    assert column == pytest.approx(feel, rel=HELD[loader["feel.breakout"] > 0])


def test_engine_matches_the_reference():
    law, time = Law.of("load-cell", YOKE), np.linspace(0.0, 0.21, 421)
    force = 8 * np.sin(2 * math.pi * 4 * time)
    run = simulate(YOKE, Scenario(Recorded(time, force), 0.2, 1e-4, YOKE["controller.period"]), law)
    angle = witness.simulate(YOKE, law.numbers, lambda t: np.interp(t, time, force), 0.2)["column_angle_rad"]
    assert np.ptp(angle) > 0.05
    assert np.abs(run.history["column_angle_rad"].values - angle).max() < AGREES * np.ptp(angle)


def test_run_starts_within_the_motor_limit_where_possible():
    """A force that no current holds, far from where the loader rests, once led the search to a motor at its limit."""
    inertia, stiffness = 2.21, 350.0
    loader = BUILT_IN["elevator-electric"]().replace(
        QUIET
        | {"feel.inertia": inertia, "feel.stiffness": stiffness, "feel.damping": 0.6 * math.sqrt(inertia * stiffness)},
        si=True,
    )
    run = simulate(loader, Scenario(Release(0.17), 0.01), "load-cell")
    held = stiffness * 0.17 / (loader["linkage.ratio"] * loader["column.base_arm"])
    current = held * loader["transmission.travel"] / loader["motor.torque_constant"]
    assert abs(run.history["motor_current_a"].values[0]) == pytest.approx(current, rel=LEFT)
