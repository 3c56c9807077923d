"""Folder of a flight schedule: page, results and all numbers of its laws, written completely or not at all."""

from pathlib import Path

from forcefeel.flight_schedule.as_json import gains_csv, schedule_json
from forcefeel.flight_schedule.page.page import schedule_page
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS, GAINS = "schedule.html", "results.json", "gains.csv"
"""File names."""

FOLDER = OutputFolder("the schedule", (PAGE, RESULTS, GAINS))
"""Checked before the computation, written after it."""


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
