"""A grip held where the feel asks for more than the motor gives, then let go: the law knows of the limit that it was told of."""

import math
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.simulation import RunStatus, Scenario, simulate
from forcefeel.simulation.inputs import Pulse, Release, Step
from forcefeel.units import UnitSystem
from tests import electric_witness as witness
from tests.parametrization import mostly_slow
from tests.simulation.test_electric_witness import AGREES, RAW, TRAVEL

LOADER = ff.loader.electric("elevator-electric").replace(RAW | {"current_loop.current_limit": 14.5}, si=True)
"""Its motor holds 12.5 deg of its feel with 14.51 A."""
ANGLE = math.radians(12.5)
AT_REST = 1e-6
"""rad in half a second: what a hand's constant force and a motor's leave of one another, by rounding."""
FEEL_RESTS = 1e-5
"""rad: the feel in the middle of a period stands for all of it."""
HELD_S = 0.5


def at_setting(name, share, hertz=2.0, damping=0.7, **changes):
    """A loader whose feel has a share of the largest stiffness, with its law."""
    loader = ff.loader.electric(name)
    stiffness, omega = share * loader["feel.maximum_stiffness"], 2 * math.pi * hertz
    inertia = stiffness / omega**2
    feel = {"feel.stiffness": stiffness, "feel.inertia": inertia, "feel.damping": 2 * damping * omega * inertia}
    loader = loader.replace(RAW | feel | {f"controller.{key}": value for key, value in changes.items()}, si=True)
    return loader, ff.Law.of("robust", loader).numbers


def held(loader, law, angle):
    """The witness's own state where a hand holds the grip against the limit, from the equations of rest.

    The current is the limit, the law has been told so for long, and the feel's spring carries the torque that it estimates.
    """
    plant, row = witness.Plant(loader), loader.__getitem__
    current = -math.copysign(row("current_loop.current_limit"), angle)
    force = plant.kt * current / plant.r
    base = angle * plant.arm
    sensors = np.array([force, plant.alpha * base + force / plant.k, angle])
    states = len(law.transition[0])
    xi = np.linalg.solve(np.eye(states) - law.transition[0], law.input[0] @ np.append(sensors, current))
    known = np.concatenate([xi, sensors])
    (asks, *asks_by), (hears, *hears_by) = ((line[:-2] @ known, *line[-2:]) for line in (law.command[0], law.torque[0]))
    inertia, damping, stiffness = (row(f"feel.{name}") for name in ("inertia", "damping", "stiffness"))
    way, period = row("controller.antiwindup"), row("controller.period")
    # delta, delta' at a sample, x: what the feel gives way by, what carries it on half-way, and what the command is beyond
    equations = [
        [0.0, 1.0, -2 * way + 0.5 * period * way**2],
        [stiffness - hears_by[0], -hears_by[1], 2 * way * damping + way * period * stiffness + inertia * way**2],
        [*asks_by, -asks_by[0]],
    ]
    delta, rate, excess = np.linalg.solve(equations, [0.0, hears, current - asks])
    assert excess * asks_by[0] / current > 0  # it is the limit that holds it
    y = np.array([sensors[1], 0.0, current, base, 0.0, 0.0, 0.0, *sensors])
    return witness.Start(y, np.array([delta, rate]), xi, current + excess * asks_by[0])


@pytest.mark.slow
@pytest.mark.parametrize(("limit", "antiwindup"), mostly_slow([(14.5, 0.0), (10.0, 100.0)]))
def test_release_beyond_holding_torque_matches_witness(limit, antiwindup):
    loader = LOADER.replace({"current_loop.current_limit": limit, "controller.antiwindup": antiwindup}, si=True)
    law = ff.Law.of("robust", loader).numbers
    run = simulate(loader, Scenario(Release(ANGLE), 0.5, sample_s=loader["controller.period"]), law)
    expected = witness.simulate(loader, law, lambda _: 0.0, 0.5, start=held(loader, law, ANGLE))
    angle = run.history.column_angle_rad.values
    assert np.abs(angle - expected["column_angle_rad"]).max() / TRAVEL < AGREES
    assert angle.min() > -0.6 * ANGLE  # on the other stop it would be beyond all of it


@pytest.mark.parametrize("limit", [14.5, 14.3, 10.0, 3.0])
def test_release_beyond_holding_torque_returns_to_neutral(limit):
    loader = LOADER.replace({"current_loop.current_limit": limit}, si=True)
    run = simulate(loader, Scenario(Release(ANGLE), 4.0), ff.Law.of("robust", loader).numbers)
    assert run.status is RunStatus.SETTLED
    assert abs(run.measures.final_angle_rad) < 0.01 * ANGLE  # of the 12.5 deg


BEYOND = [
    ("rudder-pedals", 0.7, 18.0),
    ("rudder-pedals", 1.0, 40.0),
    ("aileron-wheel", 1.0, 60.0),
    ("elevator-electric", 1.0, 12.0),
    ("sidestick-pitch", 1.0, 15.5),
]


@pytest.mark.parametrize("antiwindup", [0.0, 100.0])
@pytest.mark.parametrize(("name", "share", "degrees"), BEYOND)
def test_release_with_weak_motor_returns_to_neutral(name, share, degrees, antiwindup):
    loader, law = at_setting(name, share, antiwindup=antiwindup)
    run = simulate(loader, Scenario(Release(math.radians(degrees)), 3.0), law)
    assert run.status is RunStatus.SETTLED
    assert abs(run.measures.final_angle_rad) < 0.01 * math.radians(degrees)


