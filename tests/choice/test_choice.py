"""Choosing a method: the scores, the rule on scores made up for it, and what is said."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.choice import LawScores, Score, choose, score_laws
from forcefeel.choice.as_json import choice_json
from forcefeel.choice.demand import Demand, largest_demand, limits
from forcefeel.choice.findings import choice_conclusions, design_conclusions
from forcefeel.choice.noise import Noise
from forcefeel.choice.own_setting import own_setting
from forcefeel.choice.score import OverEnvelope, check_names
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.result import Shares
from forcefeel.laws.law import Law, names_for
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops.margins import LoopMargins
from forcefeel.simulation import Scenario, simulate
from forcefeel.units import UnitSystem

GRID = {"stiffness": "3, 100 %", "frequency": "2, 4 Hz", "damping": "0.3, 1"}
FEW = {"changes": {"linkage.stiffness": 0.2}, "arms": ()}
DIGITAL = ff.digital_elevator()


@pytest.fixture(scope="module")
def scored():
    return score_laws(DIGITAL, ("published", "observer", "robust"), GRID, **FEW)


@pytest.mark.slow
def test_shares_match_the_envelope(scored):
    names = [score.name for score in scored.scores]
    found = ff.find_envelope(DIGITAL, names, GRID, **FEW)
    assert [score.over.shares for score in scored.scores] == [found.shares(name) for name in names]


def test_release_at_the_default_setting_matches_simulation(scored):
    own = scored.scores[1].own
    scenario = Scenario(ff.Release(scored.plan.release_rad), duration_s=1.0, step_s=5e-4)
    run = simulate(DIGITAL, scenario, own.law)
    times, angles = run.history["time_s"].values, run.history["column_angle_rad"].values
    assert (
        np.interp([0.1, 0.3, 0.9], own.release.time_s, own.release.angle_rad)
        == pytest.approx(
            np.interp([0.1, 0.3, 0.9], times, angles),
            abs=1e-5,  # rad; records hold another number of samples, so noise of the sensors falls alike but in another stream
        )
    )
    ideal = ff.linear.ideal_feel(DIGITAL)
    poles = sorted(ideal.poles(), key=lambda pole: pole.imag)
    w, zeta = abs(poles[0]), -poles[0].real / abs(poles[0])
    mode = min(own.modes, key=lambda one: abs(one.frequency_rad_per_s - w))
    assert (mode.frequency_rad_per_s, mode.damping_ratio) == pytest.approx(
        (w, zeta), rel=0.01
    )  # what the observer renders


def test_peak_demand_matches_simulation():
    loader = ff.elevator()
    feel = np.array([[loader[key] for key in FEEL_SETTING]])
    law = Law("original")
    angle = np.radians(10)
    found = largest_demand(loader, law, feel, angle)
    peaks = simulate(loader, Scenario(ff.Release(angle), 1.0)).measures
    expected = np.array([peaks.peak_current_a, peaks.peak_flow_m3_per_s, peaks.peak_pressure_pa]) / limits(loader)
    shares = [found.current, found.flow, found.pressure]
    assert shares == pytest.approx(expected, rel=0.02)  # one is stepped, the other exact at its samples


def test_demand_limits_are_those_of_amplifier_and_spool():
    limited = ff.elevator().replace({"amplifier.current_limit": "8 mA", "valve.flow_limit": "50 in^3/s"})
    free = ff.elevator()
    assert limits(limited)[:2] == pytest.approx(limits(free)[:2] * [8 / 15, 0.5])
    assert limits(free)[2] == free["valve.supply_pressure"]


def test_every_applicable_law_is_evaluated():
    scored = score_laws(ff.elevator(), grid=GRID, changes={}, arms=())
    assert [score.name for score in scored.scores] == list(names_for(ff.elevator()))
    assert all(score.own.noise is None for score in scored.scores)


@pytest.mark.parametrize("name", ["observer", "robust"])
def test_analog_loader_error_states_requirements(name):
    with pytest.raises(ff.InputError, match=r"controller\.period.*elevator-2khz.*original, published, converged"):
        check_names(ff.elevator(), (name,))


def test_unknown_law_name_raises_input_error():
    with pytest.raises(ff.InputError, match=r"expected original.*got 'best'"):
        score_laws(DIGITAL, ("best",))


# The rule, on scores that are made up for it.

GOOD = LoopMargins(3.0, 0.0, np.radians(45), 2e-3, 0.8, 100.0)
QUIET = Noise(1e-5, 0.1)


def _score(name, worst, nominal, *, stable=1.0, margins=GOOD, noise=QUIET, own_stable=True, quiet=1.0):  # noqa: PLR0913
    own = SimpleNamespace(stable=own_stable, margins=margins, noise=noise)
    over = OverEnvelope(Shares(name, stable, nominal, worst, worst), None, quiet, 96, Demand(0.5, 0.5, 0.5), margins)
    return Score(name, "", own, over)


def _chosen(*scores, period_s=5e-4):
    loader = {"controller.period": period_s}
    return choose(LawScores(SimpleNamespace(loader=loader), scores))


def test_ranking_is_worst_case_then_nominal_share_then_noise():
    a, b = _score("a", 0.6, 0.99), _score("b", 0.7, 0.8)
    assert _chosen(a, b).chosen == "b"
    level = _score("c", 0.695, 0.9)
    assert _chosen(a, b, level).chosen == "c"
    quiet = _score("d", 0.7, 0.895, noise=Noise(1e-6, 0.1))
    assert _chosen(a, b, level, quiet).chosen == "d"
    assert _chosen(quiet, level, b, a).chosen == "d"


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ({"own_stable": False}, "unstable at the loader's own setting"),
        ({"stable": 0.95}, "stable at only 95 %"),
        ({"quiet": 0.85}, "only 85 % of the settings are quiet in contact"),
        ({"margins": replace(GOOD, gain_up=1.9)}, "to 1.9"),
        ({"margins": replace(GOOD, gain_down=0.6)}, "only 0.6 to"),
        ({"margins": replace(GOOD, phase_rad=np.radians(29))}, "29 deg"),
        ({"margins": replace(GOOD, delay_s=4e-4)}, "delay margin is 0.4 ms, less than a period of 0.5 ms"),
    ],
)
def test_ineligible_law_is_not_chosen_and_has_a_reason(wrong, why):
    best, other = _score("best", 0.9, 0.9, **wrong), _score("other", 0.2, 0.3)
    found = _chosen(best, other)
    assert found.chosen == "other"
    remark = next(one for one in found.remarks if one.name == "best")
    assert not remark.eligible
    assert why in remark.sentence
    assert _chosen(best).chosen is None


def test_law_that_renders_nothing_is_not_chosen():
    found = _chosen(_score("none", 0.0, 0.0))
    assert found.chosen is None
    assert "renders none of the settings" in found.remarks[0].sentence


def test_analog_loader_has_no_delay_margin_requirement():
    late = _score("late", 0.5, 0.5, margins=replace(GOOD, delay_s=1e-5), noise=None)
    assert _chosen(late, period_s=0.0).chosen == "late"


def test_each_law_has_one_remark_and_the_chosen_law_is_first():
    found = _chosen(_score("a", 0.6, 0.99), _score("b", 0.7, 0.8), _score("c", 0.1, 0.1, stable=0.5))
    assert [remark.name for remark in found.remarks] == ["b", "a", "c"]
    assert "60 % in every case, b 70 %; it has more with the nominal plant (99 %)" in found.remarks[1].sentence


def test_tied_laws_state_the_deciding_criterion():
    loud = _score("loud", 0.7, 0.9, noise=Noise(3e-5, 0.1))
    found = _chosen(loud, _score("quiet", 0.7, 0.9))
    assert found.chosen == "quiet"
    assert "more noise at the grip" in found.remarks[1].sentence


# What is said.


def test_conclusions_name_the_chosen_law_and_all_others(scored):
    choice = choose(scored)
    said = choice_conclusions(scored, choice, UnitSystem.US)
    assert said.ok
    assert said.verdict.startswith(f"Use {choice.chosen}. ")
    for score in scored.scores:
        assert any(score.name in line.lower() for line in (said.verdict, *said.findings))
    # Whether a law qualifies is what `qualify` finds by the whole programme; a choice does not claim it.
    assert not any("qualif" in line for line in (said.verdict, *said.findings))


def test_conclusions_state_that_the_loader_is_analog():
    found = score_laws(ff.elevator(), ("published",), over_envelope=False)
    said = design_conclusions(found, UnitSystem.SI)
    assert said.ok
    assert any("analog" in line and "elevator-2khz" in line and "controller.period" in line for line in said.findings)


def test_unstable_law_is_rejected():
    soft = ff.elevator().replace({"feel.inertia": 0.06, "feel.damping": 0.3, "feel.stiffness": 10.0}, si=True)
    found = score_laws(soft, ("published",), over_envelope=False)
    said = design_conclusions(found, UnitSystem.SI)
    assert (said.ok, found.scores[0].own.outcome) == (False, "unstable")
    assert "unstable" in said.verdict
    json.dumps(choice_json(found, None, UnitSystem.SI), allow_nan=False)


def test_results_contain_the_chosen_law(scored):
    choice = choose(scored)
    stored = json.loads(json.dumps(choice_json(scored, choice, UnitSystem.SI), allow_nan=False))
    law = next(score for score in scored.scores if score.name == choice.chosen).own.law.sampled
    assert stored["chosen"] == choice.chosen
    np.testing.assert_array_equal(stored["law"]["command"], law.command[0])
    assert stored["laws"]["robust"]["envelope"]["shares"]["nominal_share"]["unit"] == "%"


def test_conclusions_are_for_the_loader_of_the_plan():
    """Optional rows of the feel are left out, and said so."""
    loader = DIGITAL.replace({"feel.breakout": "4 lb"})
    found = score_laws(loader, ("robust",), over_envelope=False)
    assert found.plan.omitted == ("feel.breakout",)
    assert any("feel.breakout" in line for line in design_conclusions(found, UnitSystem.US).findings)
    bare = own_setting(make_plan(DIGITAL, ("robust",), GRID), found.plan.laws["robust"], 1)
    assert found.scores[0].own.margins == bare.margins


def test_of_few_settings_two_may_swing_on_in_contact():
    few = [_score("a", 0.5, 0.5, quiet=1 - swings / 18) for swings in (2, 3)]
    two, three = (replace(score, over=replace(score.over, settings=18)) for score in few)
    assert _chosen(two).chosen == "a"
    assert _chosen(three).chosen is None


def test_robust_is_eligible_for_a_column_that_rubs():
    """Short of the stop such a column hunts, which once counted as a swing in contact: no law was eligible."""
    lag = {f"{sensor}.bandwidth": "500 Hz" for sensor in ("load_cell", "potentiometer", "column_sensor")}
    rubs = dict.fromkeys(("column.coulomb_friction", "column.static_friction"), "2.7 lb")
    grid = {"stiffness": "2.5, 6.3, 16, 100 %", "frequency": "0.5, 1, 2, 4 Hz", "damping": "0.1, 0.3, 0.7"}
    scored = ff.choice.score_laws(ff.digital_elevator().replace(lag | rubs), ("robust",), grid, changes={}, arms=())
    assert ff.choice.choose(scored).chosen == "robust"
