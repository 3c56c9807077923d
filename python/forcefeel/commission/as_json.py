"""A commissioning for machines."""

from dataclasses import asdict
from importlib.metadata import version

from forcefeel.commission.findings import commission_conclusions
from forcefeel.commission.result import Checked, Commission
from forcefeel.json_values import Json, json_value, quantity
from forcefeel.loader.parameters import TABLE, unit


def commission_json(found: Commission) -> dict[str, Json]:
    """What each step came to; numbers in the plan's units."""
    units = found.plan.units
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": found.before.name,
        "good": found.good,
        "required_share": found.plan.share,
        "rule": found.plan.rule,
        "conclusions": json_value(commission_conclusions(found), units),
        "identification": {
            "good": found.identified.good,
            "verdict": found.identified.verdict,
            "wanting": list(found.identified.wanting),
            "next_experiment": list(found.identified.advice),
            "noticed": list(found.identified.noticed),
            "parameters": {
                one.key: {
                    "file": quantity(one.before, unit(TABLE[one.key]), units),
                    "value": quantity(one.value, unit(TABLE[one.key]), units),
                    "standard_error": one.error,
                    "state": one.state,
                }
                for one in found.identified.parameters
            },
        },
        "law": None if found.chosen is None else json_value(asdict(found.chosen), units),
        "envelope": None if found.checked is None else json_value(_numbers(found.checked), units),
        "tests": None if found.tested is None else json_value(asdict(found.tested), units),
        "folders": dict(found.folders),
    }


def _numbers(checked: Checked) -> dict[str, object]:
    """The result without its map, which the envelope's folder has."""
    return {name: value for name, value in asdict(checked).items() if name != "outcomes"}
