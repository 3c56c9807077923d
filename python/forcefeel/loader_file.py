"""The loader file: TOML, one axis, every value with its unit as text.

pydantic checks it against the parameter table of the Rust model: the schema is made from the table's rows, so a new
row is a new key. What a file may state in another way is turned into the table's rows here:

=======  ================================================  ==========================  ===================
part     given                                             instead of                  by
=======  ================================================  ==========================  ===================
valve    ``operating_current``, ``operating_pressure``     ``C_i``, ``C_p``            eqs. (1), (2)
linkage  ``resonance_frequency``, ``..._damping_ratio``    ``k``, ``c``                eqs. (6), (9)
feel     ``natural_frequency``, ``damping_ratio``          ``I``, ``B``                eq. (11)
=======  ================================================  ==========================  ===================
"""

import difflib
import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model
from pydantic_core import ErrorDetails

from forcefeel import _core
from forcefeel._core import Parameter
from forcefeel.errors import InputError
from forcefeel.parameters import (
    INDEX,
    PARTS,
    TABLE,
    alternatives,
    in_range,
    limits_si,
    main_rows,
    range_text,
    replaced,
    unit,
)
from forcefeel.templating import environment
from forcefeel.units import UnitSystem, parse, show

_STRICT = ConfigDict(extra="forbid", frozen=True, strict=True)

_DERIVE: Mapping[str, Callable[[NDArray[np.float64], Mapping[str, float]], tuple[float, float]]] = {
    "valve": lambda v, a: _core.valve_gains(v, a["operating_current"], a["operating_pressure"]),
    "linkage": lambda v, a: _core.linkage_from_resonance(v, a["resonance_frequency"], a["resonance_damping_ratio"]),
    "feel": lambda v, a: _core.feel_from_frequency(
        a["natural_frequency"], a["damping_ratio"], v[INDEX["feel.stiffness"]]
    ),
}


def read(path: Path) -> tuple[str, str, dict[str, float]]:
    """Name, source and SI values (by ``part.name``) of the loader file at ``path``.

    Raises:
        InputError: With a line for each thing that is wrong.
    """
    document = _document(path)
    complaints = [found for part in PARTS if (found := _contradiction(part, document.get(part)))]
    try:
        checked = _schema().model_validate(document).model_dump()
    except ValidationError as error:
        complaints = [*map(_explain, error.errors()), *complaints]
    if not complaints:
        values, complaints = _derive(checked)
    if complaints:
        raise InputError("\n".join(f"{path}: {complaint}" for complaint in complaints))
    return checked["name"], checked["source"], values


def _document(path: Path) -> dict[str, Any]:
    """The file as TOML reads it; a byte order mark, which some editors write, is no part of the text."""
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"{path}: cannot be read ({reason}); expected a loader file") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not UTF-8 text (byte {error.start}); save the file as UTF-8") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is not TOML: {error}") from error
    except (ValueError, RecursionError) as error:  # integers of thousands of digits, brackets a thousand deep
        raise InputError(f"{path}: cannot be read ({error}); expected a loader file") from error


def write(name: str, source: str, values: Mapping[str, float], units: UnitSystem) -> str:
    """A commented loader file with these SI values."""
    templates = environment(html=False)
    templates.filters["toml"] = _toml_string
    return templates.get_template("loader.toml.j2").render(
        name=name,
        source=source,
        parts=PARTS,
        rows=main_rows,
        alternatives=alternatives,
        replaced=replaced,
        value=lambda row: _with_unit(row, values[f"{row.part}.{row.name}"], units),
        example=lambda row: _with_unit(row, row.default_si, units),
        limits=lambda row: " to ".join(_with_unit(row, limit, units) for limit in limits_si(row)),
    )


@cache
def _schema() -> type[BaseModel]:
    """The pydantic model of a loader file, made from the parameter table."""
    parts: dict[str, Any] = {}
    for part in PARTS:
        optional = replaced(part)
        fields: dict[str, Any] = {}
        for row in (main_rows(part) | alternatives(part)).values():
            kind = Annotated[float, BeforeValidator(partial(_quantity, row))]
            fields[row.name] = (kind | None, None) if row.name in optional or row.instead_of else (kind, ...)
        parts[part] = (create_model(part, __config__=_STRICT, **fields), ...)
    return create_model("LoaderFile", __config__=_STRICT, name=(str, ...), source=(str, ""), **parts)


