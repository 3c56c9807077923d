"""The folder of a flight schedule: its page, its results and every number of its laws, whole or not at all."""

from pathlib import Path

from forcefeel.flight_schedule.as_json import gains_csv, schedule_json
from forcefeel.flight_schedule.page.page import schedule_page
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS, GAINS = "schedule.html", "results.json", "gains.csv"
"""Names in the folder."""

FOLDER = OutputFolder("the schedule", (PAGE, RESULTS, GAINS))
"""Checked before the work, written after it."""


def write_schedule(
    check: ScheduleCheck, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Writes ``gains.csv``, ``results.json`` and ``schedule.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        check: The checked schedule.
        out: The folder; made if it is not there.
        units: The units of every number but those of ``gains.csv``, which are SI.
        replace: Whether the new files may take the place of others.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
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
