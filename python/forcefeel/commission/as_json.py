"""A commissioning as plain data for JSON."""

from dataclasses import asdict
from importlib.metadata import version

from forcefeel.commission.findings import commission_conclusions
from forcefeel.commission.result import Commission, EnvelopeResult
from forcefeel.json_values import json_value
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import Json, quantity


def commission_json(commission: Commission) -> dict[str, Json]:
    """Results of each step; numbers in the plan's units."""
    units = commission.plan.units
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": commission.before.name,
        "ok": commission.ok,
        "required_share": commission.plan.share,
        "rule": commission.plan.rule,
        "conclusions": json_value(commission_conclusions(commission), units),
        "identification": {
            "ok": commission.identified.ok,
            "verdict": commission.identified.verdict,
            "wanting": list(commission.identified.wanting),
            "next_experiment": list(commission.identified.advice),
            "noticed": list(commission.identified.noticed),
            "parameters": {
                parameter.key: {
                    "file": quantity(parameter.before, unit(TABLE[parameter.key]), units),
                    "value": quantity(parameter.value, unit(TABLE[parameter.key]), units),
                    "standard_error": parameter.error,
                    "state": parameter.state,
                }
                for parameter in commission.identified.parameters
            },
        },
        "law": None if commission.chosen is None else json_value(asdict(commission.chosen), units),
        "envelope": None if commission.envelope is None else json_value(_numbers(commission.envelope), units),
        "tests": None if commission.tested is None else json_value(asdict(commission.tested), units),
        "folders": dict(commission.folders),
    }


def _numbers(envelope: EnvelopeResult) -> dict[str, object]:
    """The result without its map, which is in the envelope's folder."""
    return {name: value for name, value in asdict(envelope).items() if name != "outcomes"}
