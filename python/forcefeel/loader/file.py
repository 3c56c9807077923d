"""The loader file: TOML, one axis, every value with its unit as text.

pydantic checks it against the parameter table of the Rust model: the schema is made from the table's rows, so a new
row is a new key. What a file may state in the stead of rows is in ``conversions``.

Curves are read in ``curve_text``, tolerances in ``tolerance_text``; ``loader_text`` writes the file.
"""

import re
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model
from pydantic_core import ErrorDetails

from forcefeel._core import Parameter
from forcefeel.errors import MOST_LINES, InputError, nearest
from forcefeel.files import MOST_TEXT_BYTES, read_input
from forcefeel.loader import bus, curve_text, tolerance_text
from forcefeel.loader.contents import Contents, misfits
from forcefeel.loader.conversions import groups
from forcefeel.loader.curves import CURVES
from forcefeel.loader.parameters import (
    DRIVES,
    ELECTRIC,
    HYDRAULIC,
    OFF,
    TABLE,
    a_drive,
    alternatives,
    in_range,
    is_switch,
    main_rows,
    parts,
    range_text,
    replaced,
    table,
    with_unit,
    without,
)
from forcefeel.loader.text import toml_value
from forcefeel.loader.tolerances import Tolerance, beyond
from forcefeel.units import UnitSystem, parse, show

PROJECT_COMMANDS = (
    "forcefeel size, analyze, law, simulate, sweep, envelope, frontier, qualify, identify, excite, commission, run, emulate, "
    "bus and export take a project"
)
"""The commands that take a cockpit's project in place of a loader, for messages."""

_MOST_DOTS = 100
"""Most dots outside quotes on a line, up to the next "=". The keys of a loader file have three; the time that TOML takes for a key
grows with the square of their number."""

_QUOTED = re.compile(r"""\"(?:[^"\\]|\\.?)*(?:"|$)|'[^']*(?:'|$)""")
"""Text in quotes on a line, closed or not."""

_STRICT = ConfigDict(extra="forbid", frozen=True, strict=True)


def read(path: Path) -> Contents:
    """The loader file at ``path``.

    Raises:
        InputError: With a line for each thing that is wrong.
    """
    return checked_contents(path, document(path))


def checked_contents(path: Path, given: Mapping[str, Any]) -> Contents:
    """The contents of a loader file from its document; ``path`` is for messages.

    Raises:
        InputError: As ``read``.
    """
    if "axes" in given:
        raise InputError(
            f"{path}: is a project, which names the loader of each axis; expected one of those loaders; "
            f"{PROJECT_COMMANDS}"
        )
    drive = _drive(path, given)
    complaints = [complaint for part in parts(drive) for complaint in _contradictions(part, given.get(part), drive)]
    try:
        checked = _schema(drive).model_validate(given)
    except ValidationError as error:
        wrong = error.errors()
        unseen = (error["msg"] for error in wrong[MOST_LINES:])  # no message shows these
        complaints = [*(_explain(error, drive) for error in wrong[:MOST_LINES]), *unseen, *complaints]
    else:
        if not complaints:
            contents, complaints = _contents(checked)
    if complaints:
        raise InputError("\n".join(f"{path}: {complaint}" for complaint in complaints))
    return contents


def _contents(checked: BaseModel) -> tuple[Contents, list[str]]:
    """What follows from values that are good by themselves; and what is wrong with it."""
    top = dict(checked)
    stated = {part: dict(top[part]) for part in parts(top["drive"])}
    values, complaints = _derive(stated, top["drive"])
    tolerances: dict[str, Tolerance] = {}
    for key, given in top["tolerances"].items():
        try:
            tolerances[key] = tolerance_text.read(key, given, values.get(key, np.nan), table(top["drive"]))
        except InputError as error:
            complaints.append(str(error))
    curves = {name: curve for name in CURVES if (curve := stated["feel"][name]) is not None}
    contents = Contents(top["name"], top["source"], values, curves, tolerances, top["bus"])
    return contents, complaints or misfits(contents) or beyond(tolerances)


def document(path: Path, what: str = "a loader file") -> dict[str, Any]:
    """The file as TOML reads it; a byte order mark, which some editors write, is no part of the text.

    Raises:
        InputError: If it cannot be read, or is not TOML; ``what`` was expected.
    """
    data = read_input(path, MOST_TEXT_BYTES, what)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not UTF-8 text (byte {error.start}); save the file as UTF-8") from error
    _check_dots(path, text)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is not TOML: {error}") from error
    except (ValueError, RecursionError) as error:  # integers of thousands of digits, brackets a thousand deep
        raise InputError(f"{path}: cannot be read ({error}); expected {what}") from error


