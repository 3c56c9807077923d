"""The design of the 1974 report for any loader, as one frozen result."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from forcefeel._core import feel_frequency
from forcefeel.design.analysis import LOW_SHARE, Analysis, configuration, originals
from forcefeel.design.assessment import loops_html
from forcefeel.design.motor import MotorAnalysis, analyze_motor
from forcefeel.design.studies import Deviation, DroppedPaths, drop_paths, sensitivity
from forcefeel.laws.analog.recursion import DesignSettings, GainDesign, design_gains
from forcefeel.linear.frequency import Margins, Peak, margins, resonance
from forcefeel.linear.models import Linkage, servo_model
from forcefeel.linear.modes import Mode, least_damped, modes
from forcefeel.loader.loader import Loader, check_hydraulic, check_loader
from forcefeel.loader.parameters import ELECTRIC

if TYPE_CHECKING:
    from forcefeel.design.motor_design import MotorDesign

STEPS = ("compensation", "original system", "compensated system", "dropped paths", "sensitivity")
"""Progress steps of ``design_servo``."""


@dataclass(frozen=True)
class ServoResult:
    """The hydraulic servo alone, column attached (figs. 8, 9).

    Attributes:
        linkage: Rigid or compliant link.
        open_modes: Modes with the position loop open.
        closed_modes: Modes with it closed.
        margins: Margins of the position loop.
        column_resonance: Largest gain from command to column near its least damped mode, position loop
            closed; ``None`` where there is no peak.
    """

    linkage: Linkage
    open_modes: tuple[Mode, ...]
    closed_modes: tuple[Mode, ...]
    margins: Margins
    column_resonance: Peak | None


@dataclass(frozen=True)
class ServoAnalysis(Analysis):
    """Analysis of the original system of a hydraulic loader.

    Attributes:
        servos: The servo with rigid and with compliant link.
    """

    servos: tuple[ServoResult, ...]

    def servo(self, linkage: Linkage) -> ServoResult:
        """The servo with that link."""
        return next(servo for servo in self.servos if servo.linkage is linkage)


@dataclass(frozen=True)
class Design(ServoAnalysis):
    """The original system and its compensation.

    Attributes:
        compensation: The gains that close the loop.
        published: Gains over the published horizon, with the pilot force coupled as the report must have had it.
        converged: Gains over an endless horizon.
        dropped: Which feedback paths can be dropped.
        deviations: Sensitivity of the compensated loop.

    Example:
        >>> design = ff.design_loader(ff.elevator())
        >>> [configuration.name for configuration in design.configurations]
        ['rigid', 'compliant', 'compensated']
    """

    compensation: GainDesign
    published: GainDesign
    converged: GainDesign
    dropped: tuple[DroppedPaths, ...]
    deviations: tuple[Deviation, ...]

    def __repr__(self) -> str:
        assessment = self.configuration("compensated").programmed.assessment
        rendered = (
            f"{assessment.frequency_rad_per_s / 2 / np.pi:.3g} Hz, damping ratio {assessment.damping_ratio:.2g}"
            if assessment.stable
            else "unstable"
        )
        programmed = f"{self.feel_frequency_rad_per_s / 2 / np.pi:.3g} Hz, {self.feel_damping_ratio:.2g}"
        return f"<Design of {self.loader.name!r}: programmed {programmed}; compensated {rendered}>"

    def _repr_html_(self) -> str:
        loops = {configuration.name: configuration.programmed.assessment for configuration in self.configurations}
        return loops_html(self.loader.name, loops)

    @property
    def acceptable(self) -> bool:
        """Whether the recursion found gains, and the loader is stable with them."""
        return self.compensation.reached and self.configuration("compensated").programmed.assessment.stable


def analyze(loader: Loader) -> ServoAnalysis | MotorAnalysis:
    """Analyzes a loader without a law: drive, loops, stability and response, with rigid and with compliant link.

    For a valve this is the original system, eq. (13); for a motor the feel by current alone.

    Raises:
        InputError: If ``loader`` is no loader.

    Example:
        >>> analysis = ff.analyze(ff.elevator())
        >>> analysis.configuration("compliant").boundary.note
        'lost by oscillation at 12.0 Hz'
        >>> ff.analyze(ff.loader.electric("sidestick-roll")).configuration("compliant").boundary.note[:19]
        'lost by oscillation'
    """
    check_loader(loader)
    return analyze_motor(loader) if loader.drive == ELECTRIC else _analyze_servo(loader)


def _analyze_servo(loader: Loader) -> ServoAnalysis:
    low = loader.scale_feel(LOW_SHARE)
    frequency, damping_ratio = feel_frequency(loader.si_values)
    return ServoAnalysis(
        loader=loader,
        low_loader=low,
        feel_frequency_rad_per_s=frequency,
        feel_damping_ratio=damping_ratio,
        servos=tuple(_servo(loader, linkage) for linkage in Linkage),
        configurations=originals(loader, low),
    )


def design_loader(
    loader: Loader, settings: DesignSettings | None = None, progress: Callable[[str], None] = lambda _: None
) -> "Design | MotorDesign":
    """Analyzes ``loader``, designs its law and assesses the result.

    For a valve as in the report, ``design_servo``; for a motor ``design_motor`` with the default law.

    Args:
        loader: The loader.
        settings: How the gains of recursion (22) are computed; the published horizon if not given.
        progress: Called with each of ``STEPS`` as it begins; a motor has none of them.

    Raises:
        InputError: If ``loader`` is no loader; if settings of recursion (22) are given for a motor.

    Example:
        >>> design = ff.design_loader(ff.elevator())
        >>> ff.design.conclusions(design, ff.UnitSystem.US).ok
        True
    """
    from forcefeel.design.motor_design import design_motor  # noqa: PLC0415  python-control, for which analyze need not wait

    check_loader(loader)
    if loader.drive == ELECTRIC:
        if settings is not None:
            check_hydraulic(
                loader, "recursion (22)", "a motor takes a sampled law, such as design.design_motor(loader, 'robust')"
            )
        return design_motor(loader)
    return design_servo(loader, settings, progress)


def design_servo(
    loader: Loader, settings: DesignSettings | None = None, progress: Callable[[str], None] = lambda _: None
) -> Design:
    """Analyzes ``loader``, designs its compensation as in the report, and assesses the result.

    Args:
        loader: The loader.
        settings: How the gains that close the loop are computed; the published horizon if not given.
        progress: Called with each of ``STEPS`` as it begins.

    Raises:
        InputError: If ``loader`` is no loader, or has a motor.

    Example:
        >>> design = ff.design.design_servo(ff.elevator())
        >>> ff.design.conclusions(design, ff.UnitSystem.US).ok
        True
    """
    check_hydraulic(loader, "the design of the report", "design_loader takes either")
    progress(STEPS[0])
    published, converged = design_gains(loader), design_gains(loader, DesignSettings())
    chosen = published if settings is None else design_gains(loader, settings)
    law = chosen.law(loader)
    progress(STEPS[1])
    original = _analyze_servo(loader)
    progress(STEPS[2])
    compensated = configuration("compensated", (loader, original.low_loader), Linkage.COMPLIANT, law, chosen.settings)
    progress(STEPS[3])
    dropped = drop_paths(loader, chosen.gains, chosen.settings)
    progress(STEPS[4])
    deviations = sensitivity(loader, chosen.gains, chosen.settings)
    return Design(
        loader=loader,
        low_loader=original.low_loader,
        feel_frequency_rad_per_s=original.feel_frequency_rad_per_s,
        feel_damping_ratio=original.feel_damping_ratio,
        servos=original.servos,
        configurations=(*original.configurations, compensated),
        compensation=chosen,
        published=published,
        converged=converged,
        dropped=dropped,
        deviations=deviations,
    )


def _servo(loader: Loader, linkage: Linkage) -> ServoResult:
    opened, closed = (servo_model(loader, linkage, closed=closed) for closed in (False, True))
    closed_modes = modes(closed)
    w = least_damped(closed_modes).frequency_rad_per_s
    # Wide enough for the peak of a mode that others pull aside; a mode that rounding leaves no frequency has none.
    peak = resonance(closed.to_output(1), w / 2, 3 * w) if w > 0 else None
    return ServoResult(linkage, modes(opened), closed_modes, margins(opened.to_output(0)), peak)
