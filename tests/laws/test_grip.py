"""The law for a force sensor at the grip: the witness, what it hears and what not, light feels under an arm, what is refused."""

import math

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.choice.noise import noise_at_grip
from forcefeel.envelope.plan import make_plan
from forcefeel.frontier.bound import inertia_bound
from forcefeel.laws.law import Law, names_for
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.sensors import SENSORS, sample_variance, unseen_inertia
from forcefeel.loops import sampled_loops
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded, Release
from tests import electric_witness as witness
from tests.parametrization import mostly_slow

QUIET = {f"{sensor}.{row}": None for sensor in SENSORS for row in ("noise", "resolution")}
SENSOR = {"grip_sensor.gain": 1.0}
VALVE = ff.digital_elevator().replace(QUIET | SENSOR, si=True)
MOTOR = BUILT_IN["elevator-electric"]().replace(QUIET | SENSOR, si=True)
YOKE = BUILT_IN["desktop-yoke"]().replace(QUIET, si=True)
LOADERS = pytest.mark.parametrize("loader", [VALVE, MOTOR], ids=["valve", "motor"])

FORGOTTEN = 1e-7
"""Of the angle at rest: the observer forgets its disturbance by 1e-9 a period. Measured: 5e-8."""
AGREES = 1e-4
"""Of the travel."""


def own(loader):
    return Law.of("grip", loader)


@pytest.mark.slow
@pytest.mark.parametrize("mass", mostly_slow([None, 0.05]))
def test_engine_matches_the_reference(mass):
    loader = YOKE.replace({"grip_sensor.gain": 0.97, "grip_sensor.mass": mass}, si=True)
    law, time = own(loader), np.linspace(0.0, 0.21, 421)
    force = 8 * np.sin(2 * math.pi * 4 * time)
    run = simulate(loader, Scenario(Recorded(time, force), 0.2, 1e-4, loader["controller.period"]), law)
    angle = witness.simulate(loader, law.numbers, lambda t: np.interp(t, time, force), 0.2)["column_angle_rad"]
    assert np.ptp(angle) > 0.02
    assert np.abs(run.history["column_angle_rad"].values - angle).max() < AGREES * np.ptp(angle)


@LOADERS
@pytest.mark.parametrize("mass", [None, 0.3])
def test_static_stiffness_is_that_of_the_feel_for_any_column(loader, mass):
    """By the sensor alone: not by the link's ratio, nor by the load cell, that the torque of other laws comes from."""
    loader, law = (
        loader.replace({"grip_sensor.mass": mass}, si=True),
        own(loader.replace({"grip_sensor.mass": mass}, si=True)),
    )
    off = loader.replace({key: 1.2 * loader[key] for key in ("linkage.ratio", "column.inertia")}, si=True)
    force = 0.2 * loader["pilot.force"]
    angle = force * loader["column.grip_arm"] / loader["feel.stiffness"]
    for machine in (loader, off):
        run = simulate(machine, Scenario(Recorded([0.0, 1.0], [force, force]), 0.01), law)
        assert run.history["column_angle_rad"].values[0] == pytest.approx(angle, rel=FORGOTTEN)


@LOADERS
def test_loop_poles_include_the_poles_of_the_feel(loader):
    """Hands off nothing is heard, so two poles are those of I, B, G run by themselves; 0.5 ms of Runge-Kutta leave 1e-9."""
    inertia, damping, stiffness = (loader[f"feel.{key}"] for key in ("inertia", "damping", "stiffness"))
    expected = np.exp(np.roots([inertia, damping, stiffness]) * loader["controller.period"])
    poles = sampled_loops(loader, own(loader)).poles[0]
    for pole in expected:
        assert np.abs(poles - pole).min() < 1e-6 * abs(pole - 1)


@LOADERS
def test_column_deviations_do_not_change_the_feel(loader):
    law = own(loader)
    for key in ("column.inertia", "linkage.ratio"):
        for factor in (0.8, 1.2):
            assert sampled_loops(loader.replace({key: factor * loader[key]}, si=True), law).stable.all()


def test_column_dry_friction_is_not_felt():
    """Under 2 lb the hand moves it as it moves the feel: half the loop's width is below a twentieth of the friction."""
    friction = 2 * 4.4482216
    loader = VALVE.replace({"column.coulomb_friction": friction, "column.static_friction": friction}, si=True)
    run = simulate(loader, Scenario(Release(0.17), 3.0), "grip")
    bare = simulate(VALVE, Scenario(Release(0.17), 3.0), "grip")
    angle, expected = (one.history["column_angle_rad"].values for one in (run, bare))
    assert np.abs(angle - expected).max() < 0.02 * 0.17


def test_robust_law_uses_the_grip_sensor_where_present():
    law = Law.of("robust", VALVE).sampled
    assert law.sampled == 4
    assert Law.of("robust", ff.digital_elevator()).sampled.sampled == 3


def test_law_with_grip_sensor_round_trips_through_its_file(tmp_path):
    law = own(VALVE)
    law.save(tmp_path / "law.json")
    again = Law.of(tmp_path / "law.json", VALVE)
    assert np.array_equal(again.sampled.rows(), law.sampled.rows())


def test_grip_sensor_noise_is_included():
    noisy = VALVE.replace({"grip_sensor.noise": 0.5, "grip_sensor.resolution": 0.3}, si=True)
    assert sample_variance(noisy)[-1] == pytest.approx(0.25 + 0.09 / 12)
    assert noise_at_grip(noisy, own(noisy)).angle_rad > 0


def test_inertia_bound_depends_on_outboard_mass():
    grid = {"stiffness": "1, 10 %", "frequency": "2, 4 Hz", "damping": "0.2, 1"}
    bare, heavy, without = VALVE, VALVE.replace({"grip_sensor.mass": 1.0}, si=True), ff.digital_elevator()
    assert unseen_inertia(without) == without["column.inertia"]
    assert unseen_inertia(heavy) == pytest.approx(heavy["column.grip_arm"] ** 2)
    shares = [
        inertia_bound(make_plan(one, ("robust",), grid), (0.2,), threads=1).shares[0] for one in (bare, heavy, without)
    ]
    assert shares[0] == 1.0
    assert shares[0] > shares[1] > shares[2]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"grip_sensor.noise": 0.1}, "grip_sensor.noise: has no effect without grip_sensor.gain"),
        (SENSOR | {"grip_sensor.noise": 0.0}, "grip_sensor.noise: expected 1e-6 to"),
        (
            SENSOR | {"column.inertia": 1.0, "grip_sensor.mass": "4 kg"},
            "grip_sensor.mass: expected less than the whole column has",
        ),
        (
            SENSOR | {"pilot.force": "5 lb", "grip_sensor.resolution": "8 lb"},
            "grip_sensor.resolution: expected less than pilot.force",
        ),
        (SENSOR | {"controller.period": None, "controller.delay": None}, "grip_sensor.gain: has no effect without"),
    ],
)
def test_inactive_sensor_is_refused(changes, said):
    bare = ff.elevator() if "controller.period" in changes else ff.digital_elevator()
    given = {key: value for key, value in changes.items() if value is not None}
    with pytest.raises(ff.InputError) as caught:
        bare.replace(given, si=True)
    assert said in str(caught.value)


def test_grip_law_without_sensor_is_not_offered_and_is_refused():
    assert "grip" in names_for(VALVE)
    assert "grip" not in names_for(ff.digital_elevator())
    with pytest.raises(ff.InputError, match="needs a force sensor at the grip, and elevator-2khz has none"):
        Law.of("grip", ff.digital_elevator())
