"""A record and its reference at different rates: a simulator at 100 Hz, an aircraft at 60 Hz, against closed forms."""

import itertools

import numpy as np
import pytest

from forcefeel.qualification import Outcome, Record, judge_release, load_rules, measure_release
from forcefeel.qualification.sweep import measure_sweep
from forcefeel.qualification.sweep_verdicts import judge_small_inputs, judge_sweep
from tests.parametrization import mostly_slow
from tests.qualification_records import exact, released, swept

RULES = load_rules()
FEELS = [(0.06, 1.0), (0.1, 3.0), (0.2, 2.0), (0.4, 1.5), (0.7, 2.0), (1.0, 1.5)]
"""Damping ratio and frequency, Hz, of the aircraft."""
CHANGES = [(1.0, 1.0), (1.05, 1.0), (1.0, 1 / 1.09), (1.0, 1 / 1.12), (1.3, 1.02)]
"""The simulator's as shares of them."""
RATES = [(100, 60), (60, 100), (60, 59.94)]
"""Samples a second of simulator and aircraft."""
WAY = 0.2
SURE = 4.0
"""Standard uncertainties within which a difference is right: one of 16,000 normal ones is farther off."""
INTERPOLATED = 5e-4
"""Share of a figure by which a record without noise may be off: what six samples at 60 a second leave of a period."""


def figure(quantity, zeta, frequency_hz):
    """A figure of a release of second order in closed form."""
    fall, cycles, sizes = exact(zeta, frequency_hz)
    if quantity == "fall time":
        return fall
    k = int(quantity[1:])
    return cycles[min(k, 1)] if quantity[0] == "P" else WAY * sizes[k - 1]


@pytest.mark.parametrize("noise", mostly_slow([1e-3, 0.0]))
def test_releases_at_two_rates_are_judged(noise):
    test, judged = RULES.of("release", "pitch"), 0
    for feel, change, (mine, theirs) in itertools.product(FEELS, CHANGES, RATES):
        other = feel[0] * change[0], feel[1] * change[1]
        aircraft = measure_release(released(*feel, theirs, way=WAY, noise=noise, seed=1, held_s=0.5037))
        simulator = measure_release(released(*other, mine, way=WAY, noise=noise, seed=2, held_s=0.7211))
        for verdict in judge_release(simulator, aircraft, test):
            if verdict.quantity not in {"fall time", *(f"{letter}{k}" for letter in "PA" for k in range(17))}:
                continue
            known = figure(verdict.quantity, *feel)
            difference = figure(verdict.quantity, *other) - known
            assert abs(verdict.difference - difference) < SURE * verdict.uncertainty + INTERPOLATED * known
            if verdict.outcome is not Outcome.TOO_CLOSE:
                n = int(verdict.quantity[1:]) if verdict.quantity[0] == "P" else 0
                limit = float(verdict.rule.limit(known, n=n)) if verdict.quantity[0] != "A" else verdict.tolerance
                assert (verdict.outcome is Outcome.PASSED) is (abs(difference) <= limit)
                judged += 1
    assert judged > 700  # of 750; the others are too close to call


@pytest.mark.parametrize(("share", "expected"), [(1.09, Outcome.PASSED), (1.11, Outcome.FAILED)])
@pytest.mark.parametrize("rates", RATES)
def test_static_sweeps_at_two_rates_are_judged(share, expected, rates):
    """F = k x: 10 % of itself, from where that is more than 5 lb."""
    stiff = {"stiffness": 4000.0, "breakout": 0.0, "friction": 0.0}
    mine = measure_sweep(swept(**{**stiff, "stiffness": share * 4000.0}, rate=rates[0], name="simulator"))
    theirs = measure_sweep(swept(**stiff, rate=rates[1], name="aircraft"))
    found = {one.quantity: one for one in judge_sweep(mine, theirs, RULES.test("2.a.1.a"))}
    for way in ("force, up", "force, down"):
        assert found[way].outcome is expected
        # A position's mean of samples is off its own by less than one of 401 positions.
        assert abs(found[way].difference) == pytest.approx((share - 1) * 4000 * abs(found[way].at), rel=0.02)


@pytest.mark.parametrize("rates", RATES)
@pytest.mark.parametrize(("share", "expected"), [(1.199, Outcome.PASSED), (1.201, Outcome.FAILED)])
def test_body_rates_at_two_rates_are_judged(share, expected, rates):
    """Straight lines between samples at 60 Hz cut off 1.2 % of a swing at 3 Hz, and with it the verdict."""

    def record(rate, gain, name):
        t = np.arange(round(4 * rate)) / rate
        w = 2 * np.pi * 3.0
        return Record(t, 0.1 * t, body_rate_rad_per_s=gain * 0.8 * np.exp(-t) * np.sin(w * t), name=name)

    test = RULES.test("2.b.4")
    (rule,) = test.tolerances
    (found,) = judge_small_inputs(record(rates[0], share, "simulator"), record(rates[1], 1.0, "aircraft"), test)
    assert rule.relative == 0.20
    assert found.outcome is expected
