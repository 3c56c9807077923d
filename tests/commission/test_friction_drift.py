"""Tolerance of dry friction after a commissioning."""

import pytest

import forcefeel as ff
from forcefeel.bench.identification.fitted_loader import normal_about
from forcefeel.commission.friction_drift import DRIFT, drift_sentence, with_drift
from forcefeel.commission.observability import BREAKAWAY, DRY
from forcefeel.laws.sampled.plant import SampledPlant

TEN_DIGITS = 1e-6  # relative; of a deviation that is the difference of two numbers of a file
IDENTIFIED = 0.005
"""Standard error as a share, as a minute of bench gives it."""


def identified(deviation):
    loader = ff.digital_elevator().replace({DRY: "2 lb", BREAKAWAY: "2.4 lb"})
    return loader.with_tolerances(
        {key: normal_about(key, loader[key], deviation * loader[key]) for key in (DRY, BREAKAWAY)}
    )


def test_law_learns_drift_beyond_the_identified_tolerance(tmp_path):
    loader, rows = with_drift(identified(IDENTIFIED))
    assert rows == (DRY, BREAKAWAY)
    (tmp_path / "loader.toml").write_text(loader.to_toml(), encoding="utf-8")
    plant = SampledPlant.of(ff.load(tmp_path / "loader.toml"))
    assert plant.friction.off == pytest.approx((-DRIFT, DRIFT), rel=TEN_DIGITS)
    assert "for drift" in loader.source
    assert f"{100 * DRIFT:.0f} %" in drift_sentence(rows)[0]
    assert DRY in drift_sentence(rows)[0]


def test_wide_or_absent_tolerance_stays():
    wide = identified(2 * DRIFT)
    bare = ff.digital_elevator()
    assert with_drift(wide) == (wide, ())
    assert with_drift(bare) == (bare, ())
    assert drift_sentence(()) == ()


def test_drift_keeps_values_and_other_tolerances():
    before = identified(IDENTIFIED)
    after, _ = with_drift(before)
    assert (after.si_values == before.si_values).all()
    others = [key for key in before.tolerances if key not in (DRY, BREAKAWAY)]
    assert {key: after.tolerances[key] for key in others} == {key: before.tolerances[key] for key in others}
