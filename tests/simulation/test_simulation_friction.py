"""Dry friction: at rest exactly, broken away at the static level, slowed at the Coulomb level; closed forms and the witness."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded, Release, Step
from tests.nonlinear_witness import Machine
from tests.side_by_side import DEG, GAINS, LB, PSI, WITNESS, Case, law_of, loader_of

COLUMN = Machine(gains=(0.0,) * 7, orifice=True, ratio=0.01, link_stiffness=1.0, link_damping=1e-3, feel_stiffness=1e-3)
"""The column all but alone: a soft link behind a closed valve, (0.1 in)^2 1 lb/in on an inertia of 37 lb in s^2."""

LINK = 2e-6
"""Angle in rad that this link makes: 0.01 lb in/rad on some 0.3 rad, for some 0.5 s."""


def run_of(machine, force, duration, step_s=1e-3, sample_s=1e-3):
    return simulate(loader_of(machine), Scenario(force, duration, step_s, sample_s), law_of(machine))


def ramp(lb_per_s, duration):
    return Recorded(np.array([0.0, duration]), np.array([0.0, lb_per_s * duration * LB]))


def angle_and_velocity(run):
    return run.history.column_angle_rad.values, run.history.column_velocity_rad_per_s.values


def test_column_breaks_away_at_the_static_and_slides_at_the_coulomb_level():
    machine = replace(COLUMN, coulomb_friction=2.0, static_friction=5.0)
    for rate in (7.3, 10.0, 29.0):
        errors, breaks = [], 5.0 / rate
        for step in (2e-3, 1e-3, 5e-4):
            run = run_of(machine, ramp(rate, 0.8), 0.8, step, 2e-3)
            t = run.history.time_s.values
            theta, rate_of = angle_and_velocity(run)
            s = np.maximum(t - breaks, 0.0)
            per_lb = machine.grip_arm / machine.column_inertia
            expected = per_lb * (3.0 * s**2 / 2 + rate * s**3 / 6)
            assert np.all(rate_of[t <= breaks] == 0)
            assert np.all(rate_of[t > breaks + step] > 0)  # within the step, not the sample
            errors.append(np.abs(theta - expected).max() / theta.max())
        assert max(errors) < 1e-5  # measured: 6e-6
        assert errors[2] < errors[0] + LINK  # no worse with smaller steps: what is left is the link


@pytest.mark.parametrize("static", [3.0, 5.0])
def test_spring_with_dry_friction_loses_equal_amplitude_per_half_cycle(static):
    """Closed form: half cosines about +-F_c / k, the amplitude 2 F_c / k less after each, then rest for good."""
    machine = replace(COLUMN, arm_stiffness=6.0, coulomb_friction=3.0, static_friction=static)
    stiffness, friction = 6.0 * machine.grip_arm**2, 3.0 * machine.grip_arm
    w, amplitude, zone = math.sqrt(stiffness / machine.column_inertia), 0.2, friction / stiffness
    t = np.arange(1001) * 2e-3
    expected, half = np.full(t.shape, np.nan), 0
    while amplitude * stiffness > static * machine.grip_arm:
        later = t >= half * math.pi / w
        swing = zone + (amplitude - zone) * np.cos(w * (t[later] - half * math.pi / w))
        expected[later] = (-1) ** half * swing
        amplitude, half = amplitude - 2 * zone, half + 1
    rest = half * math.pi / w
    expected[t >= rest] = (-1) ** half * amplitude
    errors = []
    for step in (2e-3, 1e-3, 2.5e-4):
        theta, rate = angle_and_velocity(run_of(machine, Release(0.2), 2.0, step, 2e-3))
        errors.append(np.abs(theta - expected).max())
        resting = t > rest + 2e-3
        assert np.all(rate[resting] == 0)
        assert np.ptp(theta[resting]) == 0
    assert max(errors) < 2e-6  # the link's


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
def test_stuck_column_does_not_drift(gains):
    """A minute under a force that friction holds, the servo working, the feel with friction of its own: not one bit."""
    machine = Machine(
        gains=gains,
        orifice=True,
        coulomb_friction=4.0,
        gravity_torque=80.0,
        gravity_angle=30 * DEG,
        feel_coulomb_friction=1.0,
        feel_preload=2.0,
    )
    run = run_of(machine, Step(10 * LB, 0.1), 60.0, 1e-3, 0.02)
    theta, rate = angle_and_velocity(run)
    moved = np.flatnonzero(rate)
    assert 0.1 < run.history.time_s.values[moved[-1]] < 2
    assert np.ptp(theta[moved[-1] + 1 :]) == 0
    feel = run.history["feel_position_v" if gains is None else "feel_position_rad"].values
    assert np.ptp(feel[len(feel) // 10 :]) == 0


@pytest.mark.parametrize("gains", [None, pytest.param(GAINS, marks=pytest.mark.slow)], ids=["original", "feedback"])
def test_hunting_of_stuck_column_matches_witness(gains):
    """Without friction in the feel the servo hunts behind the stuck column, which slips each time: a true limit cycle."""
    case = Case(
        Machine(gains=gains, orifice=True, coulomb_friction=4.0), [(0.1, 10.0)], Step(10 * LB, 0.1), duration=4.0
    )
    events = []
    reference = case.witness(replace(WITNESS, events=events))
    assert [name for _, name in events].count("break-away") > 10
    coarse, fine = case.errors(reference, 1e-3, 2.5e-4)
    assert coarse < 1e-5  # measured: 2e-6
    assert fine < 5e-6  # measured: 5e-7


@given(
    coulomb=st.floats(0.5, 8.0),
    extra=st.floats(0.0, 6.0),
    amplitude=st.floats(-60.0, 60.0),
    step_s=st.sampled_from((2.5e-4, 5e-4, 1e-3, 2e-3)),
)
def test_friction_law_holds_at_every_step(coulomb, extra, amplitude, step_s):
    """At rest the torque is within the static level and nothing moves; friction never pushes."""
    machine = Machine(
        gains=(0.0,) * 7, orifice=True, feel_stiffness=1.0, coulomb_friction=coulomb, static_friction=coulomb + extra
    )
    t = np.linspace(0.0, 0.4, 401)
    force = Recorded(t, amplitude * LB * np.sin(30.0 * t) * np.exp(-3.0 * t))
    run = run_of(machine, force, 0.4, step_s, step_s)
    theta, rate = angle_and_velocity(run)
    history, machine_arm = run.history, machine.ratio * machine.base_arm
    torque = machine.grip_arm * history.pilot_force_n.values / LB
    torque += machine_arm * machine.area * history.load_pressure_pa.values / PSI
    stuck = rate == 0
    level = machine.grip_arm * (coulomb + extra)
    assert np.all(np.abs(torque[stuck]) <= level * (1 + 1e-9))  # rounding of pressures of a thousand lb/in^2
    both = stuck[1:] & stuck[:-1]
    # Between two samples at rest it may have slipped within one step and stuck again, by less than that step allows.
    assert np.abs(np.diff(theta)[both]).max(initial=0.0) < 1.0 * step_s**2
    # m a = torque - friction: over a step at one direction the mean friction is the Coulomb level.
    sliding = (rate[1:] * rate[:-1] > 0) & (np.sign(rate[1:]) == np.sign(np.diff(theta)))
    mean = 0.5 * (torque[1:] + torque[:-1]) - machine.column_inertia * np.diff(rate) / step_s
    friction = mean * np.sign(rate[1:]) / machine.grip_arm
    assert np.all(friction[sliding] > 0)


@given(st.floats(0.2, 5.0), st.floats(-0.25, 0.25))
def test_released_column_rests_within_friction_zone(coulomb, angle):
    """Of a column on a spring, from whatever angle: it ends at rest within the zone |k theta| <= F_s."""
    machine = replace(COLUMN, arm_stiffness=6.0, coulomb_friction=coulomb, viscous_friction=100.0)
    theta, rate = angle_and_velocity(run_of(machine, Release(angle), 3.0, 1e-3, 1e-2))
    assert rate[-1] == 0
    assert abs(theta[-1]) * 6.0 * machine.grip_arm <= coulomb * (1 + 1e-6) + 1e-3  # lb in
