"""Options of ``forcefeel envelope`` alone."""

from typing import Annotated

import typer

from forcefeel.threads import MOST_THREADS

_WHAT = "What is asked"

EnvelopeGrid = Annotated[
    list[str] | None,
    typer.Option(
        "--grid",
        help="Values along an axis: 'stiffness=1..100 %:25:log' (of G_max), 'frequency=0.5..4 Hz:16:log', "
        "'damping=0.1, 0.2, 0.4, 0.7, 1, 1.5', which are the defaults. May be given again.",
        rich_help_panel=_WHAT,
    ),
]
EnvelopeCompensators = Annotated[
    list[str] | None,
    typer.Option(
        "--compensator",
        help="original, published or converged; for a digital controller load-cell, observer, recovered, "
        "h-infinity or robust. Laws are "
        "designed anew for each setting. May be given again.  [default: published]",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
EnvelopeCompare = Annotated[
    bool, typer.Option("--compare", help="All compensators side by side.", rich_help_panel=_WHAT, show_default=False)
]
EnvelopeRule = Annotated[
    str | None,
    typer.Option(
        "--rule",
        help="Edition of the rule whose release test is asked for.  [default: part60-a-2014]",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
EnvelopeAngle = Annotated[
    str | None,
    typer.Option(
        "--angle",
        help="Angle of the release, such as '10 deg'.  [default: half the throw's shorter side; 10 deg without stops]",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
EnvelopeOff = Annotated[
    list[str] | None,
    typer.Option(
        "--off",
        help="How far a parameter of the plant is off to either side, such as 'column.inertia=2 %', in place of the loader file's "
        "tolerance, or the 20 % (the valve's gain 30 %) assumed where it gives none; 'none' for not at all. May be given again.",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
EnvelopeDraws = Annotated[
    int,
    typer.Option(
        "--draws", help="Machines drawn with all tolerances at once; 0 for none.", min=0, rich_help_panel=_WHAT
    ),
]
EnvelopeSeed = Annotated[
    int, typer.Option("--seed", help="Of the draws; the same seed, the same machines.", min=0, rich_help_panel=_WHAT)
]
EnvelopeCorners = Annotated[
    bool,
    typer.Option(
        "--corners",
        help="Draw machines with every tolerance at one of its ends, in place of anywhere between.",
        rich_help_panel=_WHAT,
        show_default=False,
    ),
]
EnvelopeThreads = Annotated[
    int | None,
    typer.Option("--threads", help="Threads.  [default: all cores]", min=1, max=MOST_THREADS, show_default=False),
]
