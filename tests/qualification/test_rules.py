"""The tables of the rules: their figures, literally, and the laws they keep."""

import math
import re

import pytest

from forcefeel.errors import InputError
from forcefeel.qualification import DEFAULT_EDITION, editions, load_rules
from forcefeel.qualification.rules import parse_rules
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.units import UnitSystem

ROUNDING = 1e-14
"""Relative: one conversion. Measured: 0."""

LB = 4.4482216152605
"""One pound of force in N, exactly."""

STATIC = {
    "2.a.1.a": ((2.0, 0.9), (5.0, 2.2), {"elevator": 2.0}),
    "2.a.2.a": ((2.0, 0.9), (3.0, 1.3), {"aileron": 2.0, "spoiler": 3.0}),
    "2.a.3.a": ((5.0, 2.2), (5.0, 2.2), {"rudder": 2.0}),
    "2.a.4": ((2.0, 0.9), (3.0, 1.3), {"nosewheel": 2.0}),
}
"""Table A2A of the 2014 print: breakout and force in lb and daN, surfaces in deg."""


@pytest.mark.parametrize("number", STATIC)
def test_static_rows_match_printed_rule(number):
    test = load_rules("part60-a-2014").test(number)
    breakout, force, surfaces = STATIC[number]
    assert test.verified
    for quantity, (lb, dan), share in (("breakout", breakout, None), ("force", force, 0.1)):
        row = test.tolerance(quantity)
        assert (row.absolute.lb, row.absolute.dan, row.relative) == (lb, dan, share)
        assert float(row.limit(0.0, system=UnitSystem.US)) == pytest.approx(lb * LB, rel=ROUNDING)
        assert float(row.limit(0.0, system=UnitSystem.SI)) == pytest.approx(10 * dan, rel=ROUNDING)
    assert {row.surface: row.absolute.deg for row in test.tolerances if row.surface} == surfaces


@pytest.mark.parametrize("number", ["2.b.1", "2.b.2", "2.b.3"])
def test_dynamic_rows_match_printed_rule(number):
    test = load_rules("part60-a-2014").test(number)
    assert test.verified
    shares = {
        quantity: float(test.tolerance(quantity).limit(1.0))
        for quantity in ("P0", "An", "steady state", "fall time", "rise time", "overshoots")
    }
    expected = {"P0": 0.1, "An": 0.1, "steady state": 0.05, "fall time": 0.1, "rise time": 0.1, "overshoots": 1}
    assert shares == pytest.approx(expected)
    assert [float(test.tolerance("Pn").limit(1.0, n=n)) for n in (1, 2, 3)] == pytest.approx([0.2, 0.3, 0.4])
    assert test.tolerance("An").relative_to == "A1"
    assert test.tolerance("first overshoot").required
    assert math.isinf(float(test.tolerance("first overshoot").limit(1.0)))


def test_other_rows_of_2014_match_printed_rule():
    rules = load_rules("part60-a-2014")
    increment = rules.of("dynamic sweep", "pitch").tolerance("dynamic increment")
    assert (increment.relative, increment.absolute.lb, increment.absolute.dan) == (0.1, 2.0, 0.9)
    rate = rules.test("2.b.4").tolerance("body rate")
    assert (rate.relative, rate.relative_to, rate.absolute.deg_per_s) == (0.2, "peak", 0.15)
    assert (rules.release.deflection, rules.release.residual_band) == ((0.25, 0.5), 0.05)
    assert [sweep.duration_s for sweep in rules.sweeps] == [(95, 105), (8, 12), (3, 5)]
    assert not any(sweep.verified for sweep in rules.sweeps)


