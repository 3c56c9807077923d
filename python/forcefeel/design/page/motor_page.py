"""The page of an electric loader's design: the template filled with plots, tables and words."""

from math import isfinite

from forcefeel.design.analysis import LOW_SHARE
from forcefeel.design.figure import Figure
from forcefeel.design.findings import conclusions
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_findings import NO_REPORT
from forcefeel.design.page import best_law, motor_tables
from forcefeel.design.page.plot import planes, plot
from forcefeel.loader.parameters import OFF, TABLE
from forcefeel.page import machine
from forcefeel.page.render import render
from forcefeel.page.table import Table
from forcefeel.page.typography import parameter_text, quantity_text
from forcefeel.units import HERTZ, UnitSystem


def motor_page(
    design: MotorDesign,
    drawn: tuple[Figure, ...],
    files: tuple[str, ...],
    units: UnitSystem,
    *,
    tried: LawComparison | None,
    command: str,
) -> str:
    """The whole page; arguments as ``page``."""
    loader = design.loader
    return render(
        "design/page/motor.html.j2",
        command=command,
        design=design,
        loader=loader,
        law=design.law,
        conclusions=conclusions(design, units, tried),
        tried=tried,
        beside=best_law.beside(tried) if tried else None,
        plots={figure.key: plot(figure, str(number), design, units) for number, figure in enumerate(drawn, start=1)},
        planes=planes(design, "rotor and column on the link"),
        tables=_tables(design, units),
        files=files,
        no_report=NO_REPORT,
        low_share=LOW_SHARE,
        value=lambda key: parameter_text(loader, key, units),
        is_set=lambda key: isfinite(loader[key]) and loader[key] != OFF.get(key),
        frequency=lambda value: quantity_text(value, HERTZ, units, 3),
        symbols={key: row.symbol for key, row in TABLE.items()},
    )


def _tables(design: MotorDesign, units: UnitSystem) -> dict[str, Table]:
    return {
        "side_by_side": motor_tables.side_by_side(design, units),
        "inertias": motor_tables.inertias(design, units),
        "swings": motor_tables.swings(design, units),
        "margins": motor_tables.margins(design, units),
        "boundary": motor_tables.boundary(design, units),
        "modes": motor_tables.modes(design, units),
        "low_modes": motor_tables.modes(design, units, low=True),
        "parameters": machine.parameters(design.loader, units),
    }
