"""Results for machines: every number with its unit, as plain dictionaries that JSON can hold."""

import math
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np

from forcefeel.laws.recursion import GAIN_SYMBOLS, GAIN_UNITS, Compensation
from forcefeel.linear.models import DESIGN_STATES
from forcefeel.loader.curves import CURVES, Curve, CurveRow
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import REQUIRED, TABLE, unit
from forcefeel.loader.tolerances import Tolerance
from forcefeel.units import Unit, UnitSystem, to_text

Plain = dict[str, Any] | list[Any] | str | float | int | bool | None


def quantity(value: float, measured_in: Unit, system: UnitSystem) -> dict[str, Plain]:
    """``{"value": ..., "unit": ...}``; an infinite or undefined value is text, because JSON has no number for it."""
    return {"value": _number(measured_in.from_si(value, system)), "unit": measured_in.shown(system)}


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else to_text(value)


def plain(result: object, system: UnitSystem) -> Plain:
    """A result as plain data.

    Args:
        result: A result of this package: a frozen data class whose numbers are annotated with their ``Unit``, or
            tuples, dictionaries and plain values of such.
        system: The units of the numbers.

    Returns:
        Dictionaries, lists and plain values. A name loses the unit at its end, because the unit stands beside the value.
    """
    if isinstance(result, Loader):
        return plain_loader(result, system)
    if isinstance(result, Compensation):
        return _plain_fields(result, system) | {"gains": plain_gains(result.gains, system)}
    if is_dataclass(result):
        return _plain_fields(result, system)
    if isinstance(result, list | tuple):
        return [plain(item, system) for item in result]
    if isinstance(result, dict):
        return {str(key): plain(value, system) for key, value in result.items()}
    if isinstance(result, float):
        return _number(result)
    return result  # type: ignore[return-value]


def plain_loader(loader: Loader, system: UnitSystem) -> dict[str, Plain]:
    """A loader's numbers by ``part.name``; optional rows and curves only where given."""
    shown = {*REQUIRED, *loader.given}
    values = {key: quantity(loader[key], unit(row), system) for key, row in TABLE.items() if key in shown}
    curves = {CURVES[name].key: _plain_curve(CURVES[name], curve, system) for name, curve in loader.curves.items()}
    tolerances = {key: _plain_tolerance(it, unit(TABLE[key]), system) for key, it in loader.tolerances.items()}
    parts = {"values": values, "curves": curves, "tolerances": tolerances}
    return {"name": loader.name, "source": loader.source, **parts}


def _plain_curve(row: CurveRow, curve: Curve, system: UnitSystem) -> dict[str, Plain]:
    axes = zip((row.x.unit, row.y.unit), (curve.x, curve.y), strict=True)
    columns = [[measured_in.from_si(value, system) for value in values] for measured_in, values in axes]
    return {"units": list(row.units(system)), "points": [list(point) for point in zip(*columns, strict=True)]}


def _plain_tolerance(tolerance: Tolerance, measured_in: Unit, system: UnitSystem) -> dict[str, Plain]:
    numbers = {name: getattr(tolerance, name) for name in ("low", "high", "peak", "deviation")}
    given = {name: quantity(value, measured_in, system) for name, value in numbers.items() if value is not None}
    return {"distribution": str(tolerance.distribution), **given}


def plain_gains(gains: np.ndarray[Any, np.dtype[np.float64]], system: UnitSystem) -> list[Plain]:
    """Gains with the state that each acts on."""
    rows = zip(GAIN_SYMBOLS, DESIGN_STATES, gains, GAIN_UNITS, strict=False)
    return [
        {"symbol": symbol, "state": state, **quantity(float(value), measured_in, system)}
        for symbol, state, value, measured_in in rows
    ]


def _plain_fields(result: Any, system: UnitSystem) -> dict[str, Plain]:
    hints = get_type_hints(type(result), include_extras=True)
    out: dict[str, Plain] = {}
    for field in fields(result):
        if not field.repr:
            continue
        value, measured_in = getattr(result, field.name), _unit_of(hints[field.name])
        if measured_in is not None:
            name = field.name.removesuffix(f"_{measured_in.suffix}") if measured_in.suffix else field.name
            out[name] = None if value is None else quantity(value, measured_in, system)
        elif not isinstance(value, np.ndarray):
            out[field.name] = plain(value, system)
    return out


def _unit_of(hint: Any) -> Unit | None:
    """The unit in ``Annotated[float, unit]``, also inside ``... | None``."""
    if get_origin(hint) is Annotated:
        return next((extra for extra in get_args(hint)[1:] if isinstance(extra, Unit)), None)
    return next((found for arg in get_args(hint) if (found := _unit_of(arg)) is not None), None)
