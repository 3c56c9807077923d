"""The drives of a cockpit: a sizing for each axis of a project."""

from collections.abc import Mapping
from dataclasses import dataclass

from forcefeel.conclusions import Conclusions, capital, of_result
from forcefeel.loader.axes import control_of, judged_alone
from forcefeel.loader.project import Project
from forcefeel.sizing.findings import sizing_conclusions
from forcefeel.sizing.result import Sizing
from forcefeel.sizing.run import size_drive
from forcefeel.units import UnitSystem


@dataclass(frozen=True, eq=False)
class CockpitSizing:
    r"""The sizing of each drive of a cockpit.

    Attributes:
        name: Name of the project's file.
        axes: Sizing by axis, in the file's order.
    """

    name: str
    axes: Mapping[str, Sizing]

    @property
    def ok(self) -> bool:
        """Whether every drive is large enough for its programmed feel."""
        return all(sizing.ok for sizing in self.axes.values())


def size_cockpit(project: Project, release_rad: float | None = None) -> CockpitSizing:
    r"""Sizes the drive of each axis of a project.

    Args:
        project: The project.
        release_rad: Angle of the releases, rad. Default: as ``size_drive``.

    Raises:
        InputError: If the angle is invalid.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator-electric"\n', encoding="utf-8")
        >>> ff.sizing.size_cockpit(ff.loader.read_project("cockpit.toml")).ok
        True
    """
    sizings = project.each(lambda axis, loader: size_drive(loader, control_of(axis), release_rad))
    return CockpitSizing(project.name, sizings)


@of_result
def cockpit_conclusions(cockpit: CockpitSizing, units: UnitSystem) -> Conclusions:
    """Conclusions for the cockpit: the verdict of each axis, and the remedy where a drive is too small."""
    lacking = [axis for axis, sizing in cockpit.axes.items() if not sizing.ok]
    verdict = (
        f"Too small for the programmed feel: the drive of {', '.join(lacking)}."
        if lacking
        else "Every drive of the cockpit is large enough for its programmed feel."
    )
    lines = [f"{capital(axis)}: {sizing_conclusions(sizing, units).verdict}" for axis, sizing in cockpit.axes.items()]
    lines += [f"{capital(axis)}: {sizing_conclusions(cockpit.axes[axis], units).findings[0]}" for axis in lacking]
    return Conclusions(cockpit.ok, verdict, (*lines, *judged_alone(cockpit.axes)))
