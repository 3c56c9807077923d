"""The D-optimal spectrum: closed forms, the equivalence theorem, and that nothing else within the limits is better."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import nnls

from forcefeel.bench.excitation.optimal_power import GAP, OptimalPower, PowerProblem, optimal_power
from tests.parametrization import mostly_slow

ROUNDING = 1e-6
"""Relative, of limits that are reached and floors that are kept, by the solver's own tolerance."""
POWER = 1e-3
"""Relative: a gap of 1e-6 in ln det leaves the powers right to its root."""
EQUIVALENCE = 1e-4
"""Relative, of the sensitivities: their error is the root of the gap over the number of parameters at most."""


def drawn(seed: int, *, lines=60, parameters=4, limits=3, floor=0.0) -> PowerProblem:
    """A problem as frequency responses pose it: two measured channels, smooth over the lines, costs over decades."""
    rng = np.random.default_rng(seed)
    at = np.linspace(0, 1, lines)
    waves = np.exp(2j * np.pi * at[:, None, None] * rng.uniform(0.2, 1.5, (1, parameters, 2)))
    slopes = waves * np.exp(rng.normal(0, 1, (1, parameters, 2)) * at[:, None, None])
    information = np.real(np.einsum("ijc,ikc->ijk", slopes.conj(), slopes))
    cost = np.exp(rng.normal(0, 2, (limits, 1)) * at + rng.normal(0, 1, (limits, 1)))
    problem = PowerProblem(information, cost, rng.uniform(0.5, 2.0, limits), np.zeros(lines))
    return problem.with_floor(floor * problem.even())


@cache
def solved(seed: int, *, floor=0.0) -> OptimalPower:
    """What is found for a drawn problem, once for all that is asked of it."""
    return optimal_power(drawn(seed, floor=floor))


def scaled(shape, problem):
    """As much of a shape as the limits let pass."""
    return shape * np.min(problem.budget / (problem.cost @ shape))


def test_single_parameter_power_goes_to_the_most_cost_effective_line():
    information = np.array([1.0, 5.0, 4.0])[:, None, None]
    problem = PowerProblem(information, np.array([[1.0, 3.0, 2.0]]), np.array([6.0]), np.zeros(3))
    found = optimal_power(problem)
    np.testing.assert_allclose(found.power, [0.0, 0.0, 3.0], atol=POWER * 3)  # 4 / 2 beats 5 / 3 and 1 / 1
    assert found.multipliers == pytest.approx(1 / 6, rel=EQUIVALENCE)  # mu b = p, the number of parameters


def test_parameters_without_shared_lines_split_the_budget_equally():
    # ln det = sum ln(P_i m_i): the greatest has a_i P_i = b / p for each, whatever m_i and a_i.
    strengths, cost, budget = np.array([1.0, 100.0, 0.01]), np.array([[2.0, 0.5, 8.0]]), np.array([6.0])
    information = np.zeros((3, 3, 3))
    information[range(3), range(3), range(3)] = strengths
    found = optimal_power(PowerProblem(information, cost, budget, np.zeros(3)))
    np.testing.assert_allclose(found.power, budget / 3 / cost[0], rtol=POWER)


@pytest.mark.parametrize("seed", mostly_slow(range(12), 3))
@pytest.mark.parametrize("floor", [0.0, 0.2])
def test_equivalence_theorem_holds(seed, floor):
    # Kiefer and Wolfowitz: P is optimal if and only if prices mu >= 0 exist with d_i <= sum_c mu_c a_ci, equal where P_i is free,
    # and mu_c = 0 where limit c is not reached. The prices are found here by least squares over the free lines, not by the solver.
    problem, found = drawn(seed, floor=floor), solved(seed, floor=floor)
    assert found.gap < GAP
    used = problem.cost @ found.power / problem.budget
    assert used.max() == pytest.approx(1.0, abs=ROUNDING)
    assert np.all(found.power >= problem.floor * (1 - ROUNDING))
    d = np.einsum("jk,ikj->i", np.linalg.inv(problem.matrix(found.power)), problem.information)
    free = found.power - problem.floor > POWER * problem.most()
    reached = used > 1 - ROUNDING
    prices, _ = nnls(problem.cost[reached][:, free].T / d[free, None], np.ones(int(free.sum())))
    bound = prices @ problem.cost[reached]
    np.testing.assert_allclose(d[free], bound[free], rtol=10 * EQUIVALENCE)
    assert np.all(d <= bound * (1 + 10 * EQUIVALENCE))
    if not floor:
        assert prices @ problem.budget[reached] == pytest.approx(problem.information.shape[1], rel=EQUIVALENCE)


@pytest.mark.parametrize("seed", mostly_slow(range(12), 3))
def test_no_other_spectrum_within_limits_is_better(seed):
    problem = drawn(seed)
    best = problem.log_det(solved(seed).power)
    rng = np.random.default_rng(1000 + seed)
    assert problem.log_det(scaled(np.ones(60), problem)) < best
    for sparsity in (1.0, 0.3, 0.1):
        for _ in range(100):
            shape = rng.exponential(1.0, 60) * (rng.uniform(size=60) < sparsity) + 1e-9
            assert problem.log_det(scaled(shape, problem)) < best


@pytest.mark.parametrize("seed", range(12))
def test_certificate_bounds_the_loss(seed):
    problem = drawn(seed)
    best = problem.log_det(solved(seed).power)
    shape = np.random.default_rng(seed).uniform(0.1, 1.0, 60)
    poor = scaled(shape, problem)
    gap, _, _ = problem.certify(poor)
    lost = best - problem.log_det(poor)
    assert 0 < lost <= gap


@pytest.mark.parametrize("seed", mostly_slow(range(12), 3))
@pytest.mark.parametrize("share", [0.1, 0.2, 0.5])
def test_uniform_floor_costs_at_most_its_share(seed, share):
    # M >= (1 - s) M* + s M_even is within the limits, so the D-efficiency (det M / det M*)^(1/p) is 1 - s at least.
    free = drawn(seed)
    lost = free.log_det(solved(seed, floor=share).power) - free.log_det(solved(seed).power)
    assert 1 - share <= np.exp(lost / 4) <= 1 + ROUNDING


def test_result_does_not_depend_on_units():
    problem = drawn(3)
    scale = np.diag([1e-9, 1.0, 1e6, 1e3])
    other = PowerProblem(
        scale @ problem.information @ scale,
        problem.cost * np.array([[1e8], [1.0], [1e-6]]),
        problem.budget * np.array([1e8, 1.0, 1e-6]),
        problem.floor,
    )
    lost = problem.log_det(optimal_power(other).power) - problem.log_det(optimal_power(problem).power)
    assert abs(lost) < 2 * GAP


@pytest.mark.slow
def test_many_lines_and_parameters_reach_the_optimum():
    problem = drawn(5, lines=600, parameters=7)
    assert optimal_power(problem).gap < GAP
