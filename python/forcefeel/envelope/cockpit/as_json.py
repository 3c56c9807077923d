"""Envelopes of a cockpit as JSON, every number with its unit."""

from importlib.metadata import version

from forcefeel.envelope.as_json import envelope_json, grid_json
from forcefeel.envelope.cockpit.cockpit import CockpitEnvelope, cockpit_conclusions
from forcefeel.envelope.cockpit.pair import PairEnvelope
from forcefeel.envelope.result import Envelope
from forcefeel.json_values import json_value
from forcefeel.units import ANGLE, Json, UnitSystem, quantity


def result_json(result: Envelope | CockpitEnvelope, units: UnitSystem) -> dict[str, Json]:
    """An envelope; of a cockpit the table of all axes, each linked pair, then the envelope of each axis."""
    if isinstance(result, Envelope):
        return envelope_json(result, units)
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "project": result.name,
        "conclusions": json_value(cockpit_conclusions(result), units),
        "table": [json_value(row, units) for row in result.rows],
        "links": [_pair(pair, units) for pair in result.pairs],
        "axes": {axis: envelope_json(envelope, units) for axis, envelope in result.axes.items()},
    }


def _pair(pair: PairEnvelope, units: UnitSystem) -> dict[str, Json]:
    return {
        "link": pair.link.name,
        "between": list(pair.link.between),
        "law": pair.law,
        "release_angle": quantity(pair.release_rad, ANGLE, units),
        "grid": grid_json(pair.settings, units),
        "settings": pair.settings.count,
        "rendered_alone": int(pair.rendered.sum()),
        "linked_share": json_value(pair.linked_share, units),
        "arms": [json_value(row, units) for row in pair.rows],
        "failures": {str(kind): share for kind, share in pair.failures.items()},
    }
