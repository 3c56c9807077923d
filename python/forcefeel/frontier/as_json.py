"""Frontier as JSON, every number with its unit."""

from importlib.metadata import version

from forcefeel.envelope.as_json import deviations_json, grid_json, rule_json
from forcefeel.frontier.findings import frontier_conclusions
from forcefeel.frontier.motor_limits import MotorLimits
from forcefeel.frontier.result import Frontier
from forcefeel.frontier.tightening import Path
from forcefeel.frontier.valve_limits import ValveLimits
from forcefeel.json_values import json_value
from forcefeel.units import ANGLE, FLOW, FORCE, PERCENT, SECONDS, Json, UnitSystem, quantity


def frontier_json(frontier: Frontier, units: UnitSystem) -> dict[str, Json]:
    """Results and inputs of a frontier."""
    plan = frontier.plan
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": plan.loader.name,
        "law": frontier.law,
        "rule": rule_json(plan),
        "release_angle": quantity(plan.release_rad, ANGLE, units),
        "settings": plan.settings.count,
        "grid": grid_json(plan.settings, units),
        "tolerances": deviations_json(plan.deviations),
        "conclusions": json_value(frontier_conclusions(frontier, units), units),
        "shares": json_value(frontier.envelope.shares(frontier.law), units),
        "limits": {
            frontier.text(limit): quantity(share, PERCENT, units) for limit, share in frontier.limit_shares.items()
        },
        "limit_of_each_setting": frontier.limits.tolist(),
        "bound": _bound(frontier, units),
        "tightening": _tightening(frontier, units),
        frontier.drive_name: _drive(frontier, units),
        "smallest_in_every_case": json_value(frontier.smallest, units),
        "largest_stiffness_in_every_case": quantity(frontier.largest_stiffness, PERCENT, units),
        "friction": json_value(frontier.friction, units),
        "friction_bound": _friction_bound(frontier, units),
        "hardware": json_value(frontier.hardware, units),
    }


def _tightening(frontier: Frontier, units: UnitSystem) -> dict[str, Json]:
    tight = frontier.tightening
    paths = {"inertia_and_geometry": tight.inertia_and_geometry, "all_in_proportion": tight.all_in_proportion}
    return {
        "passes_nominally": quantity(tight.nominal, PERCENT, units),
        "passes_in_every_case": quantity(tight.worst, PERCENT, units),
        **{name: _path(path, units) for name, path in paths.items()},
        "pair": json_value(tight.pair, units),
        "costs": json_value(tight.costs, units),
    }


def _path(path: Path, units: UnitSystem) -> dict[str, Json]:
    return {
        "inertia_known_to": [quantity(tolerance, PERCENT, units) for tolerance in path.tolerances],
        "passes_in_every_case": [quantity(share, PERCENT, units) for share in path.shares],
        "share_at_zero_tolerance": quantity(path.limit, PERCENT, units),
        "needed_for_goal": quantity(path.needed, PERCENT, units),
    }


def _bound(frontier: Frontier, units: UnitSystem) -> dict[str, Json]:
    bound = frontier.bound
    return {
        "inertia_known_to": [quantity(error, PERCENT, units) for error in bound.errors],
        "possible": [quantity(share, PERCENT, units) for share in bound.shares],
        "possible_if_exact_nominally": [quantity(share, PERCENT, units) for share in bound.centered_shares],
        "rendered_beyond_it": quantity(frontier.beyond_bound, PERCENT, units),
    }


def _friction_bound(frontier: Frontier, units: UnitSystem) -> Json:
    bound = frontier.friction_bound
    if bound is None:
        return None
    return {
        "friction": quantity(bound.friction_n, FORCE, units),
        "tolerance": quantity(bound.tolerance, PERCENT, units),
        "force_error": quantity(bound.off_n, FORCE, units),
        "friction_known_to": [quantity(error, PERCENT, units) for error in bound.errors],
        "possible": [quantity(share, PERCENT, units) for share in bound.shares],
    }


def _drive(frontier: Frontier, units: UnitSystem) -> dict[str, Json]:
    drive = frontier.drive
    return {
        **_capability(drive, units),
        "largest_demand_of_an_ideal": quantity(float(drive.demand.max()), PERCENT, units),
        "ideals_beyond_it": quantity(drive.beyond_ideal_share, PERCENT, units),
        "forbidden": quantity(drive.forbidden_share, PERCENT, units),
        "longest_unload": quantity(drive.longest_unload_s, SECONDS, units),
        "longest_unload_of_period": quantity(drive.longest_unload_of_period, PERCENT, units),
    }


def _capability(drive: ValveLimits | MotorLimits, units: UnitSystem) -> dict[str, Json]:
    if isinstance(drive, ValveLimits):
        return {"flow": quantity(drive.flow_m3_per_s, FLOW, units)}
    return {
        "peak_force": quantity(drive.peak_force_n, FORCE, units),
        "peak_holding_share": quantity(drive.largest_hold, PERCENT, units),
    }
