"""The whole comparison."""

from collections.abc import Callable

from forcefeel.design.workflow import design_servo
from forcefeel.loader.built_in import elevator
from forcefeel.reproduction import appendix, claims, curves, equations, gains
from forcefeel.reproduction.table import Section


def reproduce(progress: Callable[[str], None] = lambda _: None) -> tuple[Section, ...]:
    """Comparison of every number and claim of the 1974 report with the models, for its elevator loader.

    Args:
        progress: Called with the name of each step of the design as it begins.

    Example:
        >>> sections = ff.reproduction.reproduce()
        >>> sum(len(section.rows) for section in sections) > 50
        True
    """
    loader = elevator()
    design = design_servo(loader, progress=progress)
    return (
        appendix.columns(),
        appendix.origins(loader),
        equations.matrices(loader),
        *gains.published(design),
        gains.horizon(design),
        curves.figures(design),
        claims.claims(design),
    )
