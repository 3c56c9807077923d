"""The tables of a sizing: what is asked and what it takes, and where each demand comes from."""

from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import prose_html
from forcefeel.sizing.cockpit import CockpitSizing
from forcefeel.sizing.columns import axis_columns, columns
from forcefeel.sizing.result import Sizing
from forcefeel.units import UnitSystem


def asked(found: Sizing, units: UnitSystem) -> Table:
    """A row for each demand; what the drive does not give stands out."""
    shown = columns(found, units)
    rows = tuple(
        (words(one.name), *(number(prose_html(column.text(one)), bad=not one.available) for column in shown))
        for one in found.demands
    )
    return Table(heads("Asked", *(f"{column.title[:1].upper()}{column.title[1:]}" for column in shown)), rows)


def sources(found: Sizing) -> Table:
    """Where each demand comes from."""
    rows = tuple(
        (
            words(one.name),
            words(prose_html(one.source if one.verified else f"{one.source}; not held against the document")),
        )
        for one in found.demands
    )
    return Table((Cell("Asked"), Cell("By")), rows)


def axes(found: CockpitSizing, units: UnitSystem) -> Table:
    """A row for each axis; one whose drive is too small stands out."""
    shown = axis_columns(units)
    rows = tuple(
        (words(axis), *(number(prose_html(column.text(one)), bad=not one.good) for column in shown))
        for axis, one in found.axes.items()
    )
    return Table(heads("Axis", *(f"{column.title[:1].upper()}{column.title[1:]}" for column in shown)), rows)
