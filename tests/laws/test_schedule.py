"""Gain schedule against a full six-state Riccati equation for each setting."""

import control
import numpy as np
import pytest

from forcefeel.errors import InputError
from forcefeel.laws.analog.gain_schedule import schedule_gains
from forcefeel.laws.analog.recursion import DesignSettings, SampledProblem, design_gains, published_settings
from forcefeel.linear.state_space import design_plant
from forcefeel.loader.built_in import elevator

# An eigenvalue solver on six states whose poles span 2 to 3e4 rad/s. Measured: 9e-11 sampled, 2e-11 continuous.
SAMPLED = 1e-9
CONTINUOUS = 2e-10
# The same recursion, its sums in another order, over up to 1000 steps. Measured: 1e-13.
HORIZON = 1e-11

DESIGNS = [DesignSettings(), DesignSettings(step_s=1e-3, position_weight=50.0, r1=0.02, r2=1.0)]


@pytest.fixture(scope="module")
def loader():
    return elevator()


def random_settings(loader, count=50):
    """I, B, G in SI units: 1 to 100 % of G_max, 0.5 to 4 Hz, damping ratio 0.1 to 1.5; the last ones exactly critical."""
    rng = np.random.default_rng(1974)
    stiffness = loader["feel.maximum_stiffness"] * np.geomspace(0.01, 1, count)
    w = 2 * np.pi * rng.uniform(0.5, 4.0, count)
    zeta = rng.uniform(0.1, 1.5, count)
    inertia = stiffness / w**2
    settings = np.column_stack([inertia, 2 * zeta * w * inertia, stiffness])
    # Powers of two and their like: B^2 = 4 I G without rounding, so the feel's two poles are one.
    critical = np.array([[i, 2 * w * i, w * w * i] for i, w in [(8.0, 4.0), (8.0, 8.0), (2.0, 16.0), (0.5, 24.0)]])
    assert np.all(critical[:, 1] ** 2 == 4 * critical[:, 0] * critical[:, 2])
    return np.vstack([settings[: count - len(critical)], critical])


def with_setting(loader, setting):
    return loader.replace(
        dict(zip(("feel.inertia", "feel.damping", "feel.stiffness"), setting.tolist(), strict=True)), si=True
    )


def sampled_gains(loader, design):
    """The six gains from one discrete Riccati equation."""
    problem = SampledProblem.of(loader, design)
    k, _, _ = control.dlqr(problem.phi[:6, :6], problem.h[:6], problem.q[:6, :6], problem.r)
    return -k[0] / problem.scale[:6]


def continuous_gains(loader, design):
    """The six gains from one continuous Riccati equation."""
    problem, plant = SampledProblem.of(loader, design), design_plant(loader)
    scale = problem.scale[:6]
    a, b = plant.A[:6, :6] * scale / scale[:, None], plant.B[:6] / scale[:, None]
    k, _, _ = control.lqr(a, b, problem.q[:6, :6], problem.r)
    return -k[0] / scale


@pytest.mark.parametrize("design", DESIGNS, ids=["report", "other"])
@pytest.mark.parametrize(
    ("continuous", "whole", "tolerance"),
    [(False, sampled_gains, SAMPLED), (True, continuous_gains, CONTINUOUS)],
    ids=["sampled", "continuous"],
)
def test_schedule_matches_the_gains_of_the_full_problem(loader, design, continuous, whole, tolerance):
    settings = random_settings(loader)
    found = schedule_gains(loader, settings, design, continuous=continuous)
    expected = [whole(with_setting(loader, setting), design) for setting in settings]
    np.testing.assert_allclose(found.gains, expected, rtol=tolerance)


HORIZONS = {
    "published": published_settings,
    "other": lambda _: DesignSettings(step_s=1e-3, horizon_s=0.02, position_weight=50.0, r1=0.02, r2=1.0),
    "one step": lambda _: DesignSettings(horizon_s=1e-4),
    "nearly endless": lambda _: DesignSettings(step_s=1e-3, horizon_s=1.0),
}


