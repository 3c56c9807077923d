"""What an engineer should conclude from a design, in words."""

from math import isfinite, isnan

import numpy as np

from forcefeel._core import feel_frequency
from forcefeel.conclusions import Conclusions, of_result
from forcefeel.design.assessment import Assessment
from forcefeel.design.laws_tried import LawsTried
from forcefeel.design.studies import CHANGES, VISIBLE_LOSS, droppable, worst
from forcefeel.design.workflow import Configuration, Design
from forcefeel.linear.models import Linkage
from forcefeel.linear.modes import least_damped
from forcefeel.loader.beyond_linear import left_out
from forcefeel.units import HERTZ, ROTARY_STIFFNESS, UnitSystem, to_text

_LOST = "where it settles is lost in rounding: its numbers are too many powers of ten apart"

SMALL_ERROR = 0.02
"""Static error below which a deflection is called right: a fifth of the 10 % of force that the static check allows (14 CFR
Part 60, Appendix A, Table A2A, test 2.a.1.a)."""

FREQUENCY_TOLERANCE = 0.10
"""Deviation of the period that qualification allows: T(P0) = 10 % of P0 (14 CFR Part 60, Appendix A, Attachment 2)."""


SAME_MODE = 0.02
"""Relative difference in frequency below which two models' modes are called the same: what one can read off a plot."""


@of_result
def conclusions(design: Design, units: UnitSystem, tried: LawsTried | None = None) -> Conclusions:
    """The conclusions of ``design``, with numbers in ``units``; those of the laws that were tried lead, where some were.

    Example:
        >>> import forcefeel as ff
        >>> found = ff.design.conclusions(ff.design_loader(ff.elevator()), ff.UnitSystem.US)
        >>> found.good, len(found.findings) > 3
        (True, True)
    """
    lead = (
        () if tried is None else (*_tried(tried), f"The report's law on the linear, analog model: {_verdict(design)}")
    )
    return Conclusions(
        design.acceptable if tried is None else tried.best is not None,
        _verdict(design) if tried is None else _tried_verdict(tried),
        (
            *lead,
            _compliance(design),
            _original(design, units),
            _compensated(design),
            _low_stiffness(design, units),
            _valve(design),
            _paths(design),
            _sensitivity(design),
            *filter(None, [_analog(design), left_out(design.loader)]),
        ),
    )


def _tried_verdict(tried: LawsTried) -> str:
    if tried.impossible:
        return f"The laws cannot be tried on this loader: {tried.impossible}."
    report = tried.report.qualified_text
    if tried.best is None:
        return f"No law is eligible for this loader. By {tried.rule} the report's law {report}."
    if tried.best == tried.report:
        return f"The report's law is the best for this loader. By {tried.rule} it {report}."
    return f"By {tried.rule} law {tried.best.name} {tried.best.qualified_text}. The report's law {report}."


def _tried(tried: LawsTried) -> list[str]:
    """What the laws render, why the best is chosen, why the report's does not qualify, and what looks closer."""
    if tried.impossible:
        return []
    settings = f"{tried.settings} settings of stiffness, frequency and damping ratio"
    lines = [f"Tried at {settings}. {tried.remarks[0]}"] if tried.best else [*tried.remarks]
    if tried.best != tried.report:
        lines.append(f"The report's law, {tried.report.name}, {tried.report.rendered_text}.")
    if tried.report.qualified and tried.report.qualified.reasons:
        lines.append(f"With the report's law: {tried.report.qualified.reasons[0]}")
    return [*lines, "The settings are few: the page names the commands that look closer."]


def _analog(design: Design) -> str:
    """What an analog loader misses."""
    if design.loader["controller.period"]:
        return ""
    return (
        "The loader is analog and can only take the report's laws. Those that were made since need a digital controller: forcefeel"
        " design elevator-2khz shows the best of them; controller.period and controller.delay, for example 0.5 ms each, give"
        " this loader one."
    )


