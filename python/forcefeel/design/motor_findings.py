"""Conclusions from the design of an electric loader, in sentences."""

from math import inf, isfinite, nan
from typing import TYPE_CHECKING

from forcefeel.conclusions import Conclusions, of_result
from forcefeel.design import tried_findings
from forcefeel.design.assessment import Assessment, MotorPeaks
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.motor import MotorAnalysis
from forcefeel.design.sentences import hertz, percent, rendering, settling
from forcefeel.linear.electric_modes import COLUMN_ON_LINK, CURRENT_LOOP, ON_THE_LINK
from forcefeel.linear.frequency import Margins
from forcefeel.loader.beyond_linear import left_out
from forcefeel.units import ANGLE, INERTIA, ROTARY_STIFFNESS, Unit, UnitSystem, to_text

if TYPE_CHECKING:
    from forcefeel.design.motor_design import MotorDesign

MILLISECONDS = Unit("s", "ms", "ms", "s")

NO_REPORT = (
    "The report's own law, recursion (22) with its gains, dropped paths and sensitivities, is for a valve and does "
    "not apply."
)


@of_result
def motor_conclusions(design: "MotorDesign", units: UnitSystem, tried: LawComparison | None) -> Conclusions:
    """The conclusions, with numbers in ``units``; those of the laws that were tried lead, where some were."""
    lead = () if tried is None else tuple(tried_findings.lines(tried))
    own = rendering(f"Under law {design.law} the loader", design.programmed.assessment, design.feel_frequency_rad_per_s)
    return Conclusions(
        design.acceptable if tried is None else tried.best is not None,
        own if tried is None else tried_findings.verdict(tried),
        (
            *lead,
            *(() if tried is None else (own,)),
            *filter(None, [law_text(design), *plant_lines(design, units), NO_REPORT, left_out(design.loader)]),
        ),
    )


def plant_lines(analysis: MotorAnalysis, units: UnitSystem) -> list[str]:
    """What motor, link and column do without a law."""
    return [
        inertia_text(analysis, units),
        _link(analysis),
        delay_text(analysis),
        boundary_text(analysis, units),
        _demand(analysis),
    ]


def law_text(design: "MotorDesign") -> str:
    """What the law makes of the loader, linear."""
    assessment, margins = design.programmed.assessment, design.programmed.margins
    if not assessment.stable:
        return ""
    return (
        f"Linear model under {design.law}: {settling(assessment)}; frequency "
        f"{hertz(assessment.frequency_rad_per_s)}, damping ratio {to_text(assessment.damping_ratio, 2)}; r.m.s. "
        f"deviation from the ideal over two seconds {percent(assessment.tracking_error)} of the "
        f"deflection. Margins at the command: gain {to_text(margins.gain_up, 3)} times, delay {_milliseconds(margins.delay_s)}."
    )


def inertia_text(analysis: MotorAnalysis, units: UnitSystem) -> str:
    """What the hand moves without a law, and how that feels."""
    loop = analysis.configuration("compliant").programmed.assessment
    rotor, column, felt, programmed = (
        _inertia(value, units)
        for value in (
            analysis.rotor_inertia_n_m_s2_per_rad,
            analysis.column_inertia_n_m_s2_per_rad,
            analysis.felt_inertia_n_m_s2_per_rad,
            analysis.loader["feel.inertia"],
        )
    )
    unit_name = INERTIA.shown(units)
    moves = (
        f" Frequency: {hertz(loop.frequency_rad_per_s)}, {hertz(analysis.feel_frequency_rad_per_s)} programmed; damping ratio: "
        f"{to_text(loop.damping_ratio, 2)}, {to_text(analysis.feel_damping_ratio, 2)} programmed. It {_static(loop)}."
        if loop.stable
        else " It is unstable at the programmed setting."
    )
    return (
        f"With current control alone the motor makes only the feel's spring and damper. The inertia at the grip is that of rotor "
        f"({rotor}) and column ({column}): {felt} {unit_name}, I = {programmed} {unit_name} programmed.{moves}"
    )


