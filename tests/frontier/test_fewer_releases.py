"""A frontier's shares and levels from few releases, held against envelopes that run every setting in every case."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope import worst_case
from forcefeel.envelope.outcomes import run_settings
from forcefeel.envelope.plan import Plan, make_plan
from forcefeel.envelope.worst_case import worst_case_shares
from forcefeel.frontier.tolerance_levels import level_releases, run_levels
from forcefeel.loader.built_in import BUILT_IN
from tests.parametrization import mostly_slow

GRID = {"stiffness": "5..100 %:4:log", "frequency": "1, 4 Hz", "damping": "0.2, 0.7"}
CHANGES = {"column.inertia": 0.3, "linkage.ratio": 0.1, "linkage.stiffness": 0.3}
FACTORS = (1.0, 0.5, 0.25, 0.1)


def plan_of(name: str) -> Plan:
    loader = BUILT_IN[name]()
    return make_plan(loader, ("robust",), GRID, changes=CHANGES)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_slow(["elevator-2khz", "desktop-yoke"]))
def test_bisected_levels_match_envelopes_at_each_tolerance(name: str) -> None:
    plan = plan_of(name)
    done: list[tuple[int, int]] = []
    levels = run_levels(plan, FACTORS, progress=lambda *now: done.append(now))
    good = levels.full.passes("robust")[[0, -3, -2, -1]].all(axis=0)  # nominally and with each arm
    found = set()
    for factor, passes, stable in zip(FACTORS, levels.passes, levels.stable, strict=True):
        changes = {key: factor * change for key, change in CHANGES.items()}
        whole = ff.find_envelope(plan.given, ["robust"], GRID, changes=changes, arms=plan.arms if factor == 1 else ())
        np.testing.assert_array_equal(passes[:, good], whole.passes("robust")[:, good])
        np.testing.assert_array_equal(stable, whole.stable("robust"))
        found.add(int(passes[:7, good].sum()))
    assert len(found) > 1  # some pass only at a smaller deviation
    assert done[-1] == (level_releases(plan, FACTORS),) * 2
    assert done == sorted(done)


@pytest.mark.parametrize("batch", mostly_slow([4, 384]))
def test_worst_case_shares_match_the_envelope_with_fewer_releases(batch: int, monkeypatch: pytest.MonkeyPatch) -> None:
    plan, ran, decided = plan_of("elevator-2khz"), [], []

    def counting(ideal, cases, settings, *rest):
        ran.append(int(settings.sum()))
        return run_settings(ideal, cases, settings, *rest)

    monkeypatch.setattr(worst_case, "run_settings", counting)
    monkeypatch.setattr(worst_case, "BATCH", batch)
    whole = ff.find_envelope(plan.given, ["robust"], GRID, changes=CHANGES)
    hardest = [row.case for row in sorted(whole.case_shares("robust"), key=lambda row: row.passes)]
    shares = worst_case_shares(plan, hardest, advance=decided.append)
    assert shares == whole.shares("robust")
    assert 0 < shares.worst_case_share < shares.nominal_share
    assert sum(ran) < whole.stable("robust").sum() or batch == 384
    assert sum(decided) == plan.settings.count * len(plan.cases)
