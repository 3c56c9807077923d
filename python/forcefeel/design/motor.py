"""Analysis of an electric loader without a law: its feel by current alone, and its deviation from the programmed feel."""

from dataclasses import dataclass
from typing import Annotated

from forcefeel._core import feel_frequency
from forcefeel.design.analysis import LOW_SHARE, Analysis, originals
from forcefeel.linear.electric import ElectricPlant
from forcefeel.linear.electric_modes import NamedMode, motor_modes
from forcefeel.loader.loader import Loader, check_electric
from forcefeel.units import INERTIA


@dataclass(frozen=True)
class MotorAnalysis(Analysis):
    """A motor, its link and its column without a law.

    Attributes:
        rotor_inertia_n_m_s2_per_rad: Inertia of the rotor about the column's pivot, ``J_m (alpha R_b / r)^2``.
        column_inertia_n_m_s2_per_rad: The column's own J.
        modes: Named modes: current loop, and oscillations on the link.
    """

    rotor_inertia_n_m_s2_per_rad: Annotated[float, INERTIA]
    column_inertia_n_m_s2_per_rad: Annotated[float, INERTIA]
    modes: tuple[NamedMode, ...]

    def mode(self, name: str) -> NamedMode:
        """The mode of that name."""
        return next(mode for mode in self.modes if mode.name == name)

    @property
    def felt_inertia_n_m_s2_per_rad(self) -> Annotated[float, INERTIA]:
        """Inertia that the hand moves if the motor acts as spring and damper only: rotor and column."""
        return self.rotor_inertia_n_m_s2_per_rad + self.column_inertia_n_m_s2_per_rad


def analyze_motor(loader: Loader) -> MotorAnalysis:
    """Analyzes an electric loader without a law.

    Raises:
        InputError: If ``loader`` is no loader, or has a valve.
    """
    check_electric(loader, "the analysis of a motor", "analyze takes either")
    low = loader.scale_feel(LOW_SHARE)
    frequency, damping_ratio = feel_frequency(loader.si_values)
    plant = ElectricPlant.of(loader)
    return MotorAnalysis(
        loader=loader,
        low_loader=low,
        feel_frequency_rad_per_s=frequency,
        feel_damping_ratio=damping_ratio,
        configurations=originals(loader, low),
        rotor_inertia_n_m_s2_per_rad=plant.rotor_mass * plant.lever**2,
        column_inertia_n_m_s2_per_rad=plant.column_mass * plant.lever**2,
        modes=motor_modes(loader),
    )
