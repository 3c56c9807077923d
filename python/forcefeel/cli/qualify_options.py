"""The options of ``forcefeel qualify``."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from forcefeel.cli.law_option import METAVAR, law_name


class ControlAxis(StrEnum):
    """Which control of the rule."""

    PITCH = "pitch"
    ROLL = "roll"
    YAW = "yaw"
    NOSEWHEEL = "nosewheel"
    COLLECTIVE = "collective"


class Overdamped(StrEnum):
    """What a response without overshoots is judged by."""

    FALL_TIME = "fall time"
    RISE_TIME = "rise time"


_TESTS, _RECORDS, _LOADER, _PAGE = "Tests", "Records", "Loader and law", "Page"

QualifyRule = Annotated[
    str | None,
    typer.Option(
        "--rule",
        help="Edition of the rule: part60-a-2014, part60-c-2014, part60-d-2014, cs-fstd-a, icao-9625, part60-a-2016. "
        "Rows that nobody has held against the document say so.  [default: part60-a-2014]",
        rich_help_panel=_TESTS,
        metavar="EDITION",
        show_default=False,
    ),
]
Tests = Annotated[
    list[str] | None,
    typer.Option(
        "--test",
        help="Make this test alone, such as release-25-positive, static, medium or fast. May be given again. Exit status 0 if all "
        "that are asked for pass; without the rest of the programme that is incomplete, and said to be.  [default: the programme]",
        rich_help_panel=_TESTS,
        metavar="NAME",
        show_default=False,
    ),
]
AxisOption = Annotated[
    ControlAxis, typer.Option("--axis", help="Which control of the rule.", rich_help_panel=_TESTS, metavar="AXIS")
]
ThrowOption = Annotated[
    str | None,
    typer.Option(
        "--throw",
        help="Throw to either side, such as '18 deg'.  [default: the column's end stops, else the feel's hard stops, else 20 deg]",
        rich_help_panel=_TESTS,
        metavar="ANGLE",
        show_default=False,
    ),
]
OverdampedOption = Annotated[
    Overdamped,
    typer.Option(
        "--overdamped",
        help="What a reference without overshoots is judged by: the time from 0.9 to 0.1 of the displacement, or that to 90 % "
        "of the way.",
        rich_help_panel=_TESTS,
        metavar="'fall time'|'rise time'",
    ),
]
Pressure = Annotated[
    str | None,
    typer.Option(
        "--dynamic-pressure",
        help="For a loader with feel.stiffness_factor, such as '5 kPa'.",
        rich_help_panel=_TESTS,
        metavar="PRESSURE",
        show_default=False,
    ),
]
References = Annotated[
    list[str] | None,
    typer.Option(
        "--reference",
        help="A recorded aircraft in place of the programmed feel: NAME=FILE, NAME being a test such as release-25-positive, "
        "static, medium or fast; a file alone, whose test is told from its name or from what is in it; or a folder of files "
        "named after tests. CSV, Parquet or MATLAB. May be given again.",
        rich_help_panel=_RECORDS,
        metavar="[NAME=]FILE",
        show_default=False,
    ),
]
Recorded = Annotated[
    list[str] | None,
    typer.Option(
        "--record",
        help="A recorded simulator in place of the simulated loader, as --reference.",
        rich_help_panel=_RECORDS,
        metavar="[NAME=]FILE",
        show_default=False,
    ),
]
RecordColumns = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        help="What the files of --record and --reference call a column, such as 'position=theta'; with STEM:, the file's name "
        "without its ending, in that file alone. May be given again.",
        rich_help_panel=_RECORDS,
        metavar="[STEM:]COLUMN=NAME",
        show_default=False,
    ),
]
RecordUnits = Annotated[
    list[str] | None,
    typer.Option(
        "--unit",
        help="Unit of a column whose header has none, such as 'theta=deg'. May be given again.",
        rich_help_panel=_RECORDS,
        metavar="[STEM:]NAME=UNIT",
        show_default=False,
    ),
]
Laws = Annotated[
    list[str] | None,
    typer.Option(
        "--compensator",
        help="The law: the original position loop, or one that is designed for this loader: feedback gains of recursion (22), over "
        "the published or an endless horizon, or a sampled law; or the file of one, from `compensate --save-law`. Given again, a "
        "section each.  [default: original]",
        parser=law_name,
        metavar=METAVAR,
        rich_help_panel=_LOADER,
        show_default=False,
    ),
]
AllLaws = Annotated[bool, typer.Option("--compare", help="Every --compensator side by side.", rich_help_panel=_LOADER)]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Changes a value of the loader, such as 'column.coulomb_friction=3 lb'. May be given again.",
        rich_help_panel=_LOADER,
        metavar="NAME=VALUE",
        show_default=False,
    ),
]
Simulator = Annotated[
    str,
    typer.Option(
        "--simulator",
        help="Which simulator, for its field on the page.  [default: a blank line]",
        rich_help_panel=_PAGE,
        metavar="TEXT",
        show_default=False,
    ),
]
Operator = Annotated[
    str,
    typer.Option(
        "--operator",
        help="Who made the tests, for the field on the page.  [default: a blank line]",
        rich_help_panel=_PAGE,
        metavar="TEXT",
        show_default=False,
    ),
]
OutFolder = Annotated[Path, typer.Option("--out", help="Folder for qualification.html and results.json.")]
Pdf = Annotated[bool, typer.Option("--pdf", help="Print the page as qualification.pdf too; it takes a Chromium.")]
