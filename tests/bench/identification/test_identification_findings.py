"""What is said of an identification: words, digits, plain data; all on results made by hand."""

import dataclasses
import json
import re
from math import inf

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.identification.as_json import FitSettings, identification_json, response_csv
from forcefeel.bench.identification.digits import digits_of, estimated, interval, percent, rounded
from forcefeel.bench.identification.findings import (
    correlation_text,
    identification_conclusions,
    probability_text,
    strong_pairs,
)
from forcefeel.bench.identification.misfit import UNEXPLAINED, unexplained
from forcefeel.bench.identification.page.plots import MOST_POINTS, phases
from forcefeel.bench.identification.page.tables import data as data_table
from forcefeel.bench.identification.page.tables import estimates as estimates_table
from forcefeel.bench.identification.result import Status
from forcefeel.bench.response_file import read_response
from forcefeel.page.canvas import drawn
from forcefeel.units import UnitSystem
from tests.identifications import (
    NEEDED,
    SPIKE,
    bounded,
    correlation,
    determined,
    ends,
    estimate,
    loader,
    record_fitted,
    response_fitted,
    secrets_in,
    undetermined,
)

ROUNDING = 1e-12
"""Relative: a product and a conversion. Measured: 2e-16."""
NINE_DIGITS = 1e-8
"""Relative: a response is written with nine."""
ROUNDING_DEG = 1e-9
"""Of a phase of 3000 deg, unwound. Measured: 9e-13."""
BESIDE_NOISE = 0.02
"""Relative: what 3 N of noise on a thousand samples and broken turns leave of a sine of 10 N. Measured: 5e-3."""

US, SI = UnitSystem.US, UnitSystem.SI


def said(found, units=US):
    conclusions = identification_conclusions(found, units)
    return conclusions, "\n".join(conclusions.findings)


@pytest.mark.parametrize(
    ("value", "deviation", "digits"),
    [
        (6108.0, 27.0, 4),  # 6108 +- 27
        (6108.0, 270.0, 3),  # 6110 +- 270
        (6108.0, 2700.0, 3),
        (6108.0, 0.27, 4),  # never more than four in words
        (0.0123, 0.0004, 3),  # 0.0123 +- 0.0004: two digits of the error end where three of the value do, or after
        (-6108.0, 27.0, 4),
        (6108.0, 0.0, 4),
        (6108.0, inf, 4),
        (0.0, 1.0, 4),
    ],
)
def test_digits_follow_the_standard_error(value, deviation, digits):
    found = digits_of(value, deviation)
    assert found in {3, 4}
    assert found == digits or (deviation == 0.0004 and found == 4)


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(6.0495, 4, "6.050"), (5375.4, 4, "5375"), (0.0598, 2, "0.060"), (9.996, 3, "10.0"), (-8.0, 3, "-8.00")],
)
def test_trailing_zeros_are_significant_digits(value, digits, text):
    assert rounded(value, digits) == text


def test_interval_has_the_decimals_of_its_error():
    one = estimate(loader(), "k", -0.12, 0.004)
    # k = 6107.86 lb/in as printed in the report; 0.88 k -+ 1.98 0.004 k, and 0.004 k = 24: no decimals.
    assert interval(one, US) == f"{6107.86 * (0.88 - 1.98 * 0.004):.0f} to {6107.86 * (0.88 + 1.98 * 0.004):.0f}"
    assert estimated(one, one.value, US) == "5375"
    # In N/cm: 1.751268 times as much, so 0.004 k = 43.
    assert interval(one, SI) == "9328 to 9498"


@pytest.mark.parametrize(
    ("share", "text"), [(0.0123, "1.2 %"), (0.09, "9.0 %"), (1.05, "105 %"), (inf, "infinitely many %")]
)
def test_shares_have_two_digits(share, text):
    assert percent(share) == text


