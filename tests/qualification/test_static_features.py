"""Static features of feels that are programmed, beside the closed forms of their statics.

``F(x) = F_b clip(x / t_b, -1, 1) + k (x - clip(x, -d, d)) + P + detent + (F_c + F_h) sgn x'``, lb and deg, by the equation at the
head of ``feel.rs``; and of records of it that were moved by hand at a known speed, ``+ B x' + I x''``, with and without noise. What
is read is what the feel takes at rest: neither ``B x'`` nor ``I x''`` is part of it, and both sides read the same.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import savgol_filter

from forcefeel.loader.built_in import open_loader
from forcefeel.loader.curves import Curve
from forcefeel.qualification import Record
from forcefeel.qualification.plan.feel_alone import FeelAlone
from forcefeel.qualification.plan.motions import Motions, first_force
from forcefeel.qualification.static_force import _slopes
from forcefeel.qualification.sweep import measure_sweep
from forcefeel.qualification.throw import Throw
from forcefeel.units import factor
from tests.parametrization import mostly_slow

LB = factor("lb", "N")
DEG = math.pi / 180
SHARE, NEAR_LB = 0.01, 0.02
"""What a figure may be off: the larger of a share of it and of a force."""
ROUNDING = 1e-11
"""Of sums of some hundred numbers of the size of ten."""
NEAR_DEG = 0.02
"""Of a freeplay: a fifth of a place on the grid of 401."""
SLOW_S = 100.0
SURE = 4.0  # standard uncertainties, of some hundred figures

# Breakout on both sides beside the friction that is read, lb.
FEELS = {
    "nothing": ({}, 0.0, 0.0),
    "friction": ({"coulomb_friction": "2 lb"}, 2.0, 2.0),
    "static friction": ({"coulomb_friction": "2 lb", "static_friction": "4 lb"}, 4.0, 2.0),
    "breakout": ({"breakout": "3 lb"}, 3.0, 0.0),
    "small breakout": ({"breakout": "0.2 lb"}, 0.2, 0.0),
    "breakout, friction": ({"breakout": "3 lb", "coulomb_friction": "2 lb"}, 5.0, 2.0),
    "deadband": ({"deadband": "0.5 deg"}, 0.0, 0.0),
    "wide deadband, friction": ({"deadband": "2 deg", "coulomb_friction": "2 lb"}, 2.0, 2.0),
    "deadband, breakout, friction": (
        {"deadband": "0.5 deg", "breakout": "3 lb", "coulomb_friction": "2 lb"},
        5.0,
        2.0,
    ),
    "hysteresis": ({"hysteresis": "2 lb"}, 2.0, 2.0),
    "hysteresis, breakout": ({"hysteresis": "2 lb", "breakout": "3 lb"}, 5.0, 2.0),
    "detent": ({"detent_force": "6 lb", "detent_travel": "0.3 deg"}, 6.0, 0.0),
    "detent that the control moves in": ({"detent_force": "2 lb", "detent_travel": "1 deg"}, 0.0, 0.0),
    "detent off neutral": ({"detent_force": "2 lb", "detent_angle": "3 deg"}, 0.0, 0.0),
    "preload within friction": ({"preload": "1 lb", "coulomb_friction": "2 lb"}, 2.0, 2.0),
    "preload within breakout": ({"preload": "1 lb", "breakout": "3 lb"}, 3.0, 0.0),
    "preload of a spring": ({"preload": "4 lb"}, 0.0, 0.0),
    "much damping": ({"damping": "1500 lb in s/rad"}, 0.0, 0.0),
    "slow": ({"inertia": "900 lb in s^2", "coulomb_friction": "2 lb"}, 2.0, 2.0),
    "four together": (
        {"breakout": "3 lb", "coulomb_friction": "1 lb", "deadband": "0.5 deg", "hysteresis": "1 lb"},
        5.0,
        2.0,
    ),
    "curve, breakout, friction": ({"breakout": "3 lb", "coulomb_friction": "2 lb"}, 5.0, 2.0),
}
SOFTER = Curve(
    tuple(DEG * at for at in (-20.0, -8.0, 0.0, 8.0, 20.0)),
    tuple(LB * force for force in (-70.0, -40.0, 0.0, 40.0, 70.0)),
)
"""Force over angle, softer with the angle."""
BARE = {"breakout": "0 lb", "coulomb_friction": "0 lb", "deadband": "0 deg"}
"""Of a built-in loader whose feel has some."""
ELECTRIC = [
    ("deadband, breakout, friction", "aileron-wheel"),
    ("hysteresis, breakout", "rudder-pedals"),
    ("breakout, friction", "sidestick-pitch"),
]


@cache
def reference(name, built_in="elevator-2khz"):
    """A loader and the programme's slow sweep of its feel."""
    loader = replace(open_loader(built_in), force_curve=SOFTER if "curve" in name else None)
    loader = loader.replace({f"feel.{row}": value for row, value in {**BARE, **FEELS[name][0]}.items()}, si=True)
    throw = Throw.of(loader)
    record = Motions.of(loader, None).swept(FeelAlone(loader), throw, first_force(loader, throw), SLOW_S, "feel")
    return loader, measure_sweep(record)


def close(figure, expected_lb):
    return abs(figure.value / LB - expected_lb) <= max(SHARE * abs(expected_lb), NEAR_LB)


