"""The one page of a commissioning: the result in a sentence, the steps with their pages, the numbers."""

from forcefeel.commission.findings import commission_conclusions, glance
from forcefeel.commission.page import plots, tables
from forcefeel.commission.result import Commission
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.setting_maps import picture


def commission_page(commission: Commission, *, command: str = "") -> str:
    """The whole page, numbers in the plan's units."""
    units, curve = commission.plan.units, commission.identified.curve
    maps = (
        commission.envelope
        and commission.chosen
        and plots.outcome_maps(commission.envelope, commission.chosen.name, commission.loader or commission.before)
    )
    return render(
        "commission/page/commission.html.j2",
        command=command,
        loader=commission.loader or commission.before,
        commission=commission,
        conclusions=commission_conclusions(commission),
        curve=drawing(plots.curve(curve, units), "curve") if curve else None,
        maps=picture(maps, units) if maps else None,
        steps=tables.steps(glance(commission)),
        estimates=tables.estimates(commission, units) if commission.identified.parameters else None,
        tests=tables.tests(commission.tested) if commission.tested else None,
        what_ifs=tables.what_ifs(commission.envelope) if commission.envelope and commission.envelope.what_ifs else None,
        shares=tables.shares(commission.envelope, commission.plan.share) if commission.envelope else None,
        parameters=machine.parameters(commission.loader or commission.before, units),
    )
