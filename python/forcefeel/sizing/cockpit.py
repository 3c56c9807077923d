"""The drives of a cockpit: a sizing for each axis of a project."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from forcefeel.conclusions import Conclusions, capital, of_result
from forcefeel.loader.project import STICKS, read_project
from forcefeel.sizing.findings import sizing_conclusions
from forcefeel.sizing.result import Sizing
from forcefeel.sizing.run import size_drive
from forcefeel.units import UnitSystem


@dataclass(frozen=True, eq=False)
class CockpitSizing:
    r"""The sizing of each drive of a cockpit.

    Attributes:
        name: The project, by its file.
        axes: By axis, in the file's order.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\nroll = "aileron-wheel"\nyaw = "rudder-pedals"\n', encoding="utf-8")
        >>> [*ff.sizing.size_cockpit("cockpit.toml").axes]
        ['roll', 'yaw']
    """

    name: str
    axes: Mapping[str, Sizing]

    @property
    def good(self) -> bool:
        """Whether every drive gives what its programmed feel asks for."""
        return all(found.good for found in self.axes.values())


def size_cockpit(path: str | Path, release_rad: float | None = None) -> CockpitSizing:
    r"""Sizes the drive of each axis of a project.

    Args:
        path: The project file: a table ``[axes]`` with a loader file or a built-in loader for ``pitch``, ``roll``, ``yaw``,
            ``stick-pitch`` or ``stick-roll``.
        release_rad: Angle in rad of the releases; as ``size_drive`` if not given.

    Raises:
        InputError: If the file or one of its loaders is bad.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator-electric"\n', encoding="utf-8")
        >>> ff.sizing.size_cockpit("cockpit.toml").good
        True
    """
    loaders = read_project(Path(path))
    found = {
        axis: size_drive(loader, "stick" if axis in STICKS else axis, release_rad) for axis, loader in loaders.items()
    }
    return CockpitSizing(Path(path).stem, MappingProxyType(found))


@of_result
def cockpit_conclusions(found: CockpitSizing, units: UnitSystem) -> Conclusions:
    """What follows for the whole: each axis's verdict, and what would do where a drive is too small."""
    lacking = [axis for axis, one in found.axes.items() if not one.good]
    verdict = (
        f"Too small for the programmed feel: the drive of {' and '.join(lacking)}."
        if lacking
        else "Every drive of the cockpit gives what its programmed feel asks for."
    )
    lines = [f"{capital(axis)}: {sizing_conclusions(one, units).verdict}" for axis, one in found.axes.items()]
    lines += [f"{capital(axis)}: {sizing_conclusions(found.axes[axis], units).findings[0]}" for axis in lacking]
    return Conclusions(found.good, verdict, tuple(lines))
