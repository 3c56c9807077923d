"""The page of a sizing, the template filled with plot, table and texts, and its folder."""

from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import quantity_text
from forcefeel.sizing.as_json import sizing_json
from forcefeel.sizing.cockpit import CockpitSizing, cockpit_conclusions
from forcefeel.sizing.control_forces import RULE
from forcefeel.sizing.findings import noun, sizing_conclusions
from forcefeel.sizing.motor import MotorCapability
from forcefeel.sizing.page import plots as sizing_plots
from forcefeel.sizing.page import tables as sizing_tables
from forcefeel.sizing.result import Sizing
from forcefeel.units import ANGLE, UnitSystem

PAGE, RESULTS = "size.html", "results.json"

FOLDER = OutputFolder("the sizing", (PAGE, RESULTS))


def sizing_page(sizing: Sizing | CockpitSizing, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
    if isinstance(sizing, CockpitSizing):
        return _cockpit_page(sizing, units, command)
    return render(
        "sizing/page/size.html.j2",
        command=command,
        loader=sizing.loader,
        axis=sizing.plan.axis,
        noun=noun(sizing),
        rule=RULE,
        electric=isinstance(sizing.capability, MotorCapability),
        conclusions=sizing_conclusions(sizing, units),
        picture=drawing(sizing_plots.force_over_speed(sizing, units), "force-speed"),
        demands=sizing_tables.demands(sizing, units),
        sources=sizing_tables.sources(sizing),
        angle=quantity_text(sizing.plan.release_rad, ANGLE, units, 3),
        parameters=machine.parameters(sizing.loader, units),
    )


def _cockpit_page(cockpit: CockpitSizing, units: UnitSystem, command: str) -> str:
    parts = [
        (
            axis,
            sizing,
            noun(sizing),
            sizing_conclusions(sizing, units),
            drawing(sizing_plots.force_over_speed(sizing, units), f"force-speed-{axis}"),
            sizing_tables.demands(sizing, units),
        )
        for axis, sizing in cockpit.axes.items()
    ]
    return render(
        "sizing/page/cockpit.html.j2",
        command=command,
        name=cockpit.name,
        conclusions=cockpit_conclusions(cockpit, units),
        axes=sizing_tables.axes(cockpit, units),
        rule=RULE,
        parts=parts,
    )


def write_sizing(
    sizing: Sizing | CockpitSizing, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Writes ``results.json`` and ``size.html``, the page last; other files in the folder are left alone.

    Args:
        sizing: The sizing of a loader, or of each axis of a cockpit.
        out: The folder; created if it does not exist.
        units: The units of every number.
        replace: Whether existing files may be replaced.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains files of these names without ``replace``, or cannot be written.

    Example:
        >>> sizing = ff.sizing.size_drive(ff.elevator())
        >>> ff.sizing.write_sizing(sizing, Path("size"), ff.UnitSystem.US).name
        'size.html'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(sizing_json(sizing, units))
    FOLDER.write(out, {RESULTS: results, PAGE: sizing_page(sizing, units, command=command)})
    return out / PAGE
