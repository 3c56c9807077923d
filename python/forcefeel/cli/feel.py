"""``forcefeel feel``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.options import OUTPUT, DataSheetOptions, LoaderFile, OutputOptions, option
from forcefeel.cli.scenario_text import value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.files import check_output_file, is_same, write_whole
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.feel import FeelFit, FeelPlan
    from forcefeel.loader.loader import Loader
    from forcefeel.qualification import ForcePoints
    from forcefeel.tables.column_names import ColumnNames

DATA = Group("Measurements", sort_key=10)
STATED = Group("Known numbers", sort_key=20)


@dataclass(frozen=True, kw_only=True)
class FeelOptions(DataSheetOptions, OutputOptions):
    """The options of ``forcefeel feel``."""

    points: Annotated[
        Path,
        option(
            "Points of force over position: CSV, Parquet, MATLAB or MCAP with columns such as 'position (deg),force (lb)', "
            "optionally 'direction', 'time (s)', 'force uncertainty (lb)' and flight conditions.",
            DATA,
            "--from",
            metavar="FILE",
        ),
    ]
    release: Annotated[
        Path | None, option("Recorded release, angle over time, for frequency and damping.", DATA, metavar="FILE")
    ] = None
    condition: Annotated[
        tuple[str, ...],
        option(
            "Flight condition to take from the file, such as 'dynamic pressure=120 lb/ft^2'. Repeatable.",
            DATA,
            default="the only one",
            metavar="NAME=VALUE",
        ),
    ] = ()
    neutral: Annotated[
        str | None,
        option(
            "Position of the trimmed control in the file, such as '1.5 deg'.", DATA, default="0", metavar="POSITION"
        ),
    ] = None
    columns: Annotated[
        tuple[str, ...],
        option(
            "Column of the files, such as 'position=theta'. STEM: limits this to one file. Repeatable.",
            DATA,
            "--column",
            metavar="[STEM:]COLUMN=NAME",
        ),
    ] = ()
    unit: Annotated[
        tuple[str, ...],
        option("Unit of a column without one, such as 'theta=deg'. Repeatable.", DATA, metavar="[STEM:]NAME=UNIT"),
    ] = ()
    breakout: Annotated[str | None, option("Breakout force.", STATED, default="from the points", metavar="FORCE")] = (
        None
    )
    friction: Annotated[
        str | None, option("Friction at the grip.", STATED, default="from the points", metavar="FORCE")
    ] = None
    frequency: Annotated[
        str | None,
        option("Natural frequency.", STATED, default="from the release, otherwise the loader's", metavar="FREQUENCY"),
    ] = None
    damping: Annotated[
        str | None,
        option("Damping ratio.", STATED, default="from the release, otherwise the loader's", metavar="RATIO"),
    ] = None
    out: Annotated[Path, option("Loader file to write.", OUTPUT, metavar="FILE")]
    knots: Annotated[
        Path | None,
        option(
            "File of knots for forcefeel schedule, to write: the spring rate at each flight condition of the file.",
            OUTPUT,
            default="none",
            metavar="FILE",
        ),
    ] = None
    report: Annotated[
        Path | None, option("Folder for feel.html and results.json.", OUTPUT, default="no page", metavar="FOLDER")
    ] = None
    replace: Annotated[bool, option("Replace existing files.", OUTPUT)] = False

    def plan(self, loader: "Loader") -> "FeelPlan":
        """The request for a loader.

        Raises:
            InputError: If a number or the release is bad.
        """
        from forcefeel.feel import FeelPlan
        from forcefeel.qualification import read_record

        def stated(name: str, unit: str, example: str) -> float | None:
            text = getattr(self, name)
            return None if text is None else value(f"--{name}", text, unit, example)

        try:
            return FeelPlan(
                loader,
                stated("breakout", "N", "8 N"),
                stated("friction", "N", "6 N"),
                stated("frequency", "rad/s", "2 Hz"),
                stated("damping", "", "0.2"),
                None
                if self.release is None
                else read_record(self.release, name=self.release.name, **self._names().arguments(self.release.stem)),
            )
        except InputError as error:
            name, _, fault = str(error).partition(":")
            if name not in _OPTIONS:
                raise
            raise InputError(f"{_OPTIONS[name]}:{fault}") from error

    def measured(self) -> "ForcePoints":
        """The points of all conditions.

        Raises:
            InputError: If the file is bad.
        """
        from forcefeel.qualification import read_force_points

        points = read_force_points(self.points, **self._names().arguments(self.points.stem))
        if self.neutral is not None:
            points = points.about(value("--neutral", self.neutral, points.position_unit, "1.5 deg"))
        return points

    def _names(self) -> "ColumnNames":
        from forcefeel.tables.column_names import ColumnNames

        stems = [path.stem for path in (self.points, self.release) if path is not None]
        return ColumnNames.of(self.columns, self.unit, stems)

    def check(self) -> None:
        """Refuses files that cannot be written.

        Raises:
            InputError: If so.
        """
        from forcefeel.feel.page.page import FOLDER

        inputs = tuple(path for path in (self.points, self.release, self.data_sheet) if path is not None)
        for name, target in (("--out", self.out), ("--knots", self.knots)):
            if target is None:
                continue
            if any(is_same(path, target) for path in inputs):
                raise InputError(f"{name}: {target} is what the feel is made from; name another file")
            check_output_file(target, replace=self.replace)
        if self.report is not None:
            FOLDER.check(self.report, replace=self.replace, inputs=inputs)


_OPTIONS = {
    name: f"--{name.partition('_')[0]}" for name in ("breakout", "friction", "frequency", "damping_ratio", "release")
}
"""Option of each argument that a plan names in a message."""


def run(path: LoaderFile = None, /, *, options: FeelOptions) -> None:
    """Make a feel from measured force over position and a recorded release.

    Replaces the feel of the loader and writes the loader file. Prints each row with its 95 % interval, and the rows that the data
    leave open.

    Example: forcefeel feel elevator-2khz --from flight.csv --frequency "2 Hz" --damping 0.2 --out my.toml
    """
    from forcefeel.feel import fit_feel, write_feel
    from forcefeel.feel.as_json import feel_json
    from forcefeel.feel.knots import check_conditions, knots_csv

    options.check()
    loader = options.loader(path)
    points = options.measured()
    if options.knots:
        check_conditions(points)
    fit = fit_feel(points.of_condition(options.condition), options.plan(loader))
    knots = options.knots and knots_csv(points, fit, options.units)
    page = None
    if options.report is not None:
        command = options.command_line(path)
        page = write_feel(fit, options.report, options.units, replace=options.replace, command=command)
    if options.knots and knots:
        write_whole(options.knots, knots)
    write_whole(options.out, fit.loader.to_toml(options.units))
    answer(
        {"loader_file": options.out, "knots": options.knots, "page": page},
        lambda: feel_json(fit, options.units),
        lambda terminal: _show(terminal, fit, options.units),
        as_json=options.json,
    )


def _show(console: Terminal, fit: "FeelFit", units: UnitSystem) -> None:
    from forcefeel.feel import feel_conclusions
    from forcefeel.feel.findings import row_cells

    table = titled(f"{fit.loader.name}: feel from {fit.points.name}", "row", numbers=("value", "95 % interval"))
    for head in ("unit", "from"):
        table.add_column(head)
    for key, value_text, half, unit, source in row_cells(fit, units):
        table.add_row(key, value_text, f"± {half}" if half and half[0] != "a" else half, unit, source)
    console.show(table)
    console.conclude(feel_conclusions(fit, units))