@pytest.mark.parametrize("antiwindup", [0.0, 3.0, 100.0, 1e4])
@pytest.mark.parametrize(("name", "share", "degrees"), BEYOND)
def test_column_held_at_limit_is_at_rest(name, share, degrees, antiwindup):
    """Column and feel stay where they are as long as the hand holds on."""
    loader, law = at_setting(name, share, antiwindup=antiwindup)
    angle = math.radians(degrees)
    run = simulate(loader, Scenario(Release(angle, start_s=HELD_S), HELD_S), law)
    history = run.history
    limit = loader["current_loop.current_limit"]
    assert np.abs(history.motor_current_a.values).min() > limit * (1 - AT_REST)
    assert np.abs(history.column_angle_rad.values - angle).max() < AT_REST
    feel = history.feel_position_rad.values
    assert np.abs(feel - feel[0]).max() < FEEL_RESTS
    assert antiwindup or feel[0] < angle  # what gives way all the time stands ahead of what it gives up


@pytest.mark.parametrize("antiwindup", [100.0, 1e3, 1e5])
@pytest.mark.parametrize(("name", "share"), [("elevator-electric", 1 / 3), ("rudder-pedals", 0.3)])
def test_fast_antiwindup_yields_no_more_than_excess_command(name, share, antiwindup):
    """A push beyond what the motor holds, against a stop: the feel gives way by no more than its command is beyond."""
    loader, law = at_setting(name, share, antiwindup=antiwindup)
    stops = {
        "column.stop_low": -0.3,
        "column.stop_high": 0.3,
        "column.stop_stiffness": 2e4,
        "column.stop_damping": 50.0,
    }
    loader = loader.replace(stops, si=True)
    plant = witness.Plant(loader)
    holds = plant.kt * loader["current_loop.current_limit"] / plant.r * plant.alpha * plant.arm / plant.grip
    run = simulate(loader, Scenario(Pulse(1.5 * holds, 0.1, 0.5), 4.0), law)
    assert run.status is RunStatus.SETTLED
    assert np.abs(run.history.feel_position_rad.values).max() < 1.0  # rad; a push of 1.5 times as much is 0.5 of it
    assert abs(run.measures.final_angle_rad) < 0.01  # rad, of 0.3


def test_antiwindup_ends_a_limit_cycle_of_rotor_and_column_on_the_link():
    """Of a conditionally stable loop: the command that is cut off is a gain that is too small."""
    swings = []
    for antiwindup in (0.0, 100.0):
        loader, law = at_setting("desktop-yoke", 1.0, 0.5, 1.0, antiwindup=antiwindup)
        law = replace(law, contact=np.zeros_like(law.contact))  # which would end it after sixteen turns
        history = simulate(loader, Scenario(Release(math.radians(18.0)), 3.0), law).history
        late = history.time_s.values > 2.5
        swings.append(np.ptp(history.motor_speed_rad_per_s.values[late]))
        at_limit = np.abs(history.motor_current_a.values[late]) > 0.999 * loader["current_loop.current_limit"]
        assert (at_limit.mean() > 0.5) == (antiwindup == 0)  # most of the time, and never
    assert swings[1] < 0.01 * swings[0]  # measured: a part in 300


def verdict(run):
    return ff.simulation.run_conclusions(run, UnitSystem.SI).verdict


def test_verdict_is_settled_when_column_rests_at_feel_angle():
    law = ff.Law.of("robust", LOADER).numbers
    assert verdict(simulate(LOADER, Scenario(Release(ANGLE), 3.0), law)).startswith("Settled at ")


def test_verdict_of_held_column_names_angle_and_cause():
    """Pushed on its stop by a force that the motor does not hold; one of 19 A holds it there, where its feel then stands too."""
    loader = ff.loader.electric("elevator-electric")
    strong = simulate(loader, Scenario(Step(900.0), 3.0), ff.Law.of("robust", loader).numbers)
    assert strong.measures.final_angle_rad > loader["column.stop_high"]
    assert verdict(strong).startswith("Settled at ")
    loader = loader.replace({"current_loop.current_limit": 8.0}, si=True)
    run = simulate(loader, Scenario(Step(900.0), 3.0), ff.Law.of("robust", loader).numbers)
    assert run.measures.final_angle_rad > loader["column.stop_high"]
    text = verdict(run)
    assert "Settled" not in text
    assert text.startswith("The column hangs at 13.1 deg on the upper end stop while its feel is at 6.9")
    assert "with the current at its limit of 8 A" in text


def test_equilibrium_of_a_hand_that_pushes_the_feel_to_its_hard_stop():
    """At its stop the feel takes any torque; the drive holds the column a fraction of a degree beyond, off its end stop."""
    loader = ff.loader.electric("elevator-electric").replace({"feel.hard_stop_high": "12 deg"})
    run = simulate(loader, Scenario(Step(300.0), 4.0), ff.Law.of("robust", loader).without_contact().numbers)
    angle = run.measures.final_angle_rad
    assert loader["feel.hard_stop_high"] < angle < loader["column.stop_high"]
    # What the sensors' noise and the converters' steps leave of a mean.
    assert run.measures.equilibrium_angle_rad == pytest.approx(angle, abs=2e-5)


def test_verdict_names_dry_friction_beyond_motor_force():
    """A motor of 1 A against 60 N of friction at the grip."""
    loader = ff.loader.electric("elevator-electric").replace(
        {"column.coulomb_friction": 60.0, "current_loop.current_limit": 1.0}, si=True
    )
    law = ff.Law.of("robust", loader).numbers
    run = simulate(loader, Scenario(Pulse(400.0, 0.1, 0.1), 4.0), law)
    text = verdict(run)
    assert "hangs at" in text
    assert "in its dry friction" in text
