"""The cases of an envelope: the nominal machine, each parameter at either end of its tolerance, each pilot's arm at the grip.

One thing at a time: a parameter is off with the hands off, an arm is at the grip of the nominal machine.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite

from forcefeel.envelope.deviations import Deviation
from forcefeel.errors import InputError
from forcefeel.loader.arms import ARMS, UNVERIFIED, Arm


class Kind(StrEnum):
    """What is not nominal in a case."""

    NOMINAL = "nominal"
    PLANT = "plant"
    ARM = "arm"
    DRAWN = "drawn"


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


def _reference_arm(arm: Arm) -> PilotArm:
    return PilotArm(str(arm), *ARMS[arm], verified=arm not in UNVERIFIED)


REFERENCE_ARMS = (PilotArm("light", 0.8, 5.5, 30.0, verified=True), _reference_arm(Arm.LOOSE), _reference_arm(Arm.FIRM))
"""The arms of the reference table beside none: both sets of public simulations, and the middle of the ranges for two hands."""


@dataclass(frozen=True)
class Case:
    """One machine with one arm.

    Attributes:
        name: What it is called, such as ``linkage.stiffness -20 %``.
        kind: What is not nominal.
        off: By which share of its value each parameter is off, of those that are: one of a plant's case, all of a drawn machine.
        arm: The pilot's arm; ``None`` for hands off.
    """

    name: str
    kind: Kind
    off: Mapping[str, float] = field(default_factory=dict)
    arm: PilotArm | None = None

    @property
    def parameter(self) -> str:
        """The one parameter that is off; empty where none is, or several are."""
        return next(iter(self.off)) if self.kind is Kind.PLANT else ""

    @property
    def change(self) -> float:
        """By which share of its value it is off."""
        return self.off.get(self.parameter, 0.0)

    @property
    def verified(self) -> bool:
        """Whether its numbers have been held against a source, or need none."""
        return self.arm is None or self.arm.verified


NOMINAL = Case("nominal", Kind.NOMINAL)


def make_cases(deviations: Mapping[str, Deviation], arms: Sequence[PilotArm]) -> tuple[Case, ...]:
    """The nominal case first, then each parameter at either end of its deviation, then the arms.

    Args:
        deviations: How far each parameter may be off.
        arms: The arms.

    Raises:
        InputError: If an arm is bad.
    """
    cases = [NOMINAL]
    for key, deviation in deviations.items():
        ends = {f"{key} {100 * change:+.4g} %": change for change in deviation.ends if change}
        cases += [Case(name, Kind.PLANT, {key: change}) for name, change in ends.items()]
    for arm in arms:
        if not all(isfinite(value) and value >= 0 for value in arm.values):
            raise InputError(f"arms: {arm.name}: expected numbers of 0 or more, got {arm.values}")
        cases.append(Case(f"{arm.name} arm", Kind.ARM, arm=arm))
    names = [case.name for case in cases]
    if len(set(names)) < len(names):
        raise InputError("arms: two have the same name; give each its own")
    return tuple(cases)
