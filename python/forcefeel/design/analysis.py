"""Analysis of a loader without a law, for any drive: its loops at two settings, with rigid and compliant link."""

from dataclasses import dataclass, field
from typing import Annotated

from forcefeel._core import GainLaw
from forcefeel.design.assessment import AnyPeaks, Assessment, assess, peaks
from forcefeel.laws.analog.recursion import DesignSettings
from forcefeel.linear.boundary import StabilityBoundary, largest_stable_stiffness, smallest_stable_stiffness
from forcefeel.linear.electric_modes import named_modes
from forcefeel.linear.frequency import Margins, margins
from forcefeel.linear.models import Linkage, loader_model, open_loop_model
from forcefeel.linear.modes import Mode, modes
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.units import HERTZ, RATIO

LOW_SHARE = 0.1
"""Share of I, B and G at the low setting, where figures 10 and 11 show the effect of compliance.

The pilot's force is reduced by the same share, so the programmed deflection stays the same.
"""


@dataclass(frozen=True)
class LoopResult:
    """One configuration at one setting.

    Attributes:
        modes: Its modes; named for a motor.
        margins: Margins of the overall loop, opened at the feel computer's torque (fig. 10), for a motor at its current
            command.
        assessment: Rendering of the programmed feel.
        peaks: Its demand on valve or motor; ``None`` if unstable.
    """

    modes: tuple[Mode, ...]
    margins: Margins
    assessment: Assessment
    peaks: AnyPeaks | None


@dataclass(frozen=True)
class Configuration:
    """One model and control of the loader.

    Attributes:
        name: ``rigid``, ``compliant`` or ``compensated``.
        linkage: Rigid or compliant link.
        law: The law; ``None`` is the original position loop, eq. (13), or a motor's feel by current alone.
        programmed: Result at the programmed setting.
        low: Result with I, B, G and the pilot's force at ``LOW_SHARE`` of it.
        boundary: Smallest stable G; for a motor the largest, under its controller.
    """

    name: str
    linkage: Linkage
    law: GainLaw | None = field(repr=False)
    programmed: LoopResult
    low: LoopResult
    boundary: StabilityBoundary


@dataclass(frozen=True)
class Analysis:
    """Analysis of a loader without a law.

    Attributes:
        loader: The loader.
        low_loader: The same at the low setting.
        feel_frequency_rad_per_s: Programmed natural frequency.
        feel_damping_ratio: Programmed damping ratio.
        configurations: Rigid and compliant; a design by recursion (22) adds the compensated one.

    Example:
        >>> analysis = ff.analyze(ff.elevator())
        >>> analysis.configuration("rigid").programmed.assessment.stable
        True
    """

    loader: Loader
    low_loader: Loader
    feel_frequency_rad_per_s: Annotated[float, HERTZ]
    feel_damping_ratio: Annotated[float, RATIO]
    configurations: tuple[Configuration, ...]

    def configuration(self, name: str) -> Configuration:
        """The configuration of that name."""
        return next(configuration for configuration in self.configurations if configuration.name == name)


def originals(loader: Loader, low: Loader) -> tuple[Configuration, ...]:
    """A loader at two settings without a law, with rigid and with compliant link."""
    return tuple(configuration(str(linkage), (loader, low), linkage) for linkage in Linkage)


def configuration(
    name: str,
    settings_of_feel: tuple[Loader, Loader],
    linkage: Linkage,
    law: GainLaw | None = None,
    weights: DesignSettings | None = None,
) -> Configuration:
    """A loader at its programmed and its low setting."""
    loader, low = settings_of_feel
    return Configuration(
        name,
        linkage,
        law,
        programmed=_loop(loader, linkage, law, weights),
        low=_loop(low, linkage, law, weights),
        boundary=largest_stable_stiffness(loader, linkage)
        if loader.drive == ELECTRIC
        else smallest_stable_stiffness(loader, linkage, law),
    )


def _loop(loader: Loader, linkage: Linkage, law: GainLaw | None, weights: DesignSettings | None) -> LoopResult:
    assessment, model = assess(loader, law, weights, linkage=linkage), loader_model(loader, law, linkage)
    return LoopResult(
        named_modes(loader, model.A) if loader.drive == ELECTRIC else modes(model),
        margins(open_loop_model(loader, linkage, law)),
        assessment,
        peaks(loader, law, linkage) if assessment.stable else None,
    )
