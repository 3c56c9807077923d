"""Which parameters a record sees, which it sees only in a product with others, and which not at all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.records import BenchRecord
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.observability import BREAKAWAY, DRY, STRIBECK, candidates, seen_by, with_friction
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.simulated_bench import BenchTime, simulated_records

EXAMPLE = Path(__file__).parents[2] / "examples" / "bench"
FILE = ff.digital_elevator()
LBF = 4.4482216152605  # N
TIME = BenchTime(time_s=4.0, rate_hz=500.0)
NOISE = 2e-3  # relative; what the noise of four seconds leaves of a value
RUBS = {DRY: "1.5 lb", BREAKAWAY: "1.8 lb"}


@pytest.fixture(scope="module")
def records():
    return simulated_records(FILE, FILE.replace({"column.inertia": "41 lb in s^2/rad", **RUBS}), TIME)


@pytest.mark.slow
def test_multisine_with_pressure_and_current_determines_all_but_products(records):
    begun = with_friction(FILE)
    seen = seen_by(begun, records, candidates(begun))
    assert set(seen.carried) - {STRIBECK} == {"actuator.bulk_modulus", "column.base_arm", "column.grip_arm"}
    assert {DRY, "column.inertia", "amplifier.admittance", "actuator.area", "linkage.ratio"} <= set(seen.fitted)


def test_area_without_pressure_is_carried_and_rated_flow_is_fitted(records):
    (one,) = records
    channels = {name: it for name, it in one.channels.items() if name != "load_pressure"}
    begun = with_friction(FILE)
    fewer = BenchRecord(one.name, one.experiment, one.time_s, channels)
    seen = seen_by(begun, [fewer], candidates(begun))
    assert "actuator.area" in seen.carried
    assert "valve.rated_flow" in seen.fitted


def test_search_bounds_are_dropped_and_tolerances_are_kept():
    known = FILE.with_tolerances({"column.grip_arm": "1 %"})
    assert with_friction(known)[DRY] > 0
    assert "linkage.stiffness" not in with_friction(known).tolerances


def test_column_without_breakaway_does_not_determine_friction(records):
    (one,) = records
    time_s = one.time_s[:500]
    held = BenchRecord("held", one.experiment, time_s, {name: 1e-4 * it[:500] for name, it in one.channels.items()})
    assert DRY in seen_by(with_friction(FILE), [held], candidates(with_friction(FILE))).unseen


def test_record_without_reversal_does_not_determine_friction(records):
    (one,) = records
    onward = {
        name: np.linspace(0.0, np.ptp(one.channels[name]), len(one.time_s))
        for name in ("column_angle", "piston_position")
    }
    seen = seen_by(
        with_friction(FILE), [replace(one, channels={**one.channels, **onward})], candidates(with_friction(FILE))
    )
    assert {DRY, "column.static_friction"} <= set(seen.unseen)
    assert "column.inertia" in seen.fitted


def test_frequency_responses_alone_do_not_determine_friction():
    response = ff.read_bench_data(EXAMPLE / "servo-closed.csv")
    found = identify_loader(ff.load(EXAMPLE / "loader.toml"), [response], CommissionPlan()).outcome
    assert not found.ok
    assert found.wanting[0].startswith("The data do not determine the dry friction of the column")
    assert "slow sweep of force both ways" in found.advice[-1]


def test_noise_declared_as_zero_is_rejected_with_the_measured_noise(records):
    quiet = FILE.replace({"column_sensor.noise": None, "column_sensor.resolution": None, **RUBS})
    found = identify_loader(quiet, records, CommissionPlan(fit=("J",)))
    (sentence,) = found.outcome.wanting
    assert sentence.startswith("column_sensor.noise is declared as zero, and the records show ")
    assert not found.outcome.ok


@pytest.mark.slow
@pytest.mark.parametrize("stated", ["0.3 lb", "3 lb"])
def test_friction_in_the_file_does_not_mislead_the_search_and_a_carried_parameter_has_zero_tolerance(records, stated):
    """From a friction that is too small nothing breaks away; a breakaway force that is only a place to begin from is nobody's."""
    identified = identify_loader(FILE.replace({DRY: stated}, si=True), records, CommissionPlan())
    found = identified.loader
    assert found is not None
    assert identified.outcome.ok, identified.outcome
    assert found[DRY] == pytest.approx(1.5 * LBF, rel=NOISE)
    assert found[BREAKAWAY] == 0.0  # four seconds do not tell it, and the file does not state it
    assert found["column.inertia"] / FILE["column.inertia"] == pytest.approx(41 / 37.4, rel=NOISE)
    low, high = found.tolerances["column.base_arm"].ends
    assert high - low < 1e-5 * high
