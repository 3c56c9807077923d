"""The second step: the law that renders the largest share of settings of the identified loader.

All designs eligible at the loader's own setting are compared. Of those that render the required share, a law that passes the rule's
tests is preferred. A parameter known to better than ``SIZED`` has no case in this comparison, but in the step that checks the
chosen law.
"""

from collections.abc import Callable
from dataclasses import replace

from forcefeel.choice.findings import choice_conclusions
from forcefeel.choice.quick_choice import at_own_setting
from forcefeel.choice.rule import CLOSE, MEASURED, Choice, choose, obstacles
from forcefeel.choice.score import LawScores, Score, score_over
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.qualification_step import run_tests
from forcefeel.commission.result import LawChosen
from forcefeel.conclusions import capital
from forcefeel.envelope.deviations import Deviation, deviations_of
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.laws.analog.recursion import NAMED_DESIGNS
from forcefeel.laws.law import Law, names_for
from forcefeel.loader.loader import Loader
from forcefeel.threads import threads_or_cores

SIZED = 0.005
"""Least deviation of a parameter with a case of its own, as a share of the value."""


def choose_law(
    loader: Loader, plan: CommissionPlan, progress: Callable[[str], None] = lambda _: None
) -> tuple[LawChosen, LawScores, Choice]:
    """Score the laws and choose one by ``choose``, preferring those that render the required share."""
    threads = threads_or_cores(plan.threads)
    digital = [name for name in names_for(loader) if name not in NAMED_DESIGNS]
    envelope_plan = make_plan(loader, digital or names_for(loader), plan.grid, rule=plan.rule, changes=_sizing(loader))
    progress("laws at the own setting")
    scores, refused = at_own_setting(envelope_plan, threads)
    period = loader["controller.period"]
    able = [score.name for score in scores if not obstacles(score, period, MEASURED)]
    scored = LawScores(
        replace(envelope_plan, laws={score.name: envelope_plan.laws[score.name] for score in scores}), tuple(scores)
    )
    if able:
        tried = replace(envelope_plan, laws={name: envelope_plan.laws[name] for name in able})
        progress(f"{len(able)} laws over {envelope_plan.settings.count} settings")
        envelope = compute(tried, threads=threads)
        eligible = [score for score in scores if score.name in able]
        over = {score.name: score for score in score_over(tried, eligible, envelope, threads)}
        scored = replace(scored, scores=tuple(over.get(score.name, score) for score in scores))
    choice, failed = _passing(scored, plan, progress)
    lesser: tuple[str, ...] = ()
    if choice.chosen and (short := obstacles(_score(scored, choice), period)):
        lesser = (
            f"{capital(choice.chosen)} has smaller margins than the default: {'; '.join(short)}. No law with larger margins "
            "renders "
            "the required share; 3.5 dB and 25 deg are enough for a measured loader.",
        )
    conclusions = choice_conclusions(scored, choice, plan.units)
    remarks = tuple(remark.sentence for remark in choice.remarks if remark.name != choice.chosen)
    return LawChosen(choice.chosen or "", conclusions.verdict, (*lesser, *failed, *remarks, *refused)), scored, choice


def _passing(
    scored: LawScores, plan: CommissionPlan, progress: Callable[[str], None]
) -> tuple[Choice, tuple[str, ...]]:
    """The first choice that renders the share and passes the rule's tests; otherwise the first choice."""
    first = choice = _choice(scored, plan.share)
    failed: list[str] = []
    remaining = scored
    while choice.chosen and _passes(remaining, choice) >= plan.share:
        progress(f"tests of the rule with {choice.chosen}")
        loader = scored.plan.given
        tested, _ = run_tests(loader, choice.chosen, Law.of(choice.chosen, loader), plan)
        if tested.fulfilled:
            others = tuple(remark for remark in first.remarks if remark.name != choice.chosen)
            return Choice(choice.chosen, (choice.remarks[0], *others)), tuple(failed)
        why = f": {tested.reasons[0]}" if tested.reasons else "."
        failed.append(f"{capital(choice.chosen)} renders the required share but fails the rule's tests{why}")
        remaining = replace(remaining, scores=tuple(score for score in remaining.scores if score.name != choice.chosen))
        choice = _choice(remaining, plan.share)
    return first, tuple(failed)


def _choice(scored: LawScores, share: float) -> Choice:
    """The choice with the usual reserve if it renders the share, else with the reserve of a measured loader."""
    preferred = choose(scored, share)
    if preferred.chosen and _passes(scored, preferred) >= share:
        return preferred
    measured = choose(scored, share, MEASURED)
    better = measured.chosen and (
        not preferred.chosen or _passes(scored, measured) >= _passes(scored, preferred) + CLOSE
    )
    return measured if better else preferred


def _score(scored: LawScores, choice: Choice) -> Score:
    return next(score for score in scored.scores if score.name == choice.chosen)


def _passes(scored: LawScores, choice: Choice) -> float:
    over = _score(scored, choice).over
    return 0.0 if over is None else over.shares.nominal_share


def _sizing(loader: Loader) -> dict[str, Deviation]:
    """Deviations with a case of their own."""
    return {key: deviation for key, deviation in deviations_of(loader).items() if deviation.size >= SIZED}
