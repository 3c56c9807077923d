"""The table of the loader's numbers: values, curves and tolerances."""

import math

from forcefeel._core import Parameter
from forcefeel.loader.curves import CURVES, Curve, CurveRow
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import HYDRAULIC, TABLE, is_switch, meaning, required, unit
from forcefeel.loader.tolerances import Distribution, Tolerance
from forcefeel.page.table import Cell, Table, number, words
from forcefeel.page.typography import NONE, change_text, number_text, prose_html, quantity_text, symbol_html, unit_text
from forcefeel.units import UnitSystem

_SAME = 1e-9
"""Relative; a value that was converted from the other unit system is still the same."""


def parameters(loader: Loader, system: UnitSystem) -> Table:
    """The loader's numbers; optional rows and curves only where given."""
    shown = {*required(loader.drive), *loader.given, *loader.tolerances}
    rows = [_row(key, loader, system) for key in TABLE if key in shown]
    curves = [_curve(CURVES[name], curve, system) for name, curve in loader.curves.items()]
    other = "Elevator of the 1974 report" if loader.drive == HYDRAULIC else "Default, and its source"
    head = ("Symbol", "Meaning", "Value", "Unit", "Tolerance", other)
    return Table(tuple(Cell(name, "number" if name == "Value" else "") for name in head), (*rows, *curves))


def _row(key: str, loader: Loader, system: UnitSystem) -> tuple[Cell, ...]:
    row, value = TABLE[key], loader[key]
    return (
        Cell(symbol_html(row.symbol)),
        words(prose_html(f"{row.part.replace('_', ' ')}: {meaning(row, loader.drive)}")),
        number(_value(row, value, system)),
        Cell(unit_text(unit(row).shown(system)) if math.isfinite(value) else ""),
        Cell(_tolerance(row, loader.tolerances.get(key), system)),
        Cell(_elevator(row, value, system)),
    )


def _value(row: Parameter, value: float, system: UnitSystem) -> str:
    if is_switch(row):
        return "yes" if value else "no"
    return number_text(unit(row).from_si(value, system), 6) if math.isfinite(value) else NONE


def _tolerance(row: Parameter, tolerance: Tolerance | None, system: UnitSystem) -> str:
    """The bounds, and the distribution unless it is the uniform one."""
    if tolerance is None:
        return NONE
    nominal = tolerance.nominal
    if nominal is None:
        low, high = (quantity_text(bound, unit(row), system) for bound in (tolerance.low, tolerance.high))
    else:
        low, high = (change_text((bound - nominal) / abs(nominal)) for bound in (tolerance.low, tolerance.high))
    name = "" if tolerance.distribution is Distribution.UNIFORM else f", {tolerance.distribution}"
    return f"{low} to {high}{name}"


def _elevator(row: Parameter, value: float, system: UnitSystem) -> str:
    """The 1974 elevator's value, or that it is the same; a dash where the report knows of none."""
    if row.off_si is not None:
        return NONE
    if math.isclose(value, row.default_si, rel_tol=_SAME):
        return f"the same ({row.source})"
    return f"{quantity_text(row.default_si, unit(row), system, 6)} ({row.source})"


def _curve(row: CurveRow, curve: Curve, system: UnitSystem) -> tuple[Cell, ...]:
    x, y = (unit_text(shown) or "1" for shown in row.units(system))
    name = words(prose_html(f"feel: {row.meaning}"))
    return Cell(NONE), name, number(f"{len(curve.x)} points"), Cell(f"{y} over {x}"), Cell(NONE), Cell(NONE)
