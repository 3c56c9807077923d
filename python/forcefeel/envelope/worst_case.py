"""Nominal and worst-case shares alone: a setting that fails in a case is not run in the cases after it.

The shares are those of the whole envelope. One exception: a loop with stable poles whose run diverges is unstable in the envelope;
here it counts as stable if it failed before in another case.
"""

from collections.abc import Callable, Sequence

import numpy as np

from forcefeel.envelope.cases import Case, Kind
from forcefeel.envelope.outcomes import PASSED, UNSTABLE_LOOP, IdealFigures, force_not_held, run_settings
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import stable_settings
from forcefeel.envelope.result import Shares
from forcefeel.envelope.run import compute
from forcefeel.laws.law import Law
from forcefeel.threads import threads_or_cores

BATCH = 4000
"""Releases that are run together: enough to fill lanes and cores. What fails in them is not run in the cases that follow."""


def worst_case_shares(
    plan: Plan, hardest: Sequence[str] = (), *, threads: int | None = None, advance: Callable[[int], None]
) -> Shares:
    """Shares of the plan's only law, as ``Envelope.shares``.

    Args:
        plan: The envelope.
        hardest: Names of the cases in which most settings are expected to fail, the hardest first; only the time depends on it.
        threads: Number of threads; default: all cores.
        advance: Called with the number of settings times cases that are decided since the last call.
    """
    (name, spec), threads = *plan.laws.items(), threads_or_cores(threads)
    if plan.linear:
        envelope = compute(plan, threads=threads)
        advance(plan.settings.count * len(plan.cases))
        return envelope.shares(name)
    feel = plan.settings.feel(plan.loader)
    law = Law.of(spec, plan.loader, feel, name)
    cases = sorted(plan.cases, key=lambda case: _order(case, hardest))
    stable = stable_settings(plan, cases, feel, law, threads)
    ideal, held = IdealFigures(plan, feel, threads), ~force_not_held(plan, feel)
    nominal, worst = stable[0], stable.all(axis=0)
    first = 0
    while first < len(cases):
        # The nominal case alone and of all that are stable: its own share counts.
        wanted = worst if first else nominal
        size = max(1, BATCH // max(1, int(wanted.sum()))) if first else 1
        group = cases[first : first + size]
        codes = np.full((len(group), len(feel)), PASSED, dtype=np.int8)
        for places, which, outcome, _ in run_settings(ideal, group, np.tile(wanted, (len(group), 1)), law):
            codes[places, which] = outcome
        stable[first : first + len(group)] &= codes != UNSTABLE_LOOP
        passes = wanted & held & (codes == PASSED).all(axis=0)
        nominal, worst = nominal if first else passes, worst & passes
        first += len(group)
        advance(len(group) * len(feel))
    masks = (stable[0], nominal, stable.all(axis=0), worst)
    return Shares(name, *(float(which.mean()) for which in masks))


def _order(case: Case, hardest: Sequence[str]) -> tuple[bool, bool, int]:
    """The nominal case, then hands off, then arms; each the hardest first."""
    place = hardest.index(case.name) if case.name in hardest else len(hardest)
    return case.kind is not Kind.NOMINAL, case.arm is not None, place
