"""Options of the commands that release many settings of the feel under a rule."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.options import EDITION, LoaderOptions, option
from forcefeel.cli.scenario_text import value
from forcefeel.errors import InputError
from forcefeel.units import ANGLE, parse

if TYPE_CHECKING:
    from forcefeel.envelope.deviations import Deviation
    from forcefeel.loader.loader import Loader

ASKED = Group("Request", sort_key=10)


@dataclass(frozen=True, kw_only=True)
class ReleaseOptions(LoaderOptions):
    """What every command has that releases many settings of the feel under a rule."""

    rule: Annotated[str, option("Edition of the rule with the required release test.", ASKED, metavar="EDITION")] = (
        EDITION
    )
    deviation: Annotated[
        tuple[str, ...],
        option(
            "Deviation of a plant parameter to either side, such as 'column.inertia=2 %', instead of the loader file's "
            "tolerance; 'column.inertia=none' for no deviation. Default without a tolerance: lengths 1 %, valve gain 30 %, "
            "others 20 %. Repeatable.",
            ASKED,
            metavar="NAME=SHARE|none",
        ),
    ] = ()

    def deviations(self, loader: "Loader") -> "Mapping[str, Deviation]":
        """How far the parameters of a loader may be off: by its tolerances, or as assumed, changed by ``--deviation``.

        Raises:
            InputError: If an option is bad, or a tolerance of the loader leads out of its row's range.
        """
        from forcefeel.envelope.deviations import chosen_deviations, deviations_of
        from forcefeel.sweep import text

        usual = deviations_of(loader)
        shares = {
            key: _share_off(key, given)
            for key, given in text.assignments("--deviation", self.deviation, "column.inertia=2 %").items()
        }
        asked = chosen_deviations(loader, {key: share for key, share in shares.items() if share is not None})
        for key, share in shares.items():
            if share is None and key not in usual:
                raise InputError(f"--deviation: {key}: has no case to leave out; there are {', '.join(usual)}")
        kept = {key: it for key, it in usual.items() if shares.get(key, 0.0) is not None}
        return {**kept, **asked}


@dataclass(frozen=True, kw_only=True)
class AngleOptions:
    """What every command has that chooses the angle of its releases."""

    angle: Annotated[
        str | None,
        option(
            "Angle of the release, such as '10 deg'.",
            ASKED,
            default="half of the shorter side of the throw; 10 deg without stops",
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


def _share_off(key: str, given: str) -> float | None:
    """What ``--deviation`` says of one parameter; nothing where it is to have no case."""
    try:
        return None if given == "none" else parse(given, "", "2 %")
    except InputError as error:
        raise InputError(f"--deviation: {key}: {error}") from error
