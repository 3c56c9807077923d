"""The programmed feel alone, row by row, beside an integration of the feel's own equation that is written out here in lb, in, rad:

``I phi'' + B phi' + b_2 phi' |phi'| + G dead(phi) + R_p (breakout + preload + detent + hysteresis) + stops + friction = R_p F``

by the midpoint rule at ``STEP``, friction as a set: what would pass zero speed within a step stands.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.loader.built_in import open_loader
from forcefeel.loader.curves import Curve
from forcefeel.qualification import Outcome
from forcefeel.qualification.plan import QualificationSetup, qualify_loader
from forcefeel.qualification.plan.feel_alone import FeelAlone
from forcefeel.simulation import Scenario
from forcefeel.simulation.inputs import Recorded, Schedule
from forcefeel.units import factor
from tests.parametrization import mostly_slow

LB = factor("lb", "N")
DEG = math.pi / 180
STEP = 1e-4
ROUNDING = 1e-12  # of the angle; the same spring by way of two curves
NEAR = 1e-3  # of the largest angle: what moves at 2 Hz covers that in a step, and in a step it meets a stop or a limit
ANGLE = 10 * DEG
RELEASED_S = 0.1

ROWS = {
    "plain": {},
    "deadband": {"feel.deadband": "1 deg"},
    "breakout": {"feel.breakout": "12 lb"},
    "slow breakout": {"feel.breakout": "5 lb", "feel.breakout_travel": "2 deg"},
    "preload": {"feel.preload": "4 lb"},
    "detent": {"feel.detent_force": "6 lb", "feel.detent_angle": "3 deg", "feel.detent_travel": "1.5 deg"},
    "hysteresis": {"feel.hysteresis": "4 lb", "feel.hysteresis_travel": "0.5 deg"},
    "friction": {"feel.coulomb_friction": "2 lb"},
    "static friction": {"feel.coulomb_friction": "2 lb", "feel.static_friction": "4 lb"},
    "quadratic": {"feel.quadratic_damping": "500 lb in s^2/rad^2"},
    "soft stop": {
        "feel.soft_stop_high": "8 deg",
        "feel.soft_stop_low": "-8 deg",
        "feel.soft_stop_damping": "200 lb in s/rad",
    },
    "hard stop": {"feel.hard_stop_high": "12 deg", "feel.hard_stop_low": "-4 deg"},
    "rate limit": {"feel.velocity_limit": "40 deg/s"},
    "all": {
        "feel.breakout": "3 lb",
        "feel.coulomb_friction": "1 lb",
        "feel.deadband": "0.5 deg",
        "feel.hysteresis": "1 lb",
        "feel.quadratic_damping": "200 lb in s^2/rad^2",
    },
}
UNITS = {"lb": 1.0, "deg": DEG, "lb in s^2/rad^2": 1.0, "lb in s/rad": 1.0, "deg/s": DEG}
INERTIA, B, G, R_P = 60.0, 304.0, 9600.0, 31.375  # the elevator's
TRAVELS = {"breakout": 0.1 * DEG, "detent": 1.0 * DEG, "hysteresis": 0.2 * DEG}
SOFT_STOP_STIFFNESS = 50_000.0  # lb in/rad, the default


def clipped(x, low, high):
    """As ``np.clip``, which takes ten times as long for so few."""
    return np.minimum(np.maximum(x, low), high)


def integrated(rows, angle, force, steps, held):
    """Angle at the steps of ``rows``, a run each side by side, under ``force(t)`` in lb from ``angle`` at rest."""

    def of(name, otherwise=0.0):
        given = (one.get(f"feel.{name}") for one in rows)
        texts = (None if text is None else text.split(" ", 1) for text in given)
        return np.array([otherwise if text is None else float(text[0]) * UNITS[text[1]] for text in texts])

    dead, breakout, preload, detent, slip = map(of, ("deadband", "breakout", "preload", "detent_force", "hysteresis"))
    breakout_travel, detent_travel, slip_travel = (of(f"{name}_travel", TRAVELS[name]) for name in TRAVELS)
    detent_at, quadratic = of("detent_angle"), of("quadratic_damping")
    soft_low, soft_high = of("soft_stop_low", -math.inf), of("soft_stop_high", math.inf)
    soft_damping, fastest = of("soft_stop_damping"), of("velocity_limit", math.inf)
    low, high = of("hard_stop_low", -math.inf), of("hard_stop_high", math.inf)
    kinetic = of("coulomb_friction") * R_P
    static = np.maximum(of("static_friction") * R_P, kinetic)

    def pull(x, v, slider, push):
        u = (x - detent_at) / detent_travel
        height = np.sign(u) * np.maximum(np.minimum(np.abs(u), 2 - np.abs(u)), 0)
        grip = breakout * clipped(x / breakout_travel, -1, 1) + preload + detent * height
        grip = grip + slip * clipped((x - slider) / slip_travel, -1, 1)
        depth = x - clipped(x, soft_low, soft_high)
        stop = SOFT_STOP_STIFFNESS * depth + np.where(depth != 0, soft_damping * v, 0.0)
        stop = np.where(stop * depth > 0, stop, 0.0)
        return R_P * push - B * v - quadratic * v * np.abs(v) - G * (x - clipped(x, -dead, dead)) - R_P * grip - stop

    def stopped(x, v):
        x, into = clipped(x, low, high), ((x >= high) & (v > 0)) | ((x <= low) & (v < 0))
        return x, np.where(into, 0.0, clipped(v, -fastest, fastest))

    x, v = np.broadcast_to(angle, len(rows)).astype(float), np.zeros(len(rows))
    slider, found = x.copy(), [x]
    for k in range(steps):
        if k >= held:
            t = k * STEP
            now = pull(x, v, slider, force(t))
            stuck = (v == 0) & (np.abs(now) <= static) & (static > 0)
            drag = np.where(v != 0, np.sign(v), np.sign(now)) * kinetic
            half = v + STEP / 2 * (now - drag) / INERTIA
            middle = pull(x + STEP / 2 * v, half, slider, force(t + STEP / 2))
            after = v + STEP * (middle - drag) / INERTIA
            turned = (kinetic > 0) & (after * np.where(v != 0, v, now) < 0)  # friction never drives it backwards
            after = np.where(stuck | turned, 0.0, after)
            x, v = stopped(x + STEP * (v + after) / 2, after)
            slider = clipped(slider, x - slip_travel, x + slip_travel)
        found.append(x)
    return np.array(found).T


def rest(rows):
    """Where a feel with a preload stands at rest, ``G phi + R_p P = 0``."""
    return np.array([-R_P * float(one.get("feel.preload", "0 lb").split()[0]) / G for one in rows])


SWEEP_S = 4.0
SWEEP_LB = 90.0
STATIC_LB = 0.02
"""Of what is read of a feel's statics, from a sweep in which it also swings. Measured: 0.007."""


