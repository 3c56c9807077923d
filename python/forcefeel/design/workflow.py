"""Everything that the 1974 report computed, for any loader: the design as one frozen result."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from forcefeel._core import Compensator, feel_frequency
from forcefeel.design.assessment import Assessment, Peaks, assess, peaks
from forcefeel.design.studies import Deviation, DroppedPaths, drop_paths, sensitivity
from forcefeel.laws.analog.recursion import Compensation, DesignSettings, compensate
from forcefeel.linear.boundary import StabilityBoundary, smallest_stable_stiffness
from forcefeel.linear.frequency import Margins, Peak, margins, resonance
from forcefeel.linear.models import Linkage, loader_model, open_loop_model, servo_model
from forcefeel.linear.modes import Mode, least_damped, modes
from forcefeel.loader.loader import Loader, check_hydraulic
from forcefeel.printable import table_html
from forcefeel.units import HERTZ, RATIO

LOW_SHARE = 0.1
"""Share of I, B and G at the low setting, where figures 10 and 11 show what compliance does.

The pilot's force is lowered along, so that the programmed deflection stays the same.
"""


STEPS = ("compensation", "original system", "compensated system", "dropped paths", "sensitivity")
"""What ``design_loader`` reports as it goes."""


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
class LoopResult:
    """One configuration at one setting.

    Attributes:
        modes: Its modes.
        margins: Margins of the overall loop, opened at the feel computer's torque (fig. 10).
        assessment: How it renders the programmed feel.
        peaks: Its demand on the valve; not evaluated where unstable.
    """

    modes: tuple[Mode, ...]
    margins: Margins
    assessment: Assessment
    peaks: Peaks | None


@dataclass(frozen=True)
class Configuration:
    """One way to model and drive the loader.

    Attributes:
        name: ``rigid``, ``compliant`` or ``compensated``.
        linkage: Rigid or compliant link.
        compensator: The law; ``None`` is the original position loop, eq. (13).
        programmed: Result at the programmed setting.
        low: Result with I, B, G and the pilot's force at ``LOW_SHARE`` of it.
        boundary: Smallest stable G.
    """

    name: str
    linkage: Linkage
    compensator: Compensator | None = field(repr=False)
    programmed: LoopResult
    low: LoopResult
    boundary: StabilityBoundary


@dataclass(frozen=True)
class Analysis:
    """What the original system does.

    Attributes:
        loader: The loader.
        low_loader: The same at the low setting.
        feel_frequency_rad_per_s: Programmed natural frequency.
        feel_damping_ratio: Programmed damping ratio.
        servos: The servo with rigid and with compliant link.
        configurations: Rigid and compliant; a design adds the compensated one.

    Example:
        >>> import forcefeel as ff
        >>> found = ff.analyze(ff.elevator())
        >>> found.configuration("rigid").programmed.assessment.stable
        True
    """

    loader: Loader
    low_loader: Loader
    feel_frequency_rad_per_s: Annotated[float, HERTZ]
    feel_damping_ratio: Annotated[float, RATIO]
    servos: tuple[ServoResult, ...]
    configurations: tuple[Configuration, ...]

    def servo(self, linkage: Linkage) -> ServoResult:
        """The servo with that link."""
        return next(one for one in self.servos if one.linkage is linkage)

    def configuration(self, name: str) -> Configuration:
        """The configuration of that name."""
        return next(one for one in self.configurations if one.name == name)


@dataclass(frozen=True)
class Design(Analysis):
    """The original system and its compensation.

    Attributes:
        compensation: The gains that close the loop.
        published: Gains over the published horizon, with the pilot force coupled as the report must have had it.
        converged: Gains over an endless horizon.
        dropped: Which feedback paths can be dropped.
        deviations: Sensitivity of the compensated loop.

    Example:
        >>> import forcefeel as ff
        >>> found = ff.design_loader(ff.elevator())
        >>> [one.name for one in found.configurations]
        ['rigid', 'compliant', 'compensated']
    """

    compensation: Compensation
    published: Compensation
    converged: Compensation
    dropped: tuple[DroppedPaths, ...]
    deviations: tuple[Deviation, ...]

    def __repr__(self) -> str:
        found = self.configuration("compensated").programmed.assessment
        rendered = (
            f"{found.frequency_rad_per_s / 2 / np.pi:.3g} Hz, damping ratio {found.damping_ratio:.2g}"
            if found.stable
            else "unstable"
        )
        programmed = f"{self.feel_frequency_rad_per_s / 2 / np.pi:.3g} Hz, {self.feel_damping_ratio:.2g}"
        return f"<Design of {self.loader.name!r}: programmed {programmed}; compensated {rendered}>"

    def _repr_html_(self) -> str:
        judged = ((one.name, one.programmed.assessment) for one in self.configurations)
        rows = (
            (name, f"{it.frequency_rad_per_s / 2 / np.pi:.3g} Hz", f"{it.damping_ratio:.2g}", f"{it.static_error:+.1%}")
            if it.stable
            else (name, "unstable", "", "")
            for name, it in judged
        )
        return table_html(self.loader.name, ("loop", "frequency", "damping ratio", "off at rest"), rows)

    @property
    def acceptable(self) -> bool:
        """Whether the recursion gave the gains that were asked for, and the loader is stable with them."""
        return self.compensation.reached and self.configuration("compensated").programmed.assessment.stable


def analyze(loader: Loader) -> Analysis:
    """Analyses the original system: servo, loops, stability and response, with rigid and with compliant link.

    Example:
        >>> import forcefeel as ff
        >>> found = ff.analyze(ff.elevator())
        >>> found.configuration("compliant").boundary.note
        'lost by oscillation at 12.0 Hz'
    """
    check_hydraulic(loader, "the analysis of the report")
    low = loader.scale_feel(LOW_SHARE)
    frequency, damping_ratio = feel_frequency(loader.values)
    return Analysis(
        loader=loader,
        low_loader=low,
        feel_frequency_rad_per_s=frequency,
        feel_damping_ratio=damping_ratio,
        servos=tuple(_servo(loader, linkage) for linkage in Linkage),
        configurations=tuple(_configuration(str(one), (loader, low), one) for one in Linkage),
    )


def design_loader(
    loader: Loader, settings: DesignSettings | None = None, progress: Callable[[str], None] = lambda _: None
) -> Design:
    """Analyses ``loader``, designs its compensation and judges the result.

    Args:
        loader: The loader.
        settings: How the gains that close the loop are computed; the published horizon if not given.
        progress: Called with each of ``STEPS`` as it begins.

    Example:
        >>> import forcefeel as ff
        >>> found = ff.design_loader(ff.elevator())
        >>> ff.design.conclusions(found, ff.UnitSystem.US).good
        True
    """
    check_hydraulic(loader, "the design of the report")
    progress(STEPS[0])
    published, converged = compensate(loader), compensate(loader, DesignSettings())
    chosen = published if settings is None else compensate(loader, settings)
    law = chosen.compensator(loader)
    progress(STEPS[1])
    original = analyze(loader)
    progress(STEPS[2])
    compensated = _configuration("compensated", (loader, original.low_loader), Linkage.COMPLIANT, law, chosen.settings)
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


def _configuration(
    name: str,
    settings_of_feel: tuple[Loader, Loader],
    linkage: Linkage,
    law: Compensator | None = None,
    weights: DesignSettings | None = None,
) -> Configuration:
    loader, low = settings_of_feel
    return Configuration(
        name,
        linkage,
        law,
        programmed=_loop(loader, linkage, law, weights),
        low=_loop(low, linkage, law, weights),
        boundary=smallest_stable_stiffness(loader, linkage, law),
    )


def _loop(loader: Loader, linkage: Linkage, law: Compensator | None, weights: DesignSettings | None) -> LoopResult:
    found = assess(loader, law, weights, linkage=linkage)
    return LoopResult(
        modes(loader_model(loader, law, linkage)),
        margins(open_loop_model(loader, linkage, law)),
        found,
        peaks(loader, law, linkage) if found.stable else None,
    )