def test_verdict_names_the_best_and_worst_known_parameters():
    conclusions, _ = said(determined())
    assert conclusions.ok
    # Standard errors of the file's value are given as 0.4 % and 9 %; of the estimates they are 0.004 / 0.88 and 0.09 / 1.001.
    assert conclusions.verdict == (
        "All 5 parameters are determined: their standard errors are from 0.45 % (linkage.stiffness) to 9.0 % "
        "(column.viscous_friction)."
    )


def test_verdict_names_parameters_at_a_bound():
    conclusions, _ = said(bounded())
    assert not conclusions.ok
    assert conclusions.verdict.startswith(
        "All 5 parameters are determined, but column.inertia ended at its bound: their "
    )
    assert conclusions.verdict.endswith(" No loader file is written.")


def test_verdict_states_the_value_of_a_single_parameter():
    found = determined()
    one = dataclasses.replace(
        found, estimates=found.estimates[:1], correlation=np.eye(1), ends=ends(found.estimates[:1])
    )
    assert said(one)[0].verdict == "linkage.stiffness is determined: 5375 lb/in with a standard error of 24 lb/in."


def test_findings_compare_each_change_with_its_tolerance():
    _, text = said(determined())
    assert (
        "linkage.stiffness lies 12 % below the file's value, 5375 lb/in instead of 6108; its tolerance allows -20 % to +20 %."
        in text
    )
    # 0.11 of the file's value, whose normal tolerance has a deviation of 0.05 of it.
    assert "valve.current_gain lies 11 % above the file's value" in text
    assert "that is 2.2 standard deviations of its tolerance" in text
    assert "column.viscous_friction agrees with the file, whose value lies within its 95 % interval." in text


def test_missing_tolerance_is_reported():
    given = loader()
    one = estimate(given, "B_c", 0.5, 0.01)
    found = dataclasses.replace(determined(), estimates=(one,), correlation=np.eye(1), ends=ends((one,)))
    assert "column.viscous_friction lies 50 % above the file's value" in said(found)[1]
    assert "the file states no tolerance for it" in said(found)[1]


def test_bound_finding_has_a_remedy():
    text = said(bounded())[1]
    assert "column.inertia ended at its upper bound" in text
    assert "(+20 %): the data require a larger value. The bound is the file's tolerance: widen or remove it" in text


def test_range_end_is_reported_as_another_bound():
    given = loader()
    one = estimate(given, "B_c", 0.0, 0.01)
    at_end = dataclasses.replace(one, value=one.unknown.low, status=Status.AT_BOUND)
    found = dataclasses.replace(determined(), estimates=(at_end,), correlation=np.eye(1), ends=ends((at_end,)))
    text = said(found)[1]
    assert "ended at its lower bound" in text
    assert "require a smaller value" in text
    assert "the units and the experiment of the data" in text


def test_correlated_pair_is_reported_once():
    found = determined()
    assert strong_pairs(found) == [("linkage.stiffness", "linkage.damping", 0.97)]
    assert (
        "linkage.stiffness and linkage.damping are correlated: when one rises the other rises (correlation 0.97)"
        in said(found)[1]
    )
    falling = dataclasses.replace(found, correlation=found.correlation * (2 * np.eye(5) - 1))
    assert "when one rises the other falls (correlation -0.97)" in said(falling)[1]


def test_undefined_correlations_are_not_reported():
    assert strong_pairs(undetermined()) == []


def test_influential_prior_is_reported():
    text = said(determined())[1]
    # From the data alone 6 %, with the prior 1.98 0.011 / 1.11.
    assert (
        "valve.current_gain depends on the loader file's prior: from the data alone its 95 % interval is ±6.0 % in place of ±2.0 %"
        in text
    )
    assert "linkage.stiffness depends on" not in text


def test_need_for_link_compliance_is_reported():
    assert "The link's compliance is needed: a rigid link leaves an error of 34 %" in said(determined())[1]
    assert "F(2, 116) = 66000, p < 1e-16" in said(determined())[1]
    idle = dataclasses.replace(NEEDED, needed=False, rigid_rms=0.0102, f_statistic=0.8, probability=0.452)
    text = said(dataclasses.replace(determined(), rigid=idle))[1]
    assert "is not needed to explain these data: a rigid link leaves an error of 1.0 %" in text
    assert "F(2, 116) = 0.8, p = 0.45." in text
    assert "compliance" not in said(dataclasses.replace(determined(), rigid=None))[1]
    assert probability_text(dataclasses.replace(NEEDED, probability=0.02)) == "p = 0.02"


