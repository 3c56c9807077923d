"""Page of a flight schedule: the template filled with plots, tables and text."""

from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.flight_schedule.findings import schedule_conclusions
from forcefeel.flight_schedule.page import plots as schedule_plots
from forcefeel.flight_schedule.page import tables as schedule_tables
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import number_text, quantity_text
from forcefeel.units import ANGLE, UnitSystem


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
        angle=quantity_text(check.test.angle_rad, ANGLE, units, 3),
        parameters=machine.parameters(schedule.loader, units),
    )
