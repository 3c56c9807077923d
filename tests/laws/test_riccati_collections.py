"""Recursion (22) on CAREX and DAREX, the public collections of Riccati equations, as the package ``ctrlsys`` makes them.

Judged by the equation, not by the stored solutions: the one of DAREX 1.4 does not solve its equation.
"""

from typing import NamedTuple

import ctrlsys
import numpy as np
import pytest
from numpy.typing import NDArray

from forcefeel import _core
from tests.parametrization import mostly_slow

# Rounding. Measured over all solved problems: at most 3e-15.
RESIDUAL = 1e-13
# Below this CAREX 2.2 keeps moving by rounding; above it CAREX 2.4 passes for solved before its slow part has started.
TOLERANCE = 1e-12
STEPS = 4000

Array = NDArray[np.float64]


class Problem(NamedTuple):
    """Transition, input, weights, and how many steps to give the recursion."""

    phi: Array
    h: Array
    q: Array
    r: Array
    steps: int = STEPS


# CAREX is in continuous time. Its problems are sampled with a step near a third of the slowest closed-loop time
# constant, the scale on which the recursion converges, or less where the open loop grows fast.
CAREX_STEPS = {
    (1, 1): 0.3,
    (1, 2): 0.6,
    (2, 1): 0.3,
    (2, 2): 0.4,
    (2, 3): 1e-4,  # poles near 2e3
    (2, 4): 1.0,  # time constants 0.5 and 7e5, and the open loop grows with the first
    (2, 5): 0.1,
    (2, 6): 3e-8,  # poles of 1e7 to 3e7
    (2, 7): 1.2,  # poles of 0.25 and 1e5
    (2, 8): 0.3,
    (3, 1): 0.4,
    (3, 2): 0.3,
    (4, 1): 0.1,
    (4, 2): 3.0,
    (4, 3): 50.0,
}
DAREX = [(1, 1), (1, 2), (1, 3), (1, 4), (1, 9), (2, 1), (2, 2), (2, 3), (2, 4), (2, 5), (4, 1)]
# These read tables from files that do not come with the package; CAREX 4.4 is too large for it besides.
WITHOUT_TABLES = {
    "carex": [(1, 3), (1, 4), (1, 5), (1, 6), (2, 9), (4, 4)],
    "darex": [(1, 5), (1, 6), (1, 7), (1, 8), (1, 10), (1, 11), (1, 12), (1, 13)],
}

# Slow, but within reach: closed-loop poles at 1 - 1.4e-6 and 1 - 3e-4.
MANY_STEPS = {("carex", (2, 4)): 9_000_000, ("darex", (2, 1)): 150_000}

# What the recursion cannot do, and how it ends.
UNSOLVED = {
    ("carex", (2, 5)): (
        "moving",
        "closed-loop pole on the imaginary axis: the error does not shrink by a fixed share a step",
    ),
    ("carex", (2, 8)): (
        "converged",
        "slowest decay, 1.5e-11 a step, is lost in rounding: a pole stays on the unit circle",
    ),
    ("carex", (4, 1)): ("moving", "chain of 21 integrators: rounding keeps the gains moving in the eighth digit"),
    ("darex", (1, 1)): ("singular", "R = 0, and the weight that starts the recursion does not see the input"),
    ("darex", (1, 2)): ("singular", "R has rank one, and its cross term cannot be removed"),
    ("darex", (2, 5)): ("moving", "closed-loop pole at 1 - 1e-9"),
}


def make(collection, number):
    """Matrices A, B, Q, R, S of one problem and the generator's error code."""
    example = np.array(number, dtype=np.int32)
    full = True  # stored whole, not packed
    if collection == "carex":
        form = np.array([False, full, True, True, full, True])  # B and R rather than B R^-1 B'; Q
        _, n, m, _, a, b, _, r, q, _, info = ctrlsys.bb01ad("D", example, np.zeros(7), np.zeros(4, np.int32), form)
        s = np.zeros_like(b)
    else:
        form = np.array([True, full, True, False, full, True, True])  # Q; B and R; S
        _, n, m, _, a, b, _, q, r, s, _, info = ctrlsys.bb02ad("D", example, np.zeros(4), np.zeros(3, np.int32), form)
    if info != 0:
        return None, info
    return tuple(np.ascontiguousarray(x) for x in (a[:n, :n], b[:n, :m], q[:n, :n], r[:m, :m], s[:n, :m])), info


