"""The one page of a commissioning: the result in a sentence, the steps with their pages, the numbers."""

from forcefeel.commission.findings import commission_conclusions, glance
from forcefeel.commission.page import tables
from forcefeel.commission.result import Commission
from forcefeel.page import machine
from forcefeel.page.render import render


def commission_page(found: Commission, *, command: str = "") -> str:
    """The whole page, numbers in the plan's units."""
    units = found.plan.units
    return render(
        "commission/page/commission.html.j2",
        command=command,
        loader=found.loader or found.before,
        found=found,
        conclusions=commission_conclusions(found),
        steps=tables.steps(glance(found)),
        estimates=tables.estimates(found, units) if found.identified.parameters else None,
        tests=tables.tests(found.tested) if found.tested else None,
        what_ifs=tables.what_ifs(found.checked) if found.checked and found.checked.what_ifs else None,
        shares=tables.shares(found.checked, found.plan.share) if found.checked else None,
        parameters=machine.parameters(found.loader or found.before, units),
    )