def _verdict(design: Design) -> str:
    found = design.configuration("compensated").programmed.assessment
    if not design.compensation.reached:
        return f"There is no compensation to judge: recursion (22) {design.compensation.note}."
    if not found.stable:
        return "The compensated loader is unstable at the programmed setting: do not close this loop."
    if isnan(found.static_error):
        return f"The compensated loader is stable, but {_LOST}."
    static = abs(found.static_error) <= SMALL_ERROR
    moving = abs(found.frequency_rad_per_s / design.feel_frequency_rad_per_s - 1) <= FREQUENCY_TOLERANCE
    if static and moving:
        return "The compensated loader is stable and renders the programmed feel, at rest and in motion."
    if static:
        return "The compensated loader is stable and settles where it should, but it moves at the wrong frequency."
    return "The compensated loader is stable but does not settle where the programmed feel would."


def _compliance(design: Design) -> str:
    compliant = design.servo(Linkage.COMPLIANT)
    swinging = [mode for mode in compliant.closed_modes if mode.imaginary_per_s > 0]
    if not swinging:
        return "The linkage is compliant, but nothing swings on it: every mode of the servo is real."
    mode = least_damped(swinging)
    rigid = design.servo(Linkage.RIGID)
    if any(abs(one.frequency_rad_per_s / mode.frequency_rad_per_s - 1) <= SAME_MODE for one in rigid.closed_modes):
        return (
            f"The linkage is as good as rigid: the servo's least damped mode, at {_hertz(mode.frequency_rad_per_s)} with a"
            f" damping ratio of {to_text(mode.damping_ratio, 2)}, is there with a rigid link too."
        )
    peak = compliant.column_resonance
    return (
        f"The linkage is not rigid: with the position loop closed the column swings on it at"
        f" {_hertz(mode.frequency_rad_per_s)} with a damping ratio of {to_text(mode.damping_ratio, 2)}"
        + (f", and its response to the command peaks at {_hertz(peak.frequency_rad_per_s)}." if peak else ".")
    )


def _original(design: Design, units: UnitSystem) -> str:
    rigid, compliant = design.configuration("rigid"), design.configuration("compliant")
    return (
        f"The original loop is {_settling(compliant.programmed.assessment)}. With a rigid link {_reach(rigid, units)};"
        f" with the real one {_reach(compliant, units)}."
    )


def _compensated(design: Design) -> str:
    found = design.configuration("compensated").programmed.assessment
    if not found.stable:
        return "With the designed gains the loop is unstable, so there is no response to judge."
    return (
        f"With the designed gains it is {_settling(found)}, and moves at {_hertz(found.frequency_rad_per_s)} with a damping"
        f" ratio of {to_text(found.damping_ratio, 2)} where {_hertz(design.feel_frequency_rad_per_s)} and"
        f" {to_text(design.feel_damping_ratio, 2)} are programmed. Over two seconds after the step it deviates from the ideal"
        f" by {_percent(found.tracking_error)} of the final deflection (root mean square)."
        + _inertia_remark(design, found)
    )


def _inertia_remark(design: Design, found: Assessment) -> str:
    """The column's own inertia J adds to the programmed I: the frequency that this predicts, if it is what is found."""
    both = design.loader["feel.inertia"] + design.loader["column.inertia"]
    heavier, _ = feel_frequency(design.loader.replace({"feel.inertia": both}).values)
    predicted = heavier / design.feel_frequency_rad_per_s
    if abs(found.frequency_rad_per_s / design.feel_frequency_rad_per_s / predicted - 1) > FREQUENCY_TOLERANCE / 2:
        return ""  # something else is at work as well
    return (
        f" The column's own inertia J adds to the programmed I: that alone lowers the frequency to"
        f" {_hertz(design.feel_frequency_rad_per_s * predicted)}."
    )


