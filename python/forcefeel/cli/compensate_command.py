"""What ``forcefeel compensate --method`` does; without it, recursion (22) as ``commands.compensate`` runs it."""

from dataclasses import dataclass, fields
from math import degrees, isfinite
from pathlib import Path

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from forcefeel.choice import Choice, Score, Scored, choose, score_methods
from forcefeel.choice.as_json import choice_json
from forcefeel.choice.findings import choice_conclusions, design_conclusions
from forcefeel.choice.score import COARSE, check_names
from forcefeel.cli import commands
from forcefeel.cli.given_loader import given_deviations
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.laws.law_file import check_law_file
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import Loader
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.sweep import text
from forcefeel.units import UnitSystem, to_text

AUTO = "auto"
_FOLDER = Path("forcefeel-compensate")
_NONE = "-"


@dataclass(frozen=True)
class MethodOptions:
    """The options as given; ``None`` is not given."""

    method: str | None
    envelope: bool
    grid: list[str] | None
    rule: str | None
    off: list[str] | None
    out: Path | None
    replace: bool
    threads: int | None

    def refuse_alone(self) -> None:
        """Refuses what is only for a method, where none is asked for.

        Raises:
            InputError: If there is such an option.
        """
        for field in fields(self):
            if getattr(self, field.name) not in (None, False):
                raise InputError(
                    f"--{field.name}: is for --method; add --method auto or the name of a method, or leave it out"
                )

    def check(self) -> None:
        """Refuses what does not go together.

        Raises:
            InputError: If so.
        """
        if self.method == AUTO and self.envelope:
            raise InputError(
                "--envelope: is for one method by its name; --method auto tries all over the envelope anyway"
            )
        if self.method != AUTO and not self.envelope:
            for name in ("grid", "off"):
                if getattr(self, name):
                    raise InputError(f"--{name}: is for the envelope; add --envelope, or take --method auto")


def run_compensate(
    loader: Loader,
    recursion: commands.Options,
    chosen: MethodOptions,
    units: UnitSystem,
    *,
    save_law: Path | None,
    as_json: bool,
) -> None:
    """Tries methods, or designs one, and writes the folder; without ``--method``, recursion (22). The law goes to its file."""
    if save_law is not None:
        check_law_file(save_law)  # before the work, not after it
    if chosen.method is None:
        chosen.refuse_alone()
        commands.compensate(loader, recursion, units, save_law=save_law, as_json=as_json)
        return
    _refuse_recursion(recursion)
    chosen.check()
    _run(loader, chosen, units, save_law=save_law, as_json=as_json)


def _refuse_recursion(recursion: commands.Options) -> None:
    for field in fields(recursion):
        if getattr(recursion, field.name) not in (None, False):
            option = field.name.removesuffix("_s").replace("_", "-")
            raise InputError(f"--{option}: is for recursion (22) alone; leave it out, or leave out --method")


def _run(loader: Loader, options: MethodOptions, units: UnitSystem, *, save_law: Path | None, as_json: bool) -> None:
    from forcefeel.choice.page.folder import FOLDER, write_choice  # noqa: PLC0415  Plotly

    out = options.out or _FOLDER
    names = None if options.method == AUTO else (options.method or "",)
    if names is not None:
        check_names(loader, names)
    grid = {**COARSE, **text.assignments("--grid", options.grid, "stiffness=1..100 %:6:log")}
    FOLDER.check(out, replace=options.replace)  # before the work, not after it
    with all_or_nothing(silent=as_json) as bar:
        scored = score_methods(
            loader,
            names,
            grid,
            over_envelope=names is None or options.envelope,
            threads=options.threads,
            progress=bar.show,
            rule=options.rule or DEFAULT_EDITION,
            changes=given_deviations(loader, options.off),
        )
        choice = choose(scored) if names is None else None
        bar.describe("report")
        page = write_choice(scored, choice, out, units, replace=options.replace)
        law = _law(loader, scored, choice) if save_law else None
        if save_law and law:
            law.save(save_law)
    files = {"page": str(page), **({"law_file": str(save_law)} if law else {})}
    if as_json:
        print_json({**files, **choice_json(scored, choice, units)})
    else:
        _show(Terminal(), scored, choice, units)
        for what, path in files.items():
            print(f"{what.replace('_', ' ')}: {path}")
    if not (scored.scores[0].own.stable if choice is None else choice.chosen):
        raise typer.Exit(1)


def _law(loader: Loader, scored: Scored, choice: Choice | None) -> Law | None:
    """The law that was chosen or asked for, at the loader's own setting and those it was tried at; ``None`` where there is none."""
    score = scored.scores[0]
    if choice is not None:
        if choice.chosen is None:
            return None
        (score,) = (one for one in scored.scores if one.name == choice.chosen)
    if score.over is None:
        return Law.of(score.name, loader)
    return Law.of(
        score.name, loader, np.unique(np.vstack([own_feel(loader), scored.plan.settings.feel(loader)]), axis=0)
    )


def _show(console: Console, scored: Scored, choice: Choice | None, units: UnitSystem) -> None:
    console.print(_table(scored, choice))
    said = design_conclusions(scored, units) if choice is None else choice_conclusions(scored, choice, units)
    console.print(said.verdict, style="bold" if said.good else "bold red", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)


def _table(scored: Scored, choice: Choice | None) -> Table:
    table = Table(title="Methods, shares in %", title_justify="left", title_style="bold")
    table.add_column("method", no_wrap=True)
    over = scored.scores[0].over is not None
    names = ["every case", "nominal", "stable"] if over else []
    names += ["release", "gain", "phase deg", "delay ms", "current"]
    names += ["noise mdeg"] if scored.sampled else []
    for name in names:
        table.add_column(name, justify="right")
    for score in scored.scores:
        taken = choice is not None and score.name == choice.chosen
        table.add_row(score.name, *_cells(score), style="bold" if taken else None)
    return table


def _cells(score: Score) -> list[str]:
    own, margins = score.own, score.own.margins
    shares = score.over.shares if score.over else None
    numbers = [100 * one for one in (shares.passes_worst, shares.passes, shares.stable)] if shares else []
    found = [to_text(one, 3) for one in numbers]
    if own.stable:
        bears = (margins.gain_up, degrees(margins.phase_rad), 1e3 * margins.delay_s)
        found += [own.outcome, *(to_text(one, 3) for one in (*bears, 100 * own.demand.current))]
    else:
        found += [own.outcome, *[_NONE] * 4]
    if own.noise is not None:
        found.append(to_text(1e3 * degrees(own.noise.angle_rad), 3) if isfinite(own.noise.angle_rad) else _NONE)
    return found
