"""Power of each spectral line: the D-optimal spectrum within limits.

| symbol | meaning |
|---|---|
| P_i | power (mean square) of line i |
| M_i | information per power of line i |
| a_ci, b_c | cost of a unit of power of line i in limit c, and that limit |
| d_i | sensitivity of line i, tr(M^-1 M_i) |
| mu_c | multiplier (price) of limit c |
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, minimize

GAP = 1e-5
"""Largest distance of ln det M from its maximum, relative in the generalized variance."""

_ENOUGH = 1e-6  # end of the rounds; within GAP if rounding stops SLSQP earlier
_ROUNDS = 12
_WORKING = 40
_UNUSED = 1e-9  # share of the largest power that one limit would let a line have
_LINE_SEARCH = 1e-13  # of ln det; two digits above its rounding


@dataclass(frozen=True, eq=False)
class PowerProblem:
    """Maximize ``ln det M``, ``M = sum_i P_i M_i``, over ``P_i >= floor_i`` with ``sum_i a_ci P_i <= b_c``. Convex.

    Attributes:
        information: M_i, (lines, parameters, parameters), symmetric, none negative; the sum over forty of them is regular.
        cost: a_ci, (limits, lines), at least one above 0 for each line.
        budget: b_c, (limits,), above 0.
        floor: Smallest powers, (lines,), within the limits.
    """

    information: NDArray[np.float64]
    cost: NDArray[np.float64]
    budget: NDArray[np.float64]
    floor: NDArray[np.float64]

    def matrix(self, power: NDArray[np.float64]) -> NDArray[np.float64]:
        """M of powers (lines,)."""
        return np.tensordot(power, self.information, axes=1)

    def log_det(self, power: NDArray[np.float64]) -> float:
        """The value of ln det M at powers (lines,)."""
        return float(np.linalg.slogdet(self.matrix(power))[1])

    def sensitivity(self, power: NDArray[np.float64]) -> NDArray[np.float64]:
        """d_i = tr(M^-1 M_i) at powers (lines,): the slope of ln det M in P_i."""
        return np.asarray(np.einsum("jk,ikj->i", np.linalg.inv(self.matrix(power)), self.information))

    def certify(self, power: NDArray[np.float64]) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
        """Upper bound of the distance of ``power`` from the optimum, in ln det M.

        ln det M is concave, so for any admissible P' it is at most ``ln det M(P) + sum_i d_i (P'_i - P_i)``: the greatest such sum
        is a linear program, and its dual variables are the multipliers of the limits. Where it is 0, the equivalence theorem
        holds: ``d_i <= sum_c mu_c a_ci``, with equality where ``P_i`` is above its floor.

        Returns:
            The bound; the multipliers mu_c, (limits,); the powers that the bound is taken at, (lines,).

        Source: J. Kiefer and J. Wolfowitz, The Equivalence of Two Extremum Problems, Canadian J. of Mathematics 12 (1960);
        S. D. Silvey, Optimal Design, 1980, ch. 3.
        """
        slope, limits = self.sensitivity(power), self.most()
        rows = self.cost / self.budget[:, np.newaxis]
        solution = linprog(
            -slope * limits,
            A_ub=rows * limits,
            b_ub=1.0 - rows @ self.floor,
            bounds=(0.0, None),
            method="highs",
        )
        towards = self.floor + solution.x * limits
        gap = float(slope @ (towards - power))
        return gap, -solution.ineqlin.marginals / self.budget, towards

    def most(self) -> NDArray[np.float64]:
        """Largest power of each line alone, (lines,)."""
        return np.asarray(np.min(self.budget[:, np.newaxis] / np.maximum(self.cost, np.finfo(float).tiny), axis=0))

    def filled(self, power: NDArray[np.float64]) -> NDArray[np.float64]:
        """Powers of this shape, scaled to the limits, (lines,)."""
        return power * float(np.min(self.budget / (self.cost @ power)))

    def with_floor(self, floor: NDArray[np.float64]) -> "PowerProblem":
        """The same with other smallest powers, (lines,)."""
        return replace(self, floor=floor)

    def even(self) -> NDArray[np.float64]:
        """Equal power on each line, scaled to the limits, (lines,)."""
        return self.filled(np.ones(len(self.floor)))


@dataclass(frozen=True, eq=False)
class OptimalPower:
    """An optimal spectrum.

    Attributes:
        power: P_i, (lines,).
        multipliers: mu_c, (limits,); 0 for a limit that does not bind.
        gap: Upper bound of the gain in ln det M by any other spectrum within the limits.
    """

    power: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    gap: float


def optimal_power(problem: PowerProblem) -> OptimalPower:
    """The D-optimal spectrum, by SciPy's SLSQP over a working set of lines that grows by those with a gain.

    A D-optimal spectrum of p parameters needs at most p (p + 1) / 2 lines and one more per limit, so the working set stays
    small.

    Returns:
        The powers, with a certificate; see ``PowerProblem.certify``.

    Source: G. C. Goodwin and R. L. Payne, Dynamic System Identification, 1977, ch. 6; R. Pintelon and J. Schoukens, System
    Identification: A Frequency Domain Approach, 2012, ch. 5.
    """
    power = _start(problem)
    limits = problem.most()
    best = OptimalPower(power, np.zeros(len(problem.budget)), np.inf)
    for _ in range(_ROUNDS):
        gap, multipliers, towards = problem.certify(power)
        if gap < best.gap:
            best = OptimalPower(power, multipliers, gap)
        if gap < _ENOUGH:
            break
        slack = problem.sensitivity(power) - multipliers @ problem.cost
        used = (power - problem.floor > _UNUSED * limits) | (towards > problem.floor)
        rank = np.where(used, np.inf, slack * limits)
        working = np.sort(np.argsort(-rank)[: max(_WORKING, int(used.sum()))])
        power = _solve(problem, working, power)
    return best


def _start(problem: PowerProblem) -> NDArray[np.float64]:
    """Half of the limits' remainder, even over a working set spread over all lines."""
    lines = len(problem.floor)
    spread = np.zeros(lines)
    spread[np.unique(np.linspace(0, lines - 1, _WORKING).astype(int))] = 1.0
    remaining = problem.budget - problem.cost @ problem.floor
    return problem.floor + 0.5 * spread * float(np.min(remaining / (problem.cost @ spread)))


