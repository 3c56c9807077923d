"""Tolerance levels: passes at every setting with deviations of the full tolerance, half of it, and so on.

Each case has one deviation, hands off. So the passes with some tolerances tightened are the logical AND of cases that run once.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case, Kind
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import Envelope
from forcefeel.envelope.run import compute
from forcefeel.errors import InputError
from forcefeel.frontier.bisection import bisected
from forcefeel.threads import threads_or_cores

FACTORS = (1.0, 0.5, 0.25, 0.1, 0.05, 0.025)
"""ToleranceLevels: factors on all tolerances of the plant."""

Progress = Callable[[int, int], None]
"""Called with the numbers of completed and of all releases."""


@dataclass(frozen=True, eq=False)
class ToleranceLevels:
    """Results of one law on every level.

    Attributes:
        full: Envelope at the full tolerances.
        factors: The levels, falling from 1.
        cases: Cases of each level; arms only on the first.
        passes: Passes in each case of each level, (cases, settings); below the full tolerance of a simulated loader only of
            settings that pass nominally and with every arm.
        stable: Stability in each case of each level, (cases, settings).
    """

    full: Envelope
    factors: tuple[float, ...]
    cases: tuple[tuple[Case, ...], ...] = field(repr=False)
    passes: tuple[NDArray[np.bool_], ...] = field(repr=False)
    stable: tuple[NDArray[np.bool_], ...] = field(repr=False)

    @property
    def law(self) -> str:
        """Name of the law."""
        return self.full.laws[0]

    @property
    def tolerances(self) -> Mapping[str, float]:
        """Full tolerances by parameter: half the distance of the ends."""
        return {key: deviation.size for key, deviation in self.full.plan.deviations.items()}

    @property
    def nominal(self) -> NDArray[np.bool_]:
        """Settings that pass with the nominal plant, hands off."""
        return np.asarray(self.passes[0][0])

    def worst(self, tight: Collection[str], level: int, rest: int = 0, *, stable: bool = False) -> NDArray[np.bool_]:
        """Settings that pass in every case with some parameters on one level and all others on another.

        Args:
            tight: Parameters on ``level``.
            level: Index in ``factors``; one beyond the last for exactly known parameters.
            rest: Level of all other parameters.
            stable: Return stable settings instead of passes.
        """
        good = self.stable if stable else self.passes
        at_nominal = [case.kind is not Kind.PLANT for case in self.cases[0]]
        parts = [good[0][at_nominal], good[rest][self._cases_off(rest, set(self.tolerances) - set(tight))]]
        if level < len(self.factors):
            parts.append(good[level][self._cases_off(level, tight)])
        return np.asarray(np.concatenate(parts).all(axis=0))

    def _cases_off(self, level: int, parameters: Collection[str]) -> list[bool]:
        return [case.kind is Kind.PLANT and case.parameter in parameters for case in self.cases[level]]


def onward(progress: Progress, done: int, total: int) -> Progress:
    """Progress callback with an offset."""
    return lambda now, _: progress(done + now, total)


_SMALLER = 0.5
"""Usual releases of a simulated loader on all levels below the first, as a share of the first; for progress."""


def level_releases(plan: Plan, factors: Collection[float] = FACTORS) -> int:
    """Number of releases on all levels; for a simulated loader the usual number."""
    levels = len(factors) if plan.linear else 1 + _SMALLER
    return round(plan.settings.count * (levels * (len(plan.cases) - len(plan.arms)) + len(plan.arms)))


def run_levels(
    plan: Plan,
    factors: tuple[float, ...] = FACTORS,
    *,
    threads: int | None = None,
    progress: Progress = lambda done, total: None,
) -> ToleranceLevels:
    """Run one law on every level.

    Raises:
        InputError: If the plan does not have exactly one law, or the levels do not fall from 1 or reach 0.
    """
    if len(plan.laws) != 1:
        raise InputError(f"laws: expected one, got {', '.join(plan.laws)}; make a frontier for each")
    if factors[:1] != (1.0,) or any(np.diff(factors) >= 0) or factors[-1] <= 0:
        raise InputError(f"factors: expected levels that fall from 1 and stay above 0, got {list(factors)}")
    total, done = level_releases(plan, factors), 0
    plans = [
        Plan(
            plan.given,
            plan.laws,
            plan.settings,
            plan.rule,
            {key: deviation.scaled(factor) for key, deviation in plan.deviations.items()},
            plan.arms if factor == 1.0 else (),
            plan.angle_rad,
        )
        for factor in factors
    ]
    envelopes: list[Envelope] = []
    for level in plans if plan.linear else plans[:1]:
        envelopes.append(compute(level, threads=threads, progress=onward(progress, done, total)))
        done += level.settings.count * len(level.cases)
    passes = [envelope.passes(envelope.laws[0]) for envelope in envelopes]
    stable = [envelope.stable(envelope.laws[0]) for envelope in envelopes]
    if not plan.linear:
        for smaller in bisected(envelopes[0], plans[1:], threads_or_cores(threads)):
            passes.append(smaller.passes)
            stable.append(smaller.stable)
        progress(total, total)
    return ToleranceLevels(envelopes[0], factors, tuple(level.cases for level in plans), tuple(passes), tuple(stable))
