"""Conclusions from a design, in sentences."""

import numpy as np

from forcefeel._core import feel_frequency
from forcefeel.conclusions import Conclusions, of_result
from forcefeel.design import tried_findings
from forcefeel.design.analysis import Configuration
from forcefeel.design.assessment import Assessment, Peaks
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_findings import motor_conclusions
from forcefeel.design.sentences import FREQUENCY_TOLERANCE, hertz, percent, rendering, settling
from forcefeel.design.studies import CHANGES, VISIBLE_LOSS, droppable, worst
from forcefeel.design.workflow import Design
from forcefeel.linear.models import Linkage
from forcefeel.linear.modes import least_damped
from forcefeel.loader.beyond_linear import left_out
from forcefeel.units import ROTARY_STIFFNESS, UnitSystem, to_text

SAME_MODE = 0.02
"""Relative difference in frequency below which two models' modes are called the same: what one can read off a plot."""


def conclusions(design: Design | MotorDesign, units: UnitSystem, tried: LawComparison | None = None) -> Conclusions:
    """The conclusions of ``design``, with numbers in ``units``; those of the laws that were tried lead, where some were.

    Example:
        >>> conclusions = ff.design.conclusions(ff.design_loader(ff.elevator()), ff.UnitSystem.US)
        >>> conclusions.ok, len(conclusions.findings) > 3
        (True, True)
    """
    if isinstance(design, MotorDesign):
        return motor_conclusions(design, units, tried)
    return _servo_conclusions(design, units, tried)


