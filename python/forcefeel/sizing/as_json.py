"""What came of sizing a drive, for machines."""

from importlib.metadata import version

from forcefeel.json_values import Json, json_value, quantity
from forcefeel.sizing.cockpit import CockpitSizing, cockpit_conclusions
from forcefeel.sizing.control_forces import RULE
from forcefeel.sizing.findings import sizing_conclusions
from forcefeel.sizing.result import Sizing
from forcefeel.units import ANGLE, MASS, UnitSystem


def sizing_json(found: Sizing, units: UnitSystem) -> dict[str, Json]:
    """What is asked and given, every number with its unit."""
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": found.loader.name,
        "drive": found.loader.drive,
        "axis": found.plan.axis,
        "rule": RULE,
        "release_angle": quantity(found.plan.release_rad, ANGLE, units),
        "good": found.good,
        "conclusions": json_value(sizing_conclusions(found, units), units),
        "capability": json_value(found.capability, units),
        "demands": [{**_document(one, units), "available": one.available} for one in found.demands],
        "added_mass": quantity(found.added_mass_kg, MASS, units),
        "column_mass": quantity(found.column_mass_kg, MASS, units),
        "missing": list(found.missing),
    }


def cockpit_json(found: CockpitSizing, units: UnitSystem) -> dict[str, Json]:
    """The sizing of each axis."""
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "project": found.name,
        "good": found.good,
        "conclusions": json_value(cockpit_conclusions(found, units), units),
        "axes": {axis: sizing_json(one, units) for axis, one in found.axes.items()},
    }


def _document(one: object, units: UnitSystem) -> dict[str, Json]:
    document = json_value(one, units)
    return document if isinstance(document, dict) else {}
