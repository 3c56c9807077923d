"""``forcefeel law``: the design of one law, a comparison of all with a choice, or recursion (22)."""

from dataclasses import dataclass, fields, replace
from math import degrees, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Group
from rich.table import Table

from forcefeel.cli.each_axis import each_axis
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.law_option import LAW_NAMES, ROBUST, check_law_name
from forcefeel.cli.options import (
    OUTPUT,
    FolderOptions,
    LoaderOrProject,
    OutputOptions,
    ThreadOptions,
    named_options,
    option,
    page_folder,
)
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.recursion_options import RecursionOptions
from forcefeel.cli.release_options import ReleaseOptions
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.json_values import json_value
from forcefeel.units import UnitSystem, to_text

if TYPE_CHECKING:
    from forcefeel.choice import Choice, LawScores, Score
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader
    from forcefeel.loader.project import Project

AUTO, REPORT = "auto", "report"
_FOLDER = Path("forcefeel-law")
_NONE = "-"


LAWS = Group("Law", sort_key=10)


def _law_name(_: type, tokens: Any) -> str:
    (token,) = tokens
    name: str = token.value
    return name if name in (AUTO, REPORT) else check_law_name(name, (AUTO, REPORT))


@dataclass(frozen=True, kw_only=True)
class LawOptions(ReleaseOptions, RecursionOptions, FolderOptions, ThreadOptions, OutputOptions):
    """The options of ``forcefeel law``."""

    law: Annotated[
        str | None,
        option(
            "auto: compare all laws that the loader can run, and choose one. report: gains by recursion (22) of the 1974 "
            f"report. Or one law: {LAW_NAMES}.",
            LAWS,
            default="robust; report on an analog controller",
            metavar="NAME|auto|report",
            converter=_law_name,
        ),
    ] = None
    envelope: Annotated[bool, option("With one named law: also score it over the envelope, as auto does.", LAWS)] = (
        False
    )
    grid: Annotated[
        tuple[str, ...],
        option(
            "Settings along an axis of the envelope. Defaults: 'stiffness=1..100 %:6:log' (of G_max), 'frequency=0.5..4 "
            "Hz:4:log', 'damping=0.1, 0.3, 0.7, 1.5'. Repeatable.",
            LAWS,
            metavar="AXIS=VALUES",
        ),
    ] = ()
    out: Annotated[
        Path | None,
        option("Folder for law.html and results.json. Not used by --law report.", OUTPUT, default=str(_FOLDER)),
    ] = None
    save_law: Annotated[
        Path | None,
        option(
            "Law file (.json) that --law of other commands reads: the law of the loader's own setting, and with "
            "--envelope or --law auto also those of the grid. Not written if no law is eligible.",
            OUTPUT,
            metavar="FILE.json",
        ),
    ] = None

    def chosen(self, loader: "Loader") -> str:
        """The value of ``--law``, or its default for a loader."""
        return self.law or (ROBUST if loader["controller.period"] else REPORT)

    def check(self, law: str) -> None:
        """Refuses options that do not go together with ``law``.

        Raises:
            InputError: If one is given.
        """
        if law == REPORT:
            alone = {"replace"} if self.save_law is None else set()
            self._refuse(
                {*alone, *_SCORE_ALONE, *(field.name for field in fields(ThreadOptions))},
                "does not go with --law report; leave it out, or name another law, such as --law auto",
            )
            return
        self._refuse(
            {field.name for field in fields(RecursionOptions)},
            "is for recursion (22) alone; add --law report, or leave it out",
        )
        if law == AUTO and self.envelope:
            raise InputError("--envelope: is for one law by its name; --law auto scores all over the envelope anyway")
        if law != AUTO and not self.envelope:
            self._refuse({"grid", "deviation"}, "is for the envelope; add --envelope, or --law auto")

    def _refuse(self, names: set[str], why: str) -> None:
        for field, name, _ in named_options(type(self)):
            if field.name in names and getattr(self, field.name) != field.default:
                raise InputError(f"{name}: {why}")


def _of_axis(project: "Project", options: LawOptions, axis: str) -> LawOptions:
    """The options with the folder of an axis where none is given; a law of the report has no folder.

    Raises:
        InputError: If the law of the report is asked for an electric loader, before any axis is designed.
    """
    if options.law == REPORT:
        from forcefeel.loader.loader import check_hydraulic

        try:
            check_hydraulic(project.loaders[axis], "recursion (22)")
        except InputError as error:
            raise InputError(f"{project.path}: axes.{axis}: {error}") from error
    return options if options.out or options.law == REPORT else replace(options, out=_FOLDER / axis)


_SCORE_ALONE = ("envelope", "grid", "rule", "deviation", "out")


@each_axis(of_axis=_of_axis)
def run(path: LoaderOrProject = None, /, *, options: LawOptions = LawOptions()) -> None:
    """Design a law, or compare laws and choose one.

    --law auto scores every law over the envelope, by drive demand, noise and margins, and chooses one. --law report computes the
    gains by recursion (22) of the 1974 report.

    Exit status 1 if the loop is unstable at the programmed setting, or no law is eligible.

    Example: forcefeel law elevator-2khz --law auto --out laws
    """
    from forcefeel.laws.law_file import check_law_file

    loader = options.loader(path)
    if options.save_law is not None:
        check_law_file(options.save_law, replace=options.replace)  # before the work, not after it
    law = options.chosen(loader)
    options.check(law)
    if law == REPORT:
        _recursion(loader, options)
    else:
        _scored(loader, law, options, options.command_line(path))


