"""Options of ``forcefeel sweep`` alone."""

from typing import Annotated

import typer

_SWEEP = "What is swept"
_WORK = "Where it is computed"

Runs = Annotated[
    int | None,
    typer.Option(
        "--runs",
        help="How many loaders are drawn from the tolerances; with --grid, at each of its points.  [default: 10000; with "
        "--grid the nominal one alone]",
        rich_help_panel=_SWEEP,
        show_default=False,
    ),
]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        help="A tolerance beside or in place of the loader file's: 'linkage.stiffness=20 %', "
        '\'column.coulomb_friction=1 lb..5 lb\', \'load_cell.gain={ normal = "2 %", low = "-6 %", high = "6 %" }\', '
        "'valve.rated_flow=none'. May be given again.",
        rich_help_panel=_SWEEP,
    ),
]
Grid = Annotated[
    list[str] | None,
    typer.Option(
        "--grid",
        help="A setting over a grid: 'feel.stiffness=288..28800 lb in/rad:40:log' for 40 values evenly in proportion. Given "
        "twice, a map over two.",
        rich_help_panel=_SWEEP,
    ),
]
Redesign = Annotated[
    bool,
    typer.Option(
        "--redesign",
        help="Design the gains of --compensator anew for each setting I, B, G of the feel that --grid or --vary gives, for the "
        "nominal machine; not given, one law, that of the loader file's setting, drives all.",
        rich_help_panel=_SWEEP,
    ),
]
Threads = Annotated[
    int | None,
    typer.Option("--threads", help="Threads here.  [default: all cores]", rich_help_panel=_WORK, show_default=False),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Compute on a Dask cluster instead, such as tcp://host:8786; needs the extra forcefeel[cluster].",
        rich_help_panel=_WORK,
    ),
]
