"""Page of a flight schedule, the template filled with plots, tables and text, and its folder."""

from pathlib import Path

from forcefeel.envelope.contact import FEW_CONTACTS
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.flight_schedule.as_json import gains_csv, schedule_json
from forcefeel.flight_schedule.findings import schedule_conclusions
from forcefeel.flight_schedule.page import plots as schedule_plots
from forcefeel.flight_schedule.page import tables as schedule_tables
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import number_text, quantity_text
from forcefeel.units import ANGLE, UnitSystem

PAGE, RESULTS, GAINS = "schedule.html", "results.json", "gains.csv"

FOLDER = OutputFolder("the schedule", (PAGE, RESULTS, GAINS))


def schedule_page(check: ScheduleCheck, units: UnitSystem, *, command: str = "") -> str:
    """The page, with numbers in ``units``."""
    schedule = check.schedule
    return render(
        "flight_schedule/page/schedule.html.j2",
        command=command,
        loader=schedule.loader,
        schedule=schedule,
        found=check,
        conclusions=schedule_conclusions(check),
        parts=schedule_tables.parts(check),
        poles=drawing(schedule_plots.poles(check), "poles"),
        gains=drawing(schedule_plots.gains(schedule, check.refine, units), "gains"),
        knots=schedule_tables.knots(check, units),
        more_knots=max(0, schedule.knots - schedule_tables.MOST_ROWS),
        middle=schedule_tables.middle(check),
        margins=schedule_tables.margins(check),
        axes=schedule_tables.axes(schedule),
        tolerances=tolerances(check.deviations),
        several=len(schedule.axes) > 1,
        period=f"{number_text(1e3 * schedule.laws.period_s)} ms",
        delay=f"{number_text(1e3 * schedule.laws.delay_s)} ms",
        contacts=[contact.name for contact in FEW_CONTACTS],
        angle=quantity_text(check.test.angle_rad, ANGLE, units, 3),
        parameters=machine.parameters(schedule.loader, units),
    )


def write_schedule(
    check: ScheduleCheck, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``gains.csv``, ``results.json`` and ``schedule.html``, the page last.

    Existing files stay until the new ones are complete; other files in the folder are not touched.

    Args:
        check: The checked schedule.
        out: The folder; created if missing.
        units: Units of all numbers except those of ``gains.csv``, which are SI.
        replace: Whether existing files may be replaced.
        command: Command line to show on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains such files and ``replace`` is false, or cannot be written.

    Example:
        >>> pressure = ff.flight_schedule.ScheduleAxis("pressure", "lb/ft^2", (50, 100))
        >>> feel = ff.flight_schedule.second_order_feel([500.0, 1000.0], [1.0, 1.5], 0.6)
        >>> schedule = ff.flight_schedule.design_schedule(ff.digital_elevator(), [pressure], feel)
        >>> check = ff.flight_schedule.check_schedule(schedule, refine=2, changes={}, arms=())
        >>> ff.flight_schedule.write_schedule(check, Path("schedule"), ff.UnitSystem.SI).parent.name
        'schedule'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(schedule_json(check, units))
    FOLDER.write(
        out, {GAINS: gains_csv(check.schedule), RESULTS: results, PAGE: schedule_page(check, units, command=command)}
    )
    return out / PAGE
