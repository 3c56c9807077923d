"""A changed value states its unit, or the call says that numbers are SI values."""

import math

import pytest

import forcefeel as ff
from forcefeel.errors import InputError

LB_PER_IN = 4.4482216152605 / 0.0254  # N/m, from the definitions of pound-force and inch


@pytest.mark.parametrize("number", [7000, 7000.0, -1, 1e-9, math.inf])
def test_number_without_unit_is_refused_with_an_example(number):
    with pytest.raises(InputError, match=r"linkage.stiffness: expected .* such as '6108 lb/in', got"):
        ff.elevator().replace({"linkage.stiffness": number})


def test_error_names_si_true_and_unit():
    with pytest.raises(InputError, match=r"pass si=True for a value in N/m"):
        ff.elevator().replace({"linkage.stiffness": 7000})


def test_si_true_reads_numbers_as_si_and_text_with_unit():
    loader = ff.elevator().replace(
        {"linkage.stiffness": 7000 * LB_PER_IN, "column.inertia": "40 lb in s^2/rad"}, si=True
    )
    text = ff.elevator().replace({"linkage.stiffness": "7000 lb/in", "column.inertia": "40 lb in s^2/rad"})
    assert loader["linkage.stiffness"] == pytest.approx(text["linkage.stiffness"], rel=1e-12)  # digits of LB_PER_IN
    assert loader["column.inertia"] == text["column.inertia"]


@pytest.mark.parametrize(
    "changes",
    [{"linkage.ratio": 0.9}, {"column.coulomb_friction": 0}, {"valve.orifice": True}, {"feel.breakout": None}],
    ids=str,
)
def test_unit_independent_values_need_no_unit(changes):
    assert isinstance(ff.elevator().replace(changes), ff.Loader)


def test_zero_angle_without_unit_is_refused():
    with pytest.raises(InputError, match=r"thermal\.ambient"):
        ff.loader.electric("elevator-electric").replace({"thermal.ambient": 0})
