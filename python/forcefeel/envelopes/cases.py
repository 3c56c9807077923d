"""The cases of an envelope: the nominal machine, each plant parameter off its value, each pilot's arm at the grip.

One thing at a time: a parameter is off with the hands off, an arm is at the grip of the nominal machine.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from types import MappingProxyType
from typing import Annotated

from forcefeel.arms import ARMS, UNVERIFIED, Arm
from forcefeel.errors import InputError
from forcefeel.loader import Loader
from forcefeel.parameters import REQUIRED, did_you_mean
from forcefeel.studies import PLANT_PARAMETERS
from forcefeel.units import PERCENT, show

USUAL_CHANGE, VALVE_GAIN_CHANGE = 0.2, 0.3

CHANGES: Mapping[str, float] = MappingProxyType(
    {key: VALVE_GAIN_CHANGE if key == "valve.current_gain" else USUAL_CHANGE for key in PLANT_PARAMETERS}
)
"""How far each parameter of the plant is off, to either side. Not the sensors' gains, which are calibrated, nor those of the
feel computer, which are numbers in a program."""

_ORIFICE = {"valve.current_gain": "valve.rated_flow", "valve.pressure_gain": "valve.supply_pressure"}
"""What stands for the gains C_i, C_p where the flow follows the orifice, eq. (1)."""


def changes_of(loader: Loader) -> Mapping[str, float]:
    """``CHANGES`` for a loader: of its orifice, where its flow follows that."""
    if not loader["valve.orifice"]:
        return CHANGES
    return MappingProxyType({_ORIFICE.get(key, key): share for key, share in CHANGES.items()})


class Kind(StrEnum):
    """What is not nominal in a case."""

    NOMINAL = "nominal"
    PLANT = "plant"
    ARM = "arm"


@dataclass(frozen=True)
class PilotArm:
    """An arm at the grip.

    Attributes:
        name: What it is called.
        mass_kg, damping_n_s_per_m, stiffness_n_per_m: Mass, damper and spring at the grip.
        verified: Whether somebody has held the set against its source.
    """

    name: str
    mass_kg: float
    damping_n_s_per_m: float
    stiffness_n_per_m: float
    verified: bool

    @property
    def values(self) -> tuple[float, float, float]:
        """Mass, damping and stiffness, as ``arms.ARM_ROWS`` has them."""
        return self.mass_kg, self.damping_n_s_per_m, self.stiffness_n_per_m


def _held(arm: Arm) -> PilotArm:
    return PilotArm(str(arm), *ARMS[arm], verified=arm not in UNVERIFIED)


REFERENCE_ARMS = (PilotArm("light", 0.8, 5.5, 30.0, verified=True), _held(Arm.LOOSE), _held(Arm.FIRM))
"""The arms of the reference table beside none: both sets of public simulations, and the middle of the ranges for two hands."""


@dataclass(frozen=True)
class Case:
    """One machine with one arm.

    Attributes:
        name: What it is called, such as ``linkage.stiffness -20 %``.
        kind: What is not nominal.
        parameter: Key of the plant parameter that is off; empty if none is.
        change: By which share of its value it is off.
        arm: The pilot's arm; ``None`` for hands off.
    """

    name: str
    kind: Kind
    parameter: str = ""
    change: Annotated[float, PERCENT] = 0.0
    arm: PilotArm | None = None

    @property
    def verified(self) -> bool:
        """Whether its numbers have been held against a source, or need none."""
        return self.arm is None or self.arm.verified


def make_cases(changes: Mapping[str, float], arms: Sequence[PilotArm]) -> tuple[Case, ...]:
    """The nominal case first, then each parameter below and above its value, then the arms.

    Args:
        changes: By which share each parameter is off, to either side.
        arms: The arms.

    Raises:
        InputError: If a parameter is no part of the linear model's plant, a share is not above 0 and below 1, or an arm is bad.
    """
    found = [Case("nominal", Kind.NOMINAL)]
    for key, share in changes.items():
        if key not in REQUIRED or key.startswith(("feel.", "pilot.")):
            what = did_you_mean(key) if key not in REQUIRED else "the feel and the pilot are not the plant's"
            raise InputError(f"changes: expected parameters of the plant, got {show(key)}; {what}")
        if not (isinstance(share, int | float) and 0 < share < 1):
            raise InputError(f"changes: {key}: expected a share above 0 and below 1, got {show(share)}")
        for change in (-share, share):
            found.append(Case(f"{key} {100 * change:+.4g} %", Kind.PLANT, key, change))
    for arm in arms:
        if not all(isfinite(value) and value >= 0 for value in arm.values):
            raise InputError(f"arms: {arm.name}: expected numbers of 0 or more, got {arm.values}")
        found.append(Case(f"{arm.name} arm", Kind.ARM, arm=arm))
    names = [case.name for case in found]
    if len(set(names)) < len(names):
        raise InputError("arms: two have the same name; give each its own")
    return tuple(found)
