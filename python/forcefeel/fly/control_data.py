"""The data file of an aircraft's controls: how each moves the aircraft, its surface or feel unit, its feel.

The tables ``control``, ``surface`` and ``feel`` are of pitch; those of the wheel and the pedals are in ``roll`` and ``yaw``.
"""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from math import inf, isfinite
from pathlib import Path
from typing import Any

from forcefeel.errors import InputError, suggestion
from forcefeel.loader.axes import FlightAxis
from forcefeel.units import parse

_FOLDER = files("forcefeel") / "data" / "aircraft"
_MOVES = ("surface", "command")
_GRIPS = ("wheel", "stick", "pedals")
_CATEGORIES = ("light", "transport", "military")
_KEYS = ("model", "control", "flight", "surface", "feel", "roll", "yaw")
_ROWS = {
    "control": ("moves", "full_travel", "grip"),
    "flight": ("speed", "altitude", "category", "limit_load_factor", "maximum_weight", "trim_rate"),
    "feel": ("stiffness", "damping_ratio"),
}
"""Rows of the parts; those of ``surface`` are a loader's."""


@dataclass(frozen=True)
class ControlData:
    """A control of an aircraft.

    Attributes:
        axis: ``pitch``, ``roll`` or ``yaw``.
        model: JSBSim's name of the aircraft.
        surface: Rows of the part ``surface`` of a loader.
        stiffness: Spring of the control run or feel unit, as in a loader file.
        damping_ratio: Its damping ratio with the loader's inertia of the feel.
        speed_m_per_s: Calibrated airspeed unless another is given.
        altitude_m: Altitude unless another is given.
        full_travel_rad: Angle of the control at JSBSim's full command; none where the control moves the surface itself.
        grip: ``wheel``, ``stick`` or ``pedals``.
        category: ``light``, ``transport`` or ``military``: it selects the designer's requirements.
        limit_load_factor: Positive limit maneuvering load factor.
        maximum_weight_n: Maximum weight of a light aircraft; none for others.
        trim_rate_rad_per_s: Rate of the tab of a transport aircraft; none if it is not known, and for others.
    """

    axis: FlightAxis
    model: str
    surface: dict[str, Any]
    stiffness: str
    damping_ratio: float
    speed_m_per_s: float
    altitude_m: float
    full_travel_rad: float | None
    grip: str
    category: str
    limit_load_factor: float
    maximum_weight_n: float | None
    trim_rate_rad_per_s: float | None


def known() -> list[str]:
    """The aircraft with data of their controls."""
    return sorted(path.name.removesuffix(".toml") for path in _FOLDER.iterdir() if path.name.endswith(".toml"))


