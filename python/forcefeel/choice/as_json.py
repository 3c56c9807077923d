"""Comparison of laws as JSON: every number with its unit, and the chosen law."""

from importlib.metadata import version

from forcefeel.choice.findings import choice_conclusions, design_conclusions
from forcefeel.choice.noise import HOLDING
from forcefeel.choice.rule import CLOSE, LEAST_GAIN, LEAST_PERIODS, LEAST_PHASE_RAD, Choice
from forcefeel.choice.score import LawScores, Score
from forcefeel.envelope.as_json import deviations_json, grid_json
from forcefeel.json_values import json_value
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import NUMBERS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import ANGLE, SECONDS, Json, UnitSystem, quantity


def choice_json(scored: LawScores, choice: Choice | None, units: UnitSystem) -> dict[str, Json]:
    """Scores of all laws, the choice, ``None`` for one law requested by name, and its reasons; the numbers of the law are SI."""
    plan, loader = scored.plan, scored.plan.loader
    conclusions = design_conclusions(scored, units) if choice is None else choice_conclusions(scored, choice, units)
    taken = scored.scores[0].name if choice is None else choice.chosen
    report: dict[str, Json] = {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": loader.name,
        "setting": {key.partition(".")[2]: quantity(loader[key], unit(TABLE[key]), units) for key in FEEL_SETTING},
        "rule": {"edition": plan.rule, "title": plan.rules.title, "verified": plan.rule_verified},
        "release_angle": quantity(plan.release_rad, ANGLE, units),
        "omitted": list(plan.omitted),
        "conclusions": json_value(conclusions, units),
        "chosen": taken,
        "laws": {score.name: _score(score, units) for score in scored.scores},
    }
    if any(score.over for score in scored.scores):
        report["grid"] = grid_json(plan.settings, units)
        report["tolerances"] = deviations_json(plan.deviations)
    if scored.sampled:
        report["arm_that_holds_the_grip"] = HOLDING.name
    if choice is not None:
        report["rule_of_choice"] = {
            "least_gain_margin": LEAST_GAIN,
            "least_phase_margin": quantity(LEAST_PHASE_RAD, ANGLE, units),
            "least_delay_margin": quantity(LEAST_PERIODS * loader["controller.period"], SECONDS, units),
            "level_within": CLOSE,
        }
    for score in scored.scores:
        if score.name == taken:
            report["law"] = law_json(score.own.law)
    return report


def law_json(law: Law) -> Json:
    """Numbers of a law of one setting in SI units; ``None`` for the original loop."""
    if law.sampled is None:
        return law.numbers.as_json() or None
    matrices = {name: getattr(law.sampled, name)[0].tolist() for name in NUMBERS}
    return {"period_s": law.sampled.period_s, "delay_s": law.sampled.delay_s, **matrices}


def _score(score: Score, units: UnitSystem) -> dict[str, Json]:
    own, over = score.own, score.over
    report: dict[str, Json] = {
        "summary": score.summary,
        "own_setting": {
            "stable": own.stable,
            "release": own.outcome,
            "margins": json_value(own.margins, units),
            "demand": json_value(own.demand, units),
            "noise_rms": json_value(own.noise, units),
            "modes": json_value(own.modes, units),
        },
    }
    if over is not None:
        report["envelope"] = {
            "shares": json_value(over.shares, units),
            "worst_case": json_value(over.worst_case, units),
            "quiet_in_contact": over.quiet,
            "largest_demand": json_value(over.demand, units),
            "minimum_margins": json_value(over.margins, units),
        }
    return report
