"""The tables of a commissioning's page."""

from collections.abc import Sequence

from markupsafe import Markup

from forcefeel.commission.findings import Row
from forcefeel.commission.result import IDENTIFIED, Commission, EnvelopeResult, RuleTests
from forcefeel.conclusions import capital, share_text
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, number_text, parameter_name, quantity_text
from forcefeel.units import UnitSystem


def steps(rows: Sequence[Row]) -> Table:
    """Each step with its result and page."""
    cells = [
        (
            words(Markup('<a href="{}">{}</a>').format(row.page, capital(row.title))),
            words(row.result),
            words(row.ok, bad=row.ok == "no"),
        )
        for row in rows
    ]
    return Table((Cell("Step"), Cell("Result"), Cell("Good")), tuple(cells))


def estimates(commission: Commission, units: UnitSystem) -> Table:
    """Each parameter: the file's value, the current value and its accuracy."""
    rows = []
    for parameter in commission.identified.parameters:
        row = unit(TABLE[parameter.key])
        identified = parameter.state == IDENTIFIED
        rows.append(
            (
                words(parameter_name(parameter.key)),
                number(quantity_text(parameter.before, row, units, 4)),
                number(quantity_text(parameter.value, row, units, 5)),
                number(f"{number_text(100 * parameter.error, 2)} %" if identified else NONE),
                words(parameter.state),
            )
        )
    return Table((*heads("Parameter", "File", "Now", "Standard error"), Cell("State")), tuple(rows))


def shares(envelope: EnvelopeResult, required: float) -> Table:
    """Shares that the law renders."""
    rows = (
        ("Identified loader", envelope.passes, True),
        (f"Average of drawn machines ({envelope.machines}), all tolerances at once", envelope.drawn, True),
        ("Worst of these", envelope.drawn_least, False),
        ("Every case: one parameter off, or an arm at the grip", envelope.every_case, False),
    )
    return Table(
        heads("Machine", "Settings rendered"),
        tuple(
            (words(name), number(share_text(share), bad=judged and share < required)) for name, share, judged in rows
        ),
    )


def what_ifs(envelope: EnvelopeResult) -> Table:
    """Changes that render more."""
    now = (words("As identified"), number(share_text(envelope.passes)))
    rows = ((words(capital(what_if.change)), number(share_text(what_if.passes))) for what_if in envelope.what_ifs)
    return Table(heads("Machine", "Settings rendered"), (now, *rows))


def tests(tested: RuleTests) -> Table:
    """Each test of the rule."""
    rows = ((words(name), words(outcome, bad=outcome == "failed")) for name, outcome in tested.outcomes.items())
    return Table((Cell("Test"), Cell("Outcome")), tuple(rows))