def test_agreement_of_starts_is_reported():
    found = determined()
    assert "All 3 starts of the search ended in the same minimum." in said(found)[1]
    astray = dataclasses.replace(found, ends=ends(found.estimates, (True, False, True)))
    assert "2 of 3 starts of the search ended in the same, best minimum" in said(astray)[1]
    assert "with 1.5 times the residual" in said(astray)[1]
    rival = dataclasses.replace(
        astray, ends=(*found.ends[:1], dataclasses.replace(astray.ends[1], cost=found.ends[0].cost + 0.03))
    )
    assert "another minimum explains the data about as well" in said(rival)[1]
    assert "Both starts of" in said(dataclasses.replace(found, ends=found.ends[:2]))[1]
    once = dataclasses.replace(found, ends=found.ends[:1])
    assert "started only once" in said(once)[1]


def test_model_error_is_distinguished_from_noise():
    good = response_fitted(stated=0.01, left=0.01)
    bad = response_fitted(stated=0.01, left=0.05)
    unknown = response_fitted(stated=None, left=0.05)
    texts = [said(dataclasses.replace(determined(), fitted=(one,)))[1] for one in (good, bad, unknown)]
    assert ["error of the model" in text for text in texts] == [False, True, False]
    assert "the noise of the data is 1.0 %" in texts[1]
    cells = [
        data_table(dataclasses.replace(determined(), fitted=(one,)), US).rows[0][5].kind for one in (good, bad, unknown)
    ]
    assert ["bad" in kind for kind in cells] == [False, True, False]


def test_verdict_rejects_a_model_that_misses_the_data():
    far = response_fitted(stated=None, left=0.4)
    conclusions, _ = said(dataclasses.replace(determined(), fitted=(*record_fitted(), far), loader=None))
    assert not conclusions.ok
    assert "But do not rely on them: the model misses closed, column angle over test signal by" in conclusions.verdict
    lost, _ = said(dataclasses.replace(undetermined(), fitted=(far,)))
    assert "No loader file is written. Besides, the model misses closed" in lost.verdict
    force = record_fitted()[1]
    # Its noise is a quarter of how far the force swings, but noise; 10 N that come and go are not.
    assert force.residual_rms > UNEXPLAINED * force.measured.std()
    assert said(dataclasses.replace(determined(), fitted=(force,)))[0].ok
    swinging = dataclasses.replace(force, modeled=force.modeled + 10 * np.sin(20 * force.at))
    assert unexplained(swinging) == pytest.approx(10 / np.sqrt(2) / force.measured.std(), rel=BESIDE_NOISE)
    conclusions, text = said(dataclasses.replace(determined(), fitted=(swinging,), loader=None), SI)
    assert not conclusions.ok
    # 10 N of a sine are 7.1 N over whole turns; the noise is 3 N.
    assert "release, load cell force: the model's error is 7.0 N beside a noise of 3.0 N" in text
    assert "run on" not in said(dataclasses.replace(determined(), fitted=(force,)))[1]


def test_correlated_parameters_are_not_reliable_under_model_error():
    bad = response_fitted(stated=0.01, left=0.05)
    loose = correlation(5)
    loose[0, 1] = loose[1, 0] = 0.9996
    found = dataclasses.replace(determined(), correlation=loose)
    assert "far larger than the standard errors" not in said(found)[0].verdict
    assert (
        "far larger than the standard errors" not in said(dataclasses.replace(determined(), fitted=(bad,)))[0].verdict
    )
    verdict = said(dataclasses.replace(found, fitted=(bad,)))[0].verdict
    assert (
        "But the model misses more than noise, and the data hardly separate linkage.stiffness from linkage.damping"
        in verdict
    )
    assert "(correlation beyond 0.999)" in verdict


