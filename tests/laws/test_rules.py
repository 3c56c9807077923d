"""What tunes ``robust`` from the loader: what it follows, by how much, and what it does not follow."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute_few
from forcefeel.laws.sampled import robust_tuning
from forcefeel.laws.sampled.rules import Units

FEEL = [[6.8, 34.3, 1085.0]]
SAME = 1e-6
"""Relative; the Riccati equations are solved in units of other size."""

CLOSE = 0.1
"""Decades; the declared ones are rounded to what a data sheet says."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.digital_elevator()


def test_a_law_knows_no_pressure_or_current_that_its_plant_does_not(loader: ff.Loader) -> None:
    other = loader.replace(
        {"valve.supply_pressure": 2 * loader["valve.supply_pressure"], "valve.rated_current": "20 mA"}
    )
    one, two = (ff.laws.method("robust").design(each, FEEL) for each in (loader, other))
    of_samples = slice(one.states, None)
    np.testing.assert_allclose(two.command[:, of_samples], one.command[:, of_samples], rtol=SAME)
    np.testing.assert_allclose(two.torque[:, of_samples], one.torque[:, of_samples], rtol=SAME, atol=SAME)


def test_hundred_times_the_noise_is_a_decade_more(loader: ff.Loader) -> None:
    keys = ("column_sensor.noise", "column_sensor.resolution")
    noisy = loader.replace({key: 100 * loader[key] for key in keys})
    before, after = robust_tuning(loader), robust_tuning(noisy)
    assert after.angle_noise.decades - before.angle_noise.decades == pytest.approx(1.0)
    assert after.pressure_noise == before.pressure_noise


def test_a_sensor_without_noise_has_that_of_a_good_one(loader: ff.Loader) -> None:
    silent = loader.replace(
        {f"{sensor}.{row}": None for sensor in ("load_cell", "column_sensor") for row in ("noise", "resolution")}
    )
    for name in ("angle_noise", "pressure_noise"):
        found, declared = (getattr(robust_tuning(each), name).decades for each in (silent, loader))
        assert abs(found - declared) < CLOSE


def test_units_are_the_lag_and_what_moves_the_column_in_it(loader: ff.Loader) -> None:
    """In SI units, by hand: 2 * 0.9 / 377 rad/s and 0.75 ms of delay and hold."""
    lag = 2 * 0.9 / 377 + 0.5e-3 + 0.25e-3
    found, force = Units.of(loader), loader["actuator.area"] * loader["valve.supply_pressure"]
    torque = loader["linkage.ratio"] * loader["column.base_arm"] * force
    assert found.torque == pytest.approx(loader["column.inertia"] / lag**2 / torque)
    assert found.time**2 * found.torque == pytest.approx(1.0)


def test_it_renders_with_an_encoder_of_20_bits(loader: ff.Loader) -> None:
    """With weights of another encoder it was half of these, and none from 2 deg at the lowest stiffness."""
    step = f"{360 / 2**20} deg"
    coarse = loader.replace({"column_sensor.noise": step, "column_sensor.resolution": step})
    grid = {"stiffness": "1..100 %:4:log", "frequency": "1, 4 Hz", "damping": "0.1, 0.7"}
    plan = make_plan(coarse, ["robust"], grid, changes={}, arms=())
    assert compute_few(plan).shares("robust").passes >= 15 / 16