def _static(assessment: Assessment) -> str:
    return f"settles with an error of {percent(assessment.static_error, signed=True)}, because the link is in series with G"


def _link(analysis: MotorAnalysis) -> str:
    swing, column, loop = (analysis.mode(name) for name in (ON_THE_LINK, COLUMN_ON_LINK, CURRENT_LOOP))
    how = "oscillate" if swing.imaginary_per_s > 0 else "creep"
    return (
        f"Rotor and column {how} against each other on the link at {hertz(swing.frequency_rad_per_s)} with a damping ratio of "
        f"{to_text(swing.damping_ratio, 2)}; with the motor locked, the column alone at {hertz(column.frequency_rad_per_s)}. "
        f"The bandwidth of the current loop, {hertz(loop.frequency_rad_per_s)}, is "
        f"{to_text(loop.frequency_rad_per_s / swing.frequency_rad_per_s, 2)} times as high."
    )


def delay_s(margins: Margins) -> float:
    """Delay that a loop bears at the crossover of its phase margin; infinite where it bears any, none where it is past it."""
    if margins.phase_margin_rad == inf:
        return inf
    w = margins.gain_crossover_rad_per_s
    return max(margins.phase_margin_rad, 0.0) / w if isfinite(w) and w > 0 else nan


def delay_text(analysis: MotorAnalysis) -> str:
    """What delay the feel by current alone bears, beside the controller's."""
    margins = analysis.configuration("compliant").programmed.margins
    borne, loader = delay_s(margins), analysis.loader
    if not isfinite(borne):
        return ""
    phase = to_text(ANGLE.from_si(margins.phase_margin_rad, UnitSystem.SI), 3)
    text = f"With current control alone the phase margin is {phase} deg and the delay margin {_milliseconds(borne)}"
    if not loader["controller.period"]:
        return f"{text}."
    period, delay = (_milliseconds(loader[f"controller.{name}"]) for name in ("period", "delay"))
    return f"{text}; the controller has a period of {period} and a delay of {delay}."


def boundary_text(analysis: MotorAnalysis, units: UnitSystem) -> str:
    """How stiff a feel the current alone can make."""
    rigid, compliant = (analysis.configuration(name).boundary for name in ("rigid", "compliant"))
    stiffness = compliant.stiffness_n_m_per_rad
    if stiffness == 0:
        return f"With current control alone the loader is {compliant.note} the feel."
    if stiffness == inf:
        return f"With current control alone every stiffness is stable: {compliant.note}."
    largest, highest = ROTARY_STIFFNESS.from_si(stiffness, units), analysis.loader["feel.maximum_stiffness"]
    with_rigid = rigid.stiffness_n_m_per_rad / highest
    other = (
        f"; with a rigid link {to_text(with_rigid, 2)} times"
        if isfinite(with_rigid) and with_rigid > 0
        else f"; with a rigid link the loader is {rigid.note}"
    )
    return (
        f"With current control alone under this controller the largest stable G is {to_text(largest, 3)} "
        f"{ROTARY_STIFFNESS.shown(units)}, "
        f"{to_text(stiffness / highest, 2)} times G_max ({compliant.note}){other}."
    )


def _demand(analysis: MotorAnalysis) -> str:
    peaks = analysis.configuration("compliant").programmed.peaks
    if not isinstance(peaks, MotorPeaks):
        return ""
    shares = {"current": peaks.current_share, "voltage": peaks.voltage_share}
    parts = [f"{percent(share)} of the largest {name}" for name, share in shares.items() if share > 0]
    if not parts:
        return ""
    beyond = " Beyond 100 % the linear model does not apply." if max(shares.values()) > 1 else ""
    return f"With current control alone the step of pilot force takes {' and '.join(parts)}.{beyond}"


def _inertia(value: float, units: UnitSystem) -> str:
    return to_text(INERTIA.from_si(value, units), 3)


def _milliseconds(value: float) -> str:
    return f"{to_text(MILLISECONDS.from_si(value, UnitSystem.SI), 3)} ms"
