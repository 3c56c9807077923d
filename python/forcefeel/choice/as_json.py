"""Methods that were tried, for machines: every number with its unit, and the law that is taken."""

from importlib.metadata import version

from forcefeel._core import Compensator
from forcefeel.choice.findings import choice_conclusions, design_conclusions
from forcefeel.choice.noise import HOLDING
from forcefeel.choice.rule import CLOSE, LEAST_GAIN, LEAST_PERIODS, LEAST_PHASE_RAD, Choice
from forcefeel.choice.score import Score, Scored
from forcefeel.envelope.as_json import plain_deviations, plain_grid
from forcefeel.json_values import Plain, plain, quantity
from forcefeel.laws.sampled_compensator import SampledCompensator
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import ANGLE, SECONDS, UnitSystem


def plain_choice(scored: Scored, choice: Choice | None, units: UnitSystem) -> dict[str, Plain]:
    """What was tried, what is taken, and why.

    Args:
        scored: The methods.
        choice: The choice; ``None`` for one method that was asked for by name.
        units: Of every number but those of the law, which are SI.
    """
    plan, loader = scored.plan, scored.plan.loader
    conclusions = design_conclusions(scored, units) if choice is None else choice_conclusions(scored, choice, units)
    taken = scored.scores[0].name if choice is None else choice.chosen
    found: dict[str, Plain] = {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": loader.name,
        "setting": {key.partition(".")[2]: quantity(loader[key], unit(TABLE[key]), units) for key in FEEL_SETTING},
        "rule": {"edition": plan.rule, "title": plan.rules.title, "verified": plan.rule_verified},
        "release_angle": quantity(plan.release_rad, ANGLE, units),
        "left_out": list(plan.left_out),
        "conclusions": plain(conclusions, units),
        "chosen": taken,
        "methods": {score.name: _score(score, units) for score in scored.scores},
    }
    if any(score.over for score in scored.scores):
        found["grid"] = plain_grid(plan.settings, units)
        found["tolerances"] = plain_deviations(plan.deviations)
    if scored.sampled:
        found["arm_that_holds_the_grip"] = HOLDING.name
    if choice is not None:
        found["rule_of_choice"] = {
            "least_gain_margin": LEAST_GAIN,
            "least_phase_margin": quantity(LEAST_PHASE_RAD, ANGLE, units),
            "least_delay_margin": quantity(LEAST_PERIODS * loader["controller.period"], SECONDS, units),
            "level_within": CLOSE,
        }
    for score in scored.scores:
        if score.name == taken:
            found["law"] = plain_law(score.own.law)
    return found


def plain_law(law: Compensator | SampledCompensator | None) -> Plain:
    """A law's numbers in SI units; ``None`` for the original loop."""
    if law is None:
        return None
    if isinstance(law, Compensator):
        return {
            "gains": list(law.gains),
            "load_cell_arm": law.load_cell_arm,
            "displacement_unit": law.displacement_unit,
        }
    matrices = {name: getattr(law, name)[0].tolist() for name in ("transition", "input", "command", "torque")}
    return {"period_s": law.period_s, "delay_s": law.delay_s, **matrices}


def _score(score: Score, units: UnitSystem) -> dict[str, Plain]:
    own, over = score.own, score.over
    found: dict[str, Plain] = {
        "summary": score.summary,
        "own_setting": {
            "stable": own.stable,
            "release": own.outcome,
            "margins": plain(own.margins, units),
            "demand": plain(own.demand, units),
            "noise_rms": plain(own.noise, units),
            "modes": plain(own.modes, units),
        },
    }
    if over is not None:
        found["envelope"] = {
            "shares": plain(over.shares, units),
            "lost_most": plain(over.lost_most, units),
            "largest_demand": plain(over.demand, units),
            "least_margins": plain(over.margins, units),
        }
    return found
