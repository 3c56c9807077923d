"""``forcefeel qualify``."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

from cyclopts import Group
from rich.table import Table

from forcefeel.cli.bench_data import options_named
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.law_option import DEFAULT_LAW, LAW_METAVAR, LAW_NAMES, check_law_name, law_option_named
from forcefeel.cli.options import (
    EDITION,
    LOADER,
    OUTPUT,
    FolderOptions,
    LoaderOptions,
    LoaderOrProject,
    OutputOptions,
    filled,
    option,
)
from forcefeel.cli.progress import Bar, all_or_nothing
from forcefeel.cli.scenario_text import value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.loader.axes import FlightAxis, flight_axis

if TYPE_CHECKING:
    from forcefeel.fly import FlightCase, FlightReport
    from forcefeel.loader.loader import Loader
    from forcefeel.qualification.plan import Qualification, QualificationSetup
    from forcefeel.qualification.plan.cockpit import CockpitQualification
    from forcefeel.qualification.plan.run import Progress

FLIGHT = "flight"
"""Folder of the tests in flight, within that of the qualification."""

TESTS = Group("Tests", sort_key=10)
RECORDS = Group("Records", sort_key=20)


class ControlAxis(StrEnum):
    """Which control of the rule."""

    PITCH = "pitch"
    ROLL = "roll"
    YAW = "yaw"
    NOSEWHEEL = "nosewheel"
    BRAKE = "brake"
    COLLECTIVE = "collective"


class Overdamped(StrEnum):
    """What a response without overshoots is judged by."""

    FALL_TIME = "fall time"
    RISE_TIME = "rise time"


def _law_names(_: type, tokens: Any) -> tuple[str, ...]:
    return tuple(check_law_name(token.value) for token in tokens)


@dataclass(frozen=True, kw_only=True)
class QualifyOptions(LoaderOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel qualify``."""

    rule: Annotated[
        str,
        option(
            "Edition of the rule: part60-a-2014, part60-c-2014, part60-d-2014, cs-fstd-a, icao-9625, part60-a-2016. Rows "
            "not verified against the document are marked.",
            TESTS,
            metavar="EDITION",
        ),
    ] = EDITION
    tests: Annotated[
        tuple[str, ...],
        option(
            "Run only this test, such as release-25-positive, static, medium or fast. Repeatable. Exit status 0 if these "
            "pass; the test plan is then marked as incomplete.",
            TESTS,
            "--test",
            default="all tests",
            metavar="NAME",
        ),
    ] = ()
    axis: Annotated[
        ControlAxis | None,
        option("Control in the rule.", TESTS, default="axis of the built-in loader, otherwise pitch"),
    ] = None
    throw: Annotated[
        str | None,
        option(
            "Throw to either side, such as '18 deg'.",
            TESTS,
            default="the column's end stops, otherwise the feel's hard stops, otherwise 20 deg",
            metavar="ANGLE",
        ),
    ] = None
    overdamped: Annotated[
        Overdamped,
        option(
            "Criterion for a reference without overshoot: time from 0.9 to 0.1 of the displacement, or time to 90 % of "
            "the travel.",
            TESTS,
        ),
    ] = Overdamped.FALL_TIME
    dynamic_pressure: Annotated[
        str | None,
        option(
            "Dynamic pressure, such as '5 kPa', for a loader with feel.stiffness_factor.", TESTS, metavar="PRESSURE"
        ),
    ] = None
    aircraft: Annotated[
        str | None,
        option(
            "Also fly the tests in flight, as forcefeel fly --rules does, with an aircraft of JSBSim: 737, T38, c172p, f16, or a "
            "TOML file. Its feel and surface replace the loader's; the flight's page is in the folder flight.",
            TESTS,
            default="no flight",
            metavar="NAME|FILE",
        ),
    ] = None
    references: Annotated[
        tuple[str, ...],
        option(
            "Recorded aircraft instead of the programmed feel: NAME=FILE, where NAME is a test such as "
            "release-25-positive, static, medium or fast; a file whose name or content identifies the test; or a folder "
            "of files named after tests. CSV, Parquet, MATLAB, or MCAP of forcefeel run. Repeatable.",
            RECORDS,
            "--reference",
            metavar="[NAME=]FILE",
        ),
    ] = ()
    records: Annotated[
        tuple[str, ...],
        option(
            "Recorded simulator instead of the simulated loader, as for --reference.",
            RECORDS,
            "--record",
            metavar="[NAME=]FILE",
        ),
    ] = ()
    columns: Annotated[
        tuple[str, ...],
        option(
            "Column of the files of --record and --reference, such as 'position=theta'. STEM: limits this to one file, "
            "named without its ending. Repeatable.",
            RECORDS,
            "--column",
            metavar="[STEM:]COLUMN=NAME",
        ),
    ] = ()
    unit: Annotated[
        tuple[str, ...],
        option(
            "Unit of a column without one in its header, such as 'theta=deg'. Repeatable.",
            RECORDS,
            metavar="[STEM:]NAME=UNIT",
        ),
    ] = ()
    starts: Annotated[
        tuple[str, ...],
        option(
            "Start of the part of --record and --reference to read, in the file's own time, such as '6 s'. STEM= limits "
            "this to one file. Repeatable.",
            RECORDS,
            "--from",
            default="start of the file",
            metavar="[STEM=]TIME",
        ),
    ] = ()
    ends: Annotated[
        tuple[str, ...],
        option(
            "End of the part to read, as for --from.",
            RECORDS,
            "--until",
            default="end of the file",
            metavar="[STEM=]TIME",
        ),
    ] = ()
    conditions: Annotated[
        tuple[str, ...],
        option(
            "Flight condition of points given by --reference, such as 'dynamic pressure=60 lb/ft^2'. Repeatable.",
            RECORDS,
            "--condition",
            default="the only one",
            metavar="NAME=VALUE",
        ),
    ] = ()
    law: Annotated[
        tuple[str, ...],
        option(
            f"Law, designed for this loader: {LAW_NAMES}; or a law file from forcefeel law --save-law. Repeatable, a "
            "section for each.",
            LOADER,
            default=DEFAULT_LAW,
            metavar=LAW_METAVAR,
            converter=_law_names,
        ),
    ] = ()
    compare: Annotated[bool, option("Compare all laws.", LOADER)] = False
    out: Annotated[Path, option("Folder for qualification.html and results.json.", OUTPUT)] = Path(
        "forcefeel-qualification"
    )
    pdf: Annotated[bool, option("Also print the page as qualification.pdf. Requires Chromium.", OUTPUT)] = False
    simulator: Annotated[
        str, option("Simulator, for the field on the page.", OUTPUT, default="a blank line", metavar="TEXT")
    ] = ""
    operator: Annotated[
        str, option("Operator, for the field on the page.", OUTPUT, default="a blank line", metavar="TEXT")
    ] = ""

    def setup(self, loader: "Loader") -> "QualificationSetup":
        """How a loader is qualified.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        from forcefeel.laws.law import names_for
        from forcefeel.qualification.plan import QualificationSetup

        for name, given in (("--law", self.law), ("--compare", self.compare)):
            if given and self.records:
                raise InputError(f"{name}: is about the simulated loader, and --record takes its place; leave one out")
        if self.law and self.compare:
            raise InputError("--compare: takes every law, and --law some; leave one out")
        pressure = self.dynamic_pressure
        return filled(
            QualificationSetup,
            self,
            laws=names_for(loader) if self.compare else self.law or None,
            throw_rad=None if self.throw is None else value("--throw", self.throw, "rad", "18 deg"),
            units=self.unit,
            dynamic_pressure_pa=None if pressure is None else value("--dynamic-pressure", pressure, "Pa", "5 kPa"),
            system=self.units,
        )


def run(path: LoaderOrProject = None, /, *, options: QualifyOptions = QualifyOptions()) -> None:
    """Run the control feel tests of a qualification rule on a loader, or on records of a simulator.

    The reference is the programmed feel or a recorded aircraft. The verdict is qualified, not qualified, or incomplete. Exit status
    0 if qualified, or if all tests of --test pass; otherwise 1.

    For a project file with a table [axes], writes one test guide for all axes.

    Example: forcefeel qualify my.toml --compare --pdf
    """
    from forcefeel.linked import check_link
    from forcefeel.loader.project import Project
    from forcefeel.page.chromium import find_chromium
    from forcefeel.qualification.page.page import FOLDER, write_qualification
    from forcefeel.qualification.plan import qualify_loader
    from forcefeel.qualification.plan.as_json import qualification_json
    from forcefeel.qualification.plan.cockpit import qualify_cockpit

    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    if options.pdf:
        find_chromium()
    one_loader = {
        "axis": options.axis,
        "record": options.records,
        "reference": options.references,
        "aircraft": options.aircraft,
    }
    subject = options.project(path, **one_loader) or options.loader(path)
    flight = None if isinstance(subject, Project) else _flight(subject, options)
    if flight is not None:
        subject = flight.feel
    with _progress(options) as (bar, show), options_named(), law_option_named():
        qualification: Qualification | CockpitQualification = (
            qualify_cockpit(subject, options.setup, check_link=check_link, progress=show)
            if isinstance(subject, Project)
            else qualify_loader(subject, options.setup(subject), progress=show)
        )
        command = options.command_line(path)
        flown, flight_page = (None, None) if flight is None else _fly(flight, options, command, bar.describe)
        show("report", bar.total, bar.total)
        page = write_qualification(qualification, options.out, pdf=options.pdf, command=command)
    pages = {"page": page} if flight_page is None else {"page": page, "flight_page": flight_page}
    answer(
        pages,
        lambda: qualification_json(qualification) | _flight_json(flown, options),
        lambda terminal: _show(terminal, qualification, flown),
        as_json=options.json,
    )
    if not qualification.fulfilled or (flown is not None and not flown.fulfilled):
        raise SystemExit(BAD_ANSWER)


def _flight(loader: "Loader", options: QualifyOptions) -> "FlightCase | None":
    """Loader and aircraft of the tests in flight.

    Raises:
        InputError: If an option is of another loader or law, or the aircraft does not trim.
    """
    if options.aircraft is None:
        return None
    for name, given in (
        ("--record", options.records),
        ("--reference", options.references),
        ("--compare", options.compare),
    ):
        if given:
            raise InputError(f"{name}: --aircraft flies the simulated loader with the aircraft's feel; leave one out")
    if len(options.law) > 1:
        raise InputError("--law: --aircraft takes one; fly the others in a run of their own")
    if options.axis not in (None, *get_args(FlightAxis)):
        raise InputError(f"--axis: --aircraft flies {', '.join(get_args(FlightAxis))}, got {options.axis}")
    from forcefeel.fly import FlightCase
    from forcefeel.fly.page.page import FOLDER

    FOLDER.check(options.out / FLIGHT, replace=options.replace)
    axis: FlightAxis | None = None if options.axis is None else flight_axis(options.axis)
    case = FlightCase.of(loader, options.aircraft, law=options.law[0] if options.law else None, axis=axis)
    _ = case.designed  # what cannot run live is refused before the work
    return case


def _flight_json(flown: "FlightReport | None", options: QualifyOptions) -> dict[str, Any]:
    if flown is None:
        return {}
    from forcefeel.fly.as_json import report_json

    return {"flight": report_json(flown, options.units)}


def _fly(
    flight: "FlightCase", options: QualifyOptions, command: str, tell: "Callable[[str], None]"
) -> "tuple[FlightReport, Path]":
    """The tests in flight, and their page."""
    from forcefeel.fly import fly_rules, write_flight

    flown = fly_rules(flight, tell)
    return flown, write_flight(flown, options.out / FLIGHT, options.units, replace=options.replace, command=command)


@contextmanager
def _progress(options: QualifyOptions) -> "Iterator[tuple[Bar, Progress]]":
    """The line of the command, and what to call as each test begins."""
    with all_or_nothing("qualify", "tests", silent=options.json, even=False) as bar:
        bar.describe("laws")

        def show(test: str, done: int, total: int) -> None:
            bar.describe(test)
            bar.show(done, total)

        yield bar, show


def _show_axes(console: Terminal, cockpit: "CockpitQualification") -> None:
    from forcefeel.qualification.plan.cockpit import cockpit_conclusions

    table = titled(f"{cockpit.name}: test guide", "axis", "test", "outcome", "law", "number")
    for axis, qualification in cockpit.axes.items():
        for section in qualification.sections:
            for result in section.results:
                trial = result.trial
                table.add_row(axis, trial.key, str(result.outcome), section.title, trial.test.number)
        table.add_section()
    console.show(table)
    for name, checks in cockpit.links.items():
        table = titled(f"Link {name}: forcefeel's own checks", "check", "outcome", numbers=("value", "limit"))
        for check in checks:
            table.add_row(check.name, check.outcome, *check.texts(cockpit.system))
        console.show(table)
    console.conclude(cockpit_conclusions(cockpit))


def _show(
    console: Terminal, qualification: "Qualification | CockpitQualification", flown: "FlightReport | None"
) -> None:
    from forcefeel.qualification.plan.cockpit import CockpitQualification
    from forcefeel.qualification.plan.sentences import conclusions

    if isinstance(qualification, CockpitQualification):
        _show_axes(console, qualification)
        return
    title = f"{qualification.loader.name}, {qualification.rules.title} ({qualification.rules.edition}), {qualification.axis}"
    console.show((_tests if len(qualification.sections) <= _SIDE_BY_SIDE else _counts)(qualification, title))
    console.conclude(conclusions(qualification))
    if flown is not None:
        from forcefeel.cli.fly import show_report

        show_report(console, flown, qualification.system)


_SIDE_BY_SIDE = 3
"""Laws whose outcomes a terminal shows test by test."""


def _tests(qualification: "Qualification", title: str) -> Table:
    """Test by test, a column for each law."""
    table = titled(title, "test", *(section.title for section in qualification.sections), "number")
    for results in zip(*(section.results for section in qualification.sections), strict=True):
        trial = results[0].trial
        table.add_row(trial.key, *(str(result.outcome) for result in results), trial.test.number)
    return table


def _counts(qualification: "Qualification", title: str) -> Table:
    """What each law came to, and how many tests came to what."""
    from forcefeel.qualification import Outcome

    table = titled(title, "law", "status", numbers=map(str, Outcome))
    for section in qualification.sections:
        counts = (str(section.count(outcome)) for outcome in Outcome)
        table.add_row(section.title, str(section.status), *counts)
    return table
