"""The one page of a commissioning: the result in a sentence, the steps with their pages, the numbers."""

from forcefeel.commission.findings import commission_conclusions, glance
from forcefeel.commission.page import plots, tables
from forcefeel.commission.result import Commission
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.setting_maps import picture


def commission_page(found: Commission, *, command: str = "") -> str:
    """The whole page, numbers in the plan's units."""
    units, curve = found.plan.units, found.identified.curve
    maps = (
        found.checked
        and found.chosen
        and plots.outcome_maps(found.checked, found.chosen.name, found.loader or found.before)
    )
    return render(
        "commission/page/commission.html.j2",
        command=command,
        loader=found.loader or found.before,
        found=found,
        conclusions=commission_conclusions(found),
        curve=drawing(plots.curve(curve, units), "curve") if curve else None,
        maps=picture(maps, units) if maps else None,
        steps=tables.steps(glance(found)),
        estimates=tables.estimates(found, units) if found.identified.parameters else None,
        tests=tables.tests(found.tested) if found.tested else None,
        what_ifs=tables.what_ifs(found.checked) if found.checked and found.checked.what_ifs else None,
        shares=tables.shares(found.checked, found.plan.share) if found.checked else None,
        parameters=machine.parameters(found.loader or found.before, units),
    )
