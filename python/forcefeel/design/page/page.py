"""The page: the template filled with plots, tables and words."""

from typing import Any

from forcefeel.design.analysis import LOW_SHARE
from forcefeel.design.figure import Figure
from forcefeel.design.findings import conclusions
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.page import best_law, glance, laws, loops
from forcefeel.design.page.plot import planes, plot
from forcefeel.design.studies import worst
from forcefeel.design.workflow import Design
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS, gains_in
from forcefeel.loader.parameters import TABLE
from forcefeel.page import machine
from forcefeel.page.render import render
from forcefeel.page.typography import number_text, parameter_text, quantity_text, unit_text
from forcefeel.units import HERTZ, UnitSystem


def page(
    design: Design,
    drawn: tuple[Figure, ...],
    files: tuple[str, ...],
    units: UnitSystem,
    *,
    tried: LawComparison | None,
    command: str,
) -> str:
    """The whole page.

    Args:
        design: The design.
        drawn: Its figures.
        files: Names of the tables of values beside the page.
        units: The units of every number.
        tried: Laws that were tried.
        command: The command that asked for it.
    """
    return render(
        "design/page/report.html.j2",
        command=command,
        design=design,
        loader=design.loader,
        conclusions=conclusions(design, units, tried),
        tried=tried,
        beside=best_law.beside(tried) if tried else None,
        plots={figure.key: plot(figure, _number(figure), design, units) for figure in drawn},
        planes=planes(design, "the column on its linkage"),
        tables=_tables(design, units),
        files=files,
        low_share=LOW_SHARE,
        full=design.configuration("compensated").programmed.assessment,
        worst=worst(design.deviations),
        value=lambda key: parameter_text(design.loader, key, units),
        low_value=lambda key: parameter_text(design.low_loader, key, units),
        frequency=lambda value: quantity_text(value, HERTZ, units, 3),
        symbols={key: row.symbol for key, row in TABLE.items()},
        gains=_drawn_gains(design, units),
    )


def _number(figure: Figure) -> str:
    """That of the report."""
    return figure.key.removeprefix("figure-").removeprefix("0")


def _tables(design: Design, units: UnitSystem) -> dict[str, Any]:
    return {
        "side_by_side": glance.side_by_side(design, units),
        "margins": loops.margins(design, units),
        "boundary": loops.boundary(design, units),
        "modes": loops.modes(design, units),
        "low_modes": loops.modes(design, units, low=True),
        "servo_modes": loops.servo_modes(design, units),
        "gains": laws.gains(design, units),
        "laws": laws.laws(design, units),
        "dropped": laws.dropped(design, units),
        "all_dropped": laws.all_dropped(design, units),
        "sensitivity": laws.sensitivity(design),
        "parameters": machine.parameters(design.loader, units),
    }


def _drawn_gains(design: Design, units: UnitSystem) -> tuple[tuple[str, str], ...]:
    """Symbol and value of the six gains that are fed back."""
    gain_values = gains_in(units, design.compensation.gains[:6])
    return tuple(
        (symbol, f"{number_text(float(value), 3)} {unit_text(unit.shown(units))}")
        for symbol, value, unit in zip(GAIN_SYMBOLS, gain_values, GAIN_UNITS, strict=False)
    )