@pytest.mark.parametrize("edition", ["part60-c-2014", "part60-d-2014"])
def test_helicopter_rows_match_printed_rule(edition):
    rules = load_rules(edition)
    assert rules.category == "helicopter"
    release = rules.of("release", "pitch")
    later = release.tolerance("An")
    assert (later.relative, later.relative_to) == (0.2, "itself")
    assert (release.tolerance("A1").relative, release.tolerance("overshoots").absolute.count) == (0.1, 1)
    assert [float(release.tolerance("Pn").limit(1.0, n=n)) for n in (1, 2)] == pytest.approx([0.2, 0.3])
    read = {row.quantity for row in release.tolerances if release.is_verified(row)}
    assert read == {"P0", "Pn", "A1", "An", "overshoots"}
    assert release.conditions == ("hover", "cruise", "trim on", "friction off")
    static = rules.of("static", "collective")
    breakout, force = static.tolerance("breakout"), static.tolerance("force")
    assert (breakout.relative, breakout.absolute.lb, breakout.absolute.dan) == (0.25, 0.5, None)
    assert (force.relative, force.absolute.lb) == (0.1, 1.0)
    freeplay = rules.of("freeplay", "pitch").tolerance("freeplay")
    assert float(freeplay.limit(0.0)) == pytest.approx(0.00254)


def test_edition_2016_matches_verified_paragraph_only():
    """Attachment 2, paragraph 4, of the 2019 print: 10 %, 10 (n + 1) %, 10 % of A1, no amount beside them."""
    release = load_rules("part60-a-2016").of("release", "roll")
    assert all(row.absolute is None or row.absolute.count == 1 for row in release.tolerances)
    assert float(release.tolerance("P0").limit(0.1)) == pytest.approx(0.01)
    assert [float(release.tolerance("Pn").limit(1.0, n=n)) for n in (1, 2)] == pytest.approx([0.2, 0.3])
    assert (release.tolerance("An").relative, release.tolerance("An").relative_to) == (0.1, "A1")
    assert not any(release.is_verified(row) for row in release.tolerances)
    assert "2019 print" in release.source
    assert "not read" in release.source


@pytest.mark.parametrize(
    ("number", "axis", "quantity", "amount"),
    [
        ("2.a.5", "yaw", "surface", math.radians(2.0)),
        ("2.a.6", "pitch", "surface", math.radians(0.5)),
        ("2.a.7", "pitch", "trim rate", 0.1),
        ("2.a.9", "brake", "force", 5.0 * LB),
    ],
)
@pytest.mark.parametrize("edition", ["part60-a-2014", "part60-a-2016"])
def test_rows_of_pedals_trim_and_brakes(edition, number, axis, quantity, amount):
    test = load_rules(edition).test(number)
    (row,) = test.tolerances
    assert (test.axis, row.quantity, test.verified) == (axis, quantity, False)
    assert float(row.limit(1.0)) == pytest.approx(amount, rel=ROUNDING)


@pytest.mark.parametrize("edition", ["cs-fstd-a", "icao-9625"])
def test_newer_tables_are_not_verified(edition):
    rules = load_rules(edition)
    assert not any(test.is_verified(row) for test in rules.tests for row in test.tolerances)
    release = rules.of("release", "roll")
    assert float(release.tolerance("P0").limit(0.1)) == 0.05
    assert float(release.tolerance("Pn").limit(1.0, n=2)) == pytest.approx(0.3)
    travel = release.tolerance("An")
    assert float(travel.limit(0.01, travel=0.7)) == pytest.approx(0.0035)
    assert float(travel.limit(0.01)) == pytest.approx(0.001)
    assert float(release.tolerance("Ad").limit(0.1, travel=2.0)) == pytest.approx(0.01)
    pedals = rules.test("2.a.3.a")
    assert (pedals.tolerance("breakout").absolute.lb, pedals.tolerance("breakout").absolute.dan) == (5.0, 2.2)
    assert "2014 print" in pedals.source


@pytest.mark.parametrize("edition", editions())
def test_every_row_states_its_source(edition):
    rules = load_rules(edition)
    assert rules.id == edition
    assert rules.verified is False  # the durations of the sweeps at least
    for test in rules.tests:
        assert len(test.source) > 5
        for row in test.tolerances:
            assert row.text(UnitSystem.US)
            assert "None" not in row.text(UnitSystem.SI)


