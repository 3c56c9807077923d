"""Laws over the settings an aircraft runs through: designed at knots, interpolated between them, checked on a refined grid.

Not ``forcefeel.laws.analog.gain_schedule``, which is the report's gains for many settings.
"""

from forcefeel.flight_schedule.axes import ScheduleAxis
from forcefeel.flight_schedule.check import check_schedule
from forcefeel.flight_schedule.knots import read_knots
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.flight_schedule.schedule import FlightSchedule, design_schedule, second_order_feel

__all__ = [
    "FlightSchedule",
    "ScheduleAxis",
    "ScheduleCheck",
    "check_schedule",
    "design_schedule",
    "read_knots",
    "second_order_feel",
]