def _check_dots(path: Path, text: str) -> None:
    """Refuses a key that would take TOML minutes to read."""
    for number, line in enumerate(text.splitlines(), 1):
        if line.count(".") > _MOST_DOTS:
            bare = _QUOTED.sub("", line).split("#")[0]
            if any(part.count(".") > _MOST_DOTS for part in bare.split("=")):
                raise InputError(
                    f"{path}: line {number}: has a key of more than {_MOST_DOTS} parts; expected a loader file"
                )


def _drive(path: Path, document: Mapping[str, Any]) -> str:
    """Which drive the file says; a hydraulic one where it says nothing."""
    drive = document.get("drive", HYDRAULIC)
    if drive not in DRIVES:
        raise InputError(f"{path}: drive: expected {' or '.join(DRIVES)}, got {show(drive)}")
    return str(drive)


@cache
def _schema(drive: str) -> type[BaseModel]:
    """The pydantic model of a loader file, made from the parameter table."""
    tables: dict[str, Any] = {}
    for part in parts(drive):
        fields: dict[str, Any] = {}
        for row in (main_rows(part, drive) | alternatives(part)).values():
            kind = Annotated[float, BeforeValidator(partial(_switch if is_switch(row) else _quantity, row))]
            fields[row.name] = (kind, ...) if _must_stand(row) else (kind | None, None)
        for row_of_curve in CURVES.values() if part == "feel" else ():
            fields[row_of_curve.name] = (Annotated[Any, BeforeValidator(partial(curve_text.read, row_of_curve))], None)
        rows = create_model(part, __config__=_STRICT, **fields)
        stated = any(row.off_si is None for row in main_rows(part, drive).values())
        tables[part] = (rows, ... if stated else rows())
    tables["tolerances"] = (Annotated[dict[str, Any], BeforeValidator(tolerance_text.entries)], {})
    tables["bus"] = (Annotated[Any, BeforeValidator(bus.read)], None)
    return create_model(
        "LoaderFile", __config__=_STRICT, name=(str, ...), source=(str, ""), drive=(str, drive), **tables
    )


def _must_stand(row: Parameter) -> bool:
    """Whether every file states the row by its own key."""
    return row.off_si is None and row.name not in replaced(row.part) and not row.instead_of


def _quantity(row: Parameter, given: object) -> float:
    """A value of the file in SI units, within the row's range."""
    value = parse(given, row.unit_si, with_unit(row, row.default_si, UnitSystem.US))
    if not in_range(row, value):
        remedy = f"; {without(row)}" if value == row.off_si else ""
        raise InputError(f"out of range: expected {range_text(row)}, got {show(given)}{remedy}")
    return value


def _switch(row: Parameter, given: object) -> float:
    """A yes or a no of the file as 1 or 0."""
    if not isinstance(given, bool):
        raise InputError(f"expected {range_text(row)}, got {show(given)}")
    return float(given)


def _contradictions(part: str, given: object, drive: str) -> Iterator[str]:
    """A line for each of the rows that can be stated in several ways, unless one of them is given, whole."""
    if not isinstance(given, dict):
        return
    for rows, conversions in groups(part).items():
        ways = [rows, *(conversion.stated for conversion in conversions)]
        stated = [key for key in dict.fromkeys(key for way in ways for key in way) if key in given]
        optional = all(main_rows(part, drive)[row].off_si is not None for row in rows)
        if any(set(way) == set(stated) for way in ways) or (optional and not stated):
            continue
        choice = "give " + ", or ".join(("either " * (k == 0)) + " and ".join(way) for k, way in enumerate(ways))
        begun = [way for way in ways if set(way) > set(stated)]
        if not begun:
            yield f"{part}: stated in more than one way ({', '.join(stated)}); {choice}"
            continue
        usual = ways[1] if part == "motor" and not stated and given.get("three_phase") is True else begun[0]
        missing = [_example(part, key, drive) for key in usual if key not in stated]
        yield f"{part}: missing value; add {' and '.join(missing)}; {choice}"


