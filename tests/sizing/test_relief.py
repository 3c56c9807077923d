"""What a release takes of a drive: beside runs of the engine, and beside an integrator that shares no line with it."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.simulation.inputs import Release
from forcefeel.sizing.valve import Valve
from tests import electric_witness as witness

ENGINE = 1e-3  # relative; peaks at the steps of two runs
WITNESS = (
    1.5e-2  # relative; a peak at the samples of the controller, from an angle that the law is off by so much at rest
)
NEAR = 5e-3  # of the limit; a current comes to it with the lag of its loop
ROUNDING = 1e-9  # relative; of a sum that the pressure is a thousand times
NOISE = ("load_cell", "potentiometer", "column_sensor")


def release_of(loader):
    """The release among what is asked."""
    found = ff.sizing.size_drive(loader)
    (row,) = (one for one in found.demands if one.name.startswith("release"))
    return row, found.plan.release_rad


def quiet(loader):
    """The loader without the noise of its sensors; its law is that of the one with it."""
    return loader.replace(dict.fromkeys(f"{sensor}.noise" for sensor in NOISE))


@pytest.mark.parametrize(
    ("name", "share"),
    [("sidestick-pitch", 0.969), ("desktop-yoke", 0.339), ("elevator-electric", 0.382), ("rudder-pedals", None)],
)
def test_release_demand_matches_simulated_run(name, share):
    loader = ff.loader.electric(name)
    row, angle = release_of(loader)
    law = ff.Law.of("robust", loader).sampled
    run = ff.simulate(quiet(loader), ff.Scenario(Release(angle), 0.6), law)
    peak = run.measures.peak_current_a / loader["current_loop.current_limit"]
    assert row.law == "robust"
    assert row.of_motion <= row.of_peak
    assert row.of_peak >= peak * (1 - ENGINE)
    if share is not None:
        assert row.of_peak == pytest.approx(peak, rel=ENGINE)
        assert row.of_peak == pytest.approx(share, abs=5e-4)  # three digits
        assert row.needs.current_a == pytest.approx(run.measures.peak_current_a, rel=ENGINE)


@pytest.mark.slow
def test_release_demand_matches_independent_integrator():
    """The loader's and the law's equations written out: a hand that pushes as hard as the angle asks, and lets go at a sample."""
    loader = ff.loader.electric("desktop-yoke")
    row, angle = release_of(loader)
    law, bare = ff.Law.of("robust", loader).sampled, quiet(loader)
    _, damping, stiffness = (loader[key] for key in FEEL_SETTING)
    assert damping > 0
    force, held = stiffness * angle / loader["column.grip_arm"], 3.0
    # It comes in a second and stays for two: what swings is gone.
    found = witness.simulate(
        bare, law, lambda t: force * (0.5 - 0.5 * np.cos(np.pi * min(t, 1.0))) * (t < held), held + 0.05
    )
    at = round(held / loader["controller.period"])
    assert found["column_angle_rad"][at] == pytest.approx(angle, rel=WITNESS)
    peak = np.abs(found["motor_current_a"][at:]).max() / loader["current_loop.current_limit"]
    assert peak == pytest.approx(row.of_peak, rel=WITNESS)


def test_release_demand_saturates_at_drive_limit():
    loader = ff.loader.electric("sidestick-pitch").replace(
        {"current_loop.current_limit": 20.0, "pilot.force": "40 N"}, si=True
    )
    row, _ = release_of(loader)
    assert row.of_motion < 1 - NEAR < row.of_peak <= 1
    assert row.available


def test_release_demand_includes_pressure_of_held_valve():
    loader = ff.digital_elevator()
    row, angle = release_of(loader)
    run = ff.simulate(quiet(loader), ff.Scenario(Release(angle), 0.6), ff.Law.of("robust", loader).sampled)
    pressure = np.abs(run.history.load_pressure_pa.to_numpy()).max()
    assert row.needs.pressure_pa == pytest.approx(pressure, rel=ENGINE)
    assert ff.sizing.sizing_conclusions(ff.sizing.size_drive(ff.elevator()), ff.UnitSystem.SI).ok


def test_elevator_release_uses_original_loop():
    row, _ = release_of(ff.elevator())
    assert row.law == "original"


def test_seals_take_pressure_of_a_moving_piston():
    """Closed form: ``p = F / (l A) + F_seal / A`` along the motion, at rest along the force."""
    bare = ff.digital_elevator()
    loader = bare.replace({"actuator.seal_friction": "15 lb"})
    force, speed = np.array([100.0, 100.0, -100.0, 0.0, 0.0]), np.array([0.1, -0.1, 0.0, 0.1, 0.0])
    (plain, _), (rubbed, _) = (Valve(one).statics.taken(force, speed) for one in (bare, loader))
    taken = loader["actuator.seal_friction"] / loader["actuator.area"]
    assert rubbed - plain == pytest.approx(taken * np.array([1, -1, -1, 1, 0]), rel=ROUNDING, abs=ROUNDING * taken)
    at_grip = Valve(bare).force_per_pressure * taken
    assert Valve(loader).capability.peak_force_n == pytest.approx(
        Valve(bare).capability.peak_force_n - at_grip, rel=ROUNDING
    )
