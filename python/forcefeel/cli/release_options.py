"""Options of the commands that release many settings of the feel under a rule."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.law_and_deviations import plant_deviations
from forcefeel.cli.options import EDITION, LoaderOptions, option
from forcefeel.cli.scenario_text import value
from forcefeel.units import ANGLE

if TYPE_CHECKING:
    from forcefeel.envelope.deviations import Deviation
    from forcefeel.loader.loader import Loader

ASKED = Group("What is asked", sort_key=10)


@dataclass(frozen=True, kw_only=True)
class ReleaseOptions(LoaderOptions):
    """What every command has that releases many settings of the feel under a rule."""

    rule: Annotated[str, option("Edition of the rule whose release test is asked for.", ASKED, metavar="EDITION")] = (
        EDITION
    )
    deviation: Annotated[
        tuple[str, ...],
        option(
            "How far a parameter of the plant is off to either side, such as 'column.inertia=2 %', in place of the loader file's "
            "tolerance, or the 20 % (the valve's gain 30 %) assumed where it gives none; 'column.inertia=none' for one that is not "
            "off at all. May be given again.",
            ASKED,
            metavar="NAME=SHARE|none",
        ),
    ] = ()

    def deviations(self, loader: "Loader") -> "Mapping[str, Deviation]":
        """How far the parameters of a loader may be off.

        Raises:
            InputError: If an option is bad, or a tolerance of the loader leads out of its row's range.
        """
        return plant_deviations(loader, self.deviation)


@dataclass(frozen=True, kw_only=True)
class AngleOptions:
    """What every command has that chooses the angle of its releases."""

    angle: Annotated[
        str | None,
        option(
            "Angle of the release, such as '10 deg'.",
            ASKED,
            default="half the throw's shorter side; 10 deg without stops",
            metavar="ANGLE",
        ),
    ] = None

    @property
    def angle_rad(self) -> float | None:
        """The angle in rad; ``None`` if it is not given.

        Raises:
            InputError: If it is no angle.
        """
        return None if self.angle is None else value("--angle", self.angle, ANGLE.si, "10 deg")
