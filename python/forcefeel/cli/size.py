"""``forcefeel size``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from rich.table import Table

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderOptions, LoaderOrProject, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.release_options import ASKED, AngleOptions
from forcefeel.cli.terminal import Terminal, answer
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from collections.abc import Iterable

    from forcefeel.sizing import CockpitSizing, Sizing
    from forcefeel.sizing.columns import Column, Row


@dataclass(frozen=True, kw_only=True)
class SizeOptions(AngleOptions, LoaderOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel size``."""

    axis: Annotated[
        Literal["pitch", "roll", "yaw", "stick"] | None,
        option(
            "Which control it is: 14 CFR 25.143(d) limits the forces of each but a stick's.",
            ASKED,
            default="that of a built-in loader, else pitch",
        ),
    ] = None
    out: Annotated[Path, option("Folder for size.html and results.json.", OUTPUT)] = Path("forcefeel-size")

    def sizing(self, path: Path | None) -> "Sizing":
        """The sizing of a loader.

        Raises:
            InputError: If an option or the loader is bad.
        """
        from forcefeel.sizing.run import size_drive

        return size_drive(self.loader(path), self.axis, self.angle_rad)


def run(path: LoaderOrProject = None, /, *, options: SizeOptions = SizeOptions()) -> None:
    """Set what feel and rule ask of the drive, force, speed, torque, heat, beside what motor or valve give.

    In place of a loader also a project file, whose table [axes] names the loader of each axis of a cockpit. Exit status 1 if a
    drive does not give what the programmed feel asks for.

    Example: forcefeel size sidestick-pitch --units si --out size
    """
    from forcefeel.sizing.as_json import cockpit_json, sizing_json
    from forcefeel.sizing.cockpit import size_cockpit
    from forcefeel.sizing.page.folder import FOLDER, write_cockpit, write_sizing

    command = options.command_line(path)
    if project := options.project(path, axis=options.axis):
        FOLDER.check(options.out, replace=options.replace, inputs=(project.path,))
        with all_or_nothing("size", silent=options.json):
            cockpit = size_cockpit(project, options.angle_rad)
            page = write_cockpit(cockpit, options.out, options.units, replace=options.replace, command=command)
        answer(
            {"page": page},
            lambda: cockpit_json(cockpit, options.units),
            lambda terminal: _show_axes(terminal, cockpit, options.units),
            as_json=options.json,
        )
        ok = cockpit.ok
    else:
        with all_or_nothing("size", silent=options.json):
            sizing = options.sizing(path)
            FOLDER.check(options.out, replace=options.replace)
            page = write_sizing(sizing, options.out, options.units, replace=options.replace, command=command)
        answer(
            {"page": page},
            lambda: sizing_json(sizing, options.units),
            lambda terminal: _show(terminal, sizing, options.units),
            as_json=options.json,
        )
        ok = sizing.ok
    if not ok:
        raise SystemExit(BAD_ANSWER)


def _show_axes(console: Terminal, cockpit: "CockpitSizing", units: UnitSystem) -> None:
    from forcefeel.sizing.cockpit import cockpit_conclusions
    from forcefeel.sizing.columns import axis_columns

    _show_table(console, ("axis", f"{cockpit.name}: the drives of its axes"), axis_columns(units), cockpit.axes.items())
    console.conclude(cockpit_conclusions(cockpit, units))


def _show(console: Terminal, sizing: "Sizing", units: UnitSystem) -> None:
    from forcefeel.sizing.columns import columns
    from forcefeel.sizing.findings import sizing_conclusions

    title = f"{sizing.loader.name}, {sizing.plan.axis}: demand at the grip"
    _show_table(
        console, ("demand", title), columns(sizing, units), ((demand.name, demand) for demand in sizing.demands)
    )
    console.conclude(sizing_conclusions(sizing, units))


def _show_table(
    console: Terminal, heading: tuple[str, str], columns: "tuple[Column[Row], ...]", rows: "Iterable[tuple[str, Row]]"
) -> None:
    """A table with a named row for each demand or axis.

    Args:
        console: Where.
        heading: Head of the column of names, and title.
        columns: Its further columns.
        rows: By name.
    """
    names, title = heading
    table = Table(names, title=title, title_justify="left", title_style="bold")
    for column in columns:
        table.add_column(column.title, justify="right")
    for name, row in rows:
        table.add_row(name, *(column.text(row) for column in columns))
    console.show(table, [column.title for column in columns if column.detail])
