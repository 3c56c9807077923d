"""Results for machines: every number with its unit, as values that JSON can hold."""

import json
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np

from forcefeel.units import Json, Unit, UnitSystem, number_json, quantity


def json_value(result: object, system: UnitSystem) -> Json:
    """A result as JSON has it.

    Args:
        result: A result of this package: a frozen data class whose numbers are annotated with their ``Unit``, or
            tuples, dictionaries and values of such. One that knows better has a method ``as_json(system)``.
        system: The units of the numbers.

    Returns:
        Dictionaries, lists and values. A name loses the unit at its end, because the unit stands beside the value.
    """
    own = getattr(result, "as_json", None)
    if own is not None:
        document: Json = own(system)
        return document
    if is_dataclass(result):
        return fields_json(result, system)
    if isinstance(result, list | tuple):
        return [json_value(item, system) for item in result]
    if isinstance(result, dict):
        return {str(key): json_value(value, system) for key, value in result.items()}
    if isinstance(result, float):
        return number_json(result)
    return result  # type: ignore[return-value]


def fields_json(result: Any, system: UnitSystem) -> dict[str, Json]:
    """The fields of a data class, but for arrays and what ``repr`` leaves out."""
    hints = get_type_hints(type(result), include_extras=True)
    out: dict[str, Json] = {}
    for field in fields(result):
        if not field.repr:
            continue
        value, measured_in = getattr(result, field.name), _unit_of(hints[field.name])
        if measured_in is not None:
            name = field.name.removesuffix(f"_{measured_in.suffix}") if measured_in.suffix else field.name
            out[name] = None if value is None else quantity(value, measured_in, system)
        elif not isinstance(value, np.ndarray):
            out[field.name] = json_value(value, system)
    return out


def _unit_of(hint: Any) -> Unit | None:
    """The unit in ``Annotated[float, unit]``, also inside ``... | None``."""
    if get_origin(hint) is Annotated:
        return next((extra for extra in get_args(hint)[1:] if isinstance(extra, Unit)), None)
    return next((unit for arg in get_args(hint) if (unit := _unit_of(arg)) is not None), None)


def json_text(document: Json) -> str:
    """The text of a results file; numbers that JSON does not have are refused."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
