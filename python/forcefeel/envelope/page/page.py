"""The page of an envelope: the template filled with maps, tables and words."""

from forcefeel.envelope.as_json import releases
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.page import maps as envelope_maps
from forcefeel.envelope.page import plots as envelope_plots
from forcefeel.envelope.page import tables as envelope_tables
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.envelope.result import Envelope
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import quantity_text
from forcefeel.units import ANGLE, UnitSystem


def envelope_page(found: Envelope, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
    plan = found.plan
    shares = [(name, found.shares(name)) for name in found.compensators]
    return render(
        "envelope/page/envelope.html.j2",
        command=command,
        loader=plan.given,
        plan=plan,
        conclusions=envelope_conclusions(found, units),
        compensators=shares,
        shares=envelope_tables.shares(found),
        legend=envelope_maps.legend(found),
        shows_own=envelope_maps.shows_own(found),
        spans=envelope_maps.spans(found, units),
        numbers=envelope_maps.numbers(found, units),
        nominal=envelope_maps.rows(found, worst=False),
        worst=envelope_maps.rows(found, worst=True),
        failures=envelope_tables.failures(found),
        cases=envelope_tables.cases(found),
        drawn=envelope_tables.drawn(found) if plan.machines else None,
        counted=envelope_tables.counted(found),
        tolerances=tolerances(plan.deviations),
        smallest=envelope_tables.smallest(found, units),
        impedance=drawing(envelope_plots.impedance(found), "impedance"),
        passive=envelope_tables.passive(found),
        grid=envelope_tables.grid(found, units),
        arms=envelope_tables.arms(found),
        angle=quantity_text(plan.release_rad, ANGLE, units, 3),
        releases=f"{releases(found):,}",
        parameters=machine.parameters(plan.given, units),
    )
