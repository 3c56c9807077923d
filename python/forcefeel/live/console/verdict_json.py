"""A test that was made, as the page draws it: both curves, what may lie where, and each quantity with its verdict."""

import numpy as np

from forcefeel.json_values import Json
from forcefeel.live.console.programmed import shown
from forcefeel.page.typography import unit_text
from forcefeel.qualification import Outcome, Qualification, Verdict
from forcefeel.qualification.plan.result import Result
from forcefeel.qualification.plan.sentences import UNITS, figure_text, result_text
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.units import ANGLE, FORCE, UnitSystem, to_text

_POINTS = 900
_SHOWN = 1.25
"""A release is drawn until so much longer than the slower of the two takes to come to rest."""


def verdict_json(found: Qualification) -> Json:
    """The one test of a qualification."""
    (result,) = found.sections[0].results
    system = found.system
    return {
        "title": result.trial.title,
        "rule": found.rules.title,
        "outcome": str(result.outcome),
        "passed": result.outcome is Outcome.PASSED,
        "sentence": result_text(result, found),
        "remarks": list(result.remarks),
        "verdicts": [_verdict(one, system) for one in result.verdicts],
        "plot": _plot(result, system),
    }


def _verdict(one: Verdict, system: UnitSystem) -> Json:
    unit = UNITS[one.unit]
    known = np.isfinite(one.tolerance)
    return {
        "quantity": one.quantity,
        "measured": figure_text(one.measured, system),
        "reference": figure_text(one.reference, system),
        "tolerance": f"± {to_text(unit.from_si(one.tolerance, system), 3)}" if known else "",
        "unit": unit_text(unit.shown(system)),
        "outcome": str(one.outcome),
    }


def _plot(result: Result, system: UnitSystem) -> Json:
    if result.measured is None or result.reference is None:
        return None
    if isinstance(result.reference.features, SweepFeatures):
        return _sweep(result, system)
    return _release(result, system)


def _release(result: Result, system: UnitSystem) -> Json:
    """Position from each record's steady state over the time from its release, on one grid of times."""
    assert result.measured is not None
    assert result.reference is not None
    sides = {"measured": result.measured, "reference": result.reference}
    features = {name: side.features for name, side in sides.items()}
    both = [one for one in features.values() if isinstance(one, ReleaseFeatures)]
    end = _SHOWN * max(one.settled_s - one.release_s.value for one in both)
    theirs, scale = both[1], ANGLE.from_si(1.0, system)
    time = np.linspace(-0.03 * end, end, _POINTS)
    found: dict[str, Json] = {"kind": "release", "x": shown(time), "band": theirs.band * scale}
    for (name, side), its in zip(sides.items(), both, strict=True):
        position = side.record.position - its.steady.value
        at = side.record.time_s - its.release_s.value
        found[name] = shown(np.interp(time, at, position) * scale)
    limits = {one.quantity: one.tolerance for one in result.verdicts if np.isfinite(one.tolerance)}
    sign = -1.0 if theirs.displacement.value > 0 else 1.0
    tops = zip(theirs.overshoots, theirs.overshoot_times_s, strict=False)
    passes = [at - theirs.release_s.value for at in theirs.crossing_times_s]
    bars = [
        {
            "name": name,
            "x": at - theirs.release_s.value,
            "y": sign * (-1.0) ** k * size.value * scale,
            "by": limits[name] * scale,
        }
        for k, (size, at) in enumerate(tops)
        if (name := f"A{k + 1}") in limits
    ]
    # P0 ends at the first crossing, the n-th full cycle at the crossing two later.
    times = [
        {"name": f"P{n}", "x": at, "y": 0.0, "along": limits[f"P{n}"]}
        for n, at in enumerate(passes[::2])
        if f"P{n}" in limits
    ]
    if "fall time" in limits:
        low = 0.1 * theirs.displacement.value * scale
        times.append({"name": "fall time", "x": theirs.rise_time.value, "y": low, "along": limits["fall time"]})
    marks: Json = [*bars, *times]
    return {
        **found,
        "marks": marks,
        "x_label": "time from release, s",
        "y_label": f"from steady state, {ANGLE.shown(system)}",
    }


def _sweep(result: Result, system: UnitSystem) -> Json:
    """Force over position both ways, on the reference's grid."""
    assert result.measured is not None
    assert result.reference is not None
    mine, theirs = result.measured.features, result.reference.features
    assert isinstance(mine, SweepFeatures)  # a sweep's result
    assert isinstance(theirs, SweepFeatures)
    rule = next(one for one in result.trial.test.tolerances if one.quantity == "force")
    at, force = theirs.position - theirs.neutral, FORCE.from_si(1.0, system)
    found: dict[str, Json] = {"kind": "sweep", "x": shown(at * ANGLE.from_si(1.0, system))}
    for way, reference, measured in (
        ("up", theirs.force_up_n, mine.force_up_n),
        ("down", theirs.force_down_n, mine.force_down_n),
    ):
        limit = rule.limit(np.nan_to_num(reference), system=system)
        place = mine.position - mine.neutral
        found[f"reference_{way}"] = shown(reference * force)
        found[f"{way}_low"], found[f"{way}_high"] = (
            shown((reference - limit) * force),
            shown((reference + limit) * force),
        )
        found[f"measured_{way}"] = shown(np.interp(at, place, measured, left=np.nan, right=np.nan) * force)
    x_label, y_label = f"position from neutral, {ANGLE.shown(system)}", f"force at the grip, {FORCE.shown(system)}"
    return {**found, "x_label": x_label, "y_label": y_label}
