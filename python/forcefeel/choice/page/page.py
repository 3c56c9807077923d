"""Page of a comparison of laws: the template filled with plots, tables and text."""

from forcefeel.choice import Choice, LawScores, Score
from forcefeel.choice.findings import choice_conclusions, design_conclusions
from forcefeel.choice.noise import HOLDING
from forcefeel.choice.page import plots as choice_plots
from forcefeel.choice.page import tables as choice_tables
from forcefeel.choice.rule import CLOSE, LEAST_GAIN, LEAST_PHASE_RAD
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import parameter_text, quantity_text
from forcefeel.units import ANGLE, UnitSystem


def choice_page(scored: LawScores, choice: Choice | None, units: UnitSystem, *, command: str = "") -> str:
    """The page, with numbers in ``units``; ``choice`` is ``None`` for one law requested by name."""
    plan = scored.plan
    displayed = _displayed(scored, choice)
    over = any(score.over for score in scored.scores)
    return render(
        "choice/page/choice.html.j2",
        command=command,
        loader=plan.given,
        plan=plan,
        conclusions=design_conclusions(scored, units) if choice is None else choice_conclusions(scored, choice, units),
        scored=scored,
        choice=choice,
        over=over,
        shown=displayed,
        shares=choice_tables.shares(scored, choice) if over else None,
        laws=choice_tables.laws(scored),
        trade_off=drawing(choice_plots.trade_off(scored, choice), "trade-off") if over else "",
        bars=drawing(choice_plots.bars(scored, units), "margins-and-noise") if _some_stable(scored) else "",
        margins=choice_tables.margins(scored),
        demands=choice_tables.demands(scored, units),
        release=drawing(choice_plots.release(scored, displayed), "release-plot"),
        poles=choice_tables.poles(displayed[0]),
        grid=choice_tables.grid(scored, units),
        tolerances=tolerances(plan.deviations),
        least={"gain": LEAST_GAIN, "phase": quantity_text(LEAST_PHASE_RAD, ANGLE, units, 3), "close": CLOSE},
        holding=HOLDING,
        angle=quantity_text(plan.release_rad, ANGLE, units, 3),
        setting=[
            (symbol, parameter_text(plan.loader, f"feel.{name}", units))
            for symbol, name in (("I", "inertia"), ("B", "damping"), ("G", "stiffness"))
        ],
        parameters=machine.parameters(plan.given, units),
    )


def _displayed(scored: LawScores, choice: Choice | None) -> tuple[Score, ...]:
    """Laws whose release is drawn: the chosen law, or all without a choice."""
    if choice is None or choice.chosen is None:
        return scored.scores
    return tuple(score for score in scored.scores if score.name == choice.chosen)


def _some_stable(scored: LawScores) -> bool:
    return any(score.own.stable for score in scored.scores)
