"""Checked flight schedule as JSON, every number with its unit, and all numbers of its laws as CSV."""

from importlib.metadata import version

from forcefeel.envelope.as_json import deviations_json
from forcefeel.envelope.contact import FEW_CONTACTS
from forcefeel.flight_schedule.findings import schedule_conclusions
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.flight_schedule.schedule import FlightSchedule
from forcefeel.json_values import json_value
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import ANGLE, INERTIA, SECONDS, Json, UnitSystem, quantity

FEEL_UNITS = (INERTIA, unit(TABLE["feel.damping"]), unit(TABLE["feel.stiffness"]))
"""Units of I, B, G."""


def schedule_json(check: ScheduleCheck, units: UnitSystem) -> dict[str, Json]:
    """Results and inputs of a check."""
    schedule = check.schedule
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": schedule.loader.name,
        "law": schedule.law,
        "period": quantity(schedule.laws.period_s, SECONDS, units),
        "delay": quantity(schedule.laws.delay_s, SECONDS, units),
        "axes": [{"name": axis.name, "unit": axis.unit, "values": list(axis.values)} for axis in schedule.axes],
        "knots": [
            {
                "where": where,
                **{
                    symbol: quantity(value, measured_in, units)
                    for symbol, value, measured_in in zip("IBG", feel, FEEL_UNITS, strict=True)
                },
            }
            for where, feel in zip(schedule.where.tolist(), schedule.rows.tolist(), strict=True)
        ],
        "refine": check.refine,
        "tolerances": deviations_json(check.deviations),
        "cases": [case.name for case in check.cases],
        "conclusions": json_value(schedule_conclusions(check), units),
        "stable": check.stable,
        "dense": check.dense,
        "parts": [json_value(part, units) for part in check.parts],
        "margins": [json_value(margin, units) for margin in check.margins],
        "release_test": {
            "edition": check.test.rules.edition,
            "title": check.test.rules.title,
            "angle": quantity(check.test.angle_rad, ANGLE, units),
        },
        "contacts": [contact.name for contact in FEW_CONTACTS],
        "releases": [json_value(release, units) for release in check.releases],
    }


def gains_csv(schedule: FlightSchedule) -> str:
    """A line for each knot: axis values, I, B, G, then all numbers of its law by rows; SI units, unrounded."""
    laws, n = schedule.laws, schedule.laws.states
    known = [*(f"xi{k + 1}" for k in range(n)), "F_c", "x_p", "theta", "delta", "delta'"]
    heads = [axis.title for axis in schedule.axes]
    heads += [f"{symbol} ({feel_unit.si})" for symbol, feel_unit in zip("IBG", FEEL_UNITS, strict=True)]
    heads += [f"transition[{row + 1},{column + 1}]" for row in range(n) for column in range(n)]
    heads += [f"input[{row + 1},{name}]" for row in range(n) for name in ("F_c", "x_p", "theta", "e")]
    heads += [f"{what}[{name}]" for what in ("command", "torque") for name in known]
    rows = []
    for k in range(schedule.knots):
        parts = (
            schedule.where[k],
            schedule.rows[k],
            laws.transition[k],
            laws.input[k],
            laws.command[k],
            laws.torque[k],
        )
        rows.append([number for part in parts for number in part.ravel().tolist()])
    return csv_text(heads, rows)
