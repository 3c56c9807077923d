"""The sizing of a drive as JSON."""

from importlib.metadata import version

from forcefeel.json_values import json_value
from forcefeel.sizing.cockpit import CockpitSizing, cockpit_conclusions
from forcefeel.sizing.control_forces import RULE
from forcefeel.sizing.findings import sizing_conclusions
from forcefeel.sizing.result import Sizing
from forcefeel.units import ANGLE, MASS, Json, UnitSystem, quantity


def sizing_json(sizing: Sizing | CockpitSizing, units: UnitSystem) -> dict[str, Json]:
    """Demands and capability, every number with its unit; of a cockpit the sizing of each axis."""
    head: dict[str, Json] = {"forcefeel": version("forcefeel"), "units": str(units)}
    if isinstance(sizing, CockpitSizing):
        return {
            **head,
            "project": sizing.name,
            "ok": sizing.ok,
            "conclusions": json_value(cockpit_conclusions(sizing, units), units),
            "axes": {axis: sizing_json(axis_sizing, units) for axis, axis_sizing in sizing.axes.items()},
        }
    return {
        **head,
        "loader": sizing.loader.name,
        "drive": sizing.loader.drive,
        "axis": sizing.plan.axis,
        "rule": RULE,
        "release_angle": quantity(sizing.plan.release_rad, ANGLE, units),
        "ok": sizing.ok,
        "conclusions": json_value(sizing_conclusions(sizing, units), units),
        "capability": json_value(sizing.capability, units),
        "demands": [{**_document(demand, units), "available": demand.available} for demand in sizing.demands],
        "added_mass": quantity(sizing.added_mass_kg, MASS, units),
        "column_mass": quantity(sizing.column_mass_kg, MASS, units),
        "missing": list(sizing.missing),
    }


def _document(value: object, units: UnitSystem) -> dict[str, Json]:
    document = json_value(value, units)
    return document if isinstance(document, dict) else {}
