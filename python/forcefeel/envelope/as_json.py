"""Envelope as JSON, every number with its unit, and its settings as CSV."""

from collections.abc import Mapping
from importlib.metadata import version

import numpy as np

from forcefeel.envelope.cases import Case
from forcefeel.envelope.deviations import Deviation
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import Envelope
from forcefeel.envelope.settings import AXES, Settings
from forcefeel.json_values import json_value
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import ANGLE, INERTIA, PERCENT, Json, UnitSystem, quantity


def envelope_json(envelope: Envelope, units: UnitSystem) -> dict[str, Json]:
    """Results and inputs of an envelope."""
    plan = envelope.plan
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": plan.loader.name,
        "rule": rule_json(plan),
        "release_angle": quantity(plan.release_rad, ANGLE, units),
        "method": "exact" if plan.linear else "stepped",
        "settings": plan.settings.count,
        "forbidden": dict(envelope.forbidden.counts),
        "grid": grid_json(plan.settings, units),
        "tolerances": deviations_json(plan.deviations),
        "cases": [_case(case, units) for case in plan.cases],
        "draws": json_value(plan.draws, units),
        "releases": releases(envelope),
        "inferred": envelope.inferred,
        "contacts_inferred": envelope.contacts_inferred,
        "omitted": list(plan.omitted),
        "conclusions": json_value(envelope_conclusions(envelope, units), units),
        "laws": {name: _law(envelope, name, units) for name in envelope.laws},
    }


def rule_json(plan: Plan) -> dict[str, Json]:
    """The required release test."""
    return {
        "edition": plan.rule,
        "title": plan.rules.title,
        "test": plan.test.number,
        "verified": plan.rule_verified,
    }


def grid_json(settings: Settings, units: UnitSystem) -> dict[str, Json]:
    """Values along each axis."""
    return {
        name: {
            "unit": axis.unit.shown(units),
            "values": [axis.unit.from_si(value, units) for value in getattr(settings, name)],
        }
        for name, axis in AXES.items()
    }


def deviations_json(deviations: Mapping[str, Deviation]) -> list[Json]:
    """Deviation of each parameter in percent of its value, with its source; the cases use its ends."""
    return [
        {
            "parameter": key,
            "origin": str(deviation.origin),
            "distribution": str(deviation.spread.distribution),
            "ends": [quantity(end, PERCENT, UnitSystem.SI) for end in deviation.ends],
        }
        for key, deviation in deviations.items()
    ]


def releases(envelope: Envelope) -> int:
    """Number of releases, of cases and drawn machines, without inferred ones."""
    names = ("inferred", "drawn_inferred")
    return sum(int((~envelope.arrays[name]).sum()) for name in names if name in envelope.arrays)


def _case(case: Case, units: UnitSystem) -> dict[str, Json]:
    return {
        "name": case.name,
        "kind": str(case.kind),
        "parameter": case.parameter,
        "change": quantity(case.change, PERCENT, units),
        "arm": json_value(case.arm, units),
    }


def _law(envelope: Envelope, name: str, units: UnitSystem) -> dict[str, Json]:
    return {
        "shares": json_value(envelope.shares(name), units),
        "shares_of_allowed": json_value(envelope.allowed_shares(name), units),
        "nominal_by_release_angle": [
            {
                "release_angle": quantity(angle_shares.release_rad, ANGLE, units),
                "allowed": angle_shares.allowed,
                "passes": angle_shares.passes[name],
            }
            for angle_shares in envelope.by_angle
        ],
        "shares_log_weighted": json_value(envelope.even_shares(name), units),
        "joint_tolerances": json_value(envelope.drawn_shares(name), units) if envelope.plan.machines else None,
        "softened": next((json_value(shares, units) for shares in envelope.softened if shares.law == name), None),
        "contact": json_value(envelope.contact_shares(name), units) if envelope.plan.contacts else None,
        "nominal_first_failure": {str(kind): share for kind, share in envelope.failure_shares(name).items()},
        "smallest_nominally": json_value(envelope.smallest(name), units),
        "smallest_in_every_case": json_value(envelope.smallest(name, worst=True), units),
        "cases": [json_value(row, units) for row in envelope.case_shares(name)],
        "passivity": json_value(envelope.passivity[name], units),
    }


def settings_csv(envelope: Envelope, units: UnitSystem) -> str:
    """A line for each setting: its feel, and the outcome of each law nominally and in its first failing case."""
    plan = envelope.plan
    rows = plan.settings.rows * [axis.unit.from_si(1.0, units) for axis in AXES.values()]
    feel = plan.settings.feel(plan.loader)
    feel_units = [INERTIA, unit(TABLE["feel.damping"]), unit(TABLE["feel.stiffness"])]
    feel = feel * [feel_unit.from_si(1.0, units) for feel_unit in feel_units]
    names = [f"{axis.title} ({axis.unit.shown(units)})".removesuffix(" ()") for axis in AXES.values()]
    names += [f"{symbol} ({feel_unit.shown(units)})" for symbol, feel_unit in zip("IBG", feel_units, strict=True)]
    columns = []
    for name in envelope.laws:
        codes = envelope.codes(name)
        first = np.argmax(codes != 0, axis=0)
        case = np.array([case.name for case in plan.cases])[first]
        worst = np.take_along_axis(codes, first[np.newaxis], axis=0)[0]
        columns.append([envelope.outcomes[code] for code in codes[0]])
        columns.append([envelope.outcomes[code] for code in worst])
        columns.append(np.where(worst == 0, "", case).tolist())
        names += [f"{name}: nominal", f"{name}: outcome in the first case that fails", f"{name}: first case that fails"]
    lines = zip(np.hstack([rows, feel]).tolist(), zip(*columns, strict=True), strict=True)
    return csv_text(names, ((*numbers, *words) for numbers, words in lines), ".6g")
