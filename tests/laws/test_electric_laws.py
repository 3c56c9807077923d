"""Laws on loaders with a motor: which there are, the plant that they are made for, the steps of their runs, what they render."""

import numpy as np
import pytest
from scipy.linalg import expm

import forcefeel as ff
from forcefeel.laws.law import Law, names_for
from forcefeel.laws.sampled import load_cell_loop, torque_mode
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.loader.axes import ELECTRIC_AXES
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.timing import longest_step_s
from forcefeel.loops import sampled_loops
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Release

ELECTRIC = BUILT_IN["elevator-electric"]()

ROUNDING = 1e-9
"""Relative; two ways to the same matrix exponential."""

CONVERGED = 1e-4
"""Of the throw: what a run may change with its step."""


def test_motor_laws_exclude_those_for_a_valve():
    assert names_for(ELECTRIC) == ("load-cell", "observer", "recovered", "h-infinity", "robust", "agile", "torque-mode")
    assert Law.of(None, ELECTRIC).name == "robust"


@pytest.mark.parametrize("name", ["original", "published", "converged"])
def test_law_for_a_valve_is_refused(name):
    with pytest.raises(ff.InputError, match=f"{name} is a law for a valve, and elevator-electric has a motor"):
        Law.of(name, ELECTRIC)


def test_load_cell_loop_of_a_valve_refuses_a_motor():
    with pytest.raises(ff.InputError, match="load-cell takes a loader with a hydraulic drive"):
        load_cell_loop.design(ELECTRIC, own_feel(ELECTRIC))


def test_law_for_a_motor_is_refused_by_a_valve():
    valve = ff.digital_elevator()
    assert "torque-mode" not in names_for(valve)
    with pytest.raises(ff.InputError, match="torque-mode is a law for a motor, and elevator-2khz has a valve"):
        Law.of("torque-mode", valve)
    with pytest.raises(ff.InputError, match="torque-mode takes a loader with an electric drive"):
        torque_mode.design(valve, own_feel(valve))


@pytest.mark.parametrize("name", ELECTRIC_AXES)
def test_every_law_is_stable_at_the_default_setting(name):
    loader = BUILT_IN[name]()
    for law in names_for(loader):
        assert sampled_loops(loader, law).stable.all(), law


def test_plant_matches_the_equations():
    """Position, speed and current of the motor and the base, written down once more."""
    loader = ELECTRIC
    r, alpha, arm = (loader[key] for key in ("transmission.travel", "linkage.ratio", "column.base_arm"))
    mass = loader["motor.inertia"] / r**2
    push = loader["motor.torque_constant"] / r
    link = np.array([loader["linkage.stiffness"], loader["linkage.damping"], 0, 0, 0])
    link += [0, 0, 0, -alpha * loader["linkage.stiffness"], -alpha * loader["linkage.damping"]]
    pulled = alpha * arm**2 / loader["column.inertia"]
    a = np.zeros((5, 5))
    a[0, 1] = a[3, 4] = 1.0
    a[1] = -link / mass
    a[1, 1] -= loader["motor.viscous_friction"] / loader["motor.inertia"]
    a[1, 2] = push / mass
    a[2, 2] = -loader["current_loop.bandwidth"]
    a[4] = pulled * link
    expected = expm(a * loader["controller.period"])
    force = np.eye(5)
    force[1] = link  # the force stands for the motor's speed
    plant = SampledPlant.of(loader)
    found = plant.phi * plant.scale.states[:, None] / plant.scale.states
    wanted = force @ expected @ np.linalg.inv(force)
    np.testing.assert_allclose(
        found / plant.scale.states[:, None] * plant.scale.states,
        wanted / plant.scale.states[:, None] * plant.scale.states,
        atol=ROUNDING,
    )


@pytest.mark.parametrize("name", ["elevator-electric", "sidestick-roll"])
def test_run_does_not_depend_on_its_step(name):
    """A current loop of 1 kHz would not be stable in Runge-Kutta steps of 0.5 ms: it is solved exactly."""
    loader = BUILT_IN[name]()
    quiet = loader.replace(
        dict.fromkeys(key for key in loader.given if key.endswith((".noise", ".resolution", "breakout")))
    )
    runs = [
        simulate(quiet, Scenario(Release(0.15), 0.4, sample_s=1e-3, step_s=step), "observer") for step in (1e-3, 5e-5)
    ]
    coarse, fine = (run.history["column_angle_rad"].values for run in runs)
    assert np.abs(coarse - fine).max() < CONVERGED * np.ptp(fine)


def test_valve_accepts_any_step():
    assert longest_step_s(ff.digital_elevator()) == np.inf


def test_robust_law_renders_all_sidestick_settings():
    grid = {"stiffness": "3, 100 %", "frequency": "1, 4 Hz", "damping": "0.3, 1"}
    found = ff.find_envelope(BUILT_IN["sidestick-roll"](), ["robust"], grid, changes={}, arms=())
    assert found.shares("robust").nominal_share == 1.0
