"""The best law in seconds: as the closer look has it, and honest where there is none."""

from dataclasses import replace

import pytest

import forcefeel as ff
from forcefeel.choice.quick_choice import STEPS, best_law
from forcefeel.envelope.cases import REFERENCE_ARMS
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.laws.law import names_for

DIGITAL = ff.digital_elevator()
GRID = {"stiffness": "20, 100 %", "frequency": "2, 4 Hz", "damping": "0.3, 1"}
FEW_CASES = {"changes": {"linkage.ratio": 0.2}, "arms": REFERENCE_ARMS[:1]}


def test_batched_cases_match_single_cases(monkeypatch):
    plan = make_plan(DIGITAL, ("load-cell", "robust"), GRID, **FEW_CASES)
    one = compute(plan)
    monkeypatch.setattr("forcefeel.envelope.run._TOGETHER", 1)
    other = compute(plan)
    assert one.outcomes == other.outcomes
    assert one.data.identical(other.data)
    assert one.shares("load-cell").stable < 1
    assert 0 < one.shares("robust").worst_case_share < 1


def test_analog_loader_error_states_requirements():
    with pytest.raises(ff.InputError, match=r"analog.*controller\.period.*elevator-2khz"):
        best_law(ff.elevator())


def test_loader_without_eligible_law_is_reported():
    late = DIGITAL.replace({"controller.delay": "3.5 ms"})
    steps = []
    tried = best_law(late, GRID, called=("late.toml",), progress=steps.append)
    assert steps == list(STEPS)
    assert tried.best is None
    assert tried.laws == (tried.report,)
    assert len(tried.remarks) == len(names_for(late))
    assert all("not eligible" in remark or "cannot be designed" in remark for remark in tried.remarks)
    assert tried.compare_command == "forcefeel law late.toml --law auto --out laws"


def test_untestable_loader_error_states_reason():
    by_pressure = replace(DIGITAL, stiffness_factor=ff.loader.Curve((0.0, 5e3), (0.25, 0.75)))
    tried = best_law(by_pressure)
    assert tried.best is None
    assert "dynamic pressure" in tried.impossible
