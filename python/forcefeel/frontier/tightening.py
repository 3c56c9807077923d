"""How the worst-case share moves with the tolerances, and the smallest tightening that lifts it to the goal."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from forcefeel.envelope.cases import Kind
from forcefeel.envelope.findings import WHOLE_NOMINAL, WHOLE_WORST
from forcefeel.frontier.tolerance_levels import Rungs
from forcefeel.units import PERCENT

INERTIA, GEOMETRY = "column.inertia", ("linkage.ratio", "column.base_arm")
KNOWN_BETTER = (INERTIA, *GEOMETRY)
"""What the bound is about: the column's inertia and the scale of the torque that is rendered about it."""


@dataclass(frozen=True)
class Path:
    """Worst-case shares along one way of tightening.

    Attributes:
        name: What is tightened.
        tolerances: Relative tolerance of the column's inertia at each rung, falling; other parameters in proportion to theirs.
        shares: Worst-case share at each.
        limit: The share that is left where what is tightened is known exactly.
        needed: Tolerance at which the share first reaches the goal, interpolated between two rungs in the logarithm of the
            tolerance; not a number where no rung reaches it.
    """

    name: str
    tolerances: tuple[float, ...]
    shares: tuple[float, ...]
    limit: Annotated[float, PERCENT]
    needed: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Pair:
    """Two tightenings at once, of the rungs that were computed.

    Attributes:
        inertia_and_geometry: Tolerance of the column's inertia and of the geometry that reaches the goal.
        others: Factor on the tolerances of all other parameters.
        share: Worst-case share there.
    """

    inertia_and_geometry: Annotated[float, PERCENT]
    others: float
    share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Cost:
    """What one tolerance, or one arm, costs.

    Attributes:
        name: The parameter or the arm.
        tolerance: How far the parameter is off, to either side; not a number for an arm.
        passes: Share of the settings that pass with it off, to either side, all else nominal.
        lost: Share of all settings that pass nominally and not with it off.
        only: Share of all settings that pass in every other case: what a perfect knowledge of this alone would give back.
    """

    name: str
    tolerance: Annotated[float, PERCENT]
    passes: Annotated[float, PERCENT]
    lost: Annotated[float, PERCENT]
    only: Annotated[float, PERCENT]


@dataclass(frozen=True)
class Tightening:
    """What tighter tolerances would give.

    Attributes:
        nominal: Share of the settings that pass with the nominal plant, which no tolerance changes.
        worst: Share that passes in every case at the full tolerances.
        inertia_and_geometry: Of ``KNOWN_BETTER`` alone, all others at their full tolerance.
        all_in_proportion: Of all parameters of the plant together.
        pair: The loosest of both that reaches the goal where the first alone does not; ``None`` if it does, or nothing does.
        costs: What each tolerance and arm costs, the dearest first.
    """

    nominal: Annotated[float, PERCENT]
    worst: Annotated[float, PERCENT]
    inertia_and_geometry: Path
    all_in_proportion: Path
    pair: Pair | None
    costs: tuple[Cost, ...]

    @property
    def nominal_is_enough(self) -> bool:
        """Whether the nominal share reaches its own part of the goal."""
        return self.nominal >= WHOLE_NOMINAL


def tightening(rungs: Rungs) -> Tightening:
    """What tighter tolerances would give the law of a ladder."""
    every, last = tuple(rungs.tolerances), len(rungs.factors)
    known = tuple(key for key in every if key in KNOWN_BETTER)
    trio = _path(rungs, "column inertia and geometry", known)
    return Tightening(
        nominal=float(rungs.nominal.mean()),
        worst=trio.shares[0],
        inertia_and_geometry=trio,
        all_in_proportion=_path(rungs, "all tolerances in proportion", every),
        pair=None if trio.limit >= WHOLE_WORST and np.isfinite(trio.needed) else _pair(rungs, known, last),
        costs=_costs(rungs),
    )


def _path(rungs: Rungs, name: str, tight: Sequence[str]) -> Path:
    tolerances = tuple(factor * rungs.tolerances[INERTIA] for factor in rungs.factors)
    shares = tuple(float(rungs.worst(tight, rung).mean()) for rung in range(len(tolerances)))
    limit = float(rungs.worst(tight, len(tolerances)).mean())
    return Path(name, tolerances, shares, limit, needed(tolerances, shares, WHOLE_WORST))


def needed(tolerances: Sequence[float], shares: Sequence[float], goal: float) -> float:
    """Largest tolerance whose share reaches the goal, between two rungs in the logarithm of the tolerance.

    Args:
        tolerances: Falling.
        shares: Share at each.
        goal: What is to be reached.

    Returns:
        The tolerance; not a number where no rung reaches the goal.
    """
    reached = np.flatnonzero(np.array(shares) >= goal)
    if not len(reached):
        return float("nan")
    first = int(reached[0])
    if first == 0:
        return tolerances[0]
    ends = shares[first - 1], shares[first]
    logs = np.log([tolerances[first - 1], tolerances[first]])
    return float(np.exp(np.interp(goal, ends, logs)))


def _pair(rungs: Rungs, known: Sequence[str], last: int) -> Pair | None:
    """The loosest factor on the others with which some rung of the known ones reaches the goal, and the loosest such rung."""
    for rest in range(1, last):
        for rung in range(last):
            share = float(rungs.worst(known, rung, rest).mean())
            if share >= WHOLE_WORST:
                return Pair(rungs.factors[rung] * rungs.tolerances[INERTIA], rungs.factors[rest], share)
    return None


def _costs(rungs: Rungs) -> tuple[Cost, ...]:
    names = [*rungs.tolerances, *(case.name for case in rungs.cases[0] if case.kind is Kind.ARM)]
    of = [np.array([name in {case.parameter, case.name} for case in rungs.cases[0]]) for name in names]
    costs = []
    for name, in_case in zip(names, of, strict=True):
        passes, others = rungs.passes[0][in_case].all(axis=0), rungs.passes[0][~in_case].all(axis=0)
        costs.append(
            Cost(
                name,
                rungs.tolerances.get(name, float("nan")),
                float(passes.mean()),
                float((rungs.nominal & ~passes).mean()),
                float((others & ~passes).mean()),
            )
        )
    return tuple(sorted(costs, key=lambda cost: (-cost.only, -cost.lost)))
