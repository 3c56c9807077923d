"""The table that says it all at a glance: the three configurations beside the ideal feel."""

import math

from forcefeel.design.assessment import AnyPeaks, Assessment, programmed_angle_rad
from forcefeel.design.workflow import Design
from forcefeel.linear.boundary import StabilityBoundary
from forcefeel.page.table import Cell, Table, Text, configuration, heads, number, words
from forcefeel.page.typography import NONE, heading_text, percent_text, value_text
from forcefeel.units import ANGLE, HERTZ, RATIO, ROTARY_STIFFNESS, Unit, UnitSystem


def side_by_side(design: Design, system: UnitSystem) -> Table:
    """What each configuration does at the programmed setting."""
    loops = [one.programmed for one in design.configurations]
    found = [loop.assessment for loop in loops]
    wanted = programmed_angle_rad(design.loader)

    def of(name: str, attribute: str, unit: Unit, ideal: float = math.nan) -> tuple[Cell, ...]:
        values = [value_text(getattr(one, attribute), unit, system) for one in found]
        return row(heading_text(name, unit, system), values, value_text(ideal, unit, system))

    names = (*(one.name for one in design.configurations), "ideal feel")
    rows = (
        (words("Stable"), *(stable(one) for one in found), number("yes")),
        of("Frequency of the feel", "frequency_rad_per_s", HERTZ, design.feel_frequency_rad_per_s),
        of("Its damping ratio", "damping_ratio", RATIO, design.feel_damping_ratio),
        of("Damping ratio of the least damped mode", "least_damping_ratio", RATIO),
        of("Deflection at rest", "static_angle_rad", ANGLE, wanted),
        row("Its error", [percent_text(one.static_error, signed=True) for one in found]),
        row("Deviation from the ideal over 2 s", [percent_text(one.tracking_error) for one in found]),
        row("Largest valve current, of its rating", [_share(loop.peaks, "current_share") for loop in loops]),
        row("Largest flow, of its rating", [_share(loop.peaks, "flow_share") for loop in loops]),
        row(smallest(system), [edge(one.boundary, system) for one in design.configurations]),
    )
    return Table(heads("At the programmed setting", *map(configuration, names)), rows)


def smallest(system: UnitSystem) -> str:
    """Heading of the smallest stable stiffness."""
    return heading_text("Smallest stable stiffness", ROTARY_STIFFNESS, system)


def edge(boundary: StabilityBoundary, system: UnitSystem) -> str:
    """The smallest stable stiffness; "none" if there is none."""
    value = boundary.stiffness_n_m_per_rad
    return "none" if value == math.inf else value_text(value, ROTARY_STIFFNESS, system)


def row(name: Text, values: list[str], ideal: str = NONE) -> tuple[Cell, ...]:
    """A row of numbers, the ideal's last."""
    return (words(name), *map(number, values), number(ideal))


def stable(found: Assessment) -> Cell:
    """Whether a loop is."""
    return number("yes") if found.stable else number("unstable", bad=True)


def _share(found: AnyPeaks | None, attribute: str) -> str:
    return NONE if found is None else percent_text(getattr(found, attribute))
