"""Result of a test for the page: both curves, tolerances, and a verdict for each quantity."""

import numpy as np

from forcefeel.live.console.programmed import plot_values
from forcefeel.page.typography import unit_text
from forcefeel.qualification import Outcome, Qualification, Verdict
from forcefeel.qualification.plan.result import Result
from forcefeel.qualification.plan.sentences import UNITS, figure_text, result_text
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.units import ANGLE, FORCE, Json, UnitSystem, to_text

_POINTS = 900
_SHOWN = 1.25
"""Drawn duration of a release, as a factor on the longer of both settling times."""


def verdict_json(qualification: Qualification) -> Json:
    """The single test of a qualification."""
    (result,) = qualification.sections[0].results
    system = qualification.system
    return {
        "title": result.trial.title,
        "rule": qualification.rules.title,
        "outcome": str(result.outcome),
        "passed": result.outcome is Outcome.PASSED,
        "sentence": result_text(result, qualification),
        "remarks": list(result.remarks),
        "verdicts": [_verdict(verdict, system) for verdict in result.verdicts],
        "plot": _plot(result, system),
    }


def _verdict(verdict: Verdict, system: UnitSystem) -> Json:
    unit = UNITS[verdict.unit]
    known = np.isfinite(verdict.tolerance)
    return {
        "quantity": verdict.quantity,
        "measured": figure_text(verdict.measured, system),
        "reference": figure_text(verdict.reference, system),
        "tolerance": f"± {to_text(unit.from_si(verdict.tolerance, system), 3)}" if known else "",
        "unit": unit_text(unit.shown(system)),
        "outcome": str(verdict.outcome),
    }


def _plot(result: Result, system: UnitSystem) -> Json:
    if result.measured is None or result.reference is None:
        return None
    if isinstance(result.reference.features, SweepFeatures):
        return _sweep(result, system)
    return _release(result, system)


def _release(result: Result, system: UnitSystem) -> Json:
    """Position relative to the steady state over time since the release, for both records at the same times."""
    assert result.measured is not None
    assert result.reference is not None
    sides = {"measured": result.measured, "reference": result.reference}
    features = {name: side.features for name, side in sides.items()}
    both = [side for side in features.values() if isinstance(side, ReleaseFeatures)]
    end = _SHOWN * max(side.settled_s - side.release_s.value for side in both)
    reference, scale = both[1], ANGLE.from_si(1.0, system)
    time = np.linspace(-0.03 * end, end, _POINTS)
    plot: dict[str, Json] = {"kind": "release", "x": plot_values(time), "band": reference.band * scale}
    for (name, side), side_features in zip(sides.items(), both, strict=True):
        position = side.record.position - side_features.steady.value
        at = side.signals.time_s - side_features.release_s.value
        plot[name] = plot_values(np.interp(time, at, position) * scale)
    limits = {verdict.quantity: verdict.tolerance for verdict in result.verdicts if np.isfinite(verdict.tolerance)}
    sign = -1.0 if reference.displacement.value > 0 else 1.0
    tops = zip(reference.overshoots, reference.overshoot_times_s, strict=False)
    passes = [at - reference.release_s.value for at in reference.crossing_times_s]
    bars = [
        {
            "name": name,
            "x": at - reference.release_s.value,
            "y": sign * (-1.0) ** k * size.value * scale,
            "by": limits[name] * scale,
        }
        for k, (size, at) in enumerate(tops)
        if (name := f"A{k + 1}") in limits
    ]
    # P0 ends at the first crossing, each further full cycle two crossings later.
    times = [
        {"name": f"P{n}", "x": at, "y": 0.0, "along": limits[f"P{n}"]}
        for n, at in enumerate(passes[::2])
        if f"P{n}" in limits
    ]
    if "fall time" in limits:
        low = 0.1 * reference.displacement.value * scale
        times.append({"name": "fall time", "x": reference.rise_time.value, "y": low, "along": limits["fall time"]})
    marks: Json = [*bars, *times]
    return {
        **plot,
        "marks": marks,
        "x_label": "time from release, s",
        "y_label": f"from steady state, {ANGLE.shown(system)}",
    }


def _sweep(result: Result, system: UnitSystem) -> Json:
    """Force over position in both directions, on the reference's grid."""
    assert result.measured is not None
    assert result.reference is not None
    actual, programmed = result.measured.features, result.reference.features
    assert isinstance(actual, SweepFeatures)  # a sweep's result
    assert isinstance(programmed, SweepFeatures)
    rule = next(tolerance for tolerance in result.trial.test.tolerances if tolerance.quantity == "force")
    at, force = programmed.position - programmed.neutral, FORCE.from_si(1.0, system)
    plot: dict[str, Json] = {"kind": "sweep", "x": plot_values(at * ANGLE.from_si(1.0, system))}
    for direction, reference, measured in (
        ("up", programmed.force_up_n, actual.force_up_n),
        ("down", programmed.force_down_n, actual.force_down_n),
    ):
        limit = rule.limit(np.nan_to_num(reference), system=system)
        position = actual.position - actual.neutral
        plot[f"reference_{direction}"] = plot_values(reference * force)
        plot[f"{direction}_low"], plot[f"{direction}_high"] = (
            plot_values((reference - limit) * force),
            plot_values((reference + limit) * force),
        )
        plot[f"measured_{direction}"] = plot_values(
            np.interp(at, position, measured, left=np.nan, right=np.nan) * force
        )
    x_label, y_label = f"position from neutral, {ANGLE.shown(system)}", f"force at the grip, {FORCE.shown(system)}"
    return {**plot, "x_label": x_label, "y_label": y_label}
