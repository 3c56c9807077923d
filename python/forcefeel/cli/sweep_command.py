"""What ``forcefeel sweep`` does."""

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.cli.exit_status import INTERRUPTED
from forcefeel.cli.progress import Bar
from forcefeel.cli.scenario_options import ScenarioOptions
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.conclusions import share_text
from forcefeel.errors import InputError
from forcefeel.laws.law import named
from forcefeel.loader.built_in import open_loader
from forcefeel.simulation import RunStatus
from forcefeel.sweep import Sweep, SweepResult, run_sweep, text
from forcefeel.sweep.as_json import sweep_json
from forcefeel.sweep.findings import main_measures, number_of, sweep_conclusions
from forcefeel.sweep.summary import Summary, measure_name, measure_unit, summarize
from forcefeel.units import UnitSystem

REDESIGNED = ("published", "converged")
"""Laws of which --redesign makes one for each setting."""


@dataclass(frozen=True)
class SweepOptions:
    """The options of a sweep, as given; ``None`` is not given."""

    runs: int | None
    vary: list[str] | None
    grid: list[str] | None
    redesign: bool
    out: Path
    resume: bool
    replace: bool
    scheduler: str | None
    threads: int | None

    def sweep(self, path: Path | None, scenario: ScenarioOptions) -> Sweep:
        """What is swept.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        loader = scenario.changed(open_loader(path))
        found = scenario.scenario(loader)
        if self.redesign and scenario.law not in REDESIGNED:
            raise InputError("--redesign: is about designed gains; add --compensator published or converged")
        return Sweep(
            loader,
            found,
            named((str(scenario.law),), loader)[str(scenario.law)] if self.redesign else scenario.law_of(loader),
            self.runs,
            found.seed,
            text.assignments("--vary", self.vary, "linkage.stiffness=20 %"),
            text.assignments("--grid", self.grid, "feel.stiffness=1000..9000 lb in/rad:20"),
        )


def run_sweep_command(
    path: Path | None, options: SweepOptions, scenario: ScenarioOptions, units: UnitSystem, *, as_json: bool
) -> None:
    """Carries out a sweep and writes its folder."""
    from forcefeel.sweep.page.folder import FOLDER, RUNS_FOLDER, write_sweep  # noqa: PLC0415  Plotly

    for part in (FOLDER, RUNS_FOLDER):  # before the work, not after it
        part.check(options.out)
    sweep = options.sweep(path, scenario)
    law = str(scenario.law) if options.redesign else sweep.nominal_law.name
    with Bar(silent=as_json) as bar:
        try:
            result = run_sweep(
                sweep,
                options.out,
                scheduler=options.scheduler,
                threads=options.threads,
                resume=options.resume,
                replace=options.replace,
                progress=bar.show,
            )
            bar.describe("report")
            summary = summarize(result)
            page = write_sweep(result, summary, options.out, units, law)
        except KeyboardInterrupt:
            bar.stop()
            print(f"\nforcefeel: interrupted; {_kept(bar, options.out)}", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
        except InputError as error:
            raise InputError(f"{error}\n{_kept(bar, options.out)}" if bar.done else str(error)) from error
    if as_json:
        print_json({"page": str(page), **sweep_json(result, summary, units)})
    else:
        _show(Terminal(), result, summary, units)
        print(f"page: {page}")
    if not sweep.axes and summary.share(RunStatus.DIVERGED).runs:
        raise typer.Exit(1)


def _kept(bar: Bar, out: Path) -> str:
    """What is kept, and the command that goes on."""
    words = [word for word in sys.argv[1:] if word not in {"--replace", "--resume"}]
    command = shlex.join(["forcefeel", *words, "--resume"])
    return f"{bar.done:,} of {bar.total:,} runs are kept in {out}; go on with: {command}"


def _show(console: Console, result: SweepResult, summary: Summary, units: UnitSystem) -> None:
    found = sweep_conclusions(result, summary, units)
    console.print(_measures(result, summary, units))
    ended = ", ".join(f"{one.status} {share_text(one.share)}" for one in summary.shares if one.runs)
    console.print(f"{result.sweep.total:,} runs: {ended}", highlight=False)
    console.print(found.verdict, style="bold" if found.good else "bold red", highlight=False)
    for finding in found.findings:
        console.print(f"- {finding}", highlight=False)


def _measures(result: SweepResult, summary: Summary, units: UnitSystem) -> Table:
    table = Table("measure", title="Measures", title_justify="left", title_style="bold")
    for name in ("nominal", "lowest", "5 %", "median", "95 %", "highest"):
        table.add_column(name, justify="right")
    for name in main_measures(result, summary):
        spread = summary.spreads[name]
        marks = (spread.nominal, spread.lowest, *map(spread.quantile, (0.05, 0.5, 0.95)), spread.highest)
        values = (number_of(name, value, units) for value in marks)
        table.add_row(f"{measure_name(name)}, {measure_unit(name).shown(units)}", *values)
    return table