def _recursion(loader: "Loader", options: LawOptions) -> None:
    """Computes gains and closes the loop; gains that the recursion reached go to their file."""
    from forcefeel.cli import show
    from forcefeel.design.assessment import assess, peaks
    from forcefeel.laws.analog.recursion import design_gains
    from forcefeel.laws.law import Law

    settings = options.settings(loader)
    design = design_gains(loader, settings)
    law = design.law(loader)
    judged = assess(loader, law, design.settings)
    demand = peaks(loader, law) if judged.stable else None
    saved = options.save_law if design.reached else None
    if saved:
        Law.of(settings, loader, name="recursion (22)").save(saved)
    parts = {"loader": loader, "compensation": design, "assessment": judged, "peaks": demand}
    answer(
        {"law_file": saved} if saved else {},
        lambda: {name: json_value(part, options.units) for name, part in parts.items()},
        lambda terminal: show.compensation(terminal, loader, design, judged, demand, options.units),
        as_json=options.json,
    )
    if not (design.reached and judged.stable):
        raise SystemExit(BAD_ANSWER)


def _scored(loader: "Loader", law: str, options: LawOptions, command: str) -> None:
    """Scores laws and writes the folder; the law goes to its file."""
    from forcefeel.choice import choose, score_laws
    from forcefeel.choice.as_json import choice_json
    from forcefeel.choice.score import COARSE, check_names
    from forcefeel.sweep import text

    out, units = page_folder(options.out, _FOLDER), options.units
    names = None if law == AUTO else (law,)
    if names is not None:
        check_names(loader, names)
    grid = {**COARSE, **text.assignments("--grid", options.grid, "stiffness=1..100 %:6:log")}
    if out is not None:
        from forcefeel.choice.page.page import FOLDER, write_choice

        FOLDER.check(out, replace=options.replace)  # before the work, not after it
    with all_or_nothing("law", "releases", silent=options.json) as bar:
        scored = score_laws(
            loader,
            names,
            grid,
            over_envelope=names is None or options.envelope,
            threads=options.threads,
            progress=bar.show,
            rule=options.rule,
            changes=options.deviations(loader),
        )
        choice = choose(scored) if names is None else None
        files = {}
        if out is not None:
            bar.describe("report")
            files["page"] = write_choice(scored, choice, out, units, replace=options.replace, command=command)
        saved = _law(loader, scored, choice) if options.save_law else None
        if options.save_law and saved:
            saved.save(options.save_law)
    files |= {"law_file": options.save_law} if saved and options.save_law else {}
    answer(
        files,
        lambda: choice_json(scored, choice, units),
        lambda terminal: _show(terminal, scored, choice, units),
        as_json=options.json,
    )
    if not (scored.scores[0].own.stable if choice is None else choice.chosen):
        raise SystemExit(BAD_ANSWER)


def _law(loader: "Loader", scored: "LawScores", choice: "Choice | None") -> "Law | None":
    """The chosen or requested law, at the loader's own setting and the scored ones; ``None`` without a law."""
    import numpy as np

    from forcefeel.laws.law import Law
    from forcefeel.loader.feel_settings import own_feel

    score = scored.scores[0]
    if choice is not None:
        if choice.chosen is None:
            return None
        (score,) = (score for score in scored.scores if score.name == choice.chosen)
    if score.over is None:
        return Law.of(score.name, loader)
    return Law.of(
        score.name, loader, np.unique(np.vstack([own_feel(loader), scored.plan.settings.feel(loader)]), axis=0)
    )


def _show(console: Terminal, scored: "LawScores", choice: "Choice | None", units: UnitSystem) -> None:
    from forcefeel.choice.findings import choice_conclusions, design_conclusions

    console.show(_table(scored, choice), on_the_page=_MARGINS)
    console.conclude(design_conclusions(scored, units) if choice is None else choice_conclusions(scored, choice, units))


_MARGINS = ("gain", "phase deg", "delay ms")


def _table(scored: "LawScores", choice: "Choice | None") -> Table:
    table = titled("Laws, shares in %")
    table.add_column("law", no_wrap=True)
    over = scored.scores[0].over is not None
    names = ["every case", "nominal", "stable"] if over else []
    names += ["release", *_MARGINS, "current"]
    names += ["noise mdeg"] if scored.sampled else []
    for name in names:
        table.add_column(name, justify="left" if name == "release" else "right")
    for score in scored.scores:
        taken = choice is not None and score.name == choice.chosen
        table.add_row(score.name, *_cells(score), style="bold" if taken else None)
    return table


def _cells(score: "Score") -> list[str]:
    own, margins = score.own, score.own.margins
    shares = score.over.shares if score.over else None
    numbers = (
        [100 * share for share in (shares.worst_case_share, shares.nominal_share, shares.stable)] if shares else []
    )
    cells = [to_text(number, 3) for number in numbers]
    if own.stable:
        bears = (margins.gain_up, degrees(margins.phase_rad), 1e3 * margins.delay_s)
        cells += [own.outcome, *(to_text(number, 3) for number in (*bears, 100 * own.demand.current))]
    else:
        cells += [own.outcome, *[_NONE] * 4]
    if own.noise is not None:
        cells.append(to_text(1e3 * degrees(own.noise.angle_rad), 3) if isfinite(own.noise.angle_rad) else _NONE)
    return cells
