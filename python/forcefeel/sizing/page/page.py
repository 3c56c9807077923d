"""The page of a sizing: the template filled with the picture, the table and words."""

from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import quantity_text
from forcefeel.sizing.cockpit import CockpitSizing, cockpit_conclusions
from forcefeel.sizing.control_forces import RULE
from forcefeel.sizing.findings import noun, sizing_conclusions
from forcefeel.sizing.motor import MotorCapability
from forcefeel.sizing.page import plots as sizing_plots
from forcefeel.sizing.page import tables as sizing_tables
from forcefeel.sizing.result import Sizing
from forcefeel.units import ANGLE, UnitSystem


def sizing_page(sizing: Sizing, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
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


def cockpit_page(cockpit: CockpitSizing, units: UnitSystem, *, command: str = "") -> str:
    """The page of a cockpit, numbers in ``units``."""
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