def test_tolerance_text_of_rows():
    test = load_rules().test("2.a.1.a")
    assert test.tolerance("force").text(UnitSystem.US) == "10 % or 5 lb, whichever is larger"
    assert test.tolerance("force").text(UnitSystem.SI) == "10 % or 2.2 daN, whichever is larger"
    release = load_rules().test("2.b.1")
    assert release.tolerance("Pn").text() == "10 (n + 1) %"
    assert release.tolerance("An").text() == "10 % of A1"
    assert release.tolerance("first overshoot").text() == "required"
    assert release.tolerance("overshoots").text() == "1"


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"quantity": "P0"}, "states a share or an amount"),
        ({"quantity": "P0", "relative": 0.1}, "relative and relative_to go together"),
        ({"quantity": "P0", "relative": 0.1, "relative_to": "itself", "grows": "n + 1"}, "only the periods"),
        ({"quantity": "surface", "absolute": {"deg": 2.0}}, "a surface is named"),
        ({"quantity": "force", "absolute": {"deg": 2.0}}, "force is stated in"),
        ({"quantity": "force", "absolute": {"dan": 2.0}}, "force is stated in"),
        ({"quantity": "force", "absolute": {"lb": 2.0, "dan": 9.0}}, "same force but for rounding"),
        ({"quantity": "force", "absolute": {"lb": -2.0}}, "greater than 0"),
        ({"quantity": "P9", "absolute": {"s": 2.0}}, "Input should be"),
        ({"quantity": "P0", "absolute": {"min": 2.0}}, "Extra inputs"),
        ({"quantity": "first overshoot", "required": True, "absolute": {"count": 1}}, "states a share or an amount"),
    ],
)
def test_invalid_row_is_refused(row, message):
    with pytest.raises(ValueError, match=message):
        Tolerance.model_validate(row)


TABLE = """
id = "mine"
title = "Mine"
edition = "1"
category = "aeroplane"
same_as = "part60-a-2014"
"""
ROW = """
[[tests]]
number = "1"
name = "one"
kind = "static"
axis = "pitch"
conditions = ["any"]
source = "me"
verified = true
tolerances = [{ quantity = "breakout", absolute = { lb = 2.0 } }]
"""


def test_table_can_inherit_rows_of_another_table():
    assert parse_rules(TABLE, "mine").tests == load_rules("part60-a-2014").tests


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("id = ", "mine: is not TOML"),
        ('id = "mine"', "mine: title: Field required"),
        (TABLE.replace('"mine"', '"yours"'), "id: expected 'mine' as the file is called, got 'yours'"),
        (TABLE.replace("aeroplane", "balloon"), "mine: category: Input should be 'aeroplane' or 'helicopter'"),
        (TABLE + ROW + ROW, "two tests have the same number"),
        (TABLE + ROW.replace('"breakout"', '"P0"').replace("lb", "s"), "a static test measures no P0"),
        (TABLE + ROW.replace("}]", '}, { quantity = "breakout", absolute = { lb = 3.0 } }]'), "a quantity has two"),
        (
            TABLE + '[[sweeps]]\nname = "slow"\nduration_s = [9.0, 1.0]\nsource = "me"\nverified = true',
            "shortest duration below",
        ),
        (
            TABLE + '[[sweeps]]\nname = "slow"\nduration_s = [1.0, 9.0]\nsource = "me"\nverified = true',
            "a medium and a fast",
        ),
    ],
)
def test_invalid_table_is_refused(text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        parse_rules(text, "mine")


def test_unknown_edition_or_test_raises_input_error():
    rules = load_rules(DEFAULT_EDITION)
    with pytest.raises(InputError, match=r"rule: expected one of cs-fstd-a, .* got 'part61'"):
        load_rules("part61")
    with pytest.raises(InputError, match=r"test: expected one of part60-a-2014: 2\.a\.1\.a, .*; got '9'"):
        rules.test("9")
    with pytest.raises(
        InputError, match="part60-a-2014 has a release test for pitch, roll, yaw, none for 'collective'"
    ):
        rules.of("release", "collective")
