"""A project file: the axes of a cockpit, the loader of each, the links between two pilots' controls (``links``), trips, flap trim.

[axes]
pitch = "elevator.toml"     # a loader file, from the project's folder
roll = "aileron-wheel"      # or a built-in loader

[trips]
pitch = ["roll"]            # what stops with pitch; "all", or [] for nothing

[flap_trim]
pitch = -0.1                # the neutral moves by so many degrees for a degree of the host's flaps
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

from forcefeel.errors import InputError
from forcefeel.files import Kind, input_kind
from forcefeel.loader.axes import AXIS_OF, PROJECT_AXES, motion_axis
from forcefeel.loader.built_in import BUILT_IN, is_built_in
from forcefeel.loader.file import document
from forcefeel.loader.links import Link, LinkKind, read_links
from forcefeel.loader.loader import Loader, load
from forcefeel.units import show

Found = TypeVar("Found")


@dataclass(frozen=True, eq=False)
class Project:
    r"""The loaders of a cockpit.

    Attributes:
        path: The project file.
        loaders: By axis, in the file's order.
        paths: By axis, the loader's file, or the name of a built-in loader.
        links: By name, in the file's order.
        stops: By axis, the axes that stop in a live run when it trips. Default: the other side of a mechanical link, which would
            otherwise drag a column without power along. An electronic link opens instead, and other axes go on, so that a pilot
            keeps the controls that still work. An emergency stop stops all axes.
        flap_trim: By axis, the angle of its neutral for an angle of the flaps; axes without it are left out.
    """

    path: Path
    loaders: Mapping[str, Loader]
    paths: Mapping[str, Path]
    links: Mapping[str, Link]
    stops: Mapping[str, tuple[str, ...]]
    flap_trim: Mapping[str, float]

    def sides(self, link: Link) -> tuple[Loader, Loader]:
        """The loaders of a link, in its order."""
        first, second = link.between
        return self.loaders[first], self.loaders[second]

    @property
    def pilot_links(self) -> Mapping[str, Link]:
        """The links that join the same control of two pilots, without interconnects."""
        return {name: link for name, link in self.links.items() if link.joins_pilots}

    @property
    def name(self) -> str:
        """What it is called: by its file."""
        return self.path.stem

    def each(self, work: Callable[[str, Loader], Found]) -> Mapping[str, Found]:
        """What ``work`` makes of each axis and its loader.

        Raises:
            InputError: As ``work``, with the axis.
        """
        results = {}
        for axis, loader in self.loaders.items():
            try:
                results[axis] = work(axis, loader)
            except InputError as error:
                raise InputError(f"{self.path}: axes.{axis}: {error}") from error
        return MappingProxyType(results)


def is_project(path: Path | None) -> bool:
    """Whether it is a TOML file with a table of axes; an unreadable file is not a project; the reader of loaders reports it."""
    if path is None or input_kind(path) is not Kind.FILE:
        return False
    try:
        return "axes" in document(path)
    except InputError:
        return False


def read_project(path: str | Path) -> Project:
    r"""The project of a file.

    Args:
        path: The file: a table ``[axes]`` with a loader file, by its path from the project's folder, or a built-in loader for
            ``pitch``, ``roll``, ``yaw``, ``stick-pitch`` or ``stick-roll``, or for one of these with ``-first-officer``; and a
            table ``[links]`` as of ``links``, a table ``[trips]`` and a table ``[flap_trim]``, if any.

    Raises:
        InputError: If it cannot be read, has another table than these, no axes, an unknown one, one without a loader's name, one
            file for two axes, or a built-in loader of another axis; or a loader is bad.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator-electric"\n', encoding="utf-8")
        >>> ff.loader.read_project("cockpit.toml").loaders["pitch"].drive
        'electric'
    """
    path = Path(path)
    given = document(path, "a project file")
    if strangers := [key for key in given if key not in ("axes", "links", "trips", "flap_trim")]:
        raise InputError(
            f"{path}: {', '.join(strangers)}: a project file has tables [axes], [links], [trips] and [flap_trim] and nothing else"
        )
    axes = given.get("axes")
    if not isinstance(axes, dict) or not axes:
        raise InputError(f"{path}: axes: expected a table with a loader for at least one axis, such as {_EXAMPLE}")
    loaders, paths, taken = {}, {}, dict[Path, str]()
    for axis, name in axes.items():
        try:
            loaders[axis], paths[axis] = _loader(path.parent, axis, name, taken)
        except InputError as error:
            raise InputError(f"{path}: axes.{axis}: {error}") from error
    try:
        links = read_links(given.get("links"), loaders)
        stops = _stops(given.get("trips", {}), loaders, links)
        flap_trim = _flap_trim(given.get("flap_trim", {}), loaders)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return Project(path, MappingProxyType(loaders), MappingProxyType(paths), links, MappingProxyType(stops), flap_trim)


_MOST_FLAP_TRIM = 10.0


def _flap_trim(given: object, axes: Mapping[str, Loader]) -> Mapping[str, float]:
    """The angle of each neutral for an angle of the flaps, from the table ``flap_trim``."""
    if not isinstance(given, dict):
        raise InputError(f"flap_trim: expected a table such as [flap_trim] with pitch = -0.1, got {show(given)}")
    for axis, share in given.items():
        if axis not in axes:
            raise InputError(f"flap_trim.{axis}: expected an axis of [axes] ({', '.join(axes)})")
        if isinstance(share, bool) or not isinstance(share, (int, float)) or not abs(share) <= _MOST_FLAP_TRIM:
            raise InputError(
                f"flap_trim.{axis}: expected the angle of its neutral for an angle of the flaps, at most {_MOST_FLAP_TRIM:g} "
                f"either way, such as -0.1, got {show(share)}"
            )
        if not axes[axis]["controller.period"]:
            raise InputError(
                f"flap_trim.{axis}: the flaps move the neutral of a digital controller; set controller.period"
            )
    return MappingProxyType({axis: float(share) for axis, share in given.items()})


def _stops(given: object, axes: Mapping[str, Loader], links: Mapping[str, Link]) -> dict[str, tuple[str, ...]]:
    """The axes that stop with each, from the table ``trips``."""
    if not isinstance(given, dict):
        raise InputError(f'trips: expected a table such as [trips] with pitch = ["roll"], got {show(given)}')
    if strangers := [axis for axis in given if axis not in axes]:
        raise InputError(f"trips.{strangers[0]}: expected an axis of [axes] ({', '.join(axes)})")
    shafts = [link.between for link in links.values() if link.kind is LinkKind.MECHANICAL]
    stops = {}
    for axis in axes:
        linked = tuple(other for both in shafts if axis in both for other in both if other != axis)
        named = given.get(axis, list(linked))
        others = [other for other in axes if other != axis] if named == "all" else named
        if not isinstance(others, list) or any(other not in axes for other in others):
            raise InputError(f'trips.{axis}: expected "all", or a list of axes ({", ".join(axes)}), got {show(named)}')
        stops[axis] = tuple(others)
    return stops


_EXAMPLE = 'pitch = "elevator.toml" or roll = "aileron-wheel"'


def _loader(folder: Path, axis: str, given: object, taken: dict[Path, str]) -> tuple[Loader, Path]:
    """The loader of an axis and where it is; ``taken`` has the files of the axes before it, and is given its own."""
    if axis not in PROJECT_AXES:
        raise InputError(f"is no axis; expected some of {', '.join(PROJECT_AXES)}")
    if not isinstance(given, str) or not given:
        raise InputError(f"expected a loader, such as {_EXAMPLE}, got {show(given)}")
    file = folder / given
    at = file
    if not is_built_in(given, folder):
        loader = load(file)
        if (other := taken.get(file.resolve(), motion_axis(axis))) != motion_axis(axis):
            raise InputError(f"{given} is the loader of {other} already; expected a file of its own for each axis")
        taken[file.resolve()] = motion_axis(axis)
    else:
        loader, at = BUILT_IN[given](), Path(given)
    own = AXIS_OF.get(loader.name, motion_axis(axis))
    if own != motion_axis(axis):
        others = ", ".join(name for name, of in AXIS_OF.items() if of == motion_axis(axis))
        raise InputError(
            f"{loader.name} is the name of a built-in loader of {own}; expected one of {axis}, such as {others}; or, where its "
            f'numbers are meant for {axis}, a file of them (forcefeel new) with a name of its own (name = "..." in the file)'
        )
    return loader, at