@pytest.mark.parametrize("name", HORIZONS)
def test_finite_horizon_schedule_matches_the_recursion(loader, name):
    settings, design = random_settings(loader), HORIZONS[name](loader)
    found = schedule_gains(loader, settings, design).gains
    expected = [design_gains(with_setting(loader, setting), design).gains[:6] for setting in settings]
    np.testing.assert_allclose(found, expected, rtol=HORIZON)


@pytest.mark.parametrize("design", [DesignSettings(), DesignSettings(horizon_s=0.05)], ids=["endless", "horizon"])
def test_gains_of_a_setting_do_not_depend_on_the_batch(loader, design):
    settings = random_settings(loader)
    together = schedule_gains(loader, np.tile(settings, (7, 1))[:-3], design).gains
    for k in (0, 17, 46, 49):
        assert np.array_equal(schedule_gains(loader, settings[k : k + 1], design).gains[0], together[k])


def test_only_the_feel_gains_depend_on_the_setting(loader):
    # The report's claim, without the schedule: c_1, c_2, c_5, c_6 of two settings far apart.
    settings = random_settings(loader)
    low, high = (sampled_gains(with_setting(loader, setting), DesignSettings()) for setting in settings[[0, 45]])
    np.testing.assert_allclose(low[[0, 1, 4, 5]], high[[0, 1, 4, 5]], rtol=SAMPLED)
    assert np.all(np.abs(low[[2, 3]] / high[[2, 3]] - 1) > 0.01)


def test_schedule_contains_its_settings(loader):
    settings = random_settings(loader)
    np.testing.assert_array_equal(schedule_gains(loader, settings.tolist()).settings, settings)


def test_schedule_does_not_depend_on_the_feel_of_the_loader(loader):
    # It sets the scale of the states, and so the rounding, but nothing else.
    settings = random_settings(loader)[:5]
    other = with_setting(loader, np.array([0.3, 2.0, 2000.0]))
    np.testing.assert_allclose(
        schedule_gains(other, settings).gains, schedule_gains(loader, settings).gains, rtol=SAMPLED
    )


def test_empty_settings_give_no_gains(loader):
    assert schedule_gains(loader, np.empty((0, 3))).gains.shape == (0, 6)


GOOD = [6.8, 34.0, 1084.0]


@pytest.mark.parametrize(
    "bad",
    [
        [0.0, 34.0, 1084.0],
        [-6.8, 34.0, 1084.0],
        [6.8, -1e-9, 1084.0],
        [6.8, 34.0, 0.0],
        [6.8, 34.0, -1084.0],
        [np.nan, 34.0, 1084.0],
        [6.8, np.nan, 1084.0],
        [6.8, 34.0, np.inf],
    ],
)
@pytest.mark.parametrize("row", [0, 3])
def test_invalid_setting_is_refused_with_its_row(loader, bad, row):
    settings = [GOOD] * 5
    settings[row] = bad
    with pytest.raises(InputError, match=rf"^settings: expected finite I > 0, B >= 0, G > 0, got .* in row {row}$"):
        schedule_gains(loader, settings)


@pytest.mark.parametrize("shape", [(3,), (2, 2), (2, 4), (1, 2, 3), (0,)])
def test_settings_of_another_shape_are_refused(loader, shape):
    with pytest.raises(InputError, match=r"^settings: expected rows of I, B, G, got shape"):
        schedule_gains(loader, np.ones(shape))


def test_unusable_schedule_arguments_raise_input_error(loader):
    rows = [[6.8, 34.0, 1085.0]]
    with pytest.raises(InputError, match="leave out horizon_s"):
        schedule_gains(loader, rows, DesignSettings(horizon_s=0.05), continuous=True)
    with pytest.raises(InputError, match="leave out q"):
        schedule_gains(loader, rows, DesignSettings(q=tuple(map(tuple, np.eye(7).tolist()))))
    with pytest.raises(InputError, match="rows of I, B, G"):
        schedule_gains(loader, [[1.0, 2.0], [3.0]])
    with pytest.raises(InputError, match=r"row 1, .* has no gains"):
        schedule_gains(loader, [*rows, [1e-300, 0.0, 1e300]])
    with pytest.raises(InputError, match=r"row 1, .* has no gains"):
        schedule_gains(loader, [*rows, [1e-300, 0.0, 1e300]], published_settings(loader))
