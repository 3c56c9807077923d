"""A flight's report as JSON: every number with its unit."""

from importlib.metadata import version

from forcefeel.fly.maneuvers import AIRSPEED, ALTITUDE, Maneuver
from forcefeel.fly.report import FlightReport, Point, flight_conclusions
from forcefeel.fly.rules import FlightVerdict
from forcefeel.json_values import json_value
from forcefeel.units import FORCE, RATIO, Json, UnitSystem, quantity


def report_json(report: FlightReport, units: UnitSystem) -> dict[str, Json]:
    """Held points, maneuvers, verdicts, conclusions."""
    case = report.case
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "aircraft": case.aircraft,
        "speed": quantity(case.speed_m_per_s, AIRSPEED, units),
        "altitude": quantity(case.altitude_m, ALTITUDE, units),
        "conclusions": json_value(flight_conclusions(report), units) if report.verdicts else None,
        "verdicts": [_verdict_json(verdict, units) for verdict in report.verdicts],
        "load_factors": [_point_json(point, units, "load_factor") for point in report.pulls],
        "speeds": [_point_json(point, units, "speed") for point in report.speeds],
        "maneuvers": [maneuver_json(maneuver, units) for maneuver in report.maneuvers],
        "faults": dict(report.faults),
        "loader": json_value(case.feel, units),
    }


def maneuver_json(maneuver: Maneuver, units: UnitSystem) -> dict[str, Json]:
    """The numbers of a maneuver."""
    return {
        "name": maneuver.name,
        "label": maneuver.label,
        "measures": {
            measure.name: {
                "with_loader": quantity(measure.with_loader, measure.unit, units),
                "feel_alone": quantity(measure.alone, measure.unit, units),
            }
            for measure in maneuver.measures
        },
    }


def _point_json(point: Point, units: UnitSystem, name: str) -> Json:
    target = quantity(point.target, AIRSPEED if name == "speed" else RATIO, units)
    held = point.held
    if held is None:
        return {"target": target, "fault": point.fault}
    return {
        "target": target,
        "speed": quantity(held.speed_m_per_s, AIRSPEED, units),
        "load_factor": quantity(held.load_factor, RATIO, units),
        "force": quantity(held.force_n, FORCE, units),
        "feel": quantity(held.feel_n, FORCE, units),
        "trimmed": quantity(held.trimmed_n, FORCE, units),
    }


def _verdict_json(verdict: FlightVerdict, units: UnitSystem) -> Json:
    rule, unit = verdict.rule, verdict.unit
    numbers = {"limit": verdict.limit, "with_loader": verdict.with_loader, "feel_alone": verdict.feel}
    return {
        "document": rule.document,
        "number": rule.number,
        "name": rule.name,
        "source": rule.source,
        "verified": rule.verified,
        "quantity": verdict.quantity,
        "outcome": str(verdict.outcome),
        "where": verdict.where,
        "bound": verdict.bound,
        **{key: None if unit is None else quantity(number, unit, units) for key, number in numbers.items()},
    }
