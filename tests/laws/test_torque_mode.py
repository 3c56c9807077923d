"""The feel by the motor's current alone: closed forms, the witness, what sticks, and what is refused."""

import math

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.laws.law import Law
from forcefeel.laws.sampled import torque_mode
from forcefeel.laws.sampled.torque_mode import Coupling
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops import sampled_loops
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded, Release
from tests import electric_witness as witness

SENSORS = ("load_cell", "potentiometer", "column_sensor")
QUIET = {f"{sensor}.{row}": None for sensor in SENSORS for row in ("noise", "resolution")}
YOKE = BUILT_IN["desktop-yoke"]().replace(QUIET, si=True)
STICK = BUILT_IN["sidestick-roll"]().replace(QUIET, si=True)

NEAR_RIGID = {
    "linkage.stiffness": 1e8,
    "linkage.damping": 1e3,
    "current_loop.bandwidth": 2 * math.pi * 2e4,
    "current_loop.voltage_limit": None,
    "controller.period": 2e-5,
    "controller.delay": 0.0,
}
"""All but no delay and no give."""

RENDERED = 0.01
"""Of a pole of the feel: what the delay left and the coupling cost it. Measured: 0.004."""
ROUNDING = 1e-9
AGREES = 1e-4
"""Of the travel."""


@pytest.mark.parametrize("ratio", [0.3, 3.0])
def test_rigid_loader_without_delay_renders_the_programmed_feel(ratio, monkeypatch):
    """A pole pair of ``max(I, J) s^2 + B s + G``: the motor takes J off a larger I, and without a share none off J."""
    monkeypatch.setattr(torque_mode, "SHARES", ())
    loader = YOKE.replace(NEAR_RIGID, si=True)
    g = loader.__getitem__
    moved = (
        g("column.inertia")
        + g("motor.inertia") * (g("linkage.ratio") * g("column.base_arm") / g("transmission.travel")) ** 2
    )
    felt = max(ratio, 1.0) * moved
    stiffness = felt * (2 * math.pi) ** 2
    damping = 0.6 * math.sqrt(felt * stiffness)
    loader = loader.replace(dict(zip(FEEL_SETTING, (ratio * moved, damping, stiffness), strict=True)), si=True)
    poles = sampled_loops(loader, "torque-mode").poles[0]
    expected = np.exp(np.roots([felt, damping, stiffness])[0] * g("controller.period"))
    assert np.abs(poles - expected).min() < RENDERED * abs(expected - 1)


@pytest.mark.parametrize("name", ["elevator-electric", "desktop-yoke"])
def test_static_stiffness_is_that_of_the_feel(name):
    """The link gives by 4 to 8 % of it, and the law knows."""
    loader = BUILT_IN[name]().replace(QUIET, si=True)
    force = 0.2 * loader["pilot.force"]
    run = simulate(loader, Scenario(Recorded([0.0, 1.0], [force, force]), 0.01), "torque-mode")
    angle = force * loader["column.grip_arm"] / loader["feel.stiffness"]
    assert run.history["column_angle_rad"].values[0] == pytest.approx(angle, rel=ROUNDING)


def test_engine_matches_the_reference():
    law, time = Law.of("torque-mode", YOKE), np.linspace(0.0, 0.21, 421)
    force = 8 * np.sin(2 * math.pi * 4 * time)
    run = simulate(YOKE, Scenario(Recorded(time, force), 0.2, 1e-4, YOKE["controller.period"]), law)
    found = witness.simulate(YOKE, law.numbers, lambda t: np.interp(t, time, force), 0.2)
    angle = found["column_angle_rad"]
    assert np.ptp(angle) > 0.05
    assert np.abs(run.history["column_angle_rad"].values - angle).max() < AGREES * np.ptp(angle)


def test_steep_breakout_causes_no_limit_cycle():
    """Where all that moves was taken off the feel's inertia, this stick swung by 0.3 deg for ever at 20 Hz."""
    run = simulate(STICK, Scenario(Release(0.17), 1.5), "torque-mode")
    assert np.abs(run.history["column_angle_rad"].values[-400:]).max() < math.radians(0.02)


def test_feel_dry_friction_sticks():
    """Under half of the friction the column stays within what the coupling gives."""
    friction = 4.0
    loader = YOKE.replace({"feel.coulomb_friction": friction}, si=True)
    time = np.linspace(0.0, 1.6, 321)
    force = np.clip(time / 0.2, 0, 1) * friction / 2
    run = simulate(loader, Scenario(Recorded(time, force), 1.5), "torque-mode")
    angle = run.history["column_angle_rad"].values
    coupling = Coupling.of(loader)
    tied = coupling.frequency**2 * min(loader["feel.inertia"], coupling.rotor) + loader["feel.stiffness"]
    link = loader["linkage.stiffness"] * coupling.arm**2
    gives = friction / 2 * loader["column.grip_arm"] * (1 / tied + 1 / link)
    assert angle[-1] == pytest.approx(gives, rel=0.1)  # the correction for the link knows the spring alone
    assert np.ptp(angle[-500:]) < 0.01 * gives


def test_stiffness_above_that_of_the_link_is_refused():
    with pytest.raises(ff.InputError, match="row 0 programs 300 N m/rad, and link and transmission have 240 N m/rad"):
        torque_mode.design(YOKE, [[0.1, 1.0, 300.0]])


def test_coarse_encoder_softens_the_coupling():
    """Its steps, times the damper, are not to stir the current."""
    fine, coarse = (Coupling.of(YOKE.replace({"potentiometer.resolution": step}, si=True)) for step in (1e-7, 1e-5))
    assert coarse.memory > fine.memory
    assert coarse.frequency < fine.frequency