def _quantity(row: Parameter, given: object) -> float:
    """A value of the file in SI units, within the row's range."""
    value = parse(given, row.unit_si, _with_unit(row, row.default_si, UnitSystem.US))
    if not in_range(row, value):
        raise InputError(f"out of range: expected {range_text(row)}, got {show(given)}")
    return value


def _contradiction(part: str, given: object) -> str | None:
    """What is wrong where a part can be stated in two ways; nothing if one of them is given, whole."""
    one, other = replaced(part), list(alternatives(part))
    if not other or not isinstance(given, dict):
        return None
    has_one, has_other = ([key for key in keys if key in given] for keys in (one, other))
    choice = f"give either {' and '.join(one)}, or {' and '.join(other)}"
    if has_one and has_other:
        return f"{part}: given both ways at once ({', '.join(has_one + has_other)}); {choice}"
    if has_one != one and has_other != other:
        missing = [_example(part, key) for key in (other if has_other else one) if key not in given]
        return f"{part}: missing value; add {' and '.join(missing)}; {choice}"
    return None


def _derive(checked: Mapping[str, Any]) -> tuple[dict[str, float], list[str]]:
    """The table's values, with those stated in another way worked out by the model; and what is wrong with them."""
    values = {key: checked[row.part][row.name] for key, row in TABLE.items()}
    # The model's formulas read only rows that are given; the others stand as "not a number" until worked out.
    array = np.array([np.nan if value is None else value for value in values.values()])
    complaints = []
    for part, derive in _DERIVE.items():
        given = {name: value for name in alternatives(part) if (value := checked[part][name]) is not None}
        derived = zip(replaced(part), derive(array, given), strict=True) if given else ()
        for name, value in derived:
            row = TABLE[f"{part}.{name}"]
            values[f"{part}.{name}"] = value
            if not in_range(row, value):
                came = f"{name} = {_with_unit(row, value, UnitSystem.US)}"
                complaints.append(f"{part}: {' and '.join(given)} lead to {came}; expected {range_text(row)}")
    return values, complaints


def _explain(error: ErrorDetails) -> str:
    """One line for one pydantic complaint."""
    place = [str(name) for name in error["loc"]]
    key = ".".join(map(_key, place))
    match error["type"]:
        case "missing":
            what = 'name = "elevator"' if key == "name" else f"the table [{key}]"
            return f"{key}: missing value; add {_example(*place) if key in TABLE else what}"
        case "extra_forbidden":
            return f"{key}: unknown key; {_hint(*place)}"
        case "value_error":
            return f"{key}: {error['ctx']['error']}"
        case _:
            expected = f"the table [{key}]" if key in PARTS else f'text such as {key} = "elevator"'
            return f"{key}: expected {expected}, got {show(error['input'])}"


def _hint(*place: str) -> str:
    """What may have been meant by an unknown key."""
    keys = {part: [*main_rows(part), *alternatives(part)] for part in PARTS}
    known = keys[place[0]] if len(place) > 1 else ["name", "source", *PARTS]
    name = place[-1]
    if close := difflib.get_close_matches(name, known, n=1):
        return f"did you mean {close[0]}?"
    if tables := [f"[{part}]" for part in PARTS if name in keys[part]]:
        return f"it belongs in the table {' or '.join(tables)}"
    return f"known are {', '.join(known)}"


def _example(part: str, name: str) -> str:
    """A line of the file, with the elevator's value."""
    row = (main_rows(part) | alternatives(part))[name]
    return f'{name} = "{_with_unit(row, row.default_si, UnitSystem.US)}"'


def _key(name: str) -> str:
    """A key as the file has it: in quotes unless it is a plain word."""
    return name if re.fullmatch(r"[\w-]{1,60}", name) else show(name)


def _with_unit(row: Parameter, value: float, units: UnitSystem) -> str:
    """A SI value as text with the unit that people read; ten digits at most, so that it reads back to rounding."""
    return f"{unit(row).from_si(value, units):.10g} {unit(row).shown(units)}".strip()


def _toml_string(text: str) -> str:
    """A TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'
