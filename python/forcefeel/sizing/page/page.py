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


def sizing_page(found: Sizing, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
    return render(
        "sizing/page/size.html.j2",
        command=command,
        loader=found.loader,
        axis=found.plan.axis,
        noun=noun(found),
        rule=RULE,
        electric=isinstance(found.capability, MotorCapability),
        conclusions=sizing_conclusions(found, units),
        picture=drawing(sizing_plots.force_over_speed(found, units), "force-speed"),
        asked=sizing_tables.asked(found, units),
        sources=sizing_tables.sources(found),
        angle=quantity_text(found.plan.release_rad, ANGLE, units, 3),
        parameters=machine.parameters(found.loader, units),
    )


def cockpit_page(found: CockpitSizing, units: UnitSystem, *, command: str = "") -> str:
    """The page of a cockpit, numbers in ``units``."""
    parts = [
        (
            axis,
            one,
            noun(one),
            sizing_conclusions(one, units),
            drawing(sizing_plots.force_over_speed(one, units), f"force-speed-{axis}"),
            sizing_tables.asked(one, units),
        )
        for axis, one in found.axes.items()
    ]
    return render(
        "sizing/page/cockpit.html.j2",
        command=command,
        name=found.name,
        conclusions=cockpit_conclusions(found, units),
        axes=sizing_tables.axes(found, units),
        rule=RULE,
        parts=parts,
    )
