"""The design of an electric loader: its analysis without a law, and its loop under a sampled law."""

from dataclasses import dataclass, fields

from forcefeel.design.assessment import loops_html
from forcefeel.design.law_loop import LawLoop, law_loop
from forcefeel.design.motor import MotorAnalysis, analyze_motor
from forcefeel.laws.law import ROBUST
from forcefeel.loader.loader import Loader


@dataclass(frozen=True)
class MotorDesign(MotorAnalysis):
    """An electric loader without a law, and under one.

    Attributes:
        law: The law's name.
        programmed: The loader under it at the programmed setting.
        low: The same at the low setting, with the law that is designed for it.
    """

    law: str
    programmed: LawLoop
    low: LawLoop

    def __repr__(self) -> str:
        assessment = self.programmed.assessment
        return f"<MotorDesign of {self.loader.name!r} with {self.law}: {'stable' if assessment.stable else 'unstable'}>"

    def _repr_html_(self) -> str:
        alone = {
            f"by current alone, {configuration.name} link": configuration.programmed.assessment
            for configuration in self.configurations
        }
        return loops_html(self.loader.name, {**alone, f"under {self.law}": self.programmed.assessment})

    @property
    def acceptable(self) -> bool:
        """Whether the loader is stable under the law at the programmed setting."""
        return self.programmed.assessment.stable


def design_motor(loader: Loader, law: str = ROBUST) -> MotorDesign:
    """Analyzes an electric loader, and assesses it under a law. To find the best law, use ``choice.best_law``.

    Args:
        loader: The loader.
        law: Name of a law for a motor. Default: ``robust``.

    Raises:
        InputError: If ``loader`` is no loader, has a valve or no ``controller.period``; if there is no such law for it.

    Example:
        >>> design = ff.design.design_motor(ff.loader.electric("sidestick-roll"), "observer")
        >>> f"{design.programmed.assessment.frequency_rad_per_s / design.feel_frequency_rad_per_s:.2f}"
        '1.00'
    """
    analysis = analyze_motor(loader)
    values = {row.name: getattr(analysis, row.name) for row in fields(analysis)}
    return MotorDesign(**values, law=law, programmed=law_loop(loader, law), low=law_loop(analysis.low_loader, law))
