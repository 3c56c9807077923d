"""The request: the loader whose feel is replaced, and numbers that the user states."""

from dataclasses import dataclass
from math import isfinite
from typing import Annotated

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.qualification import Record
from forcefeel.units import FORCE, HERTZ, RATIO, show

_NAMES = {"breakout_n": "breakout", "friction_n": "friction", "frequency_rad_per_s": "frequency"}


@dataclass(frozen=True)
class FeelPlan:
    """What a feel is fitted for.

    Attributes:
        loader: The loader; its feel is replaced.
        breakout_n: Breakout force if known. Default: from the points.
        friction_n: Friction if known. Default: from the points.
        frequency_rad_per_s: Natural frequency if known. Default: from the release, else the loader's.
        damping_ratio: Damping ratio if known. Default: as for the frequency.
        release: A recorded release, angle over time.

    Raises:
        InputError: If a number is negative or not finite, or the release leaves nothing to find.

    Example:
        >>> ff.feel.FeelPlan(ff.digital_elevator(), friction_n=6.0).friction_n
        6.0
    """

    loader: Loader
    breakout_n: Annotated[float, FORCE] | None = None
    friction_n: Annotated[float, FORCE] | None = None
    frequency_rad_per_s: Annotated[float, HERTZ] | None = None
    damping_ratio: Annotated[float, RATIO] | None = None
    release: Record | None = None

    def __post_init__(self) -> None:
        check_loader(self.loader)
        for name in ("breakout_n", "friction_n", "frequency_rad_per_s", "damping_ratio"):
            value = getattr(self, name)
            if value is not None and not (isfinite(value) and value >= 0):
                raise InputError(f"{_NAMES.get(name, name)}: expected a number of at least 0, got {show(value)}")
        if self.frequency_rad_per_s == 0:
            raise InputError("frequency: expected a frequency above 0, got 0")
        if self.release is None:
            return
        if self.release.position_unit != "rad":
            raise InputError(f"{self.release.name}: position: expected an angle, got a length; record the angle")
        if None not in (self.frequency_rad_per_s, self.damping_ratio):
            raise InputError("release: gives frequency or damping, and both are stated; leave one of the three out")
