"""Options of ``forcefeel compensate`` beside those of recursion (22)."""

from pathlib import Path
from typing import Annotated

import typer

from forcefeel.threads import MOST_THREADS

_METHOD = "Methods"

CompensateMethod = Annotated[
    str | None,
    typer.Option(
        "--method",
        help="auto tries all methods that the loader can run and chooses one; or the name of one: original, published, converged, "
        "and for a digital controller load-cell, observer, recovered, h-infinity, robust. In place of the options of "
        "recursion (22).",
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
CompensateEnvelope = Annotated[
    bool,
    typer.Option(
        "--envelope",
        help="With a method's name: try it over the envelope too, as auto does.",
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
CompensateGrid = Annotated[
    list[str] | None,
    typer.Option(
        "--grid",
        help="Settings of the envelope along an axis: 'stiffness=1..100 %:6:log' (of G_max), 'frequency=0.5..4 Hz:4:log', "
        "'damping=0.1, 0.3, 0.7, 1.5', which are the defaults. May be given again.",
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
CompensateRule = Annotated[
    str | None,
    typer.Option(
        "--rule",
        help="Edition of the rule whose release test is asked for.  [default: part60-a-2014]",
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
CompensateOff = Annotated[
    list[str] | None,
    typer.Option(
        "--off",
        help="Over the envelope: how far a parameter of the plant is off to either side, as `envelope` takes it.",
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
CompensateOut = Annotated[
    Path | None,
    typer.Option(
        "--out",
        help="Folder for compensate.html and results.json.  [default: forcefeel-compensate]",
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
CompensateSaveLaw = Annotated[
    Path | None,
    typer.Option(
        "--save-law",
        help="File (.json) for the law, which --compensator of other commands takes in a name's place: that of the loader's own "
        "setting; with --envelope or --method auto those of the grid's settings too. Nothing is saved where none is found.",
        metavar="FILE.json",
        show_default=False,
    ),
]
CompensateReplace = Annotated[
    bool,
    typer.Option("--replace", help="Replace what is in the folder.", rich_help_panel=_METHOD, show_default=False),
]
CompensateThreads = Annotated[
    int | None,
    typer.Option(
        "--threads",
        help="Threads.  [default: all cores]",
        min=1,
        max=MOST_THREADS,
        rich_help_panel=_METHOD,
        show_default=False,
    ),
]