def control_data(name: str, axis: FlightAxis = "pitch") -> ControlData:
    """The data of a control of a known aircraft, or of a file.

    Raises:
        InputError: If the aircraft is unknown, or the file cannot be read, lacks the control or a row.
    """
    if not name.endswith(".toml") and name not in known():
        raise InputError(
            f"aircraft: expected one of {', '.join(known())} or a TOML file, got {name!r}{suggestion(name, known())}"
        )
    path = Path(name) if name.endswith(".toml") else _FOLDER / f"{name}.toml"
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"aircraft: cannot read {name} ({error})") from error
    _check_rows(data, name)
    if axis != "pitch":
        if axis not in data:
            raise InputError(
                f"aircraft: {name} has no data of its {axis} control; add tables such as {axis}.control, as in "
                "python/forcefeel/data/aircraft/c172p.toml"
            )
        data = {key: data[key] for key in ("model", "flight") if key in data} | _part(data, name, axis)
        name = f"{name}, {axis}"
        _check_rows(data, name)
    moves = _word(data, name, ("control", "moves"), _MOVES)
    category = _word(data, name, ("flight", "category"), _CATEGORIES)
    for part, key, reads in (
        ("control", "full_travel", moves == "command"),
        ("flight", "maximum_weight", category == "light"),
        ("flight", "trim_rate", category == "transport"),
    ):
        if key in data[part] and not reads:
            of = "transport" if key == "trim_rate" else "light"
            other = "moves = command" if part == "control" else f"category = {of}"
            raise InputError(f"{name}: {part}.{key}: expected only with {other}; remove this row")
    load_factor = _number(data, name, "flight", "limit_load_factor", "", "3.8")
    if load_factor <= 1:
        raise InputError(f"{name}: flight.limit_load_factor: expected a number above 1, got {load_factor:g}")
    gearing = _row(data, name, "surface", "gearing")
    if not isinstance(gearing, int | float) or not isfinite(gearing) or not gearing:
        raise InputError(f"{name}: surface.gearing: expected a number other than 0, got {gearing!r}")
    return ControlData(
        axis=axis,
        model=data.get("model", path.name.removesuffix(".toml")),
        surface=data["surface"],
        stiffness=_row(data, name, "feel", "stiffness"),
        damping_ratio=_number(data, name, "feel", "damping_ratio", "", "0.5"),
        speed_m_per_s=_number(data, name, "flight", "speed", "m/s", "100 kt"),
        altitude_m=_number(data, name, "flight", "altitude", "m", "3000 ft"),
        full_travel_rad=_number(data, name, "control", "full_travel", "rad", "10 deg") if moves == "command" else None,
        grip=_word(data, name, ("control", "grip"), _GRIPS),
        category=category,
        limit_load_factor=load_factor,
        maximum_weight_n=_number(data, name, "flight", "maximum_weight", "N", "2400 lb")
        if category == "light"
        else None,
        trim_rate_rad_per_s=_number(data, name, "flight", "trim_rate", "rad/s", "1 deg/s")
        if "trim_rate" in data["flight"]
        else None,
    )


def _check_rows(data: dict[str, Any], name: str) -> None:
    """Refuses what nothing reads.

    Raises:
        InputError: If a part is missing, or a part or a row is unknown.
    """
    for part, rows in (("", _KEYS), *_ROWS.items()):
        for key in _part(data, name, part) if part else data:
            if key not in rows:
                row = f"{part}.{key}".lstrip(".")
                raise InputError(f"{name}: {row}: expected only {', '.join(sorted(rows))}{suggestion(key, rows)}")


def _part(data: dict[str, Any], name: str, part: str) -> dict[str, Any]:
    """A part of the file.

    Raises:
        InputError: If it is missing or no table.
    """
    rows = data.get(part)
    if not isinstance(rows, dict):
        raise InputError(f"{name}: {part}: required; add the table as in python/forcefeel/data/aircraft/c172p.toml")
    return rows


def _word(data: dict[str, Any], name: str, key: tuple[str, str], words: tuple[str, ...]) -> str:
    """A row that is one of some words.

    Raises:
        InputError: If it is missing or another word.
    """
    word = _row(data, name, *key)
    if word not in words:
        raise InputError(f"{name}: {'.'.join(key)}: expected {' or '.join(words)}, got {word!r}")
    return str(word)


def _number(data: dict[str, Any], name: str, part: str, key: str, unit_si: str, example: str) -> float:
    """A number above zero.

    Raises:
        InputError: If it is missing, has no unit, or is zero or below.
    """
    try:
        number = parse(_row(data, name, part, key), unit_si, example)
    except InputError as error:
        raise InputError(f"{name}: {part}.{key}: {error}") from error
    if not 0 < number < inf:
        raise InputError(f"{name}: {part}.{key}: expected a number above 0, got {number:g}")
    return number


def _row(data: dict[str, Any], name: str, part: str, key: str) -> Any:
    """A row of a part.

    Raises:
        InputError: If it is missing.
    """
    rows = _part(data, name, part)
    if key not in rows:
        raise InputError(f"{name}: {part}.{key}: required; add it as in python/forcefeel/data/aircraft/c172p.toml")
    return rows[key]
