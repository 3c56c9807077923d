"""Curves as a loader file writes them: a table with the units of a point and the points."""

from forcefeel.errors import InputError
from forcefeel.loader.curves import Curve, CurveRow, check
from forcefeel.units import UnitSystem, factor, show


def read(row: CurveRow, given: object) -> Curve:
    """A curve as a loader file states it, in SI units.

    Args:
        row: Which curve.
        given: The table: ``units``, two texts; ``points``, pairs of numbers in these units.

    Raises:
        InputError: If it is no such table, no curve or one beyond the limits of its axes; without the curve's name.
    """
    us = row.units(UnitSystem.US)
    shown = ", ".join(f"[{x:g}, {y:g}]" for x, y in row.example[:3])
    expected = f'expected units = ["{us[0]}", "{us[1]}"] and points = [{shown}, ...]'
    if not isinstance(given, dict):
        raise InputError(f"{expected}, got {show(given)}")
    if missing := [name for name in ("units", "points") if name not in given]:
        raise InputError(f"{expected}; {' and '.join(missing)} missing")
    if unknown := [name for name in given if name not in {"units", "points"}]:
        raise InputError(f"{expected}, got the key {show(unknown[0])}")
    per_x, per_y = _factors(row, given["units"])
    x, y = _points(row, given["points"])
    Curve(x, y)  # complains in the file's units
    curve = Curve(tuple(per_x * at for at in x), tuple(per_y * value for value in y))
    check(row, curve)
    return curve


def _factors(row: CurveRow, given: object) -> list[float]:
    """SI units in one of the file's units of x and of y."""
    us = row.units(UnitSystem.US)
    if not isinstance(given, list) or len(given) != 2 or not all(isinstance(unit, str) for unit in given):
        raise InputError(
            f'units: expected the two units of a point, such as ["{us[0]}", "{us[1]}"], got {_value_text(given)}'
        )
    factors = []
    for axis, unit in zip((row.x, row.y), given, strict=True):
        try:
            factors.append(factor(unit, axis.unit.si))
        except InputError as error:
            raise InputError(f"units: {axis.name}: {error}") from error
    return factors


def _points(row: CurveRow, given: object) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The points' x and y, as they stand."""
    if not isinstance(given, list):
        raise InputError(f"points: expected pairs of numbers, got {_value_text(given)}")
    for k, point in enumerate(given):
        pair = isinstance(point, list) and len(point) == 2
        if not pair or any(isinstance(number, bool) or not isinstance(number, int | float) for number in point):
            example = "[{:g}, {:g}]".format(*row.example[-1])
            raise InputError(
                f"points: expected a pair of numbers such as {example} as point {k + 1}, got {_value_text(point)}"
            )
    return tuple(point[0] for point in given), tuple(point[1] for point in given)


def _value_text(given: object) -> str:
    """As ``show``, short arrays in full."""
    text = "[" + ", ".join(map(show, given)) + "]" if isinstance(given, list) else show(given)
    return text if len(text) <= 60 else show(given)


def write(row: CurveRow, curve: Curve | None, units: UnitSystem) -> list[str]:
    """The lines of a curve; without one an example, as comments."""
    axes, shown = (row.x, row.y), row.units(units)
    if curve is None:
        per_x, per_y = (axis.unit.from_si(factor(axis.unit.us, axis.unit.si), units) for axis in axes)
        points = [f"[{x * per_x:.4g}, {y * per_y:.4g}]" for x, y in row.example]
    else:
        per_x, per_y = (axis.unit.from_si(1.0, units) for axis in axes)
        points = [f"[{x * per_x:.10g}, {y * per_y:.10g}]" for x, y in zip(curve.x, curve.y, strict=True)]
    named = f'units = ["{shown[0]}", "{shown[1]}"]'
    lines = [f"[{row.key}]", named, f"points = [{', '.join(points)}]"]
    return [f"# {row.meaning[0].upper()}{row.meaning[1:]}.", *(line if curve else f"# {line}" for line in lines)]
