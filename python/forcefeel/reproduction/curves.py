"""Figures 8 to 11 and 14: the curves are lost; the statements on them are compared."""

import numpy as np

from forcefeel.design.assessment import programmed_angle_rad
from forcefeel.design.sentences import FREQUENCY_TOLERANCE, SMALL_ERROR
from forcefeel.design.workflow import Design
from forcefeel.linear.frequency import zeros
from forcefeel.linear.models import Linkage, servo_model
from forcefeel.linear.modes import Mode, least_damped
from forcefeel.reproduction.table import Reason, Row, Section, about, claim, number
from forcefeel.units import to_text

_HYDRAULICS = (
    "oil, valve and position loop shift and damp the mode; 12.00 Hz and 0.100 are the zeros: the column on the link"
)


def figures(design: Design) -> Section:
    """A row or more per figure."""
    rigid, compliant, compensated = (design.configuration(n) for n in ("rigid", "compliant", "compensated"))
    growing = max(compliant.low.modes, key=lambda mode: mode.real_per_s)
    programmed_deg = float(np.degrees(programmed_angle_rad(design.loader)))
    assessment = compensated.programmed.assessment
    return Section(
        "Figures 8 to 11 and 14",
        (
            *_servo(design),
            *_phase_margins(design),
            claim(
                "fig. 11(a): the rigid model is stable at the low setting",
                "page of fig. 11",
                rigid.low.assessment.abscissa_per_s,
                "1/s",
                holds=rigid.low.assessment.stable,
                reason="largest real part of the poles",
            ),
            claim(
                "fig. 11(b): the compliant model oscillates with growing amplitude",
                "page of fig. 11",
                _hertz(growing),
                "Hz",
                holds=not compliant.low.assessment.stable and growing.imaginary_per_s > 0,
                reason=f"frequency of the growing oscillation, {to_text(growing.real_per_s)} 1/s",
            ),
            claim(
                "fig. 14: the compensated column settles where it should",
                "page of fig. 14",
                float(np.degrees(assessment.static_angle_rad)),
                "deg",
                holds=abs(assessment.static_error) <= SMALL_ERROR,
                reason=f"{to_text(assessment.static_angle_rad)} rad; programmed: R_p F_p / G = {to_text(programmed_deg)} deg",
            ),
            claim(
                "fig. 14: the compensated column moves as programmed",
                "page of fig. 14",
                assessment.frequency_rad_per_s / (2 * np.pi),
                "Hz",
                holds=abs(assessment.frequency_rad_per_s / design.feel_frequency_rad_per_s - 1) <= FREQUENCY_TOLERANCE,
                reason="programmed: 2.0 Hz; the column's own inertia J adds to I",
            ),
        ),
    )


def _servo(design: Design) -> list[Row]:
    rows, held = [], _piston_held(design)
    for figure, result_modes in (("fig. 8", "open_modes"), ("fig. 9", "closed_modes")):
        compliant = design.servo(Linkage.COMPLIANT)
        mode = _link(getattr(compliant, result_modes))
        near = abs(_hertz(mode) / 12 - 1) < 0.1  # "approximately"
        rows += [
            about(
                f"{figure}: resonance of the servo",
                "page of fig. 8",
                "12",
                _hertz(mode),
                "Hz",
                holds=near,
                reason=_HYDRAULICS,
            ),
            number(
                f"{figure}: its damping ratio",
                "page of fig. 8",
                "0.1",
                mode.damping_ratio,
                "",
                Reason(_HYDRAULICS, held.damping_ratio),
            ),
        ]
    rows += [
        number("column on the link, piston held", "page of fig. 8", "12", _hertz(held), "Hz"),
        number("its damping ratio", "page of fig. 8", "0.1", held.damping_ratio, ""),
    ]
    return rows


def _phase_margins(design: Design) -> list[Row]:
    rigid = float(np.degrees(design.configuration("rigid").low.margins.phase_margin_rad))
    compliant = float(np.degrees(design.configuration("compliant").low.margins.phase_margin_rad))
    return [
        claim(
            "fig. 10: compliance takes a sizable part of the phase margin",
            "page of fig. 10",
            compliant - rigid,
            "deg",
            holds=compliant < rigid - 30,  # "sizable": a third of the 90 degrees that a loop can well use
            reason=f"from {to_text(rigid, 3)} to {to_text(compliant, 3)} deg at the low setting",
        )
    ]


def _link(loop_modes: tuple[Mode, ...]) -> Mode:
    return least_damped(mode for mode in loop_modes if mode.imaginary_per_s > 0)


def _piston_held(design: Design) -> Mode:
    """The zeros of the servo's response: the mode of the column with the piston held."""
    opened = servo_model(design.loader, Linkage.COMPLIANT, closed=False).to_output(0)
    zero = max(zeros(opened), key=lambda s: s.imag)
    return Mode(zero.real, zero.imag, abs(zero), -zero.real / abs(zero))


def _hertz(mode: Mode) -> float:
    return mode.frequency_rad_per_s / (2 * np.pi)
