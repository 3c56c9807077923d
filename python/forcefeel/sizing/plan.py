"""Inputs of a sizing: loader, control, and angle of its releases."""

from dataclasses import dataclass
from math import degrees, isfinite, pi
from typing import Annotated, Literal, get_args

from forcefeel.errors import InputError, expect_number
from forcefeel.loader.axes import control_of, usual_axis
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.qualification.rules import load_rules
from forcefeel.qualification.throw import Throw
from forcefeel.units import ANGLE, show, to_text

Axis = Literal["pitch", "roll", "yaw", "stick", "collective"]
AXES: tuple[str, ...] = get_args(Axis)
"""The controls; the rule's limits are for wheels and pedals, so there are none for a stick or a collective."""


@dataclass(frozen=True)
class SizingPlan:
    """Inputs of a sizing.

    Attributes:
        loader: The loader.
        axis: The control: ``pitch``, ``roll``, ``yaw``, ``stick`` or ``collective``.
        release_rad: Angle of the release, rad.

    Raises:
        InputError: If the axis is unknown, or the angle is not above 0 and within a quarter turn.

    Example:
        >>> ff.sizing.SizingPlan.of(ff.loader.electric("rudder-pedals")).axis
        'yaw'
    """

    loader: Loader
    axis: str
    release_rad: Annotated[float, ANGLE]

    def __post_init__(self) -> None:
        check_loader(self.loader)
        if self.axis not in AXES:
            raise InputError(f"axis: expected {', '.join(AXES[:-1])} or {AXES[-1]}, got {show(self.axis)}")
        expect_number("release_rad", self.release_rad)
        if not (isfinite(self.release_rad) and 0 < self.release_rad <= pi / 2):
            came = f"{to_text(degrees(self.release_rad))} deg"
            raise InputError(f"release_rad: expected an angle above 0, up to 90 deg, got {came}")

    @classmethod
    def of(cls, loader: Loader, axis: str | None = None, release_rad: float | None = None) -> "SizingPlan":
        """The plan of a loader.

        Args:
            loader: The loader.
            axis: The control. Default: that of the built-in loader with this name, else pitch.
            release_rad: Angle of the release, rad. Default: half the throw's shorter side, 10 deg without stops.

        Raises:
            InputError: As the class.
        """
        check_loader(loader)
        angle = Throw.of(loader).release_rad(load_rules()) if release_rad is None else release_rad
        return cls(loader, control_of(usual_axis(loader.name)) if axis is None else axis, angle)
