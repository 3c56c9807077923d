"""Rendering of the programmed feel: comparison of the whole model, with valve dynamics, with the ideal."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.laws.analog.recursion import DesignSettings
from forcefeel.linear.frequency import response
from forcefeel.linear.models import DESIGN_STATES, OUTPUTS, LinearModel, Linkage, feel_model, loader_model
from forcefeel.linear.modes import Mode, feel_mode, is_stable, modes, spectral_abscissa
from forcefeel.linear.step import DURATION_S, equilibrium, gramian, step_outputs
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.printable import table_html
from forcefeel.units import ANGLE, CURRENT, FLOW, HERTZ, MOTOR_CURRENT, PERCENT, RATE, RATIO, VOLTAGE


@dataclass(frozen=True)
class Assessment:
    """Response of a closed loop to a step of pilot force. If it is unstable, only the first two values are finite.

    Attributes:
        stable: Whether every pole lies clearly in the left half plane.
        abscissa_per_s: Largest real part of the poles.
        frequency_rad_per_s: Frequency of the mode that renders the feel.
        damping_ratio: Its damping ratio.
        least_damping_ratio: Damping ratio of the least damped mode.
        static_angle_rad: Deflection at rest under the force.
        static_error: Its deviation from the programmed deflection, as a share of that.
        tracking_error: Root mean square of the deviation from the ideal response over 2 s, as a share of the programmed
            deflection at rest.
        cost: Index V of eq. (20) over 2 s; NaN for the original system, whose computer works in volts, and for a rigid
            link and a motor, which lack the states weighted by [Q].
    """

    stable: bool
    abscissa_per_s: Annotated[float, RATE]
    frequency_rad_per_s: Annotated[float, HERTZ]
    damping_ratio: Annotated[float, RATIO]
    least_damping_ratio: Annotated[float, RATIO]
    static_angle_rad: Annotated[float, ANGLE]
    static_error: Annotated[float, PERCENT]
    tracking_error: Annotated[float, PERCENT]
    cost: Annotated[float, RATIO]


@dataclass(frozen=True)
class Peaks:
    """Largest demand of a step of pilot force on the valve, relative to its ratings.

    Attributes:
        current_a: Largest valve current.
        current_share: The same as a share of the rated current.
        flow_m3_per_s: Largest flow into the actuator.
        flow_share: The same as a share of the rated flow.
    """

    current_a: Annotated[float, CURRENT]
    current_share: Annotated[float, PERCENT]
    flow_m3_per_s: Annotated[float, FLOW]
    flow_share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class MotorPeaks:
    """Largest demand of a step of pilot force on a motor, relative to its limits; the share is zero without a limit.

    Attributes:
        current_a: Largest current.
        current_share: The same as a share of the amplifier's limit.
        voltage_v: Largest voltage of a phase.
        voltage_share: The same as a share of the supply voltage.
    """

    current_a: Annotated[float, MOTOR_CURRENT]
    current_share: Annotated[float, PERCENT]
    voltage_v: Annotated[float, VOLTAGE]
    voltage_share: Annotated[float, PERCENT]


AnyPeaks = Peaks | MotorPeaks
"""Peaks of either drive."""


def assess(
    loader: Loader,
    law: GainLaw | None,
    settings: DesignSettings | None = None,
    *,
    linkage: Linkage = Linkage.COMPLIANT,
    programmed: Loader | None = None,
) -> Assessment:
    """Assesses the response of ``loader`` under ``law`` to its step of pilot force.

    Args:
        loader: The actual loader.
        law: State feedback; the original system if ``None``.
        settings: Weights of the cost index. Default: the report's.
        linkage: Rigid or compliant link.
        programmed: The loader with the programmed feel, if ``loader`` deviates from it; its ideal is the reference.

    Example:
        >>> loader = ff.elevator()
        >>> law = ff.design_gains(loader).law(loader)
        >>> f"{ff.design.assess(loader, law).tracking_error:.1%}"
        '19.2%'
    """
    programmed = programmed or loader
    model, ideal = loader_model(loader, law, linkage), feel_model(programmed)
    abscissa = spectral_abscissa(model.A)
    if not is_stable(abscissa):
        return Assessment(False, abscissa, *[np.nan] * 7)
    loop_modes = modes(model)
    feel = _rendering(loop_modes, programmed)
    force = programmed["pilot.force"]
    programmed_rad = programmed_angle_rad(programmed)
    reached = _static_angle(model) * force
    system = _with_ideal(model, ideal)
    start = np.zeros(len(system))
    start[-1] = force
    deviation = _deviation(model, ideal)
    squares = gramian(system, start, DURATION_S)
    tracking = deviation @ squares @ deviation
    cost = np.nan
    if law is not None and law.displacement_unit == "rad" and linkage is Linkage.COMPLIANT:
        weight = _cost_weight(model, len(system), law, settings or DesignSettings(), programmed)
        cost = float(np.sum(weight * squares))
    return Assessment(
        stable=True,
        abscissa_per_s=abscissa,
        frequency_rad_per_s=feel.frequency_rad_per_s,
        damping_ratio=feel.damping_ratio,
        least_damping_ratio=min(mode.damping_ratio for mode in loop_modes),
        static_angle_rad=reached,
        static_error=reached / programmed_rad - 1,
        tracking_error=float(np.sqrt(tracking / DURATION_S)) / programmed_rad,
        cost=cost,
    )


def _rendering(loop_modes: tuple[Mode, ...], programmed: Loader) -> Mode:
    """The mode that renders a feel; for a motor the slowest, in which rotor and column move together."""
    frequency, damping_ratio = _core.feel_frequency(programmed.si_values)
    return feel_mode(loop_modes, frequency, max(damping_ratio, 1.0) if programmed.drive == ELECTRIC else damping_ratio)


def _static_angle(model: LinearModel) -> float:
    """The column's angle in rad at rest under a pilot force of one newton; not a number where rounding leaves none."""
    try:
        return float(model.C[OUTPUTS.index("column_angle_rad")] @ equilibrium(model))
    except np.linalg.LinAlgError:
        return np.nan


