"""What ``forcefeel schedule`` does."""

from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.cli.given_loader import given_deviations, given_loader
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.flight_schedule import ScheduleCheck, check_schedule, design_schedule, read_knots
from forcefeel.flight_schedule.as_json import schedule_json
from forcefeel.flight_schedule.findings import schedule_conclusions
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.units import UnitSystem, to_text


@dataclass(frozen=True)
class ScheduleCommandOptions:
    """The options as given; ``None`` is not given."""

    knots: Path
    method: str
    refine: int
    rule: str | None
    off: list[str] | None
    changes: list[str] | None
    out: Path
    replace: bool
    threads: int | None


def run_schedule(path: Path | None, options: ScheduleCommandOptions, units: UnitSystem, *, as_json: bool) -> None:
    """Designs and checks a schedule and writes its folder."""
    from forcefeel.flight_schedule.page.folder import FOLDER, write_schedule  # noqa: PLC0415  Plotly

    loader, knots = given_loader(path, options.changes), read_knots(options.knots)
    deviations = given_deviations(loader, options.off)
    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    with all_or_nothing(silent=as_json) as bar:
        bar.describe("schedule")
        schedule = design_schedule(loader, knots.axes, knots.feel, options.method)
        found = check_schedule(
            schedule,
            options.refine,
            changes=deviations,
            rule=options.rule or DEFAULT_EDITION,
            threads=options.threads,
            progress=bar.show,
        )
        bar.describe("report")
        page = write_schedule(found, options.out, units, replace=options.replace)
    if as_json:
        print_json({"page": str(page), **schedule_json(found, units)})
    else:
        _show(Terminal(), found)
        print(f"page: {page}")
    if not found.stable:
        raise typer.Exit(1)


def _show(console: Console, found: ScheduleCheck) -> None:
    table = Table("where", title="Sampled loops", title_justify="left", title_style="bold")
    for name in ("loops", "unstable", "pole nearest to the edge"):
        table.add_column(name, justify="right")
    for part in found.parts:
        table.add_row(str(part.part), f"{part.loops:,}", f"{part.unstable:,}", to_text(part.critical, 5))
    console.print(table)
    said = schedule_conclusions(found)
    console.print(said.verdict, style="bold", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)
