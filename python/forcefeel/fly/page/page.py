"""The page of a report in flight, the template filled with plots and tables, and its folder."""

from pathlib import Path

from forcefeel.conclusions import capital
from forcefeel.fly.as_json import report_json
from forcefeel.fly.maneuvers import Maneuver
from forcefeel.fly.page import plots
from forcefeel.fly.report import FlightReport, Point, flight_conclusions
from forcefeel.fly.rules import FlightVerdict, Outcome
from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, heading_text, number_text, quantity_text, unit_text
from forcefeel.units import AIRSPEED, ALTITUDE, FORCE, LOAD_FACTOR, Unit, UnitSystem

PAGE, RESULTS = "flight.html", "results.json"

FOLDER = OutputFolder("the flight", (PAGE, RESULTS))


def flight_page(report: FlightReport, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
    case = report.case
    return render(
        "fly/page/flight.html.j2",
        command=command,
        loader=case.loader,
        aircraft=case.aircraft,
        axis=case.axis,
        speed_text=quantity_text(case.speed_m_per_s, AIRSPEED, units, 3),
        altitude_text=quantity_text(case.altitude_m, ALTITUDE, units, 4),
        conclusions=flight_conclusions(report) if report.verdicts else None,
        verdicts=_verdicts(report.verdicts, units),
        load_factor=report.pulls and drawing(plots.force_over_load_factor(report, units), "load-factor"),
        pulls=_points(report.pulls, units),
        speed=report.speeds and drawing(plots.force_over_speed(report, units), "speed"),
        speeds=_points(report.speeds, units),
        maneuvers=[_maneuver(maneuver, case.axis, units, k) for k, maneuver in enumerate(report.maneuvers)],
        faults=report.faults,
        parameters=machine.parameters(case.feel, units),
    )


def _verdicts(verdicts: tuple[FlightVerdict, ...], units: UnitSystem) -> Table:
    """A row for each verdict."""

    def cells(verdict: FlightVerdict) -> tuple[Cell, ...]:
        unit = verdict.unit
        limit = f"{verdict.bound} {_text(verdict.limit, unit, units)}" if unit else verdict.bound
        apart = abs(verdict.with_loader - verdict.feel)
        return (
            words(verdict.rule.marked_label),
            words(capital(verdict.quantity)),
            words(str(verdict.outcome), bad=verdict.outcome is not Outcome.MET),
            number(_text(verdict.with_loader, unit, units) if unit else NONE),
            number(_text(verdict.feel, unit, units) if unit else NONE),
            number(_text(apart, unit, units) if unit else NONE),
            number(limit),
            Cell(unit_text(unit.shown(units)) if unit else ""),
            words(verdict.where),
        )

    head = (
        Cell("Rule"),
        Cell("Quantity"),
        Cell("Outcome"),
        *heads("", "Loader", "Feel alone", "Difference", "Limit")[1:],
    )
    return Table((*head, Cell("Unit"), Cell("At")), tuple(map(cells, verdicts)))


def _text(value: float, unit: Unit, units: UnitSystem) -> str:
    """A number without its unit, to three digits and four decimals."""
    return number_text(round(unit.from_si(value, units), 4), 3)


def _points(points: tuple[Point, ...], units: UnitSystem) -> Table:
    """The held load factors or speeds."""

    def cells(point: Point) -> tuple[Cell, ...]:
        held = point.held
        if held is None:
            return (words(point.label), *4 * (number(NONE),), words(point.fault, bad=True))
        pairs = (
            (held.load_factor, LOAD_FACTOR),
            (held.speed_m_per_s, AIRSPEED),
            (held.force_n, FORCE),
            (held.feel_n, FORCE),
        )
        return (words(point.label), *(number(_text(value, unit, units)) for value, unit in pairs), Cell(""))

    quantities = (
        ("Load factor", LOAD_FACTOR),
        ("Airspeed", AIRSPEED),
        ("With the loader", FORCE),
        ("Feel alone", FORCE),
    )
    names = (heading_text(name, unit, units) for name, unit in quantities)
    return Table((*heads("To hold", *names), Cell("Remark")), tuple(map(cells, points)))


def _maneuver(maneuver: Maneuver, axis: str, units: UnitSystem, k: int) -> dict[str, object]:
    rows = tuple(
        (
            words(measure.name),
            number(_text(measure.with_loader, measure.unit, units)),
            number(_text(measure.alone, measure.unit, units)),
            Cell(unit_text(measure.unit.shown(units))),
        )
        for measure in maneuver.measures
    )
    return {
        "key": f"maneuver-{k}",
        "label": maneuver.label,
        "states": "; ".join(
            name.replace("_", " ") + (", positive with the wind from the right" if name == "sideslip" else "")
            for name in plots.drawn_states(maneuver, axis)
        ),
        "drawing": drawing(plots.histories(maneuver, axis, units), f"maneuver-{k}"),
        "measures": Table((*heads("Measure", "With the loader", "Feel alone"), Cell("Unit")), rows),
    }


def write_flight(
    report: FlightReport, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Writes ``results.json`` and ``flight.html``, the page last.

    Args:
        report: The report.
        out: The folder; created if it does not exist.
        units: The units of every number.
        replace: Whether existing files may be replaced.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains files of these names without ``replace``, or cannot be written.

    Example:
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "c172p", 51.4, 900.0, "robust")
        >>> report = ff.fly.FlightReport(case, (), (), (ff.fly.fly_maneuver(case, "pull-up"),), {}, ())
        >>> ff.fly.write_flight(report, Path("flight"), ff.UnitSystem.SI).name
        'flight.html'
    """
    FOLDER.check(out, replace=replace)
    page = flight_page(report, units, command=command)
    FOLDER.write(out, {RESULTS: json_text(report_json(report, units)), PAGE: page})
    return out / PAGE
