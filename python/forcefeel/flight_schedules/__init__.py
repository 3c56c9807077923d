"""Laws over the settings an aircraft runs through: designed at knots, interpolated between them, checked on a refined grid.

Not ``forcefeel.schedule``, which is the report's gains for many settings.
"""

from forcefeel.flight_schedules.axes import ScheduleAxis
from forcefeel.flight_schedules.check import check_schedule
from forcefeel.flight_schedules.knots import read_knots
from forcefeel.flight_schedules.result import ScheduleCheck
from forcefeel.flight_schedules.schedule import FlightSchedule, design_schedule, second_order_feel

__all__ = [
    "FlightSchedule",
    "ScheduleAxis",
    "ScheduleCheck",
    "check_schedule",
    "design_schedule",
    "read_knots",
    "second_order_feel",
]