def programmed_angle_rad(loader: Loader) -> float:
    """Deflection at rest that is programmed for the pilot's force, R_p F_p / G of eq. (11)."""
    return float(response(feel_model(loader), np.zeros(1, complex))[0].real) * loader["pilot.force"]


def peaks(loader: Loader, law: GainLaw | None, linkage: Linkage = Linkage.COMPLIANT) -> AnyPeaks:
    """Largest demand on the valve, or on the motor, in the two seconds after the step of pilot force.

    Example:
        >>> f"{ff.design.peaks(ff.elevator(), None).flow_share:.0%} of the rated flow"
        '19% of the rated flow'
    """
    model = loader_model(loader, law, linkage)
    _, outputs = step_outputs(model, loader["pilot.force"])
    largest = dict(zip(model.output_labels, np.nanmax(np.abs(outputs), axis=1).tolist(), strict=True))
    if loader.drive == ELECTRIC:
        current, voltage = largest["motor_current_a"], largest["motor_voltage_v"]
        most, supply = loader["current_loop.current_limit"], loader["current_loop.voltage_limit"]
        return MotorPeaks(current, current / most, voltage, voltage / supply)
    current, flow = largest["valve_current_a"], largest["actuator_flow_m3_per_s"]
    return Peaks(current, current / loader["valve.rated_current"], flow, flow / loader["valve.rated_flow"])


def _with_ideal(model: LinearModel, ideal: LinearModel) -> NDArray[np.float64]:
    """Matrix of the autonomous system of loader, ideal feel and constant pilot force, ``z = [x, x_ideal, F_p]``."""
    n, size = len(model.A), len(model.A) + len(ideal.A) + 1
    a = np.zeros((size, size))
    a[:n, :n], a[:n, -1] = model.A, model.B[:, 0]
    a[n:-1, n:-1], a[n:-1, -1] = ideal.A, ideal.B[:, 0]
    return a


def _deviation(model: LinearModel, ideal: LinearModel) -> NDArray[np.float64]:
    """Row that gives the deviation of the column from the ideal feel from ``z``."""
    return np.concatenate([model.C[OUTPUTS.index("column_angle_rad")], -ideal.C[0], [0.0]])


def _cost_weight(
    model: LinearModel, size: int, law: GainLaw, settings: DesignSettings, programmed: Loader
) -> NDArray[np.float64]:
    """Matrix of eq. (20)'s integrand ``x' [Q] x + R_2 e^2`` on ``z``."""
    pick = np.zeros((len(DESIGN_STATES), size))
    for row, state in enumerate(DESIGN_STATES[:-1]):
        pick[row, model.state_labels.index(state)] = 1.0
    pick[-1, -1] = 1.0
    command = np.array(law.gains) @ pick
    return np.asarray(pick.T @ settings.weight(programmed) @ pick + settings.r2 * np.outer(command, command))


def loops_html(title: str, loops: Mapping[str, Assessment]) -> str:
    """A table of loops for a notebook."""
    rows = (
        (
            name,
            f"{assessment.frequency_rad_per_s / 2 / np.pi:.3g} Hz",
            f"{assessment.damping_ratio:.2g}",
            f"{assessment.static_error:+.1%}",
        )
        if assessment.stable
        else (name, "unstable", "", "")
        for name, assessment in loops.items()
    )
    return table_html(title, ("loop", "frequency", "damping ratio", "off at rest"), rows)