def discrete_problem(collection, number):
    """The problem in the form of the recursion: discrete time, no cross term."""
    (a, b, q, r, s), _ = make(collection, number)
    steps = MANY_STEPS.get((collection, number), STEPS)
    if collection == "carex":
        h = CAREX_STEPS[number]
        return Problem(*_core.discretize(a, b, h), q * h, r * h, steps)
    if not s.any():
        return Problem(a, b, q, r, steps)
    if np.linalg.matrix_rank(r) == len(r):
        # u = v - R^-1 S' x
        back = np.linalg.solve(r, s.T)
        return Problem(a - b @ back, b, q - s @ back, r, steps)
    # One step late: the state [x, u] of the step before carries the whole cost, and the new input has none.
    n, m = b.shape
    phi = np.block([[a, b], [np.zeros((m, n + m))]])
    return Problem(phi, np.eye(n + m)[:, n:], np.block([[q, s], [s.T, r]]), np.zeros((m, m)), steps)


def solve(problem):
    return _core.recursion(problem.phi, problem.h, problem.q, problem.r, problem.steps, TOLERANCE)


def share(error, whole):
    """Largest entry of ``error`` beside the largest of ``whole``; of ``error`` alone where that is zero."""
    return np.max(np.abs(error)) / (np.max(np.abs(whole)) or 1.0)


def riccati_residual(problem, found):
    """How far cost E and gains c are from E = Phi' E (Phi + H c) + Q and (R + H' E H) c = -H' E Phi."""
    phi, h, q, r, _ = problem
    e, c = found.cost, found.gains
    cost = share(phi.T @ e @ (phi + h @ c) + q - e, e)
    forces = h.T @ e @ phi
    return max(cost, share((r + h.T @ e @ h) @ c + forces, forces))


def stability_margin(problem, found):
    """One less the magnitude of the largest pole of the closed loop."""
    return 1 - np.max(np.abs(np.linalg.eigvals(problem.phi + problem.h @ found.gains)))


EVERY = [("carex", number) for number in CAREX_STEPS] + [("darex", number) for number in DAREX]


def name(case):
    return "{0}-{1[0]}.{1[1]}".format(*case)


@pytest.mark.parametrize(
    "case", mostly_slow([pytest.param(case, id=name(case)) for case in EVERY if case not in UNSOLVED], 6)
)
def test_recursion_solves_the_equation(case):
    problem = discrete_problem(*case)
    found = solve(problem)
    assert riccati_residual(problem, found) < RESIDUAL
    assert stability_margin(problem, found) > 0
    assert found.status == "converged"


@pytest.mark.parametrize("case", [pytest.param(case, id=name(case)) for case in UNSOLVED])
def test_recursion_has_expected_status_for_unsolved_problems(case):
    status, why = UNSOLVED[case]
    problem = discrete_problem(*case)
    found = solve(problem)
    assert found.status == status, why
    if status == "singular":
        assert found.steps == 0
    else:
        # If this fails, the problem is solved now: take it out of the list.
        assert riccati_residual(problem, found) > RESIDUAL, why


def test_chain_of_integrators_is_solved_to_eight_digits():
    # Rounding beside a cost whose entries span 1 to 5e8; SciPy's solver leaves 1e-7 there.
    problem = discrete_problem("carex", (4, 1))
    found = solve(problem)
    assert riccati_residual(problem, found) < 1e-8
    assert stability_margin(problem, found) > 0


def test_cross_term_can_be_removed_or_kept():
    # The two forms of DAREX 1.9, whose R is regular, give one law: u = c x, and one step late u = c [A B] [x, u].
    (a, b, q, r, s), _ = make("darex", (1, 9))
    removed = solve(discrete_problem("darex", (1, 9))).gains - np.linalg.solve(r, s.T)
    n, m = b.shape
    phi = np.block([[a, b], [np.zeros((m, n + m))]])
    late = Problem(phi, np.eye(n + m)[:, n:], np.block([[q, s], [s.T, r]]), np.zeros((m, m)))
    np.testing.assert_allclose(solve(late).gains, removed @ np.hstack([a, b]), rtol=0, atol=1e-13)  # gains near one


@pytest.mark.parametrize("collection", ["carex", "darex"])
def test_every_problem_of_the_collection_is_covered(collection):
    sizes = {"carex": (6, 9, 2, 4), "darex": (13, 5, 0, 1)}[collection]
    for group, size in enumerate(sizes, start=1):
        for k in range(1, size + 1):
            _, info = make(collection, (group, k))
            assert (info == 0) == ((collection, (group, k)) in EVERY), (group, k)
            assert (info != 0) == ((group, k) in WITHOUT_TABLES[collection]), (group, k)
