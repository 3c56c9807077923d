"""A loader that runs on a busy machine in real time: late cycles, and what they look like to a supervisor, do not stop it."""

import forcefeel as ff


def unhurried_elevator() -> ff.Loader:
    """``elevator-2khz`` that no motion stops, and only a whole second of late cycles."""
    elevator = ff.digital_elevator()
    rows = ("speed_limit", "energy_limit", "motion_limit", "runaway_power", "swing_limit")
    wide = {f"safety.{row}": 10 * elevator[f"safety.{row}"] for row in rows}
    return elevator.replace({"safety.overrun_time": 1.0, **wide}, si=True)
