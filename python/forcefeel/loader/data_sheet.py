"""A drive from a motor's data sheet: tables of a loader file that take the place of an electric loader's own."""

import tomllib
from dataclasses import replace
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.loader.file import checked_contents, document
from forcefeel.loader.loader import Loader, check_electric, of_contents
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC, parts
from forcefeel.units import UnitSystem, show

TABLES = tuple(part for part in parts(ELECTRIC) if part not in parts(HYDRAULIC))
"""Tables of a data sheet."""


def with_drive(loader: Loader, path: Path) -> Loader:
    """An electric loader with the drive of a data sheet.

    Args:
        loader: The loader.
        path: A TOML file with tables such as ``[motor]`` and ``[winding]``, as a loader file has them. Each replaces the
            loader's table as a whole, so that no row of another motor stays.

    Raises:
        InputError: If the loader has a valve, or the file has other tables or bad rows, with a line for each.
    """
    check_electric(loader, "a data sheet", "choose a built-in electric loader")
    sheet = document(path, "a data sheet with tables such as [motor] and [winding]")
    strangers = [name for name in sheet if name not in TABLES]
    if strangers or not sheet:
        got = show(strangers[0]) if strangers else "none"
        raise InputError(f"{path}: expected some of the tables {', '.join(TABLES)}, got {got}; take it out")
    given = tomllib.loads(loader.to_toml(UnitSystem.SI))
    tolerances = {key: text for key, text in given.get("tolerances", {}).items() if key.partition(".")[0] not in sheet}
    contents = checked_contents(path, given | sheet | {"tolerances": tolerances})
    return replace(of_contents(contents), source=f"{loader.source}; drive from {path.name}")
