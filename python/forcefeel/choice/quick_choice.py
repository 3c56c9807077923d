"""Best law for a loader with a digital controller, in seconds: chosen on few settings, then tested.

Laws that are not eligible at the loader's own setting are not computed over the envelope.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from forcefeel.choice.own_setting import own_setting
from forcefeel.choice.rule import choose, obstacles
from forcefeel.choice.score import LawScores, Score, score_over, summary_of
from forcefeel.conclusions import capital
from forcefeel.design.law_comparison import EnvelopeSummary, LawComparison, LawResult, QualificationSummary
from forcefeel.envelope.plan import Plan, make_plan
from forcefeel.envelope.run import compute
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError
from forcefeel.laws.law import names_for
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.qualification.plan.run import QualificationSetup, qualify_loader
from forcefeel.qualification.plan.sentences import outcome_counts, reasons, rule_text
from forcefeel.threads import side_by_side, threads_or_cores
from forcefeel.units import UnitSystem

FEW: Mapping[str, str] = MappingProxyType(
    {"stiffness": "2.5..100 %:3:log", "frequency": "0.5, 2, 4 Hz", "damping": "0.1, 0.7"}
)
"""18 settings instead of the 96 of ``score.COARSE``, over the same range of frequencies."""

REPORT = "published"
"""The report's law: its state feedback over the published horizon."""

STEPS = ("laws at the own setting", "laws over the envelope", "laws tested")
"""Progress messages of ``best_law``: the best law is tested, and for a valve the report's."""


def best_law(
    loader: Loader,
    grid: Mapping[str, str | Sequence[float]] = FEW,
    *,
    units: UnitSystem = UnitSystem.US,
    called: Sequence[str] = (),
    threads: int | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> LawComparison:
    """Find the best law of a loader by the rule of ``choose`` and test it, for a valve together with the report's law.

    Args:
        loader: The loader, with a digital controller.
        grid: Settings, as in ``find_envelope``.
        units: Units of the test results; they also select the rule's rounding of forces.
        called: Name of the loader on a command line; default: its name.
        threads: Number of threads; default: all cores. The results do not depend on it.
        progress: Called with each of ``STEPS`` when it begins.

    Returns:
        The best law and, for a valve, the report's law. The choice uses few settings, by default 18; ``score_laws`` uses more.

    Raises:
        InputError: If the loader is analog or the grid is invalid.

    Example:
        >>> grid = {"stiffness": "20, 100 %", "frequency": "2, 4 Hz", "damping": "0.3, 1"}
        >>> tried = ff.choice.best_law(ff.digital_elevator(), grid)
        >>> tried.best.name, tried.best.qualifies, tried.report.qualifies
        ('robust', True, False)
    """
    check_loader(loader)
    if not loader["controller.period"]:
        raise InputError(
            "loader: is analog and can only use the report's laws; set controller.period and controller.delay, for example "
            "0.5 ms each, or use the built-in loader elevator-2khz"
        )
    threads = threads_or_cores(threads)
    called = tuple(called) or (loader.name,)
    Settings.of(grid)  # raises before the try block, which reports errors of the loader
    report = LawResult(REPORT, summary_of(REPORT), None, None) if REPORT in names_for(loader) else None
    try:
        plan = make_plan(loader, names_for(loader), grid)
        progress(STEPS[0])
        scores, refused = at_own_setting(plan, threads)
        progress(STEPS[1])
        scored, shares = _over_envelope(plan, scores, threads)
        choice = choose(scored)
        progress(STEPS[2])
        names = list(dict.fromkeys(name for name in (report.name if report else None, choice.chosen) if name))
        tested = list(side_by_side(lambda name: _qualified(loader, name, units), names, threads))
    except InputError as error:
        return LawComparison(report, None, (), "", 0, str(error), called)
    results = {
        name: LawResult(name, summary_of(name), status, shares.get(name))
        for name, (_, status) in zip(names, tested, strict=True)
    }
    remarks = (*(remark.sentence for remark in choice.remarks), *refused)
    rule = tested[0][0] if tested else ""
    best = results.get(choice.chosen or "")
    return LawComparison(results.get(REPORT), best, remarks, rule, plan.settings.count, "", called)


def at_own_setting(plan: Plan, threads: int) -> tuple[list[Score], list[str]]:
    """A score for each law at the own setting, and a sentence for each law that cannot be designed."""
    scores, refused = [], []
    for name, law in plan.laws.items():
        try:
            scores.append(Score(name, summary_of(name), own_setting(plan, law, threads), None))
        except InputError as error:
            refused.append(f"{capital(name)} cannot be designed: {error}")
    return scores, refused


def _over_envelope(plan: Plan, scores: list[Score], threads: int) -> tuple[LawScores, dict[str, EnvelopeSummary]]:
    """Add results over the envelope for eligible laws and the report's law; return scores and shares."""
    period = plan.loader["controller.period"]
    eligible = [score for score in scores if score.name == REPORT or not obstacles(score, period)]

    plan = replace(plan, laws={score.name: plan.laws[score.name] for score in eligible})
    envelope = compute(plan, threads=threads)
    over = {score.name: score for score in score_over(plan, eligible, envelope, threads)}
    shares = {name: envelope.shares(name) for name in over}
    rendered = {
        name: EnvelopeSummary(law_shares.stable, law_shares.nominal_share, law_shares.worst_case_share)
        for name, law_shares in shares.items()
    }
    return LawScores(plan, tuple(over.get(score.name, score) for score in scores)), rendered


def _qualified(loader: Loader, name: str, units: UnitSystem) -> tuple[str, QualificationSummary]:
    """The rule, and a law's results in its tests."""
    qualification = qualify_loader(loader, QualificationSetup(laws=(name,), system=units))
    (section,) = qualification.sections
    status = QualificationSummary(
        section.fulfilled, str(section.status), outcome_counts(section), tuple(reasons(section, qualification))
    )
    return rule_text(qualification), status
