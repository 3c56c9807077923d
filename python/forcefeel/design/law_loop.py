"""Linear loop of a loader under a sampled law: modes, margins, and response to a step of pilot force.

``x+ = M x + b_F F_p`` from sample to sample, delay of the command included (``loops.sampled_loops``).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.design.assessment import Assessment, programmed_angle_rad
from forcefeel.laws.law import Law
from forcefeel.linear.models import feel_model
from forcefeel.linear.modes import Mode, feel_mode
from forcefeel.linear.step import DURATION_S, step_outputs
from forcefeel.loader.loader import Loader
from forcefeel.loops.command_loop import CommandLoop
from forcefeel.loops.margins import LoopMargins, loop_margins
from forcefeel.loops.sampled_loop import SampledLoops, sampled_loops


@dataclass(frozen=True)
class LawLoop:
    """A loader under a sampled law at one setting.

    Attributes:
        modes: Its modes, ``s = ln(z) / T``.
        margins: Margins at its command.
        assessment: Rendering of the programmed feel.
    """

    modes: tuple[Mode, ...]
    margins: LoopMargins
    assessment: Assessment


@dataclass(frozen=True, eq=False)
class LawStep:
    """A step of pilot force under a sampled law, at its samples.

    Attributes:
        time_s: Times.
        column_angle_rad: Column's angle.
        command: Command of the law to the drive, in V or A.
    """

    time_s: NDArray[np.float64]
    column_angle_rad: NDArray[np.float64]
    command: NDArray[np.float64]


def law_loop(loader: Loader, name: str) -> LawLoop:
    """A loader under the law of that name, designed for its own setting.

    Raises:
        InputError: If there is no such law for it, or it has no ``controller.period``.
    """
    loops = sampled_loops(loader, Law.of(name, loader))
    loop = CommandLoop.sampled(loops)
    modes = loop.modes
    return LawLoop(modes, loop_margins(loop), _assess(loader, loops, modes, stable=loop.stable))


def law_step(loader: Loader, name: str, duration_s: float = DURATION_S) -> LawStep:
    """The step of the loader's pilot force under the law of that name.

    Raises:
        InputError: As ``law_loop``.
    """
    return _step(loader, sampled_loops(loader, Law.of(name, loader)), duration_s)


def law_response(loader: Loader, name: str, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    """``theta / F_p`` in rad/N from sample to sample, at frequencies below half the sampling rate.

    Raises:
        InputError: As ``law_loop``.
    """
    loops = sampled_loops(loader, Law.of(name, loader))
    z = np.exp(2j * np.pi * frequency_hz * loops.period_s)
    angle_row = np.eye(len(loops.by_force[0]))[loops.base] / loader["column.base_arm"]
    return _core.frequency_response(loops.matrix[0], loops.by_force[0], angle_row, z)


def _step(loader: Loader, loops: SampledLoops, duration_s: float) -> LawStep:
    matrix, entry = loops.matrix[0], loops.by_force[0] * loader["pilot.force"]
    samples = round(duration_s / loops.period_s) + 1
    states = np.zeros((samples, len(entry)))
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(samples - 1):
            states[k + 1] = matrix @ states[k] + entry
    angle = states[:, loops.base] / loader["column.base_arm"]
    return LawStep(np.arange(samples, dtype=np.float64) * loops.period_s, angle, states[:, loops.command])


def _assess(loader: Loader, loops: SampledLoops, modes: tuple[Mode, ...], *, stable: bool) -> Assessment:
    abscissa = max(mode.real_per_s for mode in modes)
    if not stable:
        return Assessment(False, abscissa, *[np.nan] * 7)
    feel = feel_mode(modes, *_core.feel_frequency(loader.si_values))
    programmed_rad, step = programmed_angle_rad(loader), _step(loader, loops, DURATION_S)
    _, ideal = step_outputs(feel_model(loader), loader["pilot.force"], DURATION_S, len(step.time_s))
    settled = np.linalg.solve(np.eye(len(loops.matrix[0])) - loops.matrix[0], loops.by_force[0])[loops.base]
    reached = float(settled) / loader["column.base_arm"] * loader["pilot.force"]
    return Assessment(
        stable=True,
        abscissa_per_s=abscissa,
        frequency_rad_per_s=feel.frequency_rad_per_s,
        damping_ratio=feel.damping_ratio,
        least_damping_ratio=min(mode.damping_ratio for mode in modes),
        static_angle_rad=reached,
        static_error=reached / programmed_rad - 1,
        tracking_error=float(np.sqrt(np.mean((step.column_angle_rad - ideal[0]) ** 2))) / abs(programmed_rad),
        cost=np.nan,
    )
