"""The tables of a commissioning's page."""

from collections.abc import Sequence

from markupsafe import Markup

from forcefeel.commission.findings import Row
from forcefeel.commission.result import IDENTIFIED, Checked, Commission, RuleTests
from forcefeel.conclusions import capital, share_text
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, number_text, parameter_name, quantity_text
from forcefeel.units import UnitSystem


def steps(rows: Sequence[Row]) -> Table:
    """Each step, what it came to, and where it can be looked into."""
    found = [
        (
            words(Markup('<a href="{}">{}</a>').format(row.page, capital(row.title))),
            words(row.result),
            words(row.good, bad=row.good == "no"),
        )
        for row in rows
    ]
    return Table((Cell("Step"), Cell("Result"), Cell("Good")), tuple(found))


def estimates(found: Commission, units: UnitSystem) -> Table:
    """Each parameter: the file's value, what holds now, how sure."""
    rows = []
    for one in found.identified.parameters:
        row = unit(TABLE[one.key])
        known = one.state == IDENTIFIED
        rows.append(
            (
                words(parameter_name(one.key)),
                number(quantity_text(one.before, row, units, 4)),
                number(quantity_text(one.value, row, units, 5)),
                number(f"{number_text(100 * one.error, 2)} %" if known else NONE),
                words(one.state),
            )
        )
    return Table((*heads("Parameter", "File", "Now", "Standard error"), Cell("State")), tuple(rows))


def shares(checked: Checked, asked: float) -> Table:
    """What the law renders."""
    rows = (
        ("Identified loader", checked.passes, True),
        (f"Average of {checked.machines} machines, all tolerances at once", checked.drawn, True),
        ("Worst of these", checked.drawn_least, False),
        ("Every case: one parameter off, or an arm at the grip", checked.every_case, False),
    )
    return Table(
        heads("Machine", "Settings rendered"),
        tuple((words(name), number(share_text(it), bad=judged and it < asked)) for name, it, judged in rows),
    )


def what_ifs(checked: Checked) -> Table:
    """What would render more."""
    now = (words("As identified"), number(share_text(checked.passes)))
    rows = ((words(capital(one.change)), number(share_text(one.passes))) for one in checked.what_ifs)
    return Table(heads("Machine", "Settings rendered"), (now, *rows))


def tests(tested: RuleTests) -> Table:
    """Each test of the rule."""
    rows = ((words(name), words(outcome, bad=outcome == "failed")) for name, outcome in tested.outcomes.items())
    return Table((Cell("Test"), Cell("Outcome")), tuple(rows))