@pytest.fixture(scope="module")
def references():
    names = list(ROWS)
    rows = [ROWS[name] for name in names]
    released = integrated(rows, ANGLE, lambda t: 0.0, 20_000, round(RELEASED_S / STEP))
    swept = integrated(rows, rest(rows), lambda t: SWEEP_LB * math.sin(2 * math.pi * t / SWEEP_S) ** 3, 40_000, 0)
    return {name: (released[k], swept[k]) for k, name in enumerate(names)}


ELEVATORS = ("elevator-1974", "elevator-2khz")
"""The feel alone knows no drive; its rows here are of the size of an elevator's."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ROWS)
def test_each_feel_row_matches_its_equation(references, name):
    alone = FeelAlone(ff.digital_elevator().replace(ROWS[name], si=True))
    released, swept = references[name]
    time = np.linspace(0, SWEEP_S, 8001)
    push = Recorded(time, SWEEP_LB * LB * np.sin(2 * np.pi * time / SWEEP_S) ** 3, "push")
    every = round(1e-3 / STEP)
    for scenario, reference in (
        (Scenario(ff.Release(ANGLE, RELEASED_S), 2.0), released),
        (Scenario(push, SWEEP_S), swept),
    ):
        angle = alone.move(scenario)
        size = NEAR * np.max(np.abs(reference))
        np.testing.assert_allclose(angle, reference[::every], rtol=0, atol=size, err_msg=name)
    assert set(alone.rows) == set(ROWS[name])
    assert all(row in alone.method for row in ROWS[name])


@pytest.mark.parametrize("built_in", ELEVATORS)
def test_feel_alone_includes_feel_curves(built_in):
    """A straight curve of twice G, and a factor of a half on it at the pressure that is given: G again."""
    loader = open_loader(built_in)
    at = (-0.5, 0.0, 0.5)
    twice = Curve(at, tuple(2 * loader["feel.stiffness"] / loader["column.grip_arm"] * angle for angle in at))
    same = replace(loader, force_curve=twice, stiffness_factor=Curve((0.0, 5e3), (0.25, 0.75)))
    released = Scenario(ff.Release(ANGLE, RELEASED_S), 2.0)
    pressed = Scenario(ff.Release(ANGLE, RELEASED_S), 2.0, dynamic_pressure_pa=Schedule((0.0,), (2.5e3,)))
    np.testing.assert_allclose(FeelAlone(same).move(pressed), FeelAlone(loader).move(released), atol=ROUNDING * ANGLE)


@pytest.mark.parametrize("built_in", mostly_slow(ELEVATORS))
def test_a_nonlinear_feel_on_any_loader_has_a_reference(built_in):
    """On a loader with sensors that are noisy too: nothing of them is part of the feel."""
    loader = open_loader(built_in).replace({"feel.breakout": "12 lb", "feel.coulomb_friction": "1 lb"})
    found = qualify_loader(loader, QualificationSetup())
    results = {result.trial.key: result for result in found.sections[0].results}
    assert all(results[key].outcome is not Outcome.NOT_EVALUATED for key in ("static", "release-50-positive", "medium"))
    reference = results["static"].reference.features
    for figure in (reference.breakout_low, reference.breakout_high):
        assert figure.value == pytest.approx(13.0 * LB, abs=STATIC_LB * LB)
    assert reference.friction.value == pytest.approx(1.0 * LB, abs=STATIC_LB * LB)
    assert "feel.breakout" in found.reference
