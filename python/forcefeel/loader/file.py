"""The loader file: TOML, one axis, every value with its unit as text.

pydantic checks it against the parameter table of the Rust model: the schema is made from the table's rows, so a new
row is a new key. What a file may state in another way is turned into the table's rows here:

=======  ================================================  ==========================  ===================
part     given                                             instead of                  by
=======  ================================================  ==========================  ===================
valve    ``operating_current``, ``operating_pressure``     ``C_i``, ``C_p``            eqs. (1), (2)
linkage  ``resonance_frequency``, ``..._damping_ratio``    ``k``, ``c``                eqs. (6), (9)
feel     ``natural_frequency``, ``damping_ratio``          ``I``, ``B``                eq. (11)
motor    ``torque_constant_`` or ``speed_constant...``     ``K_t``                     ``_TORQUE_CONSTANT``
winding  ``resistance_``, ``inductance_line_to_line``      ``R``, ``L``                a half: two phases in star
=======  ================================================  ==========================  ===================

and the transmission's ``lead`` for its travel, ``r = lead / (2 pi)``.

Curves are read in ``curve_text``, tolerances in ``tolerance_text``; ``loader_text`` writes the file.
"""

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache, partial
from math import sqrt, tau
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model
from pydantic_core import ErrorDetails

from forcefeel import _core
from forcefeel._core import Parameter
from forcefeel.errors import MOST_LINES, InputError, nearest
from forcefeel.files import MOST_TEXT_BYTES, read_input
from forcefeel.loader import bus, curve_text, tolerance_text
from forcefeel.loader.contents import Contents, misfits
from forcefeel.loader.curves import CURVES
from forcefeel.loader.parameters import (
    DRIVES,
    ELECTRIC,
    HYDRAULIC,
    INDEX,
    OFF,
    TABLE,
    a_drive,
    absent,
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
    "forcefeel size, analyze, law, simulate, sweep, envelope, frontier, qualify, identify, excite, commission, run, emulate "
    "and export take a project"
)
"""The commands that take a cockpit's project in place of a loader, for messages."""

_MOST_DOTS = 100
"""Most dots outside quotes on a line, up to the next "=". The keys of a loader file have three; the time that TOML takes for a key
grows with the square of their number."""

_QUOTED = re.compile(r"""\"(?:[^"\\]|\\.?)*(?:"|$)|'[^']*(?:'|$)""")
"""Text in quotes on a line, closed or not."""

_STRICT = ConfigDict(extra="forbid", frozen=True, strict=True)

_BRUSHED = "speed_constant"
_TORQUE_CONSTANT: Mapping[str, Callable[[float], float]] = {
    "torque_constant_peak": lambda peak: peak,
    "torque_constant_rms": lambda rms: rms / sqrt(2),
    # Power in equals power out: K_t = U / omega, and of three phases 3/2 times the peak voltage of a phase.
    _BRUSHED: lambda speed: 1 / speed,
    "speed_constant_peak": lambda speed: sqrt(3) / 2 / speed,
    "speed_constant_rms": lambda speed: sqrt(1.5) / speed,
}
"""Torque constant from what a data sheet states; of a brushed motor, or per peak ampere of a phase of three."""

_DERIVE: Mapping[str, Callable[[NDArray[np.float64], Mapping[str, float]], tuple[float, ...]]] = {
    "valve": lambda v, a: _core.valve_gains(v, a["operating_current"], a["operating_pressure"]),
    "linkage": lambda v, a: _core.linkage_from_resonance(v, a["resonance_frequency"], a["resonance_damping_ratio"]),
    "motor": lambda _, a: (next(_TORQUE_CONSTANT[name](value) for name, value in a.items()),),
    "winding": lambda _, a: (a["resistance_line_to_line"] / 2, a["inductance_line_to_line"] / 2),
    "transmission": lambda _, a: (a["lead"] / tau,),
    "feel": lambda v, a: _core.feel_from_frequency(
        a["natural_frequency"], a["damping_ratio"], v[INDEX["feel.stiffness"]]
    ),
}


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
    complaints = [complaint for part in parts(drive) if (complaint := _contradiction(part, given.get(part), drive))]
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


def _contradiction(part: str, given: object, drive: str) -> str | None:
    """What is wrong where a part can be stated in several ways; nothing if one of them is given, whole."""
    if not alternatives(part) or not isinstance(given, dict):
        return None
    ways = _ways(part)
    begun = [way for way in ways if any(key in given for key in way)]
    choice = "give " + ", or ".join(("either " * (k == 0)) + " and ".join(way) for k, way in enumerate(ways))
    if len(begun) > 1:
        keys = [key for way in begun for key in way if key in given]
        return f"{part}: given {'both' if len(begun) == 2 else 'several'} ways at once ({', '.join(keys)}); {choice}"
    usual = ways[1] if part == "motor" and given.get("three_phase") is True else ways[0]
    missing = [_example(part, key, drive) for key in (begun[0] if begun else usual) if key not in given]
    return f"{part}: missing value; add {' and '.join(missing)}; {choice}" if missing else None


def _ways(part: str) -> list[list[str]]:
    """The keys of each way to state a part: of what stands for one row each by itself, of what stands for several all together."""
    first, other = replaced(part), list(alternatives(part))
    return [first, *([key] for key in other)] if len(first) == 1 else [first, other]


def _derive(checked: Mapping[str, Mapping[str, Any]], drive: str) -> tuple[dict[str, float], list[str]]:
    """The table's values, with those stated in another way worked out by the model; and what is wrong with them."""
    stated = {key: checked[row.part][row.name] for key, row in table(drive).items()}
    # The model's formulas read only rows that are given; the others stand as "not a number" until worked out.
    values: dict[str, float] = {key: OFF.get(key, np.nan) if it is None else it for key, it in stated.items()}
    array = np.array([values.get(key, absent(row)) for key, row in TABLE.items()])
    complaints = _phases(checked) if drive == ELECTRIC else []
    for part in parts(drive):
        if part not in _DERIVE:
            continue
        derive = _DERIVE[part]
        given = {name: value for name in alternatives(part) if (value := checked[part][name]) is not None}
        derived = zip(replaced(part), derive(array, given), strict=True) if given else ()
        for name, value in derived:
            row = TABLE[f"{part}.{name}"]
            values[f"{part}.{name}"] = value
            if not in_range(row, value):
                came = f"{name} = {with_unit(row, value, UnitSystem.US)}"
                complaints.append(f"{part}: {' and '.join(given)} lead to {came}; expected {range_text(row)}")
    return values, complaints


def _phases(checked: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """A line for each value of a motor that goes with another number of phases."""
    if checked["motor"]["three_phase"]:
        kinds = {"torque_constant": _KIND, _BRUSHED: _KIND_OF_SPEED}
        return [f"motor.{name}: {kind}" for name, kind in kinds.items() if checked["motor"][name] is not None]
    of_three = [
        f"{part}.{name}"
        for part in ("motor", "winding")
        for name in alternatives(part)
        if checked[part][name] and name != _BRUSHED
    ]
    return [
        f"{key}: is of a motor with three phases; add [motor] three_phase = true, or state what a brushed motor's data sheet gives"
        for key in of_three
    ]


_KIND_OF_SPEED = (
    "of a motor with three phases a data sheet gives it per peak or per r.m.s. volt between two of them; expected "
    "speed_constant_peak or speed_constant_rms; of a block-commutated motor, leave three_phase out"
)
_KIND = (
    "of a motor with three phases a data sheet gives it per peak or per r.m.s. ampere, 1.41 times as much; expected "
    "torque_constant_peak or torque_constant_rms"
)


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
