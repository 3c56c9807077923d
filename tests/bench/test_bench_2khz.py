"""The synthetic bench under a digital controller: made anew it is the same, and what is identified from it is the machine."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.deviations import Origin, deviations_of

BENCH = Path(__file__).parents[2] / "examples" / "bench-2khz"
FIT = "k,c,J,alpha,q_r,R_p"
ERRORS = 4  # standard errors
SECONDS = 4.0  # of the record
WORST = 0.01  # of a value: what so much of the record leaves of the worst. Measured: 2e-3
STEP_DEG = 4.29e-5  # of the column's sensor
ONE_STEP = 1.5  # of a sensor: another machine's rounding may choose the other one
TRUTH = ff.digital_elevator()


def true(key, arm=10.0):
    """The machine's value; of alpha the one that goes with the file's R_b, since only their product shows."""
    found = TRUTH[key]
    return found * arm / 10.05 if key == "linkage.ratio" else found


@pytest.fixture(scope="module")
def make():
    return runpy.run_path(str(BENCH / "make.py"))


def test_record_is_reproducible(make):
    kept, made = ff.read_bench_data(BENCH / "shaken.parquet"), make["record"](0.5)
    assert str(kept.experiment) == "loader pilot_force"
    angle = np.degrees(kept.channels["column_angle"][:126])
    assert np.abs(angle[:-1] - made["column angle (deg)"][:-1]).max() < ONE_STEP * STEP_DEG
    assert np.ptp(angle) > 1e3 * STEP_DEG


def test_loader_file_is_reproducible(make):
    assert make["believed"]().to_toml() == (BENCH / "loader.toml").read_text(encoding="utf-8")


def test_identified_loader_matches_machine_and_sets_deviations():
    loader = ff.load(BENCH / "identified.toml")
    deviations = deviations_of(loader)
    for key, tolerance in loader.tolerances.items():
        if tolerance.deviation is not None:
            assert abs(loader[key] - true(key)) < ERRORS * tolerance.deviation
            assert deviations[key].size == pytest.approx(2 * tolerance.deviation / loader[key])
    assert {key for key, it in deviations.items() if it.origin is Origin.FILE} == {*loader.tolerances}
    assert deviations["column.base_arm"].ends == pytest.approx((-0.01, 0.01))
    assert {it.size for it in deviations.values() if it.origin is Origin.ASSUMED} == {0.2}


@pytest.mark.slow
def test_tenth_of_the_record_identifies_the_machine():
    whole = ff.read_bench_data(BENCH / "shaken.parquet")
    early = whole.time_s <= SECONDS
    channels = {name: values[early] for name, values in whole.channels.items()}
    record = ff.bench.BenchRecord("early", whole.experiment, whole.time_s[early], channels)
    found = ff.identify(ff.load(BENCH / "loader.toml"), [record], FIT, starts=1)
    assert found.loader is not None
    for it in found.estimates:
        assert it.value == pytest.approx(true(it.unknown.key), rel=WORST)
