"""The sampled plant against SciPy's exponential, python-control and a finely stepped simulation, its delay included."""

import control
import numpy as np
import pytest
from scipy.linalg import expm

import forcefeel as ff
from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.laws.sampled.plant import PLANT_STATES, SampledPlant, Scale

PERIOD = 5e-4
EXACT = 1e-12
"""Share of the largest number by which two exponentials differ. Measured: 2e-14."""
STEPPED = 1e-12
"""The same of 2,000 Runge-Kutta steps a period, 8e-3 of the fastest pole's time each. Measured: 6e-15."""


def sampled(delay=PERIOD, period=PERIOD):
    return ff.elevator().replace({"controller.period": period, "controller.delay": delay}, si=True)


def continuous(loader):
    """A, B of torque and command in SI units, from the report's model."""
    model = ff.compliant_model(loader, GainLaw.none(loader.si_values))
    kept = [model.state_labels.index(name) for name in PLANT_STATES]
    return model.A[np.ix_(kept, kept)], model.B[kept] / [loader["column.grip_arm"], 1.0]


def scaled(loader):
    """The same in the units of the design."""
    a, b = continuous(loader)
    scale = Scale.of(loader)
    units = scale.states[:, None]
    return a * scale.states / units, b * [scale.torque_n_m, scale.command_v] / units


def assert_close(found, expected, share):
    np.testing.assert_allclose(found, expected, rtol=0, atol=share * np.abs(expected).max())


@pytest.mark.parametrize("period", [2.5e-4, PERIOD, 2e-3])
def test_period_matches_scipy_expm(period):
    loader = sampled(period, period)
    a, b = scaled(loader)
    block = np.zeros((8, 8))
    block[:6, :6], block[:6, 6:] = a, b
    expected = expm(block * period)
    plant = SampledPlant.of(loader)
    assert_close(plant.phi, expected[:6, :6], EXACT)
    assert_close(plant.by_torque, expected[:6, 6], EXACT)
    # A delay of a whole period: the new command does nothing yet.
    assert_close(plant.by_held, expected[:6, 7], EXACT)
    assert not plant.by_command.any()


def test_plant_without_delay_matches_python_control():
    loader = sampled(0.0)
    a, b = scaled(loader)
    expected = control.sample_system(control.ss(a, b, np.eye(6), np.zeros((6, 2))), PERIOD)
    plant = SampledPlant.of(loader)
    assert_close(plant.phi, expected.A, EXACT)
    assert_close(np.column_stack([plant.by_torque, plant.by_command]), expected.B, EXACT)
    assert not plant.by_held.any()


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_delayed_command_matches_fine_integration(share):
    loader = sampled(share * PERIOD)
    a, b = scaled(loader)
    plant = SampledPlant.of(loader)
    rng = np.random.default_rng(3)
    start, held, command, torque = rng.normal(size=6), *rng.normal(size=3)
    steps = 2000
    h, x = PERIOD / steps, start
    for k in range(steps):
        u = b @ [torque, held if k < share * steps else command]
        one = a @ x + u
        two = a @ (x + h / 2 * one) + u
        three = a @ (x + h / 2 * two) + u
        x = x + h / 6 * (one + 2 * two + 2 * three + a @ (x + h * three) + u)
    after = plant.transition @ np.append(start, held) + plant.input * command
    assert_close(after[:6] + plant.by_torque * torque, x, STEPPED)
    assert after[6] == command


def test_plant_scaling_uses_the_units_of_the_loader():
    """A column at rest under the supply pressure turns through half a radian in the unit of time."""
    loader = sampled()
    scale = Scale.of(loader)
    assert scale.torque_n_m / loader["column.inertia"] * scale.time_s**2 / 2 == pytest.approx(0.5)
    a, _ = continuous(loader)
    pressure, rate = PLANT_STATES.index("load_pressure_pa"), PLANT_STATES.index("base_velocity_m_per_s")
    acceleration = a[rate, pressure] * loader["valve.supply_pressure"] / loader["column.base_arm"]
    assert acceleration * scale.time_s**2 == pytest.approx(1.0)
    rated = scale.command_v * loader["amplifier.admittance"]
    assert rated == pytest.approx(loader["valve.rated_current"])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, r"controller\.period: expected a sample period, got none; give one, for example 0\.5 ms"),
        (
            {"controller.period": "0.5 ms", "controller.delay": "0.6 ms"},
            r"controller\.delay: expected at most the period of 0\.5 ms, got 0\.6 ms",
        ),
    ],
)
def test_plant_that_cannot_be_sampled_is_refused(changes, said):
    with pytest.raises(InputError, match=said):
        SampledPlant.of(ff.elevator().replace(changes, si=True))
