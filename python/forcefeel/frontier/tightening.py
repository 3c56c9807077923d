"""Worst-case share over the tolerances, and the smallest tightening that reaches the goal."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from forcefeel.envelope.cases import Kind
from forcefeel.envelope.findings import WHOLE_NOMINAL, WHOLE_WORST
from forcefeel.frontier.tolerance_levels import ToleranceLevels
from forcefeel.units import PERCENT

INERTIA, GEOMETRY = "column.inertia", ("linkage.ratio", "column.base_arm")
KNOWN_BETTER = (INERTIA, *GEOMETRY)
"""Parameters of the bound: the column's inertia and the scale of the rendered torque."""


@dataclass(frozen=True)
class Path:
    """Worst-case shares over one tightening.

    Attributes:
        name: Tightened parameters.
        tolerances: Relative tolerance of the column's inertia at each level, falling; other parameters in proportion to theirs.
        shares: Worst-case share at each level.
        limit: Share with the tightened parameters known exactly.
        needed: Largest tolerance that reaches the goal, interpolated between two levels in the logarithm of the tolerance; NaN if
            no level reaches it.
    """

    name: str
    tolerances: tuple[float, ...]
    shares: tuple[float, ...]
    limit: Annotated[float, PERCENT]
    needed: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Pair:
    """Two tightenings at once, on computed levels.

    Attributes:
        inertia_and_geometry: Tolerance of the column's inertia that reaches the goal, geometry in proportion.
        others: Factor on the tolerances of all other parameters.
        share: Worst-case share of the pair.
    """

    inertia_and_geometry: Annotated[float, PERCENT]
    others: float
    share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Cost:
    """Cost of one tolerance or one arm.

    Attributes:
        name: The parameter or the arm.
        tolerance: Deviation of the parameter to either side; NaN for an arm.
        passes: Share of the settings that pass with this deviation to either side, all else nominal.
        lost: Share of all settings that pass nominally and fail with this deviation.
        only: Share of all settings that fail only because of it: the gain from exact knowledge of this parameter alone.
    """

    name: str
    tolerance: Annotated[float, PERCENT]
    passes: Annotated[float, PERCENT]
    lost: Annotated[float, PERCENT]
    only: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Tightening:
    """Effect of tighter tolerances.

    Attributes:
        nominal: Share of the settings that pass with the nominal plant, independent of tolerances.
        worst: Share that passes in every case at the full tolerances.
        inertia_and_geometry: Only ``KNOWN_BETTER`` tightened, all others at their full tolerance.
        all_in_proportion: All parameters of the plant tightened by the same factor.
        pair: Loosest combination that reaches the goal if the first alone does not; ``None`` if it does, or if none does.
        costs: Cost of each tolerance and arm, the highest first.
    """

    nominal: Annotated[float, PERCENT]
    worst: Annotated[float, PERCENT]
    inertia_and_geometry: Path
    all_in_proportion: Path
    pair: Pair | None
    costs: tuple[Cost, ...]

    @property
    def nominal_is_enough(self) -> bool:
        """Whether the nominal share reaches its goal."""
        return self.nominal >= WHOLE_NOMINAL


def tightening(levels: ToleranceLevels) -> Tightening:
    """Compute the effect of tighter tolerances on a law."""
    every, last = tuple(levels.tolerances), len(levels.factors)
    known = tuple(key for key in every if key in KNOWN_BETTER)
    trio = _path(levels, "column inertia and geometry", known)
    return Tightening(
        nominal=float(levels.nominal.mean()),
        worst=trio.shares[0],
        inertia_and_geometry=trio,
        all_in_proportion=_path(levels, "all tolerances in proportion", every),
        pair=None if trio.limit >= WHOLE_WORST and np.isfinite(trio.needed) else _pair(levels, known, last),
        costs=_costs(levels),
    )


def _path(levels: ToleranceLevels, name: str, tight: Sequence[str]) -> Path:
    tolerances = tuple(factor * levels.tolerances[INERTIA] for factor in levels.factors)
    shares = tuple(float(levels.worst(tight, level).mean()) for level in range(len(tolerances)))
    limit = float(levels.worst(tight, len(tolerances)).mean())
    return Path(name, tolerances, shares, limit, needed(tolerances, shares, WHOLE_WORST))


def needed(tolerances: Sequence[float], shares: Sequence[float], goal: float) -> float:
    """Largest of the falling ``tolerances`` that reaches the goal, interpolated between two in the logarithm; NaN if none does."""
    reached = np.flatnonzero(np.array(shares) >= goal)
    if not len(reached):
        return float("nan")
    first = int(reached[0])
    if first == 0:
        return tolerances[0]
    ends = shares[first - 1], shares[first]
    logs = np.log([tolerances[first - 1], tolerances[first]])
    return float(np.exp(np.interp(goal, ends, logs)))


def _pair(levels: ToleranceLevels, known: Sequence[str], last: int) -> Pair | None:
    """Loosest factor on the other parameters with which a level of the known ones reaches the goal, and the loosest such level."""
    for rest in range(1, last):
        for level in range(last):
            share = float(levels.worst(known, level, rest).mean())
            if share >= WHOLE_WORST:
                return Pair(levels.factors[level] * levels.tolerances[INERTIA], levels.factors[rest], share)
    return None


def _costs(levels: ToleranceLevels) -> tuple[Cost, ...]:
    names = [*levels.tolerances, *(case.name for case in levels.cases[0] if case.kind is Kind.ARM)]
    of = [np.array([name in {case.parameter, case.name} for case in levels.cases[0]]) for name in names]
    costs = []
    for name, in_case in zip(names, of, strict=True):
        passes, others = levels.passes[0][in_case].all(axis=0), levels.passes[0][~in_case].all(axis=0)
        costs.append(
            Cost(
                name,
                levels.tolerances.get(name, float("nan")),
                float(passes.mean()),
                float((levels.nominal & ~passes).mean()),
                float((others & ~passes).mean()),
            )
        )
    return tuple(sorted(costs, key=lambda cost: (-cost.only, -cost.lost)))
