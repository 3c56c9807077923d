"""A parameter at an end of what its row allows: the file's value, or a friction that is none."""

import pytest

import forcefeel as ff
from forcefeel.commission.findings import commission_conclusions
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.observability import BREAKAWAY, DRY
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import AT_END, NOTHING, Commission
from forcefeel.commission.simulated_bench import BenchTime, simulated_records


@pytest.mark.slow
def test_parameter_at_its_physical_limit_counts_as_known():
    wheel = ff.loader.electric("aileron-wheel")
    assert wheel["linkage.ratio"] == 1.0  # a link moves its column by no more than itself
    records = simulated_records(wheel, wheel.replace({"column.coulomb_friction": "0.6 lb"}), BenchTime(4.0, 500.0, 1))
    plan = CommissionPlan()
    found = identify_loader(wheel, records, plan)
    assert found.loader is not None
    (ratio,) = (one for one in found.outcome.parameters if one.key == "linkage.ratio")
    assert (ratio.state, found.loader["linkage.ratio"]) == (AT_END, 1.0)
    low, high = found.loader.tolerances["linkage.ratio"].ends
    assert 0.9999 < low < high == 1.0
    said = commission_conclusions(Commission(plan, wheel, found.outcome, found.loader)).findings
    sentence = "linkage.ratio is at the end of the valid range by the file and by the records, and counts as known."
    assert sentence in said


@pytest.mark.slow
@pytest.mark.parametrize("stated", [None, "0.3 lb"])
def test_column_without_friction_is_identified_as_zero_friction(stated):
    """Beside nothing a search ends with some estimate; of the breakaway, to which the data answer in jumps, with a wrong one."""
    truth = ff.digital_elevator()
    loader = truth.replace({DRY: stated}, si=True).with_tolerances({DRY: {"uniform": ["0.2 lb", "0.4 lb"]}})
    found = identify_loader(loader, simulated_records(truth, truth, BenchTime(3.0, 500.0, 2)), CommissionPlan())
    assert found.outcome.ok
    assert found.loader is not None
    assert (found.loader[DRY], found.loader[BREAKAWAY]) == (0.0, 0.0)
    assert {one.key for one in found.outcome.parameters if one.state == NOTHING} == {DRY}
    assert DRY not in found.loader.tolerances
