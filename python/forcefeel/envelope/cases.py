"""Cases of an envelope: the nominal machine, each parameter at both ends of its tolerance, each pilot's arm at the grip.

Each case changes one thing: a parameter with hands off, or the arm at the grip of the nominal machine.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite

from forcefeel.envelope.deviations import Deviation
from forcefeel.errors import InputError
from forcefeel.loader.arms import ARMS, UNVERIFIED, Arm


class Kind(StrEnum):
    """Kind of deviation in a case."""

    NOMINAL = "nominal"
    PLANT = "plant"
    ARM = "arm"
    DRAWN = "drawn"


@dataclass(frozen=True)
class PilotArm:
    """An arm at the grip.

    Attributes:
        name: Its name.
        mass_kg, damping_n_s_per_m, stiffness_n_per_m: Mass, damper and spring at the grip.
        verified: Whether the values were verified against their source.
    """

    name: str
    mass_kg: float
    damping_n_s_per_m: float
    stiffness_n_per_m: float
    verified: bool

    @property
    def values(self) -> tuple[float, float, float]:
        """Mass, damping and stiffness, in the order of ``arms.ARM_ROWS``."""
        return self.mass_kg, self.damping_n_s_per_m, self.stiffness_n_per_m


def _reference_arm(arm: Arm) -> PilotArm:
    return PilotArm(str(arm), *ARMS[arm], verified=arm not in UNVERIFIED)


REFERENCE_ARMS = (PilotArm("light", 0.8, 5.5, 30.0, verified=True), _reference_arm(Arm.LOOSE), _reference_arm(Arm.FIRM))
"""Arms of the reference table: two sets of public simulations, and the middle of the ranges for two hands."""


@dataclass(frozen=True)
class Case:
    """One machine with one arm.

    Attributes:
        name: Its name, such as ``linkage.stiffness -20 %``.
        kind: Kind of deviation.
        off: Deviations as shares of the value: of one parameter in a plant case, of all in a drawn machine.
        arm: The pilot's arm; ``None`` for hands off.
    """

    name: str
    kind: Kind
    off: Mapping[str, float] = field(default_factory=dict)
    arm: PilotArm | None = None

    @property
    def parameter(self) -> str:
        """The deviating parameter of a plant case; empty for other kinds."""
        return next(iter(self.off)) if self.kind is Kind.PLANT else ""

    @property
    def change(self) -> float:
        """Deviation of ``parameter`` as a share of its value."""
        return self.off.get(self.parameter, 0.0)

    @property
    def verified(self) -> bool:
        """Whether its numbers are verified against a source or need no source."""
        return self.arm is None or self.arm.verified


NOMINAL = Case("nominal", Kind.NOMINAL)


def make_cases(deviations: Mapping[str, Deviation], arms: Sequence[PilotArm]) -> tuple[Case, ...]:
    """Make the nominal case, then each parameter at both ends of its deviation, then the arms.

    Raises:
        InputError: If an arm is invalid.
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