def _low_stiffness(design: Design, units: UnitSystem) -> str:
    compliant, compensated = design.configuration("compliant"), design.configuration("compensated")
    before, after = compliant.boundary.stiffness_n_m_per_rad, compensated.boundary.stiffness_n_m_per_rad
    if after == 0 and before == 0:
        return f"Low stiffness is no danger, with or without the compensation: {compensated.boundary.note}."
    if after == 0:
        return f"The compensation removes the instability at low stiffness: {compensated.boundary.note}."
    if not np.isfinite(after) or not np.isfinite(before) or before == 0:
        return f"Stability from G_max downwards: original loop {compliant.boundary.note}; compensated {compensated.boundary.note}."
    direction = "down" if after < before else "up"
    ratio = to_text(max(before / after, after / before), 2)
    return (
        f"The compensation moves the boundary of stability {direction} by a factor of {ratio}, to {_edge(compensated, units)};"
        f" it does not remove it, because the load cell still drives the feel computer and eq. (19) leaves that loop out."
    )


def _valve(design: Design) -> str:
    found = design.configuration("compensated").programmed.peaks
    if found is None:
        return "Current and flow are not evaluated, because the loop is unstable."
    within = found.current_share <= 1 and found.flow_share <= 1
    return (
        f"The step of pilot force asks for {_percent(found.current_share)} of the rated current and"
        f" {_percent(found.flow_share)} of the rated flow: the valve {'has margin' if within else 'saturates'}."
    )


def _paths(design: Design) -> str:
    compensated = design.configuration("compensated")
    full = compensated.programmed.assessment
    if not full.stable:
        return "Dropping feedback paths is not judged, because the full set is unstable."
    most = droppable(design.dropped, full, compensated.boundary)
    if most is None:
        return f"No feedback path can be dropped without a visible loss (more than {_percent(VISIBLE_LOSS)} of deflection)."
    return (
        f"{' and '.join(most.paths)} can be dropped: the deviation from the ideal goes from"
        f" {_percent(full.tracking_error)} to {_percent(most.assessment.tracking_error)}, and stability stays."
    )


def _sensitivity(design: Design) -> str:
    row = worst(design.deviations)
    found = row.assessment
    if found is None:
        return "Sensitivity is not evaluated: every deviation leaves the range of its parameter."
    harm = (
        f"deviates by {_percent(found.tracking_error)}, {_percent(found.static_error, signed=True)} at rest"
        if found.stable
        else "is unstable"
    )
    unstable = sum(1 for one in design.deviations if one.assessment is not None and not one.assessment.stable)
    count = (
        f"No single deviation up to {max(CHANGES):.0%} makes it unstable"
        if unstable == 0
        else f"{unstable} deviations make it unstable"
    )
    return f"{count}; the worst is {row.quantity} at {_percent(row.change, signed=True)}, where the column {harm}."


def _settling(found: Assessment) -> str:
    if not found.stable:
        return "unstable at the programmed setting"
    if isnan(found.static_error):
        return f"stable, but {_LOST}"
    return f"stable and settles at {_percent(1 + found.static_error)} of the programmed deflection"


def _reach(configuration: Configuration, units: UnitSystem) -> str:
    value = configuration.boundary.stiffness_n_m_per_rad
    if value == 0:
        return "no G is too low for it"
    if not np.isfinite(value):
        return "it is unstable at G_max already"
    return f"G may fall to {_edge(configuration, units)}"


def _edge(configuration: Configuration, units: UnitSystem) -> str:
    boundary = configuration.boundary
    shown = ROTARY_STIFFNESS.from_si(boundary.stiffness_n_m_per_rad, units)
    return f"{to_text(shown)} {ROTARY_STIFFNESS.shown(units)} ({boundary.note})"


def _hertz(value: float) -> str:
    return f"{to_text(HERTZ.from_si(value, UnitSystem.SI), 3)} Hz"


def _percent(value: float, *, signed: bool = False) -> str:
    return f"{100 * value:{'+' if signed else ''}.1f} %" if isfinite(value) else "undefined"
