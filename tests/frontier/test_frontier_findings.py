"""What is said of a frontier: every branch of the words, from one small frontier whose parts are set by hand."""

from dataclasses import replace
from math import nan

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.frontier.findings import frontier_conclusions
from forcefeel.frontier.friction import SmallestFriction
from forcefeel.frontier.result import Limit
from forcefeel.frontier.tightening import Cost, Pair, Path
from forcefeel.units import UnitSystem

RUNGS = (0.2, 0.1, 0.05)


@pytest.fixture(scope="module")
def found():
    grid = {"stiffness": "3, 100 %", "frequency": "2, 4 Hz", "damping": "0.4, 1"}
    return ff.find_frontier(
        ff.elevator(), "original", grid, changes={"column.inertia": 0.2, "linkage.ratio": 0.2}, arms=(), threads=1
    )


def _said(found, **parts):
    changed = replace(found, tightening=replace(found.tightening, **parts))
    conclusions = frontier_conclusions(changed, UnitSystem.US)
    return conclusions.ok, " ".join(conclusions.findings)


def _path(shares, limit, needed):
    return Path("column inertia and geometry", RUNGS, shares, limit, needed)


def test_required_share_is_reached_at_full_tolerances(found):
    path = _path((0.91, 0.95, 1.0), 1.0, 0.2)
    good, text = _said(found, nominal=0.97, worst=0.91, inertia_and_geometry=path)
    assert good
    assert "is reached at the full tolerances" in text


def test_required_share_is_reached_with_one_tightening(found):
    path = _path((0.6, 0.8, 0.95), 1.0, 0.0672)
    good, text = _said(found, nominal=0.97, worst=0.6, inertia_and_geometry=path, pair=None)
    assert not good
    assert "reaches 90 % with column inertia and geometry known to 6.7 % (interpolated" in text


def test_required_share_is_reached_with_two_tightenings(found):
    path = _path((0.6, 0.7, 0.8), 0.85, nan)
    pair = Pair(0.05, 0.5, 0.92)
    _, text = _said(found, nominal=0.97, worst=0.6, inertia_and_geometry=path, pair=pair)
    assert "the worst case is still 85 %: the other tolerances limit it" in text
    assert "With all other tolerances reduced to 50 % and column inertia and geometry known to 5 %, it is 92 %" in text


def test_tolerance_below_the_tightest_computed_is_reported(found):
    path = _path((0.6, 0.7, 0.8), 0.95, nan)
    _, text = _said(found, nominal=0.97, worst=0.6, inertia_and_geometry=path, pair=None)
    assert "known to 5 %, the tightest computed; at zero tolerance it is 95 %" in text


def test_tolerances_do_not_change_the_nominal_share(found):
    _, text = _said(found, nominal=0.7, worst=0.6, inertia_and_geometry=_path((0.6, 0.65, 0.7), 0.7, nan))
    assert "they do not change the nominal share of 70 %" in text
    assert "the worst case is still 70 %: the nominal share itself limits it" in text


def test_other_limiting_tolerances_are_named(found):
    costs = (
        Cost("linkage.ratio", 0.2, 0.6, 0.3, 0.0),
        Cost("firm arm", nan, 0.85, 0.12, 0.05),
        Cost("valve.rated_flow", 0.3, 0.95, 0.02, 0.0),
    )
    path = _path((0.6, 0.7, 0.8), 0.85, nan)
    _, text = _said(found, nominal=0.97, worst=0.6, inertia_and_geometry=path, costs=costs)
    assert "the other tolerances limit it, most of all firm arm, which loses 12 % of all settings" in text
    assert "linkage.ratio, which loses 30 %" in text


def test_diverging_run_states_that_friction_was_not_evaluated(found):
    gone = replace(found, friction=SmallestFriction(nan, nan, 0.0, 100.0))
    assert "friction was not evaluated" in " ".join(frontier_conclusions(gone, UnitSystem.SI).findings)


def test_each_setting_has_its_most_fundamental_limit(found):
    count = found.plan.settings.count
    passes = found.envelope.passes("original")
    every = passes.all(axis=0)
    for possible, forbidden, limit in (
        (np.zeros(count, bool), np.ones(count, bool), Limit.DRIVE),
        (np.zeros(count, bool), np.zeros(count, bool), Limit.INERTIA),
        (np.ones(count, bool), np.zeros(count, bool), None),
    ):
        bound = replace(found.bound, possible=np.tile(possible, (len(found.bound.errors), 1)))
        changed = replace(found, bound=bound, drive=replace(found.drive, forbidden=forbidden))
        limits = changed.limits.ravel()
        order = list(Limit)
        expected = np.where(passes[0], order.index(Limit.LAW), order.index(Limit.NOMINAL))
        if limit is not None:
            expected = np.full(count, order.index(limit))
        assert np.array_equal(limits, np.where(every, order.index(Limit.NONE), expected))
        assert sum(changed.limit_shares.values()) == pytest.approx(1)
        assert changed.beyond_bound == (every & ~possible).mean()
