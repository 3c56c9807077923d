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
import tomllib
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any

import jinja2
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model

from forcefeel import _core
from forcefeel._core import Parameter
from forcefeel.errors import InputError
from forcefeel.parameters import PARTS, TABLE, alternatives, limits_si, main_rows, replaced, unit
from forcefeel.units import UnitSystem, factor, parse, to_text

_STRICT = ConfigDict(extra="forbid", frozen=True, strict=True)

_DERIVE: Mapping[str, Callable[[NDArray[np.float64], Mapping[str, float]], tuple[float, float]]] = {
    "valve": lambda v, a: _core.valve_gains(v, a["operating_current"], a["operating_pressure"]),
    "linkage": lambda v, a: _core.linkage_from_resonance(v, a["resonance_frequency"], a["resonance_damping_ratio"]),
    "feel": lambda v, a: _core.feel_from_frequency(
        a["natural_frequency"], a["damping_ratio"], v[list(TABLE).index("feel.stiffness")]
    ),
}


def read(path: Path) -> tuple[str, str, dict[str, float]]:
    """Name, source and SI values (by ``part.name``) of the loader file at ``path``.

    Raises:
        InputError: With a line for each thing that is wrong.
    """
    try:
        document = tomllib.loads(path.read_bytes().decode("utf-8"))
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"{path}: cannot be read ({reason}); expected a loader file") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not UTF-8 text (byte {error.start}); save the file as UTF-8") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is not TOML: {error}") from error
    try:
        checked = _schema().model_validate(document).model_dump()
    except ValidationError as error:
        raise InputError("\n".join(f"{path}: {_explain(e)}" for e in error.errors())) from None
    name, source = checked.pop("name"), checked.pop("source")
    complaints = [f"{path}: {complaint}" for part in PARTS if (complaint := _contradiction(part, checked[part]))]
    if complaints:
        raise InputError("\n".join(complaints))
    return name, source, _derive(path, checked)


def write(name: str, source: str, values: Mapping[str, float], units: UnitSystem) -> str:
    """A commented loader file with these SI values."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("forcefeel"), undefined=jinja2.StrictUndefined, keep_trailing_newline=True,
        trim_blocks=True, lstrip_blocks=True, autoescape=False,  # noqa: S701  TOML, not HTML
    )
    environment.filters["toml"] = _toml_string
    return environment.get_template("loader.toml.j2").render(
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
    low, high = limits_si(row)
    if not low * (1 - 1e-12) <= value <= high * (1 + 1e-12):  # rounding of the units' conversion
        limits = " to ".join(_with_unit(row, limit, UnitSystem.US) for limit in (low, high))
        raise InputError(f"out of range: expected {limits}, got {given!r}")
    return value


def _contradiction(part: str, given: Mapping[str, float | None]) -> str | None:
    """What is wrong where a part can be stated in two ways; nothing if one of them is given, whole."""
    one, other = replaced(part), list(alternatives(part))
    if not other:
        return None
    has_one, has_other = ([key for key in keys if given[key] is not None] for keys in (one, other))
    choice = f"give either {' and '.join(one)}, or {' and '.join(other)}"
    if has_one and has_other:
        return f"{part}: given both ways at once ({', '.join(has_one + has_other)}); {choice}"
    if has_one != one and has_other != other:
        missing = [key for key in (other if has_other else one) if given[key] is None]
        return f"{part}: missing value {' and '.join(missing)}; {choice}"
    return None


def _derive(path: Path, checked: Mapping[str, Mapping[str, float | None]]) -> dict[str, float]:
    """The table's values, with those stated in another way worked out by the model."""
    values = {key: checked[row.part][row.name] for key, row in TABLE.items()}
    # The model's formulas read only rows that are given; the others stand as "not a number" until worked out.
    array = np.array([np.nan if value is None else value for value in values.values()])
    for part, derive in _DERIVE.items():
        given = {name: value for name in alternatives(part) if (value := checked[part][name]) is not None}
        if given:
            for name, value in zip(replaced(part), derive(array, given), strict=True):
                row = TABLE[f"{part}.{name}"]
                low, high = limits_si(row)
                if not low <= value <= high:
                    shown = _with_unit(row, value, UnitSystem.US)
                    raise InputError(f"{path}: {part}: {', '.join(given)} lead to {name} = {shown}, out of range")
                values[f"{part}.{name}"] = value
    return {key: value for key, value in values.items() if value is not None}


def _explain(error: Any) -> str:
    """One line for one pydantic complaint."""
    key = ".".join(str(place) for place in error["loc"])
    match error["type"]:
        case "missing":
            row = TABLE.get(key)
            example = f" = \"{_with_unit(row, row.default_si, UnitSystem.US)}\"" if row else ""
            what = f"add {error['loc'][-1]}{example}" if row or key == "name" else f"add the table [{key}]"
            return f"{key}: missing value; {what}"
        case "extra_forbidden":
            part = str(error["loc"][0])
            known = [*main_rows(part), *alternatives(part)] if len(error["loc"]) > 1 else ["name", "source", *PARTS]
            close = difflib.get_close_matches(str(error["loc"][-1]), known, n=1)
            hint = f"did you mean {close[0]}?" if close else f"known are {', '.join(known)}"
            return f"{key}: unknown key; {hint}"
        case "value_error":
            return f"{key}: {error['ctx']['error']}"
        case _:
            expected = "a table" if key in PARTS else "text"
            return f"{key}: expected {expected}, got {error['input']!r}"


def _with_unit(row: Parameter, value: float, units: UnitSystem) -> str:
    """A SI value as text with the unit that people read; ten digits at most, so that it reads back to rounding."""
    shown = unit(row).shown(units)
    return f"{value * factor(row.unit_si, shown):.10g} {shown}".strip()


def _toml_string(text: str) -> str:
    """A TOML basic string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'
