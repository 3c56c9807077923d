"""Figures of a static test from a few points of force over position, without a sweep.

``d`` distance from neutral · ``F`` force away from neutral: breakout is ``F_0`` of the line ``F = F_0 + s d`` through the two
nearest points of a side. It is as uncertain as the third point shows the force to bend.
"""

import math

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.figures import Figure, combined
from forcefeel.qualification.force_points import ForcePoints
from forcefeel.qualification.sweep import SweepFeatures

_TOGETHER = 1e-3
"""Share of the travel within which positions are equal."""

_Array = NDArray[np.float64]


def measure_points(points: ForcePoints) -> SweepFeatures:
    """The features of points; NaN where points do not show one.

    The force is known at the points alone. Points without a direction are taken as moving away from neutral.

    Raises:
        InputError: If two forces differ at one position and no direction is stated.
    """
    points = points.outward()
    x, force, way = points.position, points.force_n, points.directions
    order = np.sort(x)
    grid = order[np.concatenate(([True], np.diff(order) > _TOGETHER * np.ptp(order)))]
    up, down = (_mean(grid, x[way == sign], force[way == sign]) for sign in (1.0, -1.0))
    friction = (up - down) / 2
    known = 0.0 if points.force_uncertainty_n is None else float(np.median(points.force_uncertainty_n))
    unit = f"N/{points.position_unit}"
    low, high = (_side(sign * x[way == sign], sign * force[way == sign], known, unit) for sign in (-1.0, 1.0))
    gradient = Figure((low[1].value + high[1].value) / 2, math.hypot(low[1].uncertainty, high[1].uncertainty) / 2, unit)
    unknown = Figure(math.nan, math.nan, points.position_unit)
    loops = friction[np.isfinite(friction)]
    return SweepFeatures(
        name=points.name,
        position=grid,
        force_up_n=up,
        force_down_n=down,
        surface_up_rad=None,
        surface_down_rad=None,
        friction_curve_n=friction,
        force_uncertainty_n=known,
        breakout_low=low[0],
        breakout_high=high[0],
        friction=Figure(float(np.median(loops)) if len(loops) else math.nan, known, "N"),
        freeplay=unknown,
        centring=unknown,
        gradient=gradient,
        gradient_low=low[1],
        gradient_high=high[1],
        neutral=0.0,
        stops=(float(grid[0]), float(grid[-1])),
        duration_s=math.nan,
        position_unit=points.position_unit,
    )


def _mean(grid: _Array, x: _Array, force: _Array) -> _Array:
    """Mean force at each position of the grid; NaN without a point."""
    cell = np.clip(np.searchsorted(grid, x, side="right") - 1, 0, len(grid) - 1)
    with np.errstate(invalid="ignore"):
        return np.asarray(
            np.bincount(cell, force, minlength=len(grid)) / np.bincount(cell, minlength=len(grid)), dtype=np.float64
        )


def _side(distance: _Array, force: _Array, known_n: float, unit: str) -> tuple[Figure, Figure]:
    """Breakout and slope of one side, from its nearest points on the way out."""
    order = np.argsort(distance)
    order = order[distance[order] > 0]
    order = order[np.concatenate(([True], np.diff(distance[order]) > 0))] if len(order) else order
    if len(order) < 2:
        return Figure(math.nan, math.nan, "N"), Figure(math.nan, math.nan, unit)
    near, *others = zip(distance[order[:3]].tolist(), force[order[:3]].tolist(), strict=True)
    slopes = [(other[1] - near[1]) / (other[0] - near[0]) for other in others]
    bend, step = abs(slopes[-1] - slopes[0]) / math.sqrt(12), others[0][0] - near[0]
    start = combined(known_n * math.hypot(others[0][0], near[0]) / step, bend * near[0])
    slope = Figure(slopes[0], combined(math.sqrt(2) * known_n / step, bend), unit)
    return Figure(max(near[1] - slopes[0] * near[0], 0.0), start, "N"), slope
