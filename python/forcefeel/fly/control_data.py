"""The data file of an aircraft's pitch control: how the column moves the aircraft, its surface or feel unit, its feel."""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from math import inf, isfinite
from pathlib import Path
from typing import Any

from forcefeel.errors import InputError, suggestion
from forcefeel.units import parse

_FOLDER = files("forcefeel") / "data" / "aircraft"
_MOVES = ("surface", "command")
_KEYS = {"model", "control", "flight", "surface", "feel"}


@dataclass(frozen=True)
class ControlData:
    """The pitch control of an aircraft.

    Attributes:
        model: JSBSim's name of the aircraft.
        surface: Rows of the part ``surface`` of a loader.
        stiffness: Spring of the control run or feel unit, as in a loader file.
        damping_ratio: Its damping ratio with the loader's inertia of the feel.
        speed_m_per_s: Calibrated airspeed unless another is given.
        altitude_m: Altitude unless another is given.
        full_travel_rad: Angle of the column at JSBSim's full command; none where the column moves the surface itself.
    """

    model: str
    surface: dict[str, Any]
    stiffness: str
    damping_ratio: float
    speed_m_per_s: float
    altitude_m: float
    full_travel_rad: float | None


def known() -> list[str]:
    """The aircraft with data of their pitch control."""
    return sorted(path.name.removesuffix(".toml") for path in _FOLDER.iterdir() if path.name.endswith(".toml"))


def control_data(name: str) -> ControlData:
    """The data of a known aircraft, or of a file.

    Raises:
        InputError: If the aircraft is unknown, or the file cannot be read or lacks a row.
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
    if unknown := sorted(set(data) - _KEYS):
        raise InputError(f"{name}: {unknown[0]}: expected only {', '.join(sorted(_KEYS))}")
    moves = _row(data, name, "control", "moves")
    if moves not in _MOVES:
        raise InputError(f"{name}: control.moves: expected {' or '.join(_MOVES)}, got {moves!r}")
    gearing = _row(data, name, "surface", "gearing")
    if not isinstance(gearing, int | float) or not isfinite(gearing) or not gearing:
        raise InputError(f"{name}: surface.gearing: expected a number other than 0, got {gearing!r}")
    return ControlData(
        model=data.get("model", path.name.removesuffix(".toml")),
        surface=data["surface"],
        stiffness=_row(data, name, "feel", "stiffness"),
        damping_ratio=_number(data, name, "feel", "damping_ratio", "", "0.5"),
        speed_m_per_s=_number(data, name, "flight", "speed", "m/s", "100 kt"),
        altitude_m=_number(data, name, "flight", "altitude", "m", "3000 ft"),
        full_travel_rad=_number(data, name, "control", "full_travel", "rad", "10 deg") if moves == "command" else None,
    )


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
    rows = data.get(part)
    if not isinstance(rows, dict) or key not in rows:
        raise InputError(f"{name}: {part}.{key}: required; add it as in python/forcefeel/data/aircraft/c172p.toml")
    return rows[key]
