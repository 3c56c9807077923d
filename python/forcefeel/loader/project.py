"""A project file: the axes of a cockpit and the loader of each.

[axes]
pitch = "elevator.toml"     # a loader file, from the project's folder
roll = "aileron-wheel"      # or a built-in loader
"""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from forcefeel.errors import InputError
from forcefeel.loader.built_in import BUILT_IN, ELECTRIC_AXES, open_loader
from forcefeel.loader.loader import Loader
from forcefeel.units import show

STICKS = ("stick-pitch", "stick-roll")
PROJECT_AXES = ("pitch", "roll", "yaw", *STICKS)
"""Names of the axes: of wheel and pedals, and of a stick."""


def is_project(path: Path | None) -> bool:
    """Whether it is a TOML file with a table of axes; what cannot be read is none, and is told by whoever reads loaders."""
    try:
        return path is not None and "axes" in tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False


def read_project(path: Path) -> Mapping[str, Loader]:
    """The loaders of a project file by axis, in its order.

    Args:
        path: The file; the paths in it are from its folder.

    Raises:
        InputError: If it cannot be read, has another key than ``axes``, no axes, an unknown one, one without a loader's
            name; or a loader is bad.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: expected a project file, TOML with a table [axes] ({error})") from error
    if strangers := [key for key in document if key != "axes"]:
        raise InputError(f"{path}: {', '.join(strangers)}: a project file has a table [axes] and nothing else")
    axes, example = document.get("axes"), 'pitch = "elevator.toml" or roll = "aileron-wheel"'
    if not isinstance(axes, dict) or not axes:
        raise InputError(f"{path}: axes: expected a table with a loader for at least one axis, such as {example}")
    found = {}
    for axis, given in axes.items():
        if axis not in PROJECT_AXES:
            raise InputError(f"{path}: axes: expected {', '.join(PROJECT_AXES)}; got {show(axis)}")
        if not isinstance(given, str) or not given:
            raise InputError(f"{path}: axes.{axis}: expected a loader, such as {example}, got {show(given)}")
        found[axis] = _loader(path, axis, given)
    return MappingProxyType(found)


def _loader(path: Path, axis: str, given: str) -> Loader:
    file = path.parent / given
    if not file.exists() and given in BUILT_IN:
        if (ELECTRIC_AXES.get(given) == "stick") != (axis in STICKS):
            meant = f"expected {' or '.join(STICKS)}" if axis not in STICKS else "expected pitch, roll or yaw"
            raise InputError(f"{path}: axes.{axis}: {meant} for the built-in loader {given}")
        return BUILT_IN[given]()
    try:
        return open_loader(file)
    except InputError as error:
        raise InputError(f"{path}: axes.{axis}: {error}") from error
