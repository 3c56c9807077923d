"""The pilot's arm at the grip: sets of mass, damper and spring by name."""

from enum import StrEnum
from math import isclose
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from forcefeel.loader.loader import Loader

ARM_ROWS = ("pilot.arm_mass", "pilot.arm_damping", "pilot.arm_stiffness")
"""The rows of the loader that hold an arm."""

_SAME = 1e-9
"""Relative; a value that was read back from a file is still the same."""


class Arm(StrEnum):
    """The pilot's arm at the grip."""

    LOOSE = "loose"
    FIRM = "firm"
    HANDS_OFF = "hands-off"


ARMS = {Arm.LOOSE: (1.0, 10.0, 50.0), Arm.FIRM: (3.0, 40.0, 1000.0), Arm.HANDS_OFF: (0.0, 0.0, 0.0)}
"""Mass in kg, damping in N s/m and spring rate in N/m at the grip. Loose: a set of public simulations. Firm, two hands:
the middle of ranges that are known by hearsay only."""

UNVERIFIED = frozenset({Arm.FIRM})
"""Sets not verified against a source; results that use them state so."""


def arm_of(loader: "Loader") -> Arm | None:
    """The set that the loader's rows hold; ``None`` for any other."""
    held = [loader[row] for row in ARM_ROWS]
    matching = (
        arm
        for arm, values in ARMS.items()
        if all(isclose(value, other, rel_tol=_SAME) for value, other in zip(held, values, strict=True))
    )
    return next(matching, None)