def test_effects_omitted_by_linear_model_are_reported_for_responses():
    sentence = "which neglects column.viscous_friction; records are compared with the full model"
    assert sentence in said(determined())[1]
    assert sentence not in said(dataclasses.replace(determined(), fitted=record_fitted()))[1]
    assert "neglects" not in said(undetermined())[1]
    digital = dataclasses.replace(determined(), before=ff.digital_elevator())
    assert "the sampled linear model, which neglects friction" in said(digital)[1]


def test_correlation_is_never_shown_as_unity():
    assert correlation_text(0.97) == "0.97"
    assert correlation_text(-0.99961) == "beyond -0.999"


def test_record_residual_has_the_unit_of_its_channel():
    text = said(dataclasses.replace(determined(), fitted=record_fitted()))[1]
    # 3 N of noise are 0.67 lb.
    assert "release, load cell force: 0.67 lb" in text
    assert "release, load cell force: 3.0 N" in said(dataclasses.replace(determined(), fitted=record_fitted()), SI)[1]


def test_undetermined_parameters_come_first():
    conclusions, text = said(undetermined())
    assert not conclusions.ok
    assert conclusions.verdict == (
        "2 of 3 parameters are not determined by these data: valve.current_gain and amplifier.admittance. "
        "No loader file is written."
    )
    first, second = text.split("\n")[:2]
    assert first == "The data cannot tell C_i from K_2: only their product C_i K_2 is determined."
    assert second.startswith("Measure the response")
    assert text.count("not judged") == 1


@pytest.mark.parametrize("units", [US, SI])
def test_value_of_an_undetermined_parameter_is_not_shown(units):
    found = undetermined()
    text = said(found, units)[1]
    table = estimates_table(found, units)
    cells = " ".join(str(cell.text) for row in table.rows for cell in row)
    stored = json.dumps(identification_json(found, units, FitSettings()))
    assert secrets_in(text) == secrets_in(cells) == secrets_in(stored) == []
    assert [row[3].text == "not determined" for row in table.rows] == [True, True, False]


def test_search_for_hidden_values_finds_shown_values():
    """The search for secrets finds the values where they are determined."""
    found = undetermined()
    known = [dataclasses.replace(one, status=Status.DETERMINED) for one in found.estimates]
    table = estimates_table(dataclasses.replace(found, estimates=tuple(known)), SI)
    assert len(secrets_in(" ".join(str(cell.text) for row in table.rows for cell in row))) == 2


@pytest.mark.parametrize("make", [determined, undetermined])
@pytest.mark.parametrize("units", [US, SI])
def test_results_are_json_without_nan(make, units):
    stored = identification_json(make(), units, FitSettings())
    assert json.loads(json.dumps(stored, allow_nan=False)) == stored


def test_results_match_the_findings():
    found = determined()
    stored = identification_json(found, US, FitSettings(loss="linear", starts=3))
    assert stored["settings"] == {
        "loss": "linear",
        "starts": 3,
        "priors": True,
        "as_responses": False,
        "law": "original",
    }
    k = stored["parameters"][0]
    assert (k["parameter"], k["symbol"], k["status"]) == ("linkage.stiffness", "k", "determined")
    assert k["estimate"]["unit"] == "lb/in"
    # 6107.86 lb/in is printed in the report's appendix with six digits.
    assert k["estimate"]["value"] == pytest.approx(0.88 * 6107.86, rel=ROUNDING)
    assert k["standard_error"]["value"] == pytest.approx(0.004 * 6107.86, rel=ROUNDING)
    assert k["prior"] is None
    assert stored["parameters"][2]["prior"]["deviation"]["value"] == pytest.approx(0.05 * 5.45, rel=ROUNDING)
    assert stored["correlation"][0][1] == 0.97
    assert [one["sha256"][:2] for one in stored["data"]] == ["ab", "cd"]
    assert [channel["channel"] for channel in stored["data"][1]["channels"]] == ["column_angle", "load_cell_force"]
    assert stored["rigid_link"]["degrees"] == [2, 116]
    assert stored["after"]["values"]["linkage.stiffness"] == k["estimate"]
    assert stored["before"]["values"]["linkage.stiffness"] == k["file"]


