"""The tables of a sizing: demands with the used shares of the limits, and their sources."""

from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import prose_html
from forcefeel.sizing.cockpit import CockpitSizing
from forcefeel.sizing.columns import axis_columns, columns
from forcefeel.sizing.result import Sizing
from forcefeel.units import UnitSystem


def demands(sizing: Sizing, units: UnitSystem) -> Table:
    """A row for each demand; demands above the capability are highlighted."""
    shown_columns = columns(sizing, units)
    rows = tuple(
        (
            words(demand.name),
            *(number(prose_html(column.text(demand)), bad=not demand.available) for column in shown_columns),
        )
        for demand in sizing.demands
    )
    return Table(heads("Demand", *(f"{column.title[:1].upper()}{column.title[1:]}" for column in shown_columns)), rows)


def sources(sizing: Sizing) -> Table:
    """Source of each demand."""
    rows = tuple(
        (
            words(demand.name),
            words(
                prose_html(demand.source if demand.verified else f"{demand.source}; not verified against the document")
            ),
        )
        for demand in sizing.demands
    )
    return Table((Cell("Demand"), Cell("Source")), rows)


def axes(cockpit: CockpitSizing, units: UnitSystem) -> Table:
    """A row for each axis; a drive that is too small is highlighted."""
    shown_columns = axis_columns(units)
    rows = tuple(
        (words(axis), *(number(prose_html(column.text(sizing)), bad=not sizing.ok) for column in shown_columns))
        for axis, sizing in cockpit.axes.items()
    )
    return Table(heads("Axis", *(f"{column.title[:1].upper()}{column.title[1:]}" for column in shown_columns)), rows)
