"""A model that misses more than noise is good nowhere: its estimates are off by more than their standard errors."""

import pytest

import forcefeel as ff
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.commission.findings import commission_conclusions, glance
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.page.page import commission_page
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import Commission
from forcefeel.commission.simulated_bench import BenchTime, simulated_records
from forcefeel.units import UnitSystem

STIFFNESS = "linkage.stiffness"
BIASED = 5.0
"""Standard errors by which an estimate is off that carries what other parameters are off. Measured: 9.9."""


@pytest.fixture(scope="module")
def files():
    """A machine and a file of it that is off in more than its link."""
    return ff.load("examples/bench-2khz/loader.toml"), ff.digital_elevator()


def identified(files, plan):
    loader, truth = files
    found = identify_loader(loader, simulated_records(loader, truth, BenchTime(4.0, 500.0, 1974)), plan)
    return found, Commission(plan, loader, found.outcome, found.loader)


def test_what_is_biased_by_more_than_noise_is_good_nowhere(files):
    found, commission = identified(files, CommissionPlan(fit=("k",)))
    estimate = found.found[STIFFNESS]
    assert abs(estimate.value - files[1][STIFFNESS]) > BIASED * estimate.deviation
    assert not found.outcome.good
    (wanting,) = found.outcome.wanting
    assert "misses more of bench, column angle and bench, piston position and others than noise" in wanting
    assert "leave out --fit" in wanting
    (row,) = (one for one in glance(commission) if one.title == "identification")
    assert row.good == "no"
    assert row.result.endswith("1 wanting")
    assert wanting in commission_conclusions(commission).findings
    assert not identification_conclusions(found.found, UnitSystem.US).ok
    assert "than noise, so parameters can be off" in commission_page(commission)


def test_what_is_explained_is_good(files):
    found, commission = identified(files, CommissionPlan())
    assert found.outcome.good
    assert identification_conclusions(found.found, UnitSystem.US).ok
    assert glance(commission)[0].good == "yes"
