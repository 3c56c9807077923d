"""A fitted feel as JSON: every number with its unit."""

from importlib.metadata import version

from forcefeel.feel.findings import feel_conclusions
from forcefeel.feel.result import FeelFit
from forcefeel.json_values import json_value
from forcefeel.loader.curves import CURVES
from forcefeel.units import ANGLE, FORCE, Json, UnitSystem, quantity


def feel_json(fit: FeelFit, units: UnitSystem) -> dict[str, Json]:
    """Rows with intervals, residuals and conclusions; the loader beside them."""
    points, curve, release = fit.points, fit.loader.force_curve, fit.release
    residuals = zip(points.position.tolist(), points.force_n.tolist(), fit.residual_n.tolist(), strict=True)
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "points": {"name": points.name, "sha256": points.data_hash, "condition": points.condition},
        "directions": str(fit.directions),
        "conclusions": json_value(feel_conclusions(fit, units), units),
        "rows": {row.key: row.as_json(units) for row in fit.rows},
        "force_curve": None
        if curve is None
        else {
            **CURVES["force_curve"].as_json(curve, units),
            "half_intervals": [FORCE.from_si(half, units) for half in fit.curve_half_intervals_n],
        },
        "scatter": quantity(fit.scatter_n, FORCE, units),
        "residuals": {
            "units": [ANGLE.shown(units), FORCE.shown(units), FORCE.shown(units)],
            "rows": [[ANGLE.from_si(x, units), *(FORCE.from_si(f, units) for f in both)] for x, *both in residuals],
        },
        "inseparable": [list(pair) for pair in fit.inseparable],
        "release": None
        if release is None
        else {
            "name": release.record.name,
            "sha256": release.record.data_hash,
            "offset": quantity(release.offset_rad, ANGLE, units),
            "scatter": quantity(release.scatter_rad, ANGLE, units),
        },
        "replaced": list(fit.replaced),
        "loader": json_value(fit.loader, units),
    }
