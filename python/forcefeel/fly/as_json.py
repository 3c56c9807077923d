"""A flight's report as JSON: every number with its unit."""

from importlib.metadata import version

from forcefeel.fly.report import FlightReport, flight_conclusions
from forcefeel.json_values import fields_json, json_value
from forcefeel.units import AIRSPEED, ALTITUDE, Json, UnitSystem, quantity


def report_json(report: FlightReport, units: UnitSystem) -> dict[str, Json]:
    """Held load factors and speeds, maneuvers, verdicts, conclusions."""
    case = report.case
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "aircraft": case.aircraft,
        "axis": case.axis,
        "speed": quantity(case.speed_m_per_s, AIRSPEED, units),
        "altitude": quantity(case.altitude_m, ALTITUDE, units),
        "conclusions": json_value(flight_conclusions(report), units) if report.verdicts else None,
        **fields_json(report, units),
        "loader": json_value(case.feel, units),
    }
