"""Options that several commands share."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from forcefeel.units import UnitSystem


class Coupling(StrEnum):
    """How the pilot's force enters the feel computer's row of eq. (19)."""

    REPORT = "report"
    COLUMN = "column"


LoaderFile = Annotated[
    Path | None,
    typer.Argument(metavar="LOADER", help="Loader file, or a built-in one: elevator (if left out), elevator-2khz."),
]
Units = Annotated[UnitSystem, typer.Option("--units", help="Units of what is shown or written.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]

_DESIGN = "Recursion (22)"
Horizon = Annotated[
    float | None,
    typer.Option(
        "--horizon", help="Length of the horizon in s; 0.05, the published one, if not given.", rich_help_panel=_DESIGN
    ),
]
Converge = Annotated[
    bool, typer.Option("--converge", help="Run until the gains stand still instead.", rich_help_panel=_DESIGN)
]
Step = Annotated[
    float | None, typer.Option("--step", help="Sampling step in s.  [default: 1e-4]", rich_help_panel=_DESIGN)
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance", help="With --converge: largest change of a gain.  [default: 1e-10]", rich_help_panel=_DESIGN
    ),
]
PositionWeight = Annotated[
    float | None,
    typer.Option("--position-weight", help="Weight of (delta - theta)^2.  [default: 100]", rich_help_panel=_DESIGN),
]
R1 = Annotated[
    float | None,
    typer.Option("--r1", help="Weight R_1 of the squared velocity error.  [default: 0]", rich_help_panel=_DESIGN),
]
R2 = Annotated[float | None, typer.Option("--r2", help="Weight R_2 of e^2.  [default: 0.1]", rich_help_panel=_DESIGN)]
PilotCoupling = Annotated[
    Coupling | None,
    typer.Option(
        "--pilot-coupling",
        help="How F_p enters the computer's row, for c_7: as the report did (-alpha R_b) or as the column does (R_p)."
        "  [default: report; column with --converge]",
        rich_help_panel=_DESIGN,
    ),
]
Q = Annotated[
    Path | None,
    typer.Option(
        "--q",
        help="[Q] whole: CSV, 7 rows of 7, SI units, order x_p p delta delta' x_b x_b' F_p.",
        rich_help_panel=_DESIGN,
    ),
]