def _derive(checked: Mapping[str, Mapping[str, Any]], drive: str) -> tuple[dict[str, float], list[str]]:
    """The table's values, with those stated in another way worked out; and what is wrong with them."""
    stated = {key: checked[row.part][row.name] for key, row in table(drive).items()}
    # Rows that are not given yet stand as "not a number" until worked out.
    values: dict[str, float] = {key: OFF.get(key, np.nan) if it is None else it for key, it in stated.items()}
    complaints = _phases(checked) if drive == ELECTRIC else []
    for part in parts(drive):
        given = {name: value for name in alternatives(part) if (value := checked[part][name]) is not None}
        for rows, conversions in groups(part).items():
            keys = {key for conversion in conversions for key in conversion.stated if key in given}
            for conversion in (it for it in conversions if set(it.stated) == keys):
                for name, value in zip(rows, conversion.formula(values, given), strict=True):
                    row = TABLE[f"{part}.{name}"]
                    values[f"{part}.{name}"] = value
                    if not in_range(row, value):
                        came = f"{name} = {with_unit(row, value, UnitSystem.US)}"
                        complaints.append(
                            f"{part}: {' and '.join(conversion.stated)} lead to {came}; expected {range_text(row)}"
                        )
    return values, complaints


def _phases(checked: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """A line for each value of a motor that goes with another number of phases."""
    keys = [(part, name) for part in parts(ELECTRIC) for name, value in checked[part].items() if value is not None]
    if checked["motor"]["three_phase"]:
        return [f"{part}.{name}: {_OF_TWO_TERMINALS[name]}" for part, name in keys if name in _OF_TWO_TERMINALS]
    return [
        f"{part}.{name}: is of a motor with three phases; add [motor] three_phase = true, or state what a brushed motor's data "
        "sheet gives"
        for part, name in keys
        if name in alternatives(part) and name.endswith(_OF_THREE_PHASES)
    ]


_OF_THREE_PHASES = ("_peak", "_rms", "_line_to_line", "_phase")
_BETWEEN_TWO = (
    "of a motor with three phases, per peak or per r.m.s. volt between two of them, 1.41 times apart? Expected {0}_peak or "
    "{0}_rms; of a block-commutated motor, leave three_phase out"
)
_OF_TWO_TERMINALS = {
    "torque_constant": "of a motor with three phases, per peak or per r.m.s. ampere, 1.41 times apart? Expected "
    "torque_constant_peak or torque_constant_rms",
    **{name: _BETWEEN_TWO.format(name) for name in ("speed_constant", "voltage_constant")},
}
"""The question to ask of a key that a data sheet of three phases leaves open."""


def _explain(error: ErrorDetails, drive: str) -> str:
    """One line for one pydantic complaint."""
    place = [str(name) for name in error["loc"]]
    key = ".".join(map(_key, place))
    match error["type"]:
        case "missing":
            what = 'name = "elevator"' if key == "name" else f"the table [{key}]"
            return f"{key}: missing value; add {_example(place[0], place[1], drive) if key in TABLE else what}"
        case "extra_forbidden":
            return f"{key}: unknown key; {_hint(drive, *place)}"
        case "value_error":
            return f"{key}: {error['ctx']['error']}"
        case _:
            expected = f"the table [{key}]" if key in parts(drive) else f'text such as {key} = "elevator"'
            return f"{key}: expected {expected}, got {show(error['input'])}"


def _hint(drive: str, *place: str) -> str:
    """What may have been meant by an unknown key."""
    keys = {part: [*main_rows(part, drive), *alternatives(part)] for part in parts(drive)}
    keys["feel"] += CURVES
    known = keys[place[0]] if len(place) > 1 else ["name", "source", "drive", *parts(drive), "tolerances", "bus"]
    name = place[-1]
    (other,) = (candidate for candidate in DRIVES if candidate != drive)
    if name in (parts(other) if len(place) == 1 else main_rows(place[0], other)):
        hint = f'this file says drive = "{drive}", of which the tables are {", ".join(parts(drive))}'
        return f'it is of {a_drive(other)}, and {hint}; take it out, or say drive = "{other}"'
    if close := nearest(name, known):
        return f"did you mean {close}?"
    if tables := [f"[{part}]" for part in keys if name in keys[part]]:
        return f"it belongs in the table {' or '.join(tables)}"
    return f"known are {', '.join(known)}"


def _example(part: str, name: str, drive: str) -> str:
    """A line of the file, with the elevator's value."""
    row = (main_rows(part, drive) | alternatives(part))[name]
    return f"{name} = {toml_value(row, row.default_si, UnitSystem.US)}"


def _key(name: str) -> str:
    """A key as the file has it: in quotes unless it is a plain word."""
    return name if re.fullmatch(r"[\w-]{1,60}", name) else show(name)