def _solve(problem: PowerProblem, working: NDArray[np.intp], start: NDArray[np.float64]) -> NDArray[np.float64]:
    """The best powers of the working lines, with the others at their floor; each as a share of its largest power."""
    limits = problem.most()[working]
    base = problem.floor.copy()
    scale = np.linalg.cholesky(problem.matrix(start))
    half = np.linalg.solve(scale, problem.information)
    shares_of = np.linalg.solve(scale, half.transpose(0, 2, 1))  # M_i in coordinates where M of the start is I
    whole = np.tensordot(base, shares_of, axes=1)
    each = shares_of[working] * limits[:, np.newaxis, np.newaxis]
    rows = problem.cost / problem.budget[:, np.newaxis]
    per_share, remaining = rows[:, working] * limits, 1.0 - rows @ base

    def loss(x: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        matrix = whole + np.tensordot(x, each, axes=1)
        sign, value = np.linalg.slogdet(matrix)
        if sign <= 0:
            return 1e6, np.zeros(len(x))  # a step out of the domain; the line search retracts it
        return -float(value), -np.einsum("jk,ikj->i", np.linalg.inv(matrix), each)

    solution = minimize(
        loss,
        (start - base)[working] / limits,
        jac=True,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * len(working),
        constraints={"type": "ineq", "fun": lambda x: remaining - per_share @ x, "jac": lambda _: -per_share},
        options={"maxiter": 200, "ftol": _LINE_SEARCH},
    )
    power = base
    power[working] += np.clip(solution.x, 0.0, None) * limits
    over = float(np.max((problem.cost @ (power - problem.floor)) / (problem.budget - problem.cost @ problem.floor)))
    return problem.floor + (power - problem.floor) / max(over, 1.0)
