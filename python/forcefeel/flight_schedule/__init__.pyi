"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.flight_schedule.axes import ScheduleAxis as ScheduleAxis
from forcefeel.flight_schedule.check import check_schedule as check_schedule
from forcefeel.flight_schedule.knots import read_knots as read_knots
from forcefeel.flight_schedule.page.page import write_schedule as write_schedule
from forcefeel.flight_schedule.result import ScheduleCheck as ScheduleCheck
from forcefeel.flight_schedule.schedule import FlightSchedule as FlightSchedule
from forcefeel.flight_schedule.schedule import design_schedule as design_schedule
from forcefeel.flight_schedule.schedule import second_order_feel as second_order_feel