def check(found, breakout, friction):
    assert close(found.breakout_low, breakout)
    assert close(found.breakout_high, breakout)
    assert close(found.friction, friction)


@pytest.mark.parametrize("name", mostly_slow([name for name in FEELS if name != "preload within breakout"], 3))
def test_reference_statics_match_feel(name):
    loader, found = reference(name)
    check(found, *FEELS[name][1:])
    if "curve" in name or "detent" in name:  # the gradient is read where the force is no straight spring's
        return
    spring = loader["feel.stiffness"] / loader["column.grip_arm"]
    for side in (found.gradient_low, found.gradient_high):
        assert side.value == pytest.approx(spring, rel=SHARE)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "built_in"), ELECTRIC)
def test_electric_reference_statics_match_feel(name, built_in):
    check(reference(name, built_in)[1], *FEELS[name][1:])


@pytest.mark.slow
def test_preload_shifts_breakout_between_sides():
    """It holds the control ``x = -P / (F_b / t_b + k)`` off, from where the line beyond the knee is laid back."""
    loader, found = reference("preload within breakout")
    spring = loader["feel.stiffness"] / loader["column.grip_arm"] / LB * DEG
    rest = -1.0 / (3.0 / 0.1 + spring)
    assert close(found.breakout_high, 3.0 + 1.0 + spring * rest)
    assert close(found.breakout_low, 3.0 - 1.0 - spring * rest)
    assert close(found.friction, 0.0)


@pytest.mark.parametrize(("name", "expected_deg"), [("deadband", 1.0), ("nothing", 0.0)])
def test_deadband_is_measured_as_freeplay(name, expected_deg):
    _, found = reference(name)
    assert found.freeplay.value / DEG == pytest.approx(expected_deg, abs=NEAR_DEG)


STOP, SPRING, DAMPING, INERTIA, RATE = 20.0, 5.34, 0.4, 0.05, 100.0
"""deg, lb/deg, lb s/deg (0.5 lb at the usual speed), lb s^2/deg, samples a second."""


def statics(x, breakout=0.0, deadband=0.0):
    return breakout * np.clip(x / 0.1, -1, 1) + SPRING * (x - np.clip(x, -deadband, deadband))


def moved_by_hand(breakout=0.0, friction=0.0, deadband=0.0, *, noise_lb=0.0, noise_deg=0.0, step_deg=0.0, up=1):
    """A hand that goes out, across and back, each way eased; friction holds it before."""
    ways, at = ((STOP, 25.0), (-2 * STOP, 50.0), (STOP, 25.0)), [np.zeros(1)]
    for way, lasts in ways:
        s = np.arange(1, round(lasts * RATE) + 1) / (lasts * RATE)
        at.append(at[-1][-1] + way * (s - np.sin(2 * math.pi * s) / (2 * math.pi)))
    x = up * np.concatenate(at)
    v, a = np.gradient(x, 1 / RATE), np.gradient(np.gradient(x, 1 / RATE), 1 / RATE)
    force = statics(x, breakout, deadband) + friction * np.sign(v) + DAMPING * v + INERTIA * a
    still = 300
    x = np.concatenate([np.zeros(still), x])
    force = np.concatenate([np.linspace(0.0, up * friction, still, endpoint=False), force])
    rng = np.random.default_rng(5)
    x, force = (one + noise * rng.standard_normal(len(x)) for one, noise in ((x, noise_deg), (force, noise_lb)))
    x = np.round(x / step_deg) * step_deg if step_deg else x
    return Record(np.arange(len(x)) / RATE, x * DEG, force * LB)


@pytest.mark.parametrize(
    ("noise_lb", "noise_deg", "step_deg", "up"),
    [(0.0, 0.0, 0.0, 1), (0.1, 0.005, 0.0, -1), (0.1, 0.0, 0.01, 1)],
    ids=["exact", "both noisy", "steps"],
)
@pytest.mark.parametrize(
    ("breakout", "friction", "deadband"),
    mostly_slow([(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (3.0, 2.0, 0.0), (2.0, 3.0, 0.0), (0.0, 1.0, 0.5), (3.0, 0.0, 0.5)]),
)
def test_statics_of_hand_moved_record_match_feel(breakout, friction, deadband, noise_lb, noise_deg, step_deg, up):
    record = moved_by_hand(
        breakout, friction, deadband, noise_lb=noise_lb, noise_deg=noise_deg, step_deg=step_deg, up=up
    )
    found = measure_sweep(record)
    for figure, expected in (
        (found.breakout_low, breakout + friction),
        (found.breakout_high, breakout + friction),
        (found.friction, friction),
    ):
        fine = max(SHARE * expected, NEAR_LB)
        assert abs(figure.value / LB - expected) <= fine + SURE * figure.uncertainty / LB
        assert figure.uncertainty / LB < 0.2  # of what is read beside noise of 0.1 lb a sample


@pytest.mark.parametrize("reach", [1, 7, 149])
def test_slopes_match_savitzky_and_golay_of_scipy(reach):
    values = np.cumsum(np.random.default_rng(1).normal(size=300))
    for order, slope in _slopes(values, reach):
        assert slope == pytest.approx(savgol_filter(values, 2 * reach + 1, 2, deriv=order, delta=1.0), abs=ROUNDING)
