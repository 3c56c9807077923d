"""``forcefeel size``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, DataSheetOptions, FolderOptions, LoaderOrProject, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.release_options import ASKED, AngleOptions
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from collections.abc import Iterable

    from forcefeel.sizing import CockpitSizing, Sizing
    from forcefeel.sizing.columns import Column, Row


@dataclass(frozen=True, kw_only=True)
class SizeOptions(AngleOptions, DataSheetOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel size``."""

    axis: Annotated[
        Literal["pitch", "roll", "yaw", "stick", "collective"] | None,
        option(
            "Control of the cockpit. 14 CFR 25.143(d) limits the forces of each except a stick's and a collective's.",
            ASKED,
            default="axis of the built-in loader, otherwise pitch",
        ),
    ] = None
    out: Annotated[Path, option("Folder for size.html and results.json.", OUTPUT)] = Path("forcefeel-size")


def run(path: LoaderOrProject = None, /, *, options: SizeOptions = SizeOptions()) -> None:
    """Check whether the drive is large enough for the feel and the rule: force, speed, torque, heat.

    For a project file with a table [axes], checks all axes. Exit status 1 if a drive is too small for the programmed feel.

    Example: forcefeel size sidestick-pitch --data-sheet motor.toml --units si --out size
    """
    from forcefeel.loader.project import Project
    from forcefeel.sizing import size_cockpit, size_drive
    from forcefeel.sizing.as_json import sizing_json
    from forcefeel.sizing.page.page import FOLDER, write_sizing

    subject = options.project(path, axis=options.axis, data_sheet=options.data_sheet) or options.loader(path)
    inputs = (subject.path,) if isinstance(subject, Project) else ()
    FOLDER.check(options.out, replace=options.replace, inputs=inputs)
    with all_or_nothing("size", silent=options.json):
        sizing: Sizing | CockpitSizing = (
            size_cockpit(subject, options.angle_rad)
            if isinstance(subject, Project)
            else size_drive(subject, options.axis, options.angle_rad)
        )
        command = options.command_line(path)
        page = write_sizing(sizing, options.out, options.units, replace=options.replace, command=command)
    answer(
        {"page": page},
        lambda: sizing_json(sizing, options.units),
        lambda terminal: _show(terminal, sizing, options.units),
        as_json=options.json,
    )
    if not sizing.ok:
        raise SystemExit(BAD_ANSWER)


def _show(console: Terminal, sizing: "Sizing | CockpitSizing", units: UnitSystem) -> None:
    from forcefeel.sizing.cockpit import CockpitSizing, cockpit_conclusions
    from forcefeel.sizing.columns import axis_columns, columns
    from forcefeel.sizing.findings import sizing_conclusions

    if isinstance(sizing, CockpitSizing):
        title = f"{sizing.name}: the drives of its axes"
        _show_table(console, ("axis", title), axis_columns(units), sizing.axes.items())
        console.conclude(cockpit_conclusions(sizing, units))
        return
    title = f"{sizing.loader.name}, {sizing.plan.axis}: demand at the grip"
    _show_table(
        console, ("demand", title), columns(sizing, units), ((demand.name, demand) for demand in sizing.demands)
    )
    console.conclude(sizing_conclusions(sizing, units))


def _show_table(
    console: Terminal, heading: tuple[str, str], columns: "tuple[Column[Row], ...]", rows: "Iterable[tuple[str, Row]]"
) -> None:
    """A table with a named row for each demand or axis; ``heading`` is the head of the column of names, and the title."""
    names, title = heading
    table = titled(title, names, numbers=[column.title for column in columns])
    for name, row in rows:
        table.add_row(name, *(column.text(row) for column in columns))
    console.show(table, [column.title for column in columns if column.detail])
