"""What would make a law render more: other machines, each with a law made for it."""

import math

import pytest

import forcefeel as ff
from forcefeel.commission.findings import commission_conclusions
from forcefeel.commission.observability import BREAKAWAY, DRY, FRICTION_CURVE, SEALS, STRIBECK
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import Commission, EnvelopeResult, Identified, LawChosen, RuleTests, WhatIf
from forcefeel.commission.what_ifs import _rubbing, what_ifs
from forcefeel.loader.tolerances import Tolerance

SOFT = {"stiffness": "1, 4 %", "frequency": "1, 3 Hz", "damping": "0.3, 1"}


@pytest.fixture(scope="module")
def rubbing():
    friction = {DRY: "3 lb", BREAKAWAY: "3.6 lb"}
    encoder = dict.fromkeys(("column_sensor.noise", "column_sensor.resolution"), 2 * math.pi / 2**20)
    loader = ff.digital_elevator().replace(friction | encoder, si=True)
    return loader.with_tolerances({DRY: Tolerance("normal", 0.9 * loader[DRY], 1.1 * loader[DRY], loader[DRY], 0.3)})


def test_every_change_is_simulated_and_the_smallest_comes_first(rubbing):
    found = {one.change: one.passes for one in what_ifs(rubbing, "robust", CommissionPlan(grid=SOFT), -1.0)}
    assert list(found) == [
        "dry friction known exactly",
        "encoder of 23 bits at the column",
        "a tenth of the sensors' noise",
        "half the controller's period and delay",
        "twice the drive's limits",
        "half the dry friction",
        "no dry friction",
        "a force sensor at the grip (law grip)",
    ]
    # Soft feels are lost to the friction alone: what sees past it or takes it off renders them all, wider limits do not.
    assert found["no dry friction"] == found["a force sensor at the grip (law grip)"] == 1.0
    assert found["twice the drive's limits"] < found["no dry friction"]


def test_reduced_friction_keeps_its_relative_tolerance(rubbing):
    half = _rubbing(rubbing, 0.5)
    assert (half[DRY], half[BREAKAWAY]) == (0.5 * rubbing[DRY], 0.5 * rubbing[BREAKAWAY])
    assert half.tolerances[DRY].ends == tuple(0.5 * end for end in rubbing.tolerances[DRY].ends)
    assert DRY not in _rubbing(rubbing, 0.0).given


def test_reduced_friction_with_curve_and_seals_scales_or_removes_all_of_it(rubbing):
    """Of a valve and of a motor: the rows of the curve were left without their friction, and refused."""
    curve = {STRIBECK: 0.05, "column.friction_asymmetry": 0.2}
    valve = rubbing.replace(curve, si=True).replace({SEALS: "5 lb"})
    motor = ff.loader.electric("elevator-electric").replace({DRY: "1 lb", BREAKAWAY: "1.3 lb"}).replace(curve, si=True)
    for loader in (valve, motor.with_tolerances({STRIBECK: "20 %"})):
        assert not {DRY, *FRICTION_CURVE} & set(_rubbing(loader, 0.0).given)
        half = _rubbing(loader, 0.5)
        assert {key: half[key] for key in curve} == curve
        assert (half[DRY], half[BREAKAWAY], half[SEALS]) == tuple(0.5 * loader[key] for key in (DRY, BREAKAWAY, SEALS))


@pytest.mark.parametrize(
    ("ifs", "least"),
    [
        ((WhatIf("faster", 0.91), WhatIf("half", 0.96), WhatIf("none", 1.0)), "reaches 95 %: half, 96 %"),
        ((WhatIf("faster", 0.91),), "No single change reaches 95 %"),
    ],
)
def test_smallest_sufficient_change_is_named(ifs, least):
    found = Commission(
        CommissionPlan(),
        ff.digital_elevator(),
        Identified(True, "Found.", (), (), (), ()),
        ff.digital_elevator(),
        LawChosen("robust", "Taken."),
        None,
        EnvelopeResult(96, 0.9, 0.5, 12, 0.89, 0.8, (), ifs),
        RuleTests(True, "Part 60", "Passes.", {}, (), ()),
    )
    assert any(least in line for line in commission_conclusions(found).findings)
