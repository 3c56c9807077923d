"""``forcefeel schedule``."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from rich.table import Table

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderFile, OutputOptions, ThreadOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.release_options import ASKED, ReleaseOptions
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.units import to_text

if TYPE_CHECKING:
    from forcefeel.flight_schedule import ScheduleCheck


@dataclass(frozen=True, kw_only=True)
class ScheduleOptions(ReleaseOptions, FolderOptions, ThreadOptions, OutputOptions):
    """The options of ``forcefeel schedule``."""

    knots: Annotated[
        Path,
        option(
            "CSV with a row for each knot of a full grid: a column for each axis, such as 'dynamic pressure (lb/ft^2)', "
            "and the setting as 'stiffness (lb in/rad)', 'frequency (Hz)', 'damping ratio', or as I, B, G with units.",
            ASKED,
            metavar="FILE",
        ),
    ]
    law: Annotated[
        str,
        option(
            "Law for all knots: robust, agile, h-infinity, recovered, observer, load-cell, grip or torque-mode.", ASKED
        ),
    ] = "robust"
    refine: Annotated[int, option("Number of intervals between two knots in the check.", ASKED)] = 10
    out: Annotated[Path, option("Folder for schedule.html, gains.csv and results.json.", OUTPUT)] = Path(
        "forcefeel-schedule"
    )


def run(path: LoaderFile = None, /, *, options: ScheduleOptions) -> None:
    """Design laws over a flight envelope, and check them at the knots, between them, and during changes.

    Exit status 1 unless every checked loop is stable.

    Example: forcefeel schedule elevator-2khz --knots knots.csv --out schedule
    """
    from forcefeel.flight_schedule import check_schedule, design_schedule, read_knots
    from forcefeel.flight_schedule.as_json import schedule_json
    from forcefeel.flight_schedule.page.page import FOLDER, write_schedule

    loader, knots = options.loader(path), read_knots(options.knots)
    deviations = options.deviations(loader)
    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    with all_or_nothing("schedule", "loops", silent=options.json, even=False) as bar:
        schedule = design_schedule(loader, knots.axes, knots.feel, options.law)
        check = check_schedule(
            schedule,
            options.refine,
            changes=deviations,
            rule=options.rule,
            threads=options.threads,
            progress=bar.show,
        )
        bar.describe("report")
        page = write_schedule(
            check, options.out, options.units, replace=options.replace, command=options.command_line(path)
        )
    answer(
        {"page": page},
        lambda: schedule_json(check, options.units),
        lambda terminal: _show(terminal, check),
        as_json=options.json,
    )
    if not check.stable:
        raise SystemExit(BAD_ANSWER)


def _show(console: Terminal, check: "ScheduleCheck") -> None:
    from forcefeel.flight_schedule.findings import schedule_conclusions

    console.show(_releases(check))
    table = titled("Sampled loops", "where", numbers=("loops", "unstable", "pole nearest to the edge"))
    for part in check.parts:
        table.add_row(str(part.part), f"{part.loops:,}", f"{part.unstable:,}", to_text(part.critical, 5))
    console.show(table)
    console.conclude(schedule_conclusions(check))


def _releases(check: "ScheduleCheck") -> Table:
    """The releases at the knots and between them."""
    table = titled("Releases, nominal plant", "place", numbers=("releases", "within tolerance", "knot missing"))
    table.add_column("failures")
    for knot, name in ((True, "at the knots"), (False, "between the knots")):
        releases = [release for release in check.releases if release.knot is knot]
        failures = Counter(str(release.outcome) for release in releases if not release.passes)
        table.add_row(
            name,
            f"{len(releases):,}",
            f"{sum(release.passes for release in releases):,}",
            f"{sum(release.lost for release in releases):,}",
            ", ".join(f"{outcome} {count:,}" for outcome, count in failures.most_common()) or "none",
        )
    return table
