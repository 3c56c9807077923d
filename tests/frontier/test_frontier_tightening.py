"""The ladder of tolerances against envelopes that are computed directly, and what is read off it against sets by hand."""

from math import isnan

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.cases import REFERENCE_ARMS, Case, Kind
from forcefeel.envelope.plan import make_plan
from forcefeel.errors import InputError
from forcefeel.frontier.hardware import CHANGES, hardware
from forcefeel.frontier.tightening import KNOWN_BETTER, needed, tightening
from forcefeel.frontier.tolerance_levels import ToleranceLevels, level_releases, run_levels
from forcefeel.loader.parameters import table

GRID = {"stiffness": "10..100 %:6:log", "frequency": "1..4 Hz:4:log", "damping": "0.2, 0.4, 1.2"}
SMALL = {"column.inertia": 0.2, "linkage.ratio": 0.2, "linkage.stiffness": 0.2, "valve.current_gain": 0.3}
LAW = "published"


@pytest.fixture(scope="module")
def levels():
    return run_levels(make_plan(ff.elevator(), (LAW,), GRID, changes=SMALL), (1.0, 0.5, 0.1), threads=1)


@pytest.mark.parametrize(("level", "rest"), [(0, 0), (1, 0), (2, 1), (3, 1)])
def test_mixed_tolerances_match_an_envelope(levels, level, rest):
    factors = (*levels.factors, None)
    changes = {
        key: share * factors[level if key in KNOWN_BETTER else rest]
        for key, share in SMALL.items()
        if not (key in KNOWN_BETTER and factors[level] is None)
    }
    found = ff.find_envelope(ff.elevator(), (LAW,), GRID, changes=changes)
    known = [key for key in SMALL if key in KNOWN_BETTER]
    assert np.array_equal(levels.worst(known, level, rest), found.passes(LAW).all(axis=0))
    assert np.array_equal(levels.worst(known, level, rest, stable=True), found.stable(LAW).all(axis=0))


def test_every_release_is_counted(levels):
    done = []
    run_levels(levels.full.plan, (1.0, 0.5), threads=1, progress=lambda now, total: done.append((now, total)))
    assert done[-1][0] == done[-1][1] == level_releases(levels.full.plan, (1.0, 0.5))
    assert sorted(done) == done


def test_paths_and_costs_match_the_shares(levels):
    found = tightening(levels)
    shares = levels.full.shares(LAW)
    assert (found.nominal, found.worst) == (shares.nominal_share, shares.worst_case_share)
    assert found.all_in_proportion.shares[0] == found.inertia_and_geometry.shares[0] == found.worst
    assert found.all_in_proportion.limit >= found.inertia_and_geometry.limit >= found.inertia_and_geometry.shares[-1]
    by_case = {row.case: row for row in levels.full.case_shares(LAW)}
    passes = dict(zip(by_case, levels.full.passes(LAW), strict=True))
    for cost in found.costs:
        mine = [name for name in by_case if name.startswith(f"{cost.name} ") or name == cost.name]
        both = np.all([passes[name] for name in mine], axis=0)
        others = np.all([row for name, row in passes.items() if name not in mine], axis=0)
        assert cost.passes == both.mean()
        assert cost.lost == (passes["nominal"] & ~both).mean()
        assert cost.only == (others & ~both).mean()
    assert {cost.name for cost in found.costs} == {*SMALL, *(f"{arm.name} arm" for arm in REFERENCE_ARMS)}
    # What one alone loses and what is left add up to no more than all.
    assert found.worst + sum(cost.only for cost in found.costs) <= 1


def _by_hand(levels, *, arms=20, stiff=18):
    """Twenty settings of which the arms leave some, the linkage at full tolerance some, the inertia more the better it is known."""
    settings = np.arange(20)
    cases = (
        Case("nominal", Kind.NOMINAL),
        Case("column.inertia +20 %", Kind.PLANT, {"column.inertia": 0.2}),
        Case("linkage.stiffness +20 %", Kind.PLANT, {"linkage.stiffness": 0.2}),
    )
    left = [
        np.array([settings < arms, settings < heavy, settings < limp])
        for heavy, limp in ((10, stiff), (14, 19), (20, 19))
    ]
    return ToleranceLevels(levels.full, (1.0, 0.5, 0.1), (cases,) * 3, tuple(left), tuple(left))


def test_smallest_tightening_matches_hand_calculation(levels):
    path = tightening(_by_hand(levels)).inertia_and_geometry
    assert path.shares == (0.5, 0.7, 0.9)
    assert path.tolerances == pytest.approx((0.2, 0.1, 0.02))
    assert (path.limit, path.needed) == (0.9, pytest.approx(0.02))
    assert tightening(_by_hand(levels)).pair is None


def test_pair_is_found_where_inertia_alone_is_insufficient(levels):
    found = tightening(_by_hand(levels, stiff=17))
    assert isnan(found.inertia_and_geometry.needed)
    assert found.inertia_and_geometry.limit == 0.85
    assert (found.pair.others, found.pair.share) == (0.5, 0.95)
    assert found.pair.inertia_and_geometry == pytest.approx(0.02)
    assert tightening(_by_hand(levels, arms=17)).pair is None


def test_required_tolerance_is_interpolated_between_levels():
    assert needed((0.2, 0.1, 0.05), (0.5, 0.8, 1.0), 0.9) == pytest.approx(0.1 * 0.5**0.5)
    assert needed((0.2, 0.1), (0.95, 0.97), 0.9) == 0.2
    assert isnan(needed((0.2, 0.1), (0.5, 0.6), 0.9))


def test_several_laws_or_non_decreasing_levels_raise_input_error(levels):
    with pytest.raises(InputError, match="expected one, got original, published"):
        run_levels(make_plan(ff.elevator(), ("original", "published"), GRID))
    for factors in ((0.5, 0.1), (1.0, 1.0), (1.0, 0.0)):
        with pytest.raises(InputError, match="fall from 1"):
            run_levels(levels.full.plan, factors)


@pytest.mark.slow
def test_hardware_gains_are_those_of_the_changed_loader(levels):
    before = levels.full.shares(LAW)
    gains = {gain.name: gain for gain in hardware(levels, threads=1)}
    for change in CHANGES:
        assert (change.name in gains) == change.applies(levels.full.plan.loader)
        if change.name in gains:
            after = ff.find_envelope(change.on(ff.elevator()), (LAW,), GRID, changes=SMALL).shares(LAW)
            gain = gains[change.name]
            assert (gain.nominal, gain.worst, gain.stable_worst) == (
                after.nominal_share,
                after.worst_case_share,
                after.stable_worst,
            )
            assert gain.worst_gain == pytest.approx(after.worst_case_share - before.worst_case_share)
    assert "half the delay" not in gains  # an analog loader has none
    assert gains["column inertia known to 2 %"].worst == levels.worst(("column.inertia",), 2).mean()
    order = [gain.worst_gain for gain in hardware(levels, threads=1)]
    assert order == sorted(order, reverse=True)


@pytest.mark.parametrize(
    "loader", [ff.digital_elevator(), ff.loader.electric("sidestick-roll")], ids=lambda one: one.drive
)
def test_every_change_for_the_drive_applies(loader):
    known = table(loader.drive)
    own = [change for change in CHANGES if set(change.factors) <= set(known) - {"transmission.stiffness"}]
    assert [change for change in CHANGES if change.applies(loader)] == own
    assert len(own) > 7
    for change in own:
        changed = change.on(loader)
        for key, factor in change.factors.items():
            assert changed[key] == pytest.approx(factor * loader[key])
