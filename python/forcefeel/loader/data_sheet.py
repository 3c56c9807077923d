"""Data sheets of motor, drive and gear: tables of a loader file that take the place of an electric loader's own.

Vendors print one number in several senses. What a sheet leaves open is refused with the question to ask, so a sheet states more
than a loader file, whose rows have one meaning each. The conversions are those of ``conversions``.
"""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

from forcefeel.errors import InputError
from forcefeel.loader.file import checked_contents, document
from forcefeel.loader.loader import Loader, check_electric, of_contents
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC, parts
from forcefeel.units import UnitSystem, show

TABLES = tuple(part for part in parts(ELECTRIC) if part not in parts(HYDRAULIC))
"""Tables of a data sheet."""

_PHASE = "of a phase or between two, a factor of 2? Expected {0}_phase or {0}_line_to_line"
_SINE = "peak or r.m.s. of a phase, 1.41 times apart? Expected {0}_peak or {0}_rms"
_OPEN = {
    **{("winding", name): _PHASE.format(name) for name in ("resistance", "inductance")},
    **{("current_loop", name): _SINE.format(name) for name in ("current_limit", "continuous_current")},
    ("current_loop", "voltage_limit"): "of a phase or of the supply, 1.73 times apart? Expected supply_voltage",
}
"""The question to ask of a row of three phases."""


def with_drive(loader: Loader, path: Path) -> Loader:
    """An electric loader with the drive of a data sheet.

    Args:
        loader: The loader.
        path: A TOML file with tables such as ``[motor]`` and ``[winding]``, as a loader file has them. Each replaces the
            loader's table as a whole, so that no row of another motor stays. ``[current_loop]`` with a continuous current alone
            has no larger one.

    Raises:
        InputError: If the loader has a valve, or the file has other tables, bad rows, or numbers of which the sense is open, with
            a line for each.
    """
    check_electric(loader, "a data sheet", "choose a built-in electric loader")
    sheet = document(path, "a data sheet with tables such as [motor] and [winding]")
    strangers = [name for name in sheet if name not in TABLES]
    if strangers or not sheet:
        got = show(strangers[0]) if strangers else "none"
        raise InputError(f"{path}: expected some of the tables {', '.join(TABLES)}, got {got}; take it out")
    given = tomllib.loads(loader.to_toml(UnitSystem.SI))
    tables = {part: table for part, table in sheet.items() if isinstance(table, dict)}
    three_phase = tables.get("motor", given["motor"]).get("three_phase") is True
    if questions := list(_questions(tables, three_phase=three_phase)):
        raise InputError("\n".join(f"{path}: {question}" for question in questions))
    if "current_loop" in tables:
        sheet["current_loop"] = _lasting(tables["current_loop"])
    tolerances = {key: text for key, text in given.get("tolerances", {}).items() if key.partition(".")[0] not in sheet}
    contents = checked_contents(path, given | sheet | {"tolerances": tolerances})
    lasting, limit = (contents.values[f"current_loop.{name}"] for name in ("continuous_current", "current_limit"))
    if limit <= lasting < inf:
        raise InputError(
            f"{path}: current_loop.continuous_current: expected less than current_limit, {limit:.6g} A peak, got "
            f"{lasting:.6g} A peak; without a larger current for a time, state the continuous current alone"
        )
    return replace(of_contents(contents), source=f"{loader.source}; drive from {path.name}")


def _questions(sheet: Mapping[str, Mapping[str, Any]], *, three_phase: bool) -> Iterator[str]:
    """The questions to ask the vendor."""
    for (part, name), question in _OPEN.items():
        if three_phase and name in sheet.get(part, {}):
            yield f"{part}.{name}: {question}"
    loop, gear = sheet.get("current_loop", {}), sheet.get("transmission", {})
    limit = next((name for name in loop if name.startswith("current_limit")), None)
    if limit and "peak_time" not in loop:
        yield (
            f"current_loop.{limit}: for how long? Expected peak_time and a continuous current too; if without end, state it as "
            f"{limit.replace('current_limit', 'continuous_current')} alone"
        )
    if "efficiency" in gear and "backdriving_efficiency" not in gear:
        yield (
            "transmission.efficiency: and from the output to the motor? Expected backdriving_efficiency too; with the same losses "
            "it is 2 - 1 / efficiency"
        )


def _lasting(loop: Mapping[str, Any]) -> dict[str, Any]:
    """The table with a continuous current that stands alone as the limit."""
    if "peak_time" in loop or any(name.startswith("current_limit") for name in loop):
        return dict(loop)
    return {name.replace("continuous_current", "current_limit"): value for name, value in loop.items()}
