"""Flights that a pilot holds through the loader, against JSBSim's trims at the state flown."""

import pytest

import forcefeel as ff
from tests.parametrization import mostly_slow

KNOT = 1852 / 3600
CASES = {"c172p": (100, (1.2, 1.4)), "737": (250, (1.2, 1.3)), "T38": (300, (1.5, 2.0)), "f16": (350, (1.5, 2.0))}
FLOWN = 0.02
"""The path curves and speed is lost while a pull-up is flown; a trim has neither."""
STEADY = 0.01


@pytest.fixture(scope="module", params=mostly_slow(CASES))
def case(request):
    return ff.fly.FlightCase(ff.digital_elevator(), request.param, CASES[request.param][0] * KNOT, 900.0, "robust")


@pytest.mark.slow
def test_force_per_g_flown_is_that_of_trims_at_the_speed_and_load_factor_flown(case):
    points = []
    for load_factor in CASES[case.aircraft][1]:
        held = case.held(case.at(load_factor=load_factor))
        near = case.at(held.speed_m_per_s, load_factor)
        same = case.at(held.speed_m_per_s, load_factor * held.load_factor / near.state()["load_factor"])
        points.append((held, same.state()["load_factor"], ff.fly.trimmed_force(case.feel, case.trim, same)))
    (first, n_1, force_1), (second, n_2, force_2) = points
    flown = (second.force_n - first.force_n) / (second.load_factor - first.load_factor)
    assert flown == pytest.approx((force_2 - force_1) / (n_2 - n_1), rel=FLOWN)


def test_force_over_speed_flown_is_that_of_trims_with_one_tab(case):
    for share in (0.85, 0.93, 1.0, 1.07, 1.15):
        held = case.held(case.at(share * case.speed_m_per_s))
        assert held.force_n == pytest.approx(held.trimmed_n, rel=STEADY, abs=0.03)  # N, of the sensors' noise
        assert held.load_factor == pytest.approx(case.trim.state()["load_factor"], abs=STEADY)
