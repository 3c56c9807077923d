"""Options of ``forcefeel excite`` alone."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from forcefeel.cli.law_option import METAVAR, law_name

_WHAT = "What is asked"
_SIGNAL = "The signal"
_LIMITS = "Limits"


class ExciteKind(StrEnum):
    """Kinds of signal."""

    MULTISINE = "multisine"
    CHIRP = "chirp"


ExciteFit = Annotated[
    str,
    typer.Option(
        "--fit",
        help="Parameters to be determined, by symbol or part.name: k,c,J,C_i.",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
ExciteExperiment = Annotated[
    str,
    typer.Option(
        "--experiment",
        help="Loop and drive: servo-open, servo-closed (test signal at the amplifier), loader (force at the grip); with another "
        "drive as in 'loader test_signal', or 'servo-closed command_signal' where the controller adds the signal to its command.",
        rich_help_panel=_WHAT,
    ),
]
ExciteMeasure = Annotated[
    str | None,
    typer.Option(
        "--measure",
        help="Channels that are recorded.  [default: column_angle,piston_position,load_pressure]",
        rich_help_panel=_WHAT,
    ),
]
ExciteNoise = Annotated[
    list[str] | None,
    typer.Option(
        "--noise",
        help="White noise: as a share of each channel's r.m.s. under even lines that reach the limits, or of one channel, such as "
        "'column_angle=0.01 deg'.  [default: 1 %]",
        rich_help_panel=_WHAT,
    ),
]
ExciteLaw = Annotated[
    str | None,
    typer.Option(
        "--compensator",
        parser=law_name,
        metavar=METAVAR,
        help="The law of the whole loader, for the experiment loader.  [default: original]",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
ExciteKindOption = Annotated[ExciteKind, typer.Option("--kind", help="What kind of signal.", rich_help_panel=_SIGNAL)]
ExciteTime = Annotated[
    float, typer.Option("--time", help="Length in s; six periods fit in it at least.", rich_help_panel=_SIGNAL)
]
ExciteRate = Annotated[
    float,
    typer.Option("--rate", help="Samples per second, four per cycle of the highest line.", rich_help_panel=_SIGNAL),
]
ExciteFrom = Annotated[
    float | None,
    typer.Option("--from", help="Lowest frequency in Hz.  [default: one cycle a period]", rich_help_panel=_SIGNAL),
]
ExciteTo = Annotated[
    float | None,
    typer.Option(
        "--to",
        help="Highest frequency in Hz.  [default: the valve's natural frequency, or a quarter of the rate]",
        rich_help_panel=_SIGNAL,
    ),
]
ExciteCurrent = Annotated[
    str | None,
    typer.Option(
        "--limit-current",
        help="Largest valve current, with its unit.  [default: 80 % of the amplifier's limit or the valve's rating]",
        rich_help_panel=_LIMITS,
    ),
]
ExciteTravel = Annotated[
    str | None,
    typer.Option(
        "--limit-travel",
        help="Largest column angle, with its unit.  [default: 10 deg, or 80 % of the way to an end stop]",
        rich_help_panel=_LIMITS,
    ),
]
ExciteForce = Annotated[
    str | None,
    typer.Option(
        "--limit-force",
        help="Largest force at the load cell, with its unit.  [default: two thirds of supply pressure times piston area]",
        rich_help_panel=_LIMITS,
    ),
]
ExciteDrive = Annotated[
    str | None,
    typer.Option(
        "--limit-drive",
        help="Largest test signal or force at the grip, with its unit.  [default: 10 V or the controller's range; pilot.force]",
        rich_help_panel=_LIMITS,
    ),
]
ExciteOut = Annotated[Path, typer.Option("--out", help="CSV file for the bench.")]
