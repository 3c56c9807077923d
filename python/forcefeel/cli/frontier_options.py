"""Options of ``forcefeel frontier`` alone."""

from typing import Annotated

import typer

_WHAT = "What is asked"

FrontierGrid = Annotated[
    list[str] | None,
    typer.Option(
        "--grid",
        help="Values along an axis: 'stiffness=1.39..72 %:7:log' (of G_max), 'frequency=0.616..3.25 Hz:5:log', "
        "'damping=0.1, 0.4, 0.7, 1.5', the middles of 140 cells, are the defaults. May be given again. Each setting is released "
        "some 450 times.",
        rich_help_panel=_WHAT,
    ),
]
FrontierCompensator = Annotated[
    str | None,
    typer.Option(
        "--compensator",
        help="The law, as `envelope` takes it.  [default: robust; published without a digital controller]",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
