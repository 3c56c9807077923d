"""The second step: the law that renders most of the envelope of the identified loader, as well as it is known.

Tried are all designs that are not ruled out at the loader's own setting. Of those that render the share that is asked for, one that
passes the rule's tests goes first. A parameter known to better than ``SIZED`` makes no case of its own here, where laws are
compared; it does in the step that checks the one that is taken.
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
"""Deviation, as a share of the value, from which on a parameter makes a case."""


def choose_law(
    loader: Loader, plan: CommissionPlan, progress: Callable[[str], None] = lambda _: None
) -> tuple[LawChosen, LawScores, Choice]:
    """Scores the laws and takes one by the rule of ``choose``, those first that render the asked share.

    Args:
        loader: The identified loader.
        plan: What is asked.
        progress: Told what is being done.
    """
    threads = threads_or_cores(plan.threads)
    digital = [name for name in names_for(loader) if name not in NAMED_DESIGNS]
    asked = make_plan(loader, digital or names_for(loader), plan.grid, rule=plan.rule, changes=_sizing(loader))
    progress("laws at the own setting")
    scores, refused = at_own_setting(asked, threads)
    period = loader["controller.period"]
    able = [score.name for score in scores if not obstacles(score, period, MEASURED)]
    scored = LawScores(replace(asked, laws={one.name: asked.laws[one.name] for one in scores}), tuple(scores))
    if able:
        tried = replace(asked, laws={name: asked.laws[name] for name in able})
        progress(f"{len(able)} laws over {asked.settings.count} settings")
        found = compute(tried, threads=threads)
        over = {score.name: score_over(tried, score, found) for score in scores if score.name in able}
        scored = replace(scored, scores=tuple(over.get(score.name, score) for score in scores))
    choice, failed = _passing(scored, plan, progress)
    lesser: tuple[str, ...] = ()
    if choice.chosen and (short := obstacles(_score(scored, choice), period)):
        lesser = (
            f"{capital(choice.chosen)} has smaller margins than the default: {'; '.join(short)}. No law with larger margins "
            "renders "
            "the required share; 3.5 dB and 25 deg are enough for a measured loader.",
        )
    said = choice_conclusions(scored, choice, plan.units)
    remarks = tuple(one.sentence for one in choice.remarks if one.name != choice.chosen)
    return LawChosen(choice.chosen or "", said.verdict, (*lesser, *failed, *remarks, *refused)), scored, choice


def _passing(
    scored: LawScores, plan: CommissionPlan, progress: Callable[[str], None]
) -> tuple[Choice, tuple[str, ...]]:
    """The first choice that passes the rule's tests, of those that render the share; the first of all where none does."""
    first = choice = _choice(scored, plan.share)
    failed: list[str] = []
    left = scored
    while choice.chosen and _passes(left, choice) >= plan.share:
        progress(f"tests of the rule with {choice.chosen}")
        loader = scored.plan.given
        tested, _ = run_tests(loader, choice.chosen, Law.of(choice.chosen, loader), plan)
        if tested.fulfilled:
            others = tuple(one for one in first.remarks if one.name != choice.chosen)
            return Choice(choice.chosen, (choice.remarks[0], *others)), tuple(failed)
        why = f": {tested.reasons[0]}" if tested.reasons else "."
        failed.append(f"{capital(choice.chosen)} renders the required share but fails the rule's tests{why}")
        left = replace(left, scores=tuple(one for one in left.scores if one.name != choice.chosen))
        choice = _choice(left, plan.share)
    return first, tuple(failed)


def _choice(scored: LawScores, share: float) -> Choice:
    """By the usual reserve, if what it leaves renders the share; else by that of a loader that is measured."""
    usual = choose(scored, share)
    if usual.chosen and _passes(scored, usual) >= share:
        return usual
    measured = choose(scored, share, MEASURED)
    better = measured.chosen and (not usual.chosen or _passes(scored, measured) >= _passes(scored, usual) + CLOSE)
    return measured if better else usual


def _score(scored: LawScores, choice: Choice) -> Score:
    return next(score for score in scored.scores if score.name == choice.chosen)


def _passes(scored: LawScores, choice: Choice) -> float:
    over = _score(scored, choice).over
    return 0.0 if over is None else over.shares.nominal_share


def _sizing(loader: Loader) -> dict[str, Deviation]:
    """The deviations that make a case."""
    return {key: one for key, one in deviations_of(loader).items() if one.size >= SIZED}
