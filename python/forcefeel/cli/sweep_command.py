"""What ``forcefeel sweep`` does."""

import json
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from forcefeel.cli.scenario_options import Law, ScenarioOptions
from forcefeel.errors import InputError
from forcefeel.loader import open_loader
from forcefeel.simulation import RunStatus
from forcefeel.sweep import Sweep, SweepResult, run_sweep, text
from forcefeel.sweep.findings import main_measures, number_of, share_text, sweep_conclusions
from forcefeel.sweep.plain import plain_sweep
from forcefeel.sweep.summary import Summary, measure_name, measure_unit, summarize
from forcefeel.units import UnitSystem

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells have it: 128 and the number of the signal."""


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
        if self.redesign and scenario.law not in {Law.PUBLISHED, Law.CONVERGED}:
            raise InputError("--redesign: is about designed gains; add --compensator published or converged")
        return Sweep(
            loader,
            found,
            (scenario.design if self.redesign else scenario.compensator)(loader),
            self.runs,
            found.seed,
            text.assignments("--vary", self.vary, "linkage.stiffness=20 %"),
            text.assignments("--grid", self.grid, "feel.stiffness=1000..9000 lb in/rad:20"),
        )


def run_sweep_command(
    path: Path | None, options: SweepOptions, scenario: ScenarioOptions, units: UnitSystem, *, as_json: bool
) -> None:
    """Carries out a sweep and writes its folder."""
    from forcefeel.report.sweep_folder import check_sweep_folder, write_sweep  # noqa: PLC0415  Plotly

    check_sweep_folder(options.out)  # before the work, not after it
    sweep = options.sweep(path, scenario)
    law = str(scenario.law or Law.ORIGINAL)
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
        print(json.dumps({"page": str(page), **plain_sweep(result, summary, units)}, indent=2, allow_nan=False))
    else:
        _show(Console(), result, summary, units)
        print(f"page: {page}")
    if not sweep.axes and summary.share(RunStatus.DIVERGED).runs:
        raise typer.Exit(1)


def _kept(bar: "Bar", out: Path) -> str:
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


class Bar:
    """Runs done, their rate and the time that is left, on the terminal's error stream; nothing where that is no terminal."""

    def __init__(self, *, silent: bool) -> None:
        console = Console(stderr=True)
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:,.0f} of {task.total:,.0f} runs"),
            _Rate(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        self._bar = Progress(*columns, console=console, transient=True, disable=silent or not console.is_terminal)
        self._task = self._bar.add_task("sweep", total=1, start=False, visible=False)
        self.done = self.total = 0

    def show(self, done: int, total: int) -> None:
        """So many runs are done."""
        if not self.total:
            self._bar.start_task(self._task)
        self.done, self.total = done, total
        self._bar.update(self._task, completed=done, total=total, visible=True)

    def describe(self, what: str) -> None:
        """What is being done."""
        self._bar.update(self._task, description=what)

    def stop(self) -> None:
        """Takes the bar off the terminal."""
        self._bar.stop()

    def __enter__(self) -> "Bar":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()


class _Rate(ProgressColumn):
    """Runs per second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text(f"{speed:,.0f} per s" if speed else "")