def test_results_without_solution_state_it():
    stored = identification_json(undetermined(), US, FitSettings())
    assert stored["after"] is None
    assert not stored["determined"]
    assert [one["estimate"] for one in stored["parameters"][:2]] == ["not determined", "not determined"]
    assert stored["parameters"][0]["half_interval_without_prior"] == "infinite"
    assert stored["starts"][0]["end"]["valve.current_gain"] == "not determined"
    assert stored["correlation"][0][1] == "undefined"
    assert stored["inseparable"][0]["weights"] == [1.0, -1.0]
    assert stored["advice"][0]["half_intervals"]["amplifier.admittance"] == 0.009


@pytest.mark.parametrize("units", [US, SI])
@pytest.mark.parametrize("known", [True, False])
def test_exported_response_reads_back(tmp_path, units, known):
    data = response_fitted(stated=0.01 if known else None, coherent=known).data
    file = tmp_path / "closed.csv"
    file.write_text(response_csv(data, units))
    back = read_response(file)
    assert (back.experiment, back.input, back.output) == (data.experiment, data.input, data.output)
    # The table has nine significant digits; of a phase of 180 deg that is 2e-9 rad, of a gain of 40 dB 1e-8.
    np.testing.assert_allclose(back.value, data.value, rtol=3e-8)
    np.testing.assert_allclose(back.frequency_hz, data.frequency_hz, rtol=NINE_DIGITS)
    if known:
        np.testing.assert_allclose(back.coherence, data.coherence, rtol=NINE_DIGITS)
        np.testing.assert_allclose(back.deviation, data.deviation, rtol=NINE_DIGITS)
    else:
        assert back.coherence is None
        assert back.deviation is None


def test_plots_of_long_records_keep_extremes():
    values = record_fitted()[0].measured
    kept = drawn(values, MOST_POINTS)
    assert len(kept) <= MOST_POINTS + 2
    assert SPIKE in kept
    assert {0, len(values) - 1} <= set(kept.tolist())
    assert values[kept].min() == values.min()
    assert values[kept].max() == values.max()
    assert (np.diff(kept) > 0).all()


@pytest.mark.parametrize("count", [2, MOST_POINTS, MOST_POINTS + 1, 2 * MOST_POINTS - 1])
def test_record_of_any_length_can_be_drawn(count):
    values = np.random.default_rng(5).standard_normal(count)
    kept = drawn(values, MOST_POINTS)
    assert len(kept) == count if count <= MOST_POINTS else len(kept) <= MOST_POINTS + 2
    assert values[kept].max() == values.max()


def test_plotted_phase_does_not_jump():
    """A delay of 0.1 s turns through 18 half turns over 90 Hz; measured noise crosses +-180 deg all the time."""
    one = response_fitted()
    random = np.random.default_rng(8)
    frequency = np.linspace(1, 91, 400)
    modeled = np.exp(-2j * np.pi * frequency * 0.1)
    measured = modeled * np.exp(0.2j * random.standard_normal(400))
    found = phases(dataclasses.replace(one, at=frequency, modeled=modeled, measured=measured, before=modeled))
    # 0.6 deg to the next line of 400 would be 8.1 deg; the noise has 11 deg.
    assert np.abs(np.diff(found["fitted"])).max() < 9
    assert np.abs(found["measured"] - found["fitted"]).max() < 60
    np.testing.assert_allclose(found["fitted"], -360 * 0.1 * (frequency - 1) - 36, atol=ROUNDING_DEG)


def test_findings_have_rounded_numbers():
    for make in (determined, undetermined):
        for units in (US, SI):
            conclusions, text = said(make(), units)
            assert not re.search(r"\d\.\d{6}|\d{8}", f"{conclusions.verdict} {text}")
