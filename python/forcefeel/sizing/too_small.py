"""What other commands say of a motor that cannot hold what is programmed, and what would."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.release_motion import holding_force
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.sizing.findings import enough, sizing_conclusions, text
from forcefeel.sizing.motor import Motor
from forcefeel.sizing.run import size_drive
from forcefeel.units import FORCE, TORQUE, UnitSystem


def too_small_text(loader: Loader, units: UnitSystem, release_rad: float | None = None) -> str:
    """That the motor does not give what the loader's own feel asks for, and what would; empty where it does, and of a valve.

    Args:
        loader: The loader.
        units: The units of the numbers.
        release_rad: Angle in rad of the release; as ``size_drive`` if not given.
    """
    if loader.drive != ELECTRIC:
        return ""
    sizing = size_drive(loader, release_rad=release_rad)
    if sizing.ok:
        return ""
    conclusions = sizing_conclusions(sizing, units)
    return f"{conclusions.verdict} {conclusions.findings[0]}"


@dataclass(frozen=True, eq=False)
class Beyond:
    """Settings of the feel that a motor cannot hold still at an angle: ``G theta`` takes more than its largest current or voltage.

    Attributes:
        settings: Which.
        force_n: The largest force at the grip that one of all settings asks for.
        gives_n: What the motor gives there; infinite without a limit, and of a valve, which is not asked.
        torque_n_m: What the largest force takes at the motor.
    """

    settings: NDArray[np.bool_]
    force_n: Annotated[float, FORCE]
    gives_n: Annotated[float, FORCE]
    torque_n_m: Annotated[float, TORQUE]

    @classmethod
    def of(cls, loader: Loader, stiffness: NDArray[np.float64], angle_rad: float) -> "Beyond":
        """Those of ``stiffness``, N m/rad, that cannot be held at an angle."""
        force = holding_force(loader, stiffness, angle_rad)
        most = float(force.max())
        if loader.drive != ELECTRIC:
            return cls(np.zeros(len(force), dtype=np.bool_), most, np.inf, np.nan)
        motor = Motor(loader)
        held = motor.share(force, np.zeros(len(force)))
        torque = motor.needs(np.array([most]), np.zeros(1), held=False).torque_n_m
        return cls(np.asarray(held > 1), most, motor.capability.peak_force_n, torque)

    def sentence(self, units: UnitSystem) -> str:
        """What the motor gives, and what would do."""
        return (
            f"at the release angle the stiffest takes {text(self.force_n, FORCE, units)} at the grip; the limit of the motor is "
            f"{text(self.gives_n, FORCE, units)}. Remedy: a motor of {enough(self.torque_n_m, TORQUE, units)}, the "
            "transmission.travel that forcefeel size computes, or a smaller feel.maximum_stiffness."
        )
