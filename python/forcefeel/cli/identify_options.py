"""Options of ``forcefeel identify``, and of ``forcefeel resonance``, which reads the same files."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from forcefeel.cli.law_option import METAVAR, law_name


class IdentifyLoss(StrEnum):
    """What large residuals cost."""

    HUBER = "huber"
    LINEAR = "linear"
    SOFT_L1 = "soft_l1"
    CAUCHY = "cauchy"


_DATA, _FIT, _LOADER = "Bench data", "Fit", "Loader and law"


def _option(name: str, help: str, panel: str, metavar: str) -> Any:  # noqa: A002  Typer's word
    return typer.Option(name, help=help, rich_help_panel=panel, metavar=metavar, show_default=False)


BenchFiles = Annotated[
    list[Path],
    _option(
        "--data",
        "A file of bench data: a frequency response (CSV) or a record in time (CSV, Parquet, MATLAB). May be given again.",
        _DATA,
        "FILE",
    ),
]
BenchFile = Annotated[
    Path,
    _option("--data", "A frequency response (CSV), or a record in time (CSV, Parquet, MATLAB).", _DATA, "FILE"),
]
BenchExperiment = Annotated[
    list[str] | None,
    _option(
        "--experiment",
        "Under which experiment a file was measured, if it does not say so itself: servo-open, servo-closed or loader, and what "
        "drives it (test_signal, command_signal, pilot_force, release), or release or sweep. With STEM=, the file's name without "
        "its ending, for that file alone, as in the options below. May be given again.",
        _DATA,
        "[STEM=]EXPERIMENT",
    ),
]
BenchFrom = Annotated[
    list[str] | None,
    _option("--from", "Channel that a response leads from, such as 'test_signal (V)'.", _DATA, "[STEM=]CHANNEL"),
]
BenchTo = Annotated[
    list[str] | None,
    _option("--to", "Channel that a response leads to, such as 'column_angle (deg)'.", _DATA, "[STEM=]CHANNEL"),
]
BenchColumn = Annotated[
    list[str] | None,
    _option(
        "--column",
        "What a file calls a channel or another column, such as 'column_angle=theta'. May be given again.",
        _DATA,
        "[STEM:]CHANNEL=NAME",
    ),
]
BenchUnit = Annotated[
    list[str] | None,
    _option(
        "--unit",
        "Unit of a column whose header has none, such as 'theta=deg'. May be given again.",
        _DATA,
        "[STEM:]NAME=UNIT",
    ),
]
BenchHold = Annotated[
    list[str] | None,
    _option(
        "--hold",
        "How the drive of a record runs between two samples: straight, or as a staircase.",
        _DATA,
        "[STEM=]straight|staircase",
    ),
]
IdentifyFit = Annotated[
    str, _option("--fit", "Symbols or names of the parameters, such as k,c,J,C_i.", _FIT, "PARAMETERS")
]
IdentifyStarts = Annotated[
    int,
    typer.Option(
        "--starts",
        help="How many places the search begins at: the file's values, then others within the tolerances.",
        min=1,
        rich_help_panel=_FIT,
    ),
]
IdentifyLossOption = Annotated[
    IdentifyLoss,
    typer.Option(
        "--loss",
        help="What large residuals cost: those beyond three deviations count less with huber, linear is plain least squares.",
        rich_help_panel=_FIT,
    ),
]
NoPriors = Annotated[
    bool,
    typer.Option(
        "--no-priors",
        help="Take the file's normal tolerances for bounds only, not for knowledge.",
        rich_help_panel=_FIT,
    ),
]
AsResponses = Annotated[
    bool,
    typer.Option(
        "--responses",
        help="Turn records into frequency responses first, and fit the linear model to those.",
        rich_help_panel=_FIT,
    ),
]
IdentifyLaw = Annotated[
    str | None,
    typer.Option(
        "--compensator",
        parser=law_name,
        metavar=METAVAR,
        help="The law of the whole loader in the data, designed for the loader as its file has it.  [default: original]",
        rich_help_panel=_LOADER,
        show_default=False,
    ),
]
ResonanceBand = Annotated[
    str | None,
    _option("--band", "Where to look, such as '8..16 Hz'.  [default: all of the data]", "Resonance", "FREQUENCIES"),
]
ResonanceChannel = Annotated[
    str | None,
    _option(
        "--channel",
        "Of a record: the measured channel whose response to the drive is read.  [default: column_angle]",
        "Resonance",
        "CHANNEL",
    ),
]
