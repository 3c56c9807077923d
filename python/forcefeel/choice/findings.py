"""Conclusions from a comparison of laws, in sentences."""

from math import degrees, inf, isfinite

from forcefeel.choice.demand import demand_shares
from forcefeel.choice.noise import HOLDING, Noise
from forcefeel.choice.rule import Choice, obstacles
from forcefeel.choice.score import LawScores, OverEnvelope, Score
from forcefeel.conclusions import Conclusions, capital, of_result, share_text
from forcefeel.envelope.result import PASSES
from forcefeel.envelope.tolerance_sentences import silent_sentences, tolerance_sentences
from forcefeel.linear.modes import feel_mode
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops.margins import LoopMargins
from forcefeel.sizing.too_small import too_small_text
from forcefeel.units import ANGLE, FORCE, HERTZ, UnitSystem, to_text


@of_result
def choice_conclusions(scored: LawScores, choice: Choice, units: UnitSystem) -> Conclusions:
    """The choice, its reasons, and its limits; ``ok`` if a law is eligible."""
    lines = [remark.sentence for remark in choice.remarks if remark.name != choice.chosen]
    if choice.chosen is None:
        among = f"None of the {len(scored.scores)} laws is eligible for {scored.plan.loader.name}."
        return Conclusions(False, among, (*_too_small(scored, units), *lines, *_caveats(scored)))
    best = next(score for score in scored.scores if score.name == choice.chosen)
    verdict = f"Use {best.name}. {choice.remarks[0].sentence}"
    return Conclusions(
        True, verdict, (*_about(scored, best, units), *_too_small(scored, units), *lines, *_caveats(scored))
    )


def _too_small(scored: LawScores, units: UnitSystem) -> tuple[str, ...]:
    """That the motor does not give what is programmed, and what would; nothing where it does."""
    text = too_small_text(scored.plan.given, units, scored.plan.release_rad)
    return (text,) if text else ()


@of_result
def design_conclusions(scored: LawScores, units: UnitSystem) -> Conclusions:
    """Conclusions on one law; ``ok`` if it is stable at the loader's own setting."""
    score = scored.scores[0]
    own, name = score.own, capital(score.name)
    where = "at the loader's own setting"
    if not own.stable:
        return Conclusions(False, f"{name} is unstable {where}.", (*_too_small(scored, units), *_caveats(scored)))
    test = scored.plan.rules.title
    outcome = (
        f"passes the release test of {test}"
        if own.outcome == PASSES
        else f"fails the release test of {test} by {own.outcome}"
    )
    lines = [*_about(scored, score, units)]
    if wrong := obstacles(score, scored.plan.loader["controller.period"]):
        lines.append(f"It is not eligible in a comparison: {'; '.join(wrong)}.")
    return Conclusions(
        True, f"{name} is stable {where} and {outcome}.", (*_too_small(scored, units), *lines, *_caveats(scored))
    )


def margins_text(margins: LoopMargins) -> str:
    """The margins as part of a sentence."""
    up = "without limit" if margins.gain_up == inf else f"{to_text(margins.gain_up, 3)} times"
    down = "0" if margins.gain_down == 0 else share_text(margins.gain_down)
    delay = "without limit" if margins.delay_s == inf else f"{to_text(1e3 * margins.delay_s, 3)} ms"
    phase = "without limit" if margins.phase_rad == inf else f"{to_text(degrees(margins.phase_rad), 3)} deg"
    return f"gain up {up}, gain down to {down}, phase {phase}, delay {delay}"


def _about(scored: LawScores, score: Score, units: UnitSystem) -> list[str]:
    own = score.own
    lines = [f"Margins at the loader's own setting, each by itself: {margins_text(own.margins)}."]
    if score.over is not None:
        lines += _elsewhere(score.over)
    lines += _rendered(scored, score)
    *most, last = (f"{share_text(share)} of the {name}" for name, share in demand_shares(own.demand).items())
    lines.append(
        f"Peak demand of the release from {to_text(ANGLE.from_si(scored.plan.release_rad, units), 3)} deg: {', '.join(most)} and "
        f"{last} available."
    )
    return lines if own.noise is None else [*lines, _noise(own.noise, units)]


def _noise(noise: Noise, units: UnitSystem) -> str:
    angle = to_text(1e3 * degrees(noise.angle_rad), 2)
    hand = f"a holding hand ({HOLDING.name} arm)"
    force = f"{to_text(FORCE.from_si(noise.force_n, units), 2)} {FORCE.shown(units)} on {hand}"
    return (
        f"Sensor noise moves the column by {angle} thousandths of a degree r.m.s., hands off; "
        f"{force if isfinite(noise.force_n) else f'with {hand} the loop is unstable'}."
    )


def _elsewhere(over: OverEnvelope) -> list[str]:
    lines = []
    if over.margins.disk == 0:
        lines.append("The loop is unstable at a corner of the grid.")
    else:
        lines.append(f"Smallest margins over the corners of the grid: {margins_text(over.margins)}.")
    if over.worst_case is not None:
        lines.append(
            f"The largest loss comes from {over.worst_case.case}: {share_text(over.worst_case.lost)} of the nominal passes."
        )
    if over.demand.current >= 1:
        lines.append("At some settings the releases reach the current limit.")
    return lines


def _rendered(scored: LawScores, score: Score) -> list[str]:
    """The mode that renders the feel beside the programmed one."""
    inertia, damping, stiffness = (scored.plan.loader[key] for key in FEEL_SETTING)
    frequency = (stiffness / inertia) ** 0.5
    ratio = damping / (2 * inertia * frequency)
    near = tuple(mode for mode in score.own.modes if mode.frequency_rad_per_s > _NEAR * frequency)
    if len(near) < _PAIR:
        return []
    mode = feel_mode(near, frequency, ratio)
    texts = [to_text(HERTZ.from_si(omega, UnitSystem.SI), 3) for omega in (mode.frequency_rad_per_s, frequency)]
    return [
        f"The column oscillates at {texts[0]} Hz with a damping ratio of {to_text(mode.damping_ratio, 3)}; programmed: "
        f"{texts[1]} Hz "
        f"and {to_text(ratio, 3)}."
    ]


_NEAR = 0.05
"""Share of the programmed frequency below which a mode is no part of the feel: an observer that learns offsets is as slow."""

_PAIR = 2
"""Real poles that an overdamped feel has."""


def _caveats(scored: LawScores) -> tuple[str, ...]:
    plan = scored.plan
    lines = []
    if not scored.sampled:
        lines.append(
            "The loader is analog and can only use the report's laws. The newer laws need a digital controller: "
            "set controller.period and controller.delay, for example 0.5 ms each, or use the built-in loader elevator-2khz."
        )
    laws = [score.own.law for score in scored.scores]
    lines += [law.made_for_another(plan.given) for law in laws if law.made_for_another(plan.loader)]
    lines += silent_sentences(plan.loader)
    unverified = [] if plan.rule_verified else [f"{plan.rules.title} ({plan.rules.edition})"]
    if any(score.over for score in scored.scores):
        lines += tolerance_sentences(plan.given, plan.deviations)
        unverified += [case.name for case in plan.cases if not case.verified]
    elif scored.sampled and not HOLDING.verified:
        unverified.append(f"{HOLDING.name} arm")
    if unverified:
        lines.append(f"Not verified against a source: {', '.join(unverified)}.")
    if plan.omitted:
        lines.append(f"Omitted, because only I, B and G are programmed: {', '.join(plan.omitted)}.")
    return tuple(filter(None, lines))
