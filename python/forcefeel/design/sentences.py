"""Sentences on how a loader renders its feel, the same for every drive."""

from math import isfinite, isnan

from forcefeel.design.assessment import Assessment
from forcefeel.units import HERTZ, UnitSystem, to_text

LOST = "its final value is lost in rounding: the parameters differ by too many powers of ten"

SMALL_ERROR = 0.02
"""Static error below which a deflection is called right: a fifth of the 10 % of force that the static check allows (14 CFR
Part 60, Appendix A, Table A2A, test 2.a.1.a)."""

FREQUENCY_TOLERANCE = 0.10
"""Deviation of the period that qualification allows: T(P0) = 10 % of P0 (14 CFR Part 60, Appendix A, Attachment 2)."""


def rendering(what: str, assessment: Assessment, frequency_rad_per_s: float) -> str:
    """Whether a loader is stable and renders the feel of that frequency, in a sentence; ``what`` names it."""
    if not assessment.stable:
        return f"{what} is unstable at the programmed setting: do not close this loop."
    if isnan(assessment.static_error):
        return f"{what} is stable, but {LOST}."
    static = abs(assessment.static_error) <= SMALL_ERROR
    moving = abs(assessment.frequency_rad_per_s / frequency_rad_per_s - 1) <= FREQUENCY_TOLERANCE
    if static and moving:
        return f"{what} is stable and renders the programmed feel, at rest and in motion."
    if static:
        return f"{what} is stable and settles at the programmed deflection, but its frequency is wrong."
    return f"{what} is stable but does not settle at the programmed deflection."


def settling(assessment: Assessment) -> str:
    """Whether it is stable and where it settles, after ``is``."""
    if not assessment.stable:
        return "unstable at the programmed setting"
    if isnan(assessment.static_error):
        return f"stable, but {LOST}"
    return f"stable and settles at {percent(1 + assessment.static_error)} of the programmed deflection"


def hertz(value: float) -> str:
    """A frequency in rad/s as Hz."""
    return f"{to_text(HERTZ.from_si(value, UnitSystem.SI), 3)} Hz"


def percent(value: float, *, signed: bool = False) -> str:
    """A share as percent."""
    return f"{100 * value:{'+' if signed else ''}.1f} %" if isfinite(value) else "undefined"
