"""The report of a design and its folder: all files are computed first, then written, the page last."""

from math import isfinite
from pathlib import Path
from typing import Any

from forcefeel.design.analysis import LOW_SHARE
from forcefeel.design.figure import Figure
from forcefeel.design.figure_data import figures
from forcefeel.design.findings import conclusions
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_findings import NO_REPORT
from forcefeel.design.page import best_law, glance, laws, loops, motor_tables
from forcefeel.design.page.numbers import results_json
from forcefeel.design.page.plot import planes, plot
from forcefeel.design.page.responses import csv, table
from forcefeel.design.page.stability import AnyDesign
from forcefeel.design.studies import worst
from forcefeel.design.workflow import Design
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS, gains_in
from forcefeel.loader.parameters import OFF, TABLE
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import render
from forcefeel.page.typography import number_text, parameter_text, quantity_text, unit_text
from forcefeel.units import HERTZ, UnitSystem

PAGE, RESULTS, RESPONSES = "report.html", "results.json", "responses"

FOLDER = OutputFolder("the report", (PAGE, RESULTS), (RESPONSES,))


def write_report(
    design: AnyDesign, out: Path, units: UnitSystem, tried: LawComparison | None = None, *, command: str = ""
) -> Path:
    """Writes ``report.html``, ``results.json`` and a table of values for each figure in ``responses/``.

    An existing report stays as it is until the new one is complete; other files in the folder are left alone.

    Args:
        design: What to report.
        out: The folder; created if it does not exist.
        units: The units of every number.
        tried: Laws that were tried, for a loader with a digital controller, as ``choice.best_law`` gives them.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> ff.design.write_report(ff.design_loader(ff.elevator()), Path("report"), ff.UnitSystem.SI).name
        'report.html'
    """
    FOLDER.check(out)
    drawn = figures(design)
    tables = {f"{RESPONSES}/{figure.key}.csv": table(figure, units) for figure in drawn}
    contents = {
        **{name: csv(data) for name, data in tables.items()},
        RESULTS: results_json(design, drawn, tables, units, tried),
        PAGE: _page(design, drawn, tuple(tables), units, tried=tried, command=command),
    }
    FOLDER.write(out, contents)
    return out / PAGE


def _page(
    design: AnyDesign,
    drawn: tuple[Figure, ...],
    files: tuple[str, ...],
    units: UnitSystem,
    *,
    tried: LawComparison | None,
    command: str,
) -> str:
    """The whole page: the template of the drive filled with plots, tables and words."""
    motor = isinstance(design, MotorDesign)
    return render(
        f"design/page/{'motor' if motor else 'report'}.html.j2",
        command=command,
        design=design,
        loader=design.loader,
        conclusions=conclusions(design, units, tried),
        tried=tried,
        beside=best_law.beside(tried) if tried else None,
        plots={
            figure.key: plot(figure, str(number) if motor else _number(figure), design, units)
            for number, figure in enumerate(drawn, start=1)
        },
        planes=planes(design, "rotor and column on the link" if motor else "the column on its linkage"),
        files=files,
        low_share=LOW_SHARE,
        value=lambda key: parameter_text(design.loader, key, units),
        frequency=lambda value: quantity_text(value, HERTZ, units, 3),
        symbols={key: row.symbol for key, row in TABLE.items()},
        **(_of_motor(design, units) if isinstance(design, MotorDesign) else _of_servo(design, units)),
    )


def _number(figure: Figure) -> str:
    """That of the report."""
    return figure.key.removeprefix("figure-").removeprefix("0")


def _of_servo(design: Design, units: UnitSystem) -> dict[str, Any]:
    tables = {
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
    return {
        "tables": tables,
        "full": design.configuration("compensated").programmed.assessment,
        "worst": worst(design.deviations),
        "low_value": lambda key: parameter_text(design.low_loader, key, units),
        "gains": _drawn_gains(design, units),
    }


def _of_motor(design: MotorDesign, units: UnitSystem) -> dict[str, Any]:
    tables = {
        "side_by_side": motor_tables.side_by_side(design, units),
        "inertias": motor_tables.inertias(design, units),
        "swings": motor_tables.swings(design, units),
        "margins": motor_tables.margins(design, units),
        "boundary": motor_tables.boundary(design, units),
        "modes": motor_tables.modes(design, units),
        "low_modes": motor_tables.modes(design, units, low=True),
        "parameters": machine.parameters(design.loader, units),
    }
    return {
        "tables": tables,
        "law": design.law,
        "no_report": NO_REPORT,
        "is_set": lambda key: isfinite(design.loader[key]) and design.loader[key] != OFF.get(key),
    }


def _drawn_gains(design: Design, units: UnitSystem) -> tuple[tuple[str, str], ...]:
    """Symbol and value of the six gains that are fed back."""
    gain_values = gains_in(units, design.compensation.gains[:6])
    return tuple(
        (symbol, f"{number_text(float(value), 3)} {unit_text(unit.shown(units))}")
        for symbol, value, unit in zip(GAIN_SYMBOLS, gain_values, GAIN_UNITS, strict=False)
    )
