"""Options of ``forcefeel schedule`` alone."""

from pathlib import Path
from typing import Annotated

import typer

_WHAT = "What is asked"

ScheduleKnots = Annotated[
    Path,
    typer.Option(
        "--knots",
        help="CSV with a row for each knot of a full grid: a column for each axis, such as 'dynamic pressure (lb/ft^2)', and the "
        "setting as 'stiffness (lb in/rad)', 'frequency (Hz)', 'damping ratio', or as I, B, G with their units.",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
ScheduleMethod = Annotated[
    str,
    typer.Option(
        "--method",
        help="How the laws are designed: robust, h-infinity, recovered, observer or load-cell.",
        rich_help_panel=_WHAT,
    ),
]
ScheduleRefine = Annotated[
    int,
    typer.Option(
        "--refine", help="Into how many parts the way between two knots is cut.", min=2, rich_help_panel=_WHAT
    ),
]
