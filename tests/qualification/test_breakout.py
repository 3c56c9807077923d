"""Breakout, friction, gradient, freeplay and centring of feels with a knee, against their closed forms.

``F(x) = F_b clip(x / t, -1, 1) + k (x - clip(x, -d, d)) + P + F_c sgn x'``, moved so slowly that nothing else counts.
"""

import math
from itertools import product

import numpy as np
import pytest

from forcefeel.qualification import Record
from forcefeel.qualification.breakout import breakout
from forcefeel.qualification.sweep import measure_sweep
from tests.parametrization import mostly_slow

DEGREE = math.pi / 180
STOP = 20.0  # deg
SPRING = 24.0  # N/deg, the elevator's
TRAVEL = 0.1  # deg over which breakout builds up, the default of feel.breakout_travel
RATE = 100.0
SURE = 4.0  # standard uncertainties, of some hundred figures
FINE_N = 0.15  # what the means of neighboring samples round off a knee of 53 N in 0.1 deg

FEELS = [
    {"breakout": breakout, "friction": friction, "deadband": deadband, "preload": preload}
    for breakout, friction, deadband, preload in product((0.0, 8.0, 53.0), (0.0, 5.0), (0.0, 0.5), (0.0, 3.0))
    if preload <= breakout + friction and breakout >= friction * (breakout > 0)
]


def spring(x, breakout, deadband, preload):
    """Without friction, N; x in deg."""
    return breakout * np.clip(x / TRAVEL, -1, 1) + SPRING * (x - np.clip(x, -deadband, deadband)) + preload


def steep(breakout, deadband):
    """Of the feel while its breakout builds up, N/deg."""
    return breakout / TRAVEL + (SPRING if deadband == 0 else 0.0)


def begins(breakout, friction, deadband, preload):
    """Where a control rests that is held by friction or by the feel, deg."""
    held = max(abs(preload) - friction, 0.0) * np.sign(preload)
    return -held / steep(breakout, deadband) if held else 0.0


def swept(breakout, friction, deadband, preload, noise_n=0.0):
    """Neutral - stop - opposite stop - neutral in 100 s, each way eased at its ends; first a force that grows until it moves."""
    start = begins(breakout, friction, deadband, preload)
    ease = (1 - np.cos(np.pi * np.linspace(0, 1, round(25 * RATE), endpoint=False))) / 2
    slow = (1 - np.cos(np.pi * np.linspace(0, 1, round(50 * RATE), endpoint=False))) / 2
    x = np.concatenate([start + (STOP - start) * ease, STOP - 2 * STOP * slow, -STOP + (STOP + start) * ease])
    way = np.sign(np.gradient(x))
    force = spring(x, breakout, deadband, preload) + friction * way
    still = np.full(200, start)
    first = float(spring(np.array([start]), breakout, deadband, preload)[0])
    force = np.concatenate([np.linspace(0.0, first + friction, 200, endpoint=False), force])
    force = force + noise_n * np.random.default_rng(3).standard_normal(len(force))
    x = np.concatenate([still, x]) * DEGREE
    exact = {} if noise_n else {"noise": 0.0, "resolution": 0.0, "force_noise_n": 0.0, "force_resolution_n": 0.0}
    return Record(np.arange(len(x)) / RATE, x, force, **exact)


def near(figure, expected, fine):
    return abs(figure.value - expected) <= SURE * figure.uncertainty + fine


@pytest.mark.parametrize("noise_n", [0.0, 0.5])
@pytest.mark.parametrize(
    "feel", mostly_slow(FEELS, 6), ids=lambda feel: "-".join(f"{value:g}" for value in feel.values())
)
def test_measured_statics_match_programmed_statics(feel, noise_n):
    found = measure_sweep(swept(**feel, noise_n=noise_n))
    breakout, friction, deadband, preload = feel.values()
    # The line beyond the knee, where the control rests: a preload moves it off the spring's own zero.
    rest = 0.0 if deadband else SPRING * begins(**feel)
    assert near(found.breakout_high, breakout + friction + preload + rest, FINE_N)
    assert near(found.breakout_low, breakout + friction - preload - rest, FINE_N)
    assert near(found.friction, friction, 0.05)
    assert near(found.gradient, SPRING / DEGREE, 0.01 * SPRING / DEGREE)
    if breakout > 0:
        # Where the way back passes through no force: on the steep part, off neutral by friction and preload.
        rests = (friction + abs(preload)) / steep(breakout, deadband) - abs(begins(**feel))
        assert near(found.centring, rests * DEGREE, 0.05 * TRAVEL * DEGREE)
        assert near(found.freeplay, 0.0, 1e-9) or deadband > 0
    elif not preload and deadband:
        assert near(found.freeplay, 2 * deadband * DEGREE, 1e-3 * DEGREE)
    assert found.breakout_high.uncertainty < 1.0


def test_too_few_samples_near_neutral_give_no_breakout():
    """Two samples a degree: the knee is not in the record."""
    record = swept(53.0, 0.0, 0.0, 0.0)
    few = Record(record.time_s[::40], record.position[::40], record.force_n[::40])
    found = measure_sweep(few, points=41)
    assert not found.breakout_low.known


def test_breakout_of_falling_force_is_read_above_next_line():
    """25 N/deg up to 0.3 deg, 15 back, 5 from 0.5 deg on: 7.5 N at its peak, where the last line, laid back, has 3.5."""
    x = np.linspace(0.001, 1.6, 1000)
    force = np.interp(x, [0.0, 0.3, 0.5, 1.6], [0.0, 7.5, 4.5, 10.0])
    assert breakout(x, force, 0.0).value == pytest.approx(4.0, abs=FINE_N)


def test_friction_that_falls_a_little_once_it_slides_is_no_detent():
    """13.3 N hold a lever; on the way to sliding its linkage gives by 0.03 deg and 14.4 N are reached."""
    x = np.concatenate([np.linspace(0.0, 0.03, 600), np.linspace(0.03, 1.0, 120)])
    force = np.where(x < 0.03, 14.4 * x / 0.03, 13.3 + 0.5 * x + 1.1 * np.exp(-(x - 0.03) / 0.03))
    assert 13.0 < breakout(x, force, 0.0).value < 15.5
