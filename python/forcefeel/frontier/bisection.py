"""Tolerance levels of a simulated loader from few releases.

A setting that passes nominally and at the full deviation of a case counts as passing at the smaller ones. If it fails at the full
deviation, the level of its first pass is found by bisection. A setting that fails nominally or with an arm is not run: it passes on
no level. Stability is computed on every level.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Kind
from forcefeel.envelope.outcomes import PASSED, UNSTABLE_LOOP, IdealFigures, force_not_held, run_settings
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import stable_settings
from forcefeel.envelope.result import Envelope
from forcefeel.laws.law import Law


@dataclass(frozen=True, eq=False)
class Level:
    """Passes and stability of one law on one level, (cases, settings)."""

    passes: NDArray[np.bool_]
    stable: NDArray[np.bool_]


def bisected(full: Envelope, levels: Sequence[Plan], threads: int) -> Iterator[Level]:
    """Yield the levels below the full tolerances.

    Args:
        full: Envelope of one law at the full tolerances.
        levels: Plans at smaller tolerances, falling, without arms.
        threads: Number of threads.
    """
    plan, ((name, spec),) = full.plan, full.plan.laws.items()
    feel = plan.settings.feel(plan.loader)
    law = Law.of(spec, plan.loader, feel, name)
    ideal = IdealFigures(plan, feel, threads)
    deviates = np.array([case.kind is Kind.PLANT for case in plan.cases])
    cases = [level.cases[1:] for level in levels]
    stable = np.array([stable_settings(plan, level, feel, law, threads) for level in cases])
    passes_full = full.passes(name)
    good = passes_full[~deviates].all(axis=0) & ~force_not_held(plan, feel)
    # Of each case and setting, the last level that fails and the first that passes; beyond the last is the nominal plant.
    failing = np.full(passes_full[deviates].shape, -1)
    passing = np.where(passes_full[deviates], 0, len(levels))
    while (left := good & (passing - failing > 1)).any():
        middle = (failing + passing) // 2
        for k in np.unique(middle[left]):
            wanted = left & (middle == k)
            passes = wanted & stable[k]
            for case, which, outcome, _ in run_settings(ideal, cases[k], passes, law):
                passes[case, which] = outcome == PASSED
                stable[k][case, which] = outcome != UNSTABLE_LOOP
            passing[passes], failing[wanted & ~passes] = k, k
    for k, level in enumerate(stable):
        nominal = passes_full[0], full.stable(name)[0]
        yield Level(np.vstack([nominal[0], good & (k >= passing) & level]), np.vstack([nominal[1], level]))
