"""The fit of a feel to points and a release."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import feel_frequency, feel_from_frequency
from forcefeel.errors import InputError, expect
from forcefeel.feel.directions import Directions, assigned, both_ways, check_branches, check_line
from forcefeel.feel.plan import FeelPlan
from forcefeel.feel.release_fit import fit_release
from forcefeel.feel.result import FeelFit, FittedRow, ReleaseFit, Source
from forcefeel.feel.select import StaticFit, choose, fitting
from forcefeel.feel.shape import Shape, StaticModel
from forcefeel.loader.curves import Curve
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX, OFF, TABLE, in_range, range_text, value_text
from forcefeel.qualification import ForcePoints

_Array = NDArray[np.float64]

FEWEST, FEWEST_PLACES = 5, 3
"""Least number of points, and of their different positions."""
_ALIKE = 0.95
"""Correlation above which two rows are inseparable."""
_SCATTER = 0.04
"""Share of the largest force that points without a direction may scatter."""
_DRAWN = 401
"""Angles at which the feel is computed for pictures."""
_SLOPE = 1e-5
"""Step of the sensitivities of the rows to the unknowns."""
_KEPT = ("velocity_limit", "trim_rate", "shaker_force", "shaker_frequency", "hard_stop_low", "hard_stop_high")
"""Rows of a feel that say nothing of its force over position, and stay."""


def fit_feel(points: ForcePoints, plan: FeelPlan) -> FeelFit:
    """Fits a feel to points of force over position, and to a release if the plan has one.

    Candidates are a straight spring or a curve, with friction, breakout or deadband, preload, hysteresis and soft stops. The shape
    with the smallest criterion (``select``) is programmed; intervals follow from the covariance of its least squares fit.

    Args:
        points: The points; of a single flight condition.
        plan: The loader and stated numbers.

    Returns:
        The loader with the feel, each row with its interval.

    Raises:
        InputError: If there are too few points, they turn back, friction would be negative, conditions are mixed, or the release
            does not oscillate.

    Example:
        >>> angle = np.radians([-8, -6, -4, -2, 2, 4, 6, 8])
        >>> force = 300 * angle + 10 * np.sign(angle)
        >>> fit = ff.feel.fit_feel(ff.qualification.ForcePoints(angle, force), ff.feel.FeelPlan(ff.digital_elevator()))
        >>> f"{fit.loader['feel.breakout']:.1f} N"
        '10.0 N'
    """
    expect("points", points, ForcePoints, "ForcePoints, as read_force_points reads them")
    expect("plan", plan, FeelPlan, "a FeelPlan")
    points = _checked(points.of_condition(), plan.loader)
    static, how = _static(points, plan)
    values, curve = static.model.feel(static.numbers)
    half, inseparable = _uncertainty(static)
    loader, replaced = _loader(plan, values, curve, points)
    release = None if plan.release is None else fit_release(loader, plan)
    loader, motion = _with_motion(loader, plan, release)
    free = _free_keys(static)
    rows = [
        FittedRow(key, float(loader[key]), half[key] if key in free else None, _source(key, free))
        for key in ("feel.stiffness", *loader.given)
        if key.startswith("feel.") and key.removeprefix("feel.") not in _KEPT
    ]
    angle = np.linspace(float(points.position.min()), float(points.position.max()), _DRAWN)
    if points.position.min() > 0 or points.position.max() < 0:
        angle = np.linspace(min(angle[0], 0.0), max(angle[-1], 0.0), _DRAWN)
    ones = np.ones(_DRAWN)
    down = static.model.forces(static.numbers, angle[::-1], -ones)[::-1]
    curve_half = tuple(half[f"curve {k}"] for k in range(0 if curve is None else len(curve.x)))
    return FeelFit(
        plan,
        loader,
        replace(points, direction=static.model.directions),
        how,
        static.model.shape,
        (*rows, *motion),
        curve_half,
        static.residual_n,
        angle,
        static.model.forces(static.numbers, angle, ones),
        down,
        inseparable,
        release,
        replaced,
    )


def _checked(points: ForcePoints, loader: Loader) -> ForcePoints:
    """The points as angles of the column.

    Raises:
        InputError: If there are too few, at too few positions, or without a force.
    """
    places = len(np.unique(np.round(points.position / max(float(np.ptp(points.position)), 1e-300), 2)))
    if len(points.force_n) < FEWEST or places < FEWEST_PLACES:
        raise InputError(
            f"{points.name}: expected {FEWEST} points at least, at {FEWEST_PLACES} or more positions, got "
            f"{len(points.force_n)} at {places}; measure more points"
        )
    if not np.ptp(points.force_n) > 0:
        raise InputError(f"{points.name}: expected forces that differ, got {points.force_n[0]:g} N everywhere")
    points = points.thinned()
    check_branches(points, points.directions)
    if points.position_unit == "rad":
        return points
    return replace(points, position=points.position / loader["column.grip_arm"], position_unit="rad", shown_unit="deg")


def _static(points: ForcePoints, plan: FeelPlan) -> tuple[StaticFit, Directions]:
    """The fit at rest, and how directions are known."""
    x, force = points.position, points.force_n
    known = np.ones(len(x)) if points.force_uncertainty_n is None else points.force_uncertainty_n
    scales = {"angle": float(np.abs(x).max()), "force": float(np.abs(force).max())}
    scales["stiffness"] = scales["force"] / scales["angle"] * plan.loader["column.grip_arm"]
    stated = {"feel.breakout": plan.breakout_n, "feel.coulomb_friction": plan.friction_n}
    base, _ = _without_feel(plan.loader)
    directions = points.directions
    how = Directions.STATED if directions.any() else Directions.OUTWARD
    if how is Directions.OUTWARD:
        directions = np.sign(x)
    model = StaticModel(
        Shape(), base.si_values, x, directions, scales, {k: v for k, v in stated.items() if v is not None}
    )

    def chosen(model: StaticModel) -> StaticFit:
        best = choose(fitting(model, force, known), x, _allowed(points, plan, model.directions))
        assert best is not None  # FEWEST points are enough for a straight line
        return best

    best = chosen(model)
    if how is Directions.OUTWARD:
        loop = assigned(model, points, known, best)
        if loop is not None:
            check_branches(points, loop)
            how, best = Directions.ASSIGNED, chosen(replace(model, directions=loop))
        scatter = float(np.sqrt(np.mean(best.residual_n**2)))
        if scatter > _SCATTER * scales["force"]:
            check_line(points)
            remedy = "; check the stated breakout and friction" if model.stated else ""
            raise InputError(
                f"{points.name}: the points scatter by {scatter:.3g} N about one line{remedy}; expected the direction of each "
                "point; add a column 'direction', 1 where the position rises and -1 where it falls, or 'time (s)'; if they are of "
                "two flight conditions, add a column such as 'dynamic pressure (Pa)'"
            )
    return best, how


def _allowed(points: ForcePoints, plan: FeelPlan, directions: _Array) -> list[str]:
    """The parts that the points may show."""
    x = points.position
    loops = both_ways(x, directions)
    divided = loops or plan.breakout_n is not None
    parts = ["friction"] if divided and plan.friction_n is None else []
    if plan.breakout_n is None:
        parts.append("breakout")
    parts.append("deadband")
    if x.min() < 0 < x.max():
        parts.append("preload")
    if loops and points.in_order and len(x) > 4 * FEWEST:
        parts.append("hysteresis")
    return parts


def _uncertainty(static: StaticFit) -> tuple[dict[str, float], tuple[tuple[str, str], ...]]:
    """Halves of the intervals of rows and points of the curve, and pairs of inseparable rows."""
    from scipy.stats import t as student  # noqa: PLC0415  SciPy waits until there is a fit

    model, numbers = static.model, static.numbers
    freedom = len(static.residual_n) - len(numbers)
    covariance = np.linalg.pinv(static.jacobian.T @ static.jacobian) * static.squares / freedom
    keys = _free_keys(static)

    def outputs(at: _Array) -> _Array:
        values, curve = model.feel(at)
        return np.array([*(values[INDEX[key]] for key in keys), *(() if curve is None else curve.y)])

    base = outputs(numbers)
    size = _SLOPE * np.maximum(np.abs(numbers), 1e-3)
    slopes = np.column_stack(
        [(outputs(numbers + size * (np.arange(len(numbers)) == k)) - base) / size[k] for k in range(len(numbers))]
    )
    of_rows = slopes @ covariance @ slopes.T
    deviation = np.sqrt(np.maximum(np.diag(of_rows), 0.0))
    half = student.ppf(0.975, freedom) * deviation
    names = [*keys, *(f"curve {k}" for k in range(len(base) - len(keys)))]
    with np.errstate(invalid="ignore", divide="ignore"):
        alike = np.abs(of_rows / np.outer(deviation, deviation))
    pairs = [
        (keys[j], keys[k])
        for j in range(len(keys))
        for k in range(j)
        if alike[j, k] > _ALIKE and "feel.soft_stop_stiffness" not in (keys[j], keys[k])
    ]
    return dict(zip(names, half.tolist(), strict=True)), tuple(pairs)


def _free_keys(static: StaticFit) -> list[str]:
    """Rows of the feel that were fitted."""
    shape = static.model.shape
    rows = {"friction": "coulomb_friction", "hysteresis": "hysteresis"}
    keys = ["stiffness", *(rows.get(part, part) for part in sorted(shape.parts))]
    keys += ["hysteresis_travel"] if "hysteresis" in shape.parts else []
    sides = {"mirrored": ("high", "low"), "": ()}.get(shape.stop, tuple(shape.stop.split()))
    keys += [f"soft_stop_{side}" for side in sides] + (["soft_stop_stiffness"] if sides else [])
    return [f"feel.{key}" for key in keys]


def _source(key: str, free: list[str]) -> Source:
    if key in free:
        return Source.POINTS
    return Source.STATED if key in ("feel.breakout", "feel.coulomb_friction") else Source.ASSUMED


def _without_feel(loader: Loader) -> tuple[Loader, tuple[str, ...]]:
    """The loader without the parts of its feel, and the rows and curves that it had."""
    rows = [key for key in loader.given if key.startswith("feel.") and key.removeprefix("feel.") not in _KEPT]
    curves = [f"feel.{name}" for name in loader.curves]
    bare = replace(loader, force_curve=None, stiffness_factor=None).replace(dict.fromkeys(rows))
    return bare, (*rows, *curves)


def _loader(plan: FeelPlan, values: _Array, curve: Curve | None, points: ForcePoints) -> tuple[Loader, tuple[str, ...]]:
    """The loader with the feel at rest; frequency and damping ratio stay."""
    loader, replaced = _without_feel(plan.loader)
    stiffness = float(values[INDEX["feel.stiffness"]])
    changes = {
        key: float(values[INDEX[key]])
        for key, off in OFF.items()
        if key.startswith("feel.") and values[INDEX[key]] not in (off, loader[key])
    }
    changes["feel.stiffness"] = stiffness
    for key, value in changes.items():
        if not in_range(TABLE[key], value):
            raise InputError(
                f"{points.name}: {key}: the points give {value_text(TABLE[key], value)}, expected {range_text(TABLE[key])}; check "
                "the units in the header"
            )
    frequency, ratio = feel_frequency(plan.loader.si_values)
    inertia, damping = feel_from_frequency(frequency, ratio, stiffness)
    changes |= {"feel.inertia": inertia, "feel.damping": damping}
    if stiffness > loader["feel.maximum_stiffness"]:
        changes["feel.maximum_stiffness"] = stiffness
    source = f"{loader.source}; feel from {points.name}"
    if points.condition:
        source += f", {points.condition}"
    return replace(loader.replace(changes, si=True), force_curve=curve, source=source), replaced


def _with_motion(loader: Loader, plan: FeelPlan, release: ReleaseFit | None) -> tuple[Loader, tuple[FittedRow, ...]]:
    """The loader with its inertia and damping, and their rows."""
    kept = feel_frequency(plan.loader.si_values)
    stated = plan.frequency_rad_per_s, plan.damping_ratio
    recorded = (None, None) if release is None else (release.frequency_rad_per_s, release.damping_ratio)
    rows, numbers = [], []
    for key, own, value, record in zip(("natural_frequency", "damping_ratio"), kept, stated, recorded, strict=True):
        if value is not None:
            row = FittedRow(f"feel.{key}", value, None, Source.STATED)
        elif record is not None:
            row = FittedRow(f"feel.{key}", *record, Source.RELEASE)
        else:
            row = FittedRow(f"feel.{key}", own, None, Source.LOADER)
        rows.append(row)
        numbers.append(row.value_si)
    inertia, damping = feel_from_frequency(numbers[0], numbers[1], loader["feel.stiffness"])
    loader = loader.replace({"feel.inertia": inertia, "feel.damping": damping}, si=True)
    if "feel.soft_stop_stiffness" in loader.given:
        loader, row = _with_stop_damping(loader, numbers[1])
        rows.append(row)
    return loader, (*rows, *_of_motion(loader, rows[:2]))


def _with_stop_damping(loader: Loader, ratio: float) -> tuple[Loader, FittedRow]:
    """The loader with soft stops in which the damping ratio is that of the spring: no point shows theirs."""
    stiffness = loader["feel.stiffness"] + loader["feel.soft_stop_stiffness"]
    frequency, _ = feel_frequency(loader.replace({"feel.stiffness": stiffness}, si=True).si_values)
    damping = feel_from_frequency(frequency, ratio, stiffness)[1] - loader["feel.damping"]
    key = "feel.soft_stop_damping"
    return loader.replace({key: damping}, si=True), FittedRow(key, damping, None, Source.ASSUMED)


def _of_motion(loader: Loader, rows: list[FittedRow]) -> Iterator[FittedRow]:
    """Inertia and damping; their intervals for the programmed spring rate."""
    frequency, ratio = rows
    stiffness = loader["feel.stiffness"]
    for key, place in (("feel.inertia", 0), ("feel.damping", 1)):
        value = feel_from_frequency(frequency.value_si, ratio.value_si, stiffness)[place]
        moved = [
            feel_from_frequency(frequency.value_si + a, ratio.value_si + b, stiffness)[place] - value
            for a, b in ((frequency.half_interval_si or 0.0, 0.0), (0.0, ratio.half_interval_si or 0.0))
        ]
        half = math.hypot(*moved) or None
        yield FittedRow(key, value, half, max(frequency.source, ratio.source, key=_least_sure))


def _least_sure(source: Source) -> int:
    return [Source.STATED, Source.RELEASE, Source.LOADER].index(source)
