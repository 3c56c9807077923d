"""The folder of a flight schedule: its page, its results and every number of its laws, whole or not at all."""

import json
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.flight_schedules.plain import gains_csv, plain_schedule
from forcefeel.flight_schedules.result import ScheduleCheck
from forcefeel.report.schedule_page import schedule_page
from forcefeel.report.staging import write_together
from forcefeel.units import UnitSystem

PAGE, RESULTS, GAINS = "schedule.html", "results.json", "gains.csv"
"""Names in the folder."""


def write_schedule(found: ScheduleCheck, out: Path, units: UnitSystem, *, replace: bool = False) -> Path:
    """Writes ``gains.csv``, ``results.json`` and ``schedule.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        found: The checked schedule.
        out: The folder; made if it is not there.
        units: The units of every number but those of ``gains.csv``, which are SI.
        replace: Whether the new files may take the place of others.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.
    """
    check_schedule_folder(out, replace=replace)
    results = json.dumps(plain_schedule(found, units), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_together(out, {GAINS: gains_csv(found.schedule), RESULTS: results, PAGE: schedule_page(found, units)})
    return out / PAGE


def check_schedule_folder(out: Path, *, replace: bool) -> None:
    """Refuses what would fail halfway: a file where a folder is wanted, a folder where a file is, files of somebody else.

    Raises:
        InputError: If so.
    """
    if out.exists() and not out.is_dir():
        raise InputError(
            f"{out}: is a file; expected a folder for the schedule; name another one, or move the file away"
        )
    for name in (PAGE, RESULTS, GAINS):
        if (out / name).is_dir():
            raise InputError(f"{out / name}: is a folder; expected to write a file of that name; move the folder away")
        if (out / name).exists() and not replace:
            raise InputError(f"{out}: holds {name} already; name another folder with --out, or --replace to replace it")