@of_result
def _servo_conclusions(design: Design, units: UnitSystem, tried: LawComparison | None) -> Conclusions:
    lead = (
        ()
        if tried is None
        else (*tried_findings.lines(tried), f"The report's law on the linear, analog model: {_verdict(design)}")
    )
    return Conclusions(
        design.acceptable if tried is None else tried.best is not None,
        _verdict(design) if tried is None else tried_findings.verdict(tried),
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


def _analog(design: Design) -> str:
    """What an analog loader misses."""
    if design.loader["controller.period"]:
        return ""
    return (
        "The loader is analog and can only use the report's laws. The newer laws need a digital controller: set controller.period"
        " and controller.delay, for example 0.5 ms each. forcefeel design elevator-2khz shows such a loader."
    )


def _verdict(design: Design) -> str:
    if not design.compensation.reached:
        return f"There are no gains to evaluate: recursion (22) {design.compensation.note}."
    assessment = design.configuration("compensated").programmed.assessment
    return rendering("The compensated loader", assessment, design.feel_frequency_rad_per_s)


def _compliance(design: Design) -> str:
    compliant = design.servo(Linkage.COMPLIANT)
    swinging = [mode for mode in compliant.closed_modes if mode.imaginary_per_s > 0]
    if not swinging:
        return "The linkage is compliant, but no mode of the servo oscillates: every one is real."
    mode = least_damped(swinging)
    rigid = design.servo(Linkage.RIGID)
    if any(
        abs(rigid_mode.frequency_rad_per_s / mode.frequency_rad_per_s - 1) <= SAME_MODE
        for rigid_mode in rigid.closed_modes
    ):
        return (
            f"The linkage is nearly rigid: the servo's least damped mode, at {hertz(mode.frequency_rad_per_s)} with a"
            f" damping ratio of {to_text(mode.damping_ratio, 2)}, exists with a rigid link too."
        )
    peak = compliant.column_resonance
    return (
        f"The linkage is not rigid: with the position loop closed the column oscillates on it at"
        f" {hertz(mode.frequency_rad_per_s)} with a damping ratio of {to_text(mode.damping_ratio, 2)}"
        + (f", and its response to the command peaks at {hertz(peak.frequency_rad_per_s)}." if peak else ".")
    )


def _original(design: Design, units: UnitSystem) -> str:
    rigid, compliant = design.configuration("rigid"), design.configuration("compliant")
    return (
        f"The original loop is {settling(compliant.programmed.assessment)}. With a rigid link {_reach(rigid, units)};"
        f" with the compliant link {_reach(compliant, units)}."
    )


def _compensated(design: Design) -> str:
    assessment = design.configuration("compensated").programmed.assessment
    if not assessment.stable:
        return "With the designed gains the loop is unstable, so its response is not evaluated."
    return (
        f"With the designed gains the loop is {settling(assessment)}. Frequency: {hertz(assessment.frequency_rad_per_s)},"
        f" {hertz(design.feel_frequency_rad_per_s)} programmed; damping ratio: {to_text(assessment.damping_ratio, 2)},"
        f" {to_text(design.feel_damping_ratio, 2)} programmed. Over two seconds after the step the r.m.s. deviation from the ideal"
        f" is {percent(assessment.tracking_error)} of the final deflection." + _inertia_remark(design, assessment)
    )


def _inertia_remark(design: Design, assessment: Assessment) -> str:
    """The column's own inertia J adds to the programmed I: the frequency that this predicts, if it is what is found."""
    both = design.loader["feel.inertia"] + design.loader["column.inertia"]
    heavier, _ = feel_frequency(design.loader.replace({"feel.inertia": both}, si=True).si_values)
    predicted = heavier / design.feel_frequency_rad_per_s
    if abs(assessment.frequency_rad_per_s / design.feel_frequency_rad_per_s / predicted - 1) > FREQUENCY_TOLERANCE / 2:
        return ""  # something else is at work as well
    return (
        f" The column's own inertia J adds to the programmed I, which lowers the frequency to"
        f" {hertz(design.feel_frequency_rad_per_s * predicted)}."
    )


def _low_stiffness(design: Design, units: UnitSystem) -> str:
    compliant, compensated = design.configuration("compliant"), design.configuration("compensated")
    before, after = compliant.boundary.stiffness_n_m_per_rad, compensated.boundary.stiffness_n_m_per_rad
    if after == 0 and before == 0:
        return f"Low stiffness does not destabilize the loop, with or without the law: {compensated.boundary.note}."
    if after == 0:
        return f"The law removes the instability at low stiffness: {compensated.boundary.note}."
    if not np.isfinite(after) or not np.isfinite(before) or before == 0:
        return f"Stability from G_max downwards: original loop {compliant.boundary.note}; compensated {compensated.boundary.note}."
    direction = "down" if after < before else "up"
    ratio = to_text(max(before / after, after / before), 2)
    return (
        f"The law moves the boundary of stability {direction} by a factor of {ratio}, to {_edge(compensated, units)}. The boundary"
        f" remains, because the load cell still drives the feel computer and eq. (19) neglects that loop."
    )


def _valve(design: Design) -> str:
    peaks = design.configuration("compensated").programmed.peaks
    if not isinstance(peaks, Peaks):
        return "Current and flow are not evaluated, because the loop is unstable."
    within = peaks.current_share <= 1 and peaks.flow_share <= 1
    return (
        f"The step of pilot force takes {percent(peaks.current_share)} of the rated current and"
        f" {percent(peaks.flow_share)} of the rated flow: the valve {'has margin' if within else 'saturates'}."
    )


def _paths(design: Design) -> str:
    compensated = design.configuration("compensated")
    full = compensated.programmed.assessment
    if not full.stable:
        return "Dropped feedback paths are not evaluated, because the full set is unstable."
    most = droppable(design.dropped, full, compensated.boundary)
    if most is None:
        return (
            f"No feedback path can be dropped without a visible loss (more than {percent(VISIBLE_LOSS)} of deflection)."
        )
    return (
        f"{' and '.join(most.paths)} can be dropped: the deviation from the ideal changes from"
        f" {percent(full.tracking_error)} to {percent(most.assessment.tracking_error)}, and the loop stays stable."
    )


def _sensitivity(design: Design) -> str:
    row = worst(design.deviations)
    assessment = row.assessment
    if assessment is None:
        return "Sensitivity is not evaluated: every deviation leaves the range of its parameter."
    harm = (
        f"deviates by {percent(assessment.tracking_error)}, {percent(assessment.static_error, signed=True)} at rest"
        if assessment.stable
        else "is unstable"
    )
    unstable = sum(
        1 for deviation in design.deviations if deviation.assessment is not None and not deviation.assessment.stable
    )
    count = (
        f"No single deviation up to {100 * max(CHANGES):.0f} % makes it unstable"
        if unstable == 0
        else f"{unstable} deviations make it unstable"
    )
    return f"{count}; the worst is {row.quantity} at {percent(row.change, signed=True)}, where the column {harm}."


def _reach(configuration: Configuration, units: UnitSystem) -> str:
    value = configuration.boundary.stiffness_n_m_per_rad
    if value == 0:
        return "the loop is stable at every low G"
    if not np.isfinite(value):
        return "the loop is unstable even at G_max"
    return f"the smallest stable G is {_edge(configuration, units)}"


def _edge(configuration: Configuration, units: UnitSystem) -> str:
    boundary = configuration.boundary
    stiffness = ROTARY_STIFFNESS.from_si(boundary.stiffness_n_m_per_rad, units)
    return f"{to_text(stiffness)} {ROTARY_STIFFNESS.shown(units)} ({boundary.note})"
