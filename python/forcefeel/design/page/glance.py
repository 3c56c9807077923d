"""The summary table: the three configurations and the ideal feel."""

import math
from collections.abc import Mapping

from forcefeel.design.assessment import AnyPeaks, Assessment, programmed_angle_rad
from forcefeel.design.page.stability import AnyDesign
from forcefeel.design.workflow import Design
from forcefeel.linear.boundary import StabilityBoundary
from forcefeel.page.table import Cell, Table, Text, configuration, heads, number, words
from forcefeel.page.typography import NONE, heading_text, percent_text, value_text
from forcefeel.units import ANGLE, HERTZ, RATIO, ROTARY_STIFFNESS, Unit, UnitSystem


def side_by_side(design: Design, system: UnitSystem) -> Table:
    """Each configuration at the programmed setting."""
    loops = {configuration.name: configuration.programmed for configuration in design.configurations}
    assessments = {name: loop.assessment for name, loop in loops.items()}
    errors = [percent_text(assessment.static_error, signed=True) for assessment in assessments.values()]
    edges = [edge(configuration.boundary, system) for configuration in design.configurations]
    rows = (
        row("Largest valve current, of its rating", [_share(loop.peaks, "current_share") for loop in loops.values()]),
        row("Largest flow, of its rating", [_share(loop.peaks, "flow_share") for loop in loops.values()]),
        row(smallest(system), edges),
    )
    return Table(
        heads("At the programmed setting", *map(configuration, (*loops, "ideal feel"))),
        (*rendering(design, assessments, errors, system), *rows),
    )


def rendering(
    design: AnyDesign, assessments: Mapping[str, Assessment], errors: list[str], system: UnitSystem
) -> tuple[tuple[Cell, ...], ...]:
    """Rows of the rendered feel of each loop beside the ideal one; ``errors`` are those of the deflection at rest."""
    judged = assessments.values()

    def of(name: str, attribute: str, unit: Unit, ideal: float = math.nan) -> tuple[Cell, ...]:
        values = [value_text(getattr(assessment, attribute), unit, system) for assessment in judged]
        return row(heading_text(name, unit, system), values, value_text(ideal, unit, system))

    return (
        (words("Stable"), *map(stable, judged), number("yes")),
        of("Frequency of the feel", "frequency_rad_per_s", HERTZ, design.feel_frequency_rad_per_s),
        of("Its damping ratio", "damping_ratio", RATIO, design.feel_damping_ratio),
        of("Damping ratio of the least damped mode", "least_damping_ratio", RATIO),
        of("Deflection at rest", "static_angle_rad", ANGLE, programmed_angle_rad(design.loader)),
        row("Its error", errors),
        row("Deviation from the ideal over 2 s", [percent_text(assessment.tracking_error) for assessment in judged]),
    )


def smallest(system: UnitSystem) -> str:
    """Heading of the smallest stable stiffness."""
    return heading_text("Smallest stable stiffness", ROTARY_STIFFNESS, system)


def edge(boundary: StabilityBoundary, system: UnitSystem) -> str:
    """The smallest stable stiffness; "none" if no stiffness is stable."""
    value = boundary.stiffness_n_m_per_rad
    return "none" if value == math.inf else value_text(value, ROTARY_STIFFNESS, system)


def row(name: Text, values: list[str], ideal: str = NONE) -> tuple[Cell, ...]:
    """A row of numbers, the ideal's last."""
    return (words(name), *map(number, values), number(ideal))


def stable(assessment: Assessment) -> Cell:
    """Whether a loop is stable."""
    return number("yes") if assessment.stable else number("unstable", bad=True)


def _share(peaks: AnyPeaks | None, attribute: str) -> str:
    return NONE if peaks is None else percent_text(getattr(peaks, attribute))
