"""Page of a comparison of laws, the template filled with plots, tables and text, and its folder."""

from pathlib import Path

from forcefeel.choice import Choice, LawScores, Score
from forcefeel.choice.as_json import choice_json
from forcefeel.choice.findings import choice_conclusions, design_conclusions
from forcefeel.choice.noise import HOLDING
from forcefeel.choice.page import plots as choice_plots
from forcefeel.choice.page import tables as choice_tables
from forcefeel.choice.rule import CLOSE, LEAST_GAIN, LEAST_PHASE_RAD, LEAST_QUIET
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import parameter_text, quantity_text
from forcefeel.units import ANGLE, UnitSystem

PAGE, RESULTS = "law.html", "results.json"

FOLDER = OutputFolder("the laws", (PAGE, RESULTS))


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
        least={
            "gain": LEAST_GAIN,
            "phase": quantity_text(LEAST_PHASE_RAD, ANGLE, units, 3),
            "close": CLOSE,
            "quiet": LEAST_QUIET,
        },
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


def write_choice(
    scored: LawScores, choice: Choice | None, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``results.json`` and ``law.html``, the page last.

    Existing files stay until the new ones are complete; other files in the folder are not touched.

    Args:
        scored: The laws with their scores.
        choice: The choice; ``None`` for one law requested by name.
        out: The folder; created if missing.
        units: Units of all numbers except those of the law in ``results.json``, which are SI.
        replace: Whether existing files may be replaced.
        command: Command line to show on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains such files and ``replace`` is false, or cannot be written.

    Example:
        >>> scored = ff.choice.score_laws(ff.digital_elevator(), ("published", "robust"), over_envelope=False)
        >>> ff.choice.write_choice(scored, None, Path("choice"), ff.UnitSystem.SI).parent.name
        'choice'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(choice_json(scored, choice, units))
    FOLDER.write(out, {RESULTS: results, PAGE: choice_page(scored, choice, units, command=command)})
    return out / PAGE
