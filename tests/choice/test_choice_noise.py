"""Noise at the grip: the covariance's own equation, and long runs of the engine."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.choice.noise import HOLDING, hand_force_rms, noise_at_grip
from forcefeel.laws.law import Law, named
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.sensors import sample_variance
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.noisy_loop import NoisyLoop
from tests.parametrization import mostly_slow

ROUNDING = 1e-12
"""Relative, and of the largest number: sums of a few products. Measured: 3e-14."""

SENSORS = ("load_cell", "potentiometer", "column_sensor")
DIGITAL = ff.digital_elevator()
SMOOTH = DIGITAL.replace({f"{sensor}.resolution": None for sensor in SENSORS})
LAGGING = SMOOTH.replace(
    {"load_cell.bandwidth": "400 Hz", "column_sensor.bandwidth": "300 Hz", "controller.delay": "0.25 ms"}
)
HELD = dict(zip(ARM_ROWS, HOLDING.values, strict=True))

DURATION_S, SETTLED_S = 200.0, 2.0
BY_CHANCE = 0.1
"""The feel swings for 1 / (zeta w) = 0.4 s, so that a run holds some 500 independent swings and its r.m.s. is known to
1 / sqrt(1000); here three times that."""


def _law(name, loader):
    own = np.array([[loader[key] for key in FEEL_SETTING]])
    return Law.of(named((name,), loader)[name], loader, own).single(loader, 0)


def _run(loader, law, seed=7):
    scenario = Scenario(duration_s=DURATION_S, step_s=5e-4, sample_s=5e-4, seed=seed)
    history = simulate(loader, scenario, law).history
    return history.isel(time_s=slice(round(SETTLED_S / 5e-4), None))


def _rms(values):
    return float(np.sqrt(np.mean(np.asarray(values) ** 2)))


@pytest.mark.parametrize("name", ["published", "load-cell", "observer", "recovered", "h-infinity", "robust"])
def test_covariance_satisfies_its_equation(name):
    loop = NoisyLoop.of(DIGITAL, _law(name, DIGITAL))
    p = loop.covariance()
    added = (loop.by_sample * loop.variance) @ loop.by_sample.T
    scale = np.sqrt(np.outer(np.diag(p), np.diag(p)))
    known = scale > 0
    residual = np.abs(loop.matrix @ p @ loop.matrix.T + added - p)[known] / scale[known]
    assert residual.max() < 1e-6  # of each state's own variance


@pytest.mark.parametrize("name", ["observer", "robust"])
def test_sample_enters_through_the_law_input(name):
    """On the law's nine states, the last of the loop, ``B_y + b_e c_y``; on the youngest command ``c_y``."""
    law = _law(name, DIGITAL)
    numbers = law.sampled
    on_command = numbers.command[0, numbers.states : numbers.states + 3]
    expected = numbers.input[0, :, :3] + numbers.input[0, :, 3:] * on_command
    found = NoisyLoop.of(DIGITAL, law).by_sample
    assert found[-numbers.states :] == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING * np.abs(expected).max())
    assert np.isclose(found, on_command, rtol=ROUNDING, atol=0).all(axis=1).sum() == 1


@pytest.mark.parametrize(
    ("name", "loader"),
    mostly_slow(
        [("published", SMOOTH), ("load-cell", SMOOTH), ("observer", SMOOTH), ("robust", SMOOTH), ("published", LAGGING)]
    ),
)
def test_angle_noise_matches_a_long_run(name, loader):
    law = _law(name, loader)
    expected = noise_at_grip(loader, law).angle_rad
    assert _rms(_run(loader, law)["column_angle_rad"]) == pytest.approx(expected, rel=BY_CHANCE)


def test_sensor_lag_does_not_reduce_sample_noise():
    """Noise comes after the lag: with lags on an otherwise equal loader it enters by the same numbers."""
    lagging = SMOOTH.replace({"load_cell.bandwidth": "9000 Hz"})
    law = _law("published", SMOOTH)
    one, other = (noise_at_grip(loader, law).angle_rad for loader in (SMOOTH, lagging))
    assert other == pytest.approx(one, rel=0.01)  # 9 kHz is far above what the loop passes


@pytest.mark.parametrize("name", mostly_slow(["observer", "load-cell"]))
def test_grip_force_noise_matches_the_column_equation(name):
    """By the column's equation, J theta'' = T_link - R_p F: from the load cell's force, with no differences."""
    loader = SMOOTH.replace(HELD, si=True)
    law = _law(name, SMOOTH)
    history = _run(loader, law)
    angle, rate, pressure = (
        history[key].values for key in ("column_angle_rad", "column_velocity_rad_per_s", "load_pressure_pa")
    )
    mass, damping, stiffness = HOLDING.values
    lever = loader["column.grip_arm"]
    link = loader["linkage.ratio"] * loader["column.base_arm"] * loader["actuator.area"] * pressure
    rest = damping * rate + stiffness * angle
    acceleration = (link - lever**2 * rest) / (loader["column.inertia"] + mass * lever**2)
    force = lever * (mass * acceleration + rest)
    assert _rms(force) == pytest.approx(hand_force_rms(NoisyLoop.of(loader, law), loader), rel=BY_CHANCE)
    assert noise_at_grip(SMOOTH, law).force_n == hand_force_rms(NoisyLoop.of(loader, law), loader)


def test_quantization_adds_step_squared_over_twelve():
    variance = sample_variance(DIGITAL)
    for sensor, found in zip(SENSORS, variance, strict=True):
        assert found == pytest.approx(DIGITAL[f"{sensor}.noise"] ** 2 + DIGITAL[f"{sensor}.resolution"] ** 2 / 12)
    law = _law("load-cell", DIGITAL)
    assert _rms(_run(DIGITAL, law)["column_angle_rad"]) == pytest.approx(
        noise_at_grip(DIGITAL, law).angle_rad, rel=BY_CHANCE
    )


def test_loop_without_samples_has_no_noise():
    assert noise_at_grip(ff.elevator(), _law("published", ff.elevator())) is None


def test_unused_sensor_adds_no_noise():
    loud = DIGITAL.replace({"potentiometer.noise": "0.1 in"})
    law = _law("robust", DIGITAL)
    assert noise_at_grip(loud, law) == noise_at_grip(DIGITAL, law)


def test_unstable_loop_has_infinite_noise():
    soft = DIGITAL.replace({"feel.inertia": 0.01, "feel.damping": 0.01, "feel.stiffness": 5.0}, si=True)
    assert noise_at_grip(soft, _law("published", soft)).angle_rad == np.inf
