"""A qualification as JSON: every figure with its unit."""

from collections.abc import Sequence
from importlib.metadata import version
from math import isfinite, isnan

from forcefeel.json_values import json_value
from forcefeel.qualification import Record, Verdict
from forcefeel.qualification.figures import Figure
from forcefeel.qualification.plan.cockpit import CockpitQualification, cockpit_conclusions
from forcefeel.qualification.plan.result import Qualification, Result, Section, Side
from forcefeel.qualification.plan.sentences import UNITS, conclusions, outcome_counts, result_text, unverified_tests
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.units import SECONDS, Json, UnitSystem
from forcefeel.units import quantity as json_quantity

_RELEASE = ("release_s", "steady", "displacement", "fall_time", "rise_time")
_SWEEP = (
    "breakout_low",
    "breakout_high",
    "friction",
    "freeplay",
    "centring",
    "gradient",
    "gradient_low",
    "gradient_high",
)


def qualification_json(qualification: Qualification | CockpitQualification) -> dict[str, Json]:
    """The whole qualification without the records' samples; of a cockpit the qualification of each axis."""
    system = qualification.system
    if isinstance(qualification, CockpitQualification):
        return {
            "forcefeel": version("forcefeel"),
            "units": str(system),
            "project": qualification.name,
            "status": str(qualification.status),
            "conclusions": json_value(cockpit_conclusions(qualification), system),
            "axes": {axis: qualification_json(one_axis) for axis, one_axis in qualification.axes.items()},
            "links": {
                name: [
                    {
                        "check": check.name,
                        "outcome": check.outcome,
                        **{
                            key: None if isnan(number) else json_quantity(number, check.unit, system)
                            for key in ("value", "low", "high")
                            for number in (getattr(check, key),)
                        },
                    }
                    for check in checks
                ]
                for name, checks in qualification.links.items()
            },
        }
    rules = qualification.rules
    rule = {
        "id": rules.id,
        "title": rules.title,
        "edition": rules.edition,
        "category": rules.category,
        "axis": qualification.axis,
        "verified": rules.verified,
        "unverified": list(unverified_tests(qualification)),
    }
    files = {
        name: {"name": file.record.name, "path": str(file.path), "sha256": file.sha256}
        for name, file in qualification.files.items()
        if file.path is not None
    }
    return {
        "forcefeel": version("forcefeel"),
        "date": qualification.day.isoformat(),
        "units": str(system),
        "status": str(qualification.status),
        "conclusions": json_value(conclusions(qualification), system),
        "rule": rule,
        "throw": json_value(qualification.throw, system),
        "reference": qualification.reference,
        "omitted": list(qualification.omitted),
        "simulator": qualification.simulator,
        "operator": qualification.operator,
        "test_plan": [trial.key for trial in qualification.test_plan.trials],
        "tests_not_simulated": [trial.key for trial in qualification.test_plan.outside],
        "named": list(qualification.test_plan.named),
        "files": files,
        "sections": [_section(section, qualification) for section in qualification.sections],
        "loader": json_value(qualification.loader, system),
    }


def _section(section: Section, qualification: Qualification) -> dict[str, Json]:
    return {
        "name": section.name,
        "title": section.title,
        "status": str(section.status),
        "missing": [{"any_of": [trial.key for trial in group]} for group in section.missing],
        "outcome_counts": outcome_counts(section),
        "tests": [_result(result, qualification) for result in section.results],
    }


def _result(result: Result, qualification: Qualification) -> dict[str, Json]:
    trial, test = result.trial, result.trial.test
    return {
        "key": trial.key,
        "title": trial.title,
        "test": test.number,
        "source": test.source,
        "conditions": list(test.conditions),
        "verified": trial.verified,
        "outcome": str(result.outcome),
        "summary": result_text(result, qualification),
        "reason": result.reason,
        "remarks": list(result.remarks),
        "verdicts": [_verdict(verdict, qualification.system) for verdict in result.verdicts],
        "measured": _side(result.measured, qualification.system),
        "reference": _side(result.reference, qualification.system),
    }


def _verdict(verdict: Verdict, system: UnitSystem) -> dict[str, Json]:
    numbers = {name: getattr(verdict, name) for name in ("difference", "tolerance", "margin", "uncertainty")}
    return {
        "quantity": verdict.quantity,
        "outcome": str(verdict.outcome),
        "measured": _figure(verdict.measured, system),
        "reference": _figure(verdict.reference, system),
        **{name: _number(value, verdict.unit, system) for name, value in numbers.items()},
        "rule": verdict.rule.text(system),
        "verified": verdict.verified,
        "reason": verdict.reason,
    }


def _side(side: Side | None, system: UnitSystem) -> Json:
    if side is None:
        return None
    record, features = side.record, side.features
    about: dict[str, Json] = {"name": record.name, "samples": len(record.position)}
    if isinstance(record, Record):
        about["duration"] = json_quantity(record.duration_s, SECONDS, system)
    if isinstance(features, ReleaseFeatures):
        about |= {name.removesuffix("_s"): _figure(getattr(features, name), system) for name in _RELEASE}
        about |= {"cycles": _figures(features.cycles, system), "overshoots": _figures(features.overshoots, system)}
        about |= {"count": features.count, "settled": features.settled}
    if isinstance(features, SweepFeatures):
        about |= {name: _figure(getattr(features, name), system) for name in _SWEEP}
    return about


def _figures(figures: Sequence[Figure], system: UnitSystem) -> list[Json]:
    return [_figure(figure, system) for figure in figures]


def _figure(figure: Figure | None, system: UnitSystem) -> dict[str, Json] | None:
    if figure is None or not figure.known:
        return None
    known = figure.uncertainty
    return json_quantity(figure.value, UNITS[figure.unit], system) | {
        "uncertainty": UNITS[figure.unit].from_si(known, system) if isfinite(known) else None
    }


def _number(value: float, unit: str, system: UnitSystem) -> dict[str, Json] | None:
    return json_quantity(value, UNITS[unit], system) if isfinite(value) else None
