"""The tables of an electric loader's design."""

import math

from forcefeel.design.analysis import LoopResult
from forcefeel.design.assessment import MotorPeaks
from forcefeel.design.law_loop import LawLoop
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_figures import under
from forcefeel.design.motor_findings import MILLISECONDS, delay_s
from forcefeel.design.page.glance import rendering, row
from forcefeel.design.page.loops import moves, pole
from forcefeel.linear.electric_modes import NamedMode
from forcefeel.linear.modes import MARGINAL_PER_S, Mode
from forcefeel.page.table import Cell, Table, configuration, heads, number, words
from forcefeel.page.typography import NONE, heading_text, number_text, percent_text, prose_html, value_text
from forcefeel.units import ANGLE, HERTZ, INERTIA, RATIO, ROTARY_STIFFNESS, UnitSystem


def side_by_side(design: MotorDesign, system: UnitSystem) -> Table:
    """What the loader does by current alone and under the law, at the programmed setting."""
    loops = dict(_loops(design))
    assessments = {name: loop.assessment for name, loop in loops.items()}
    errors = [_error(assessment.static_error) for assessment in assessments.values()]
    rows = (
        row("Largest current, of the limit", [_share(loop, "current_share") for loop in loops.values()]),
        row("Largest voltage, of the limit", [_share(loop, "voltage_share") for loop in loops.values()]),
    )
    return Table(
        heads("Step of pilot force", *map(configuration, (*loops, "ideal feel"))),
        (*rendering(design, assessments, errors, system), *rows),
    )


_NOTHING = 5e-5
"""Share that percent with two decimals show as zero, with a sign that is rounding's."""


def _error(share: float) -> str:
    return percent_text(0.0 if abs(share) < _NOTHING else share, signed=True)


def _loops(design: MotorDesign, *, low: bool = False) -> tuple[tuple[str, LoopResult | LawLoop], ...]:
    alone = (
        (f"{configuration.name} link", configuration.low if low else configuration.programmed)
        for configuration in design.configurations
    )
    return (*alone, (under(design.law), design.low if low else design.programmed))


def _share(loop: LoopResult | LawLoop, attribute: str) -> str:
    peaks = loop.peaks if isinstance(loop, LoopResult) else None
    share = getattr(peaks, attribute) if isinstance(peaks, MotorPeaks) else math.nan
    return percent_text(share) if share > 0 else NONE


def inertias(design: MotorDesign, system: UnitSystem) -> Table:
    """What the hand moves, beside what is programmed."""
    felt = design.felt_inertia_n_m_s2_per_rad
    named = (
        ("Column", design.column_inertia_n_m_s2_per_rad),
        ("Rotor, through transmission and linkage", design.rotor_inertia_n_m_s2_per_rad),
        ("Both: what is felt by current alone", felt),
        ("Programmed", design.loader["feel.inertia"]),
    )
    rows = tuple(
        (words(name), number(value_text(value, INERTIA, system)), number(percent_text(value / felt)))
        for name, value in named
    )
    return Table(heads("About the column's pivot", heading_text("Inertia", INERTIA, system), "of both"), rows)


def swings(design: MotorDesign, system: UnitSystem) -> Table:
    """Current loop, and what swings on the link."""
    rows = tuple(
        (
            words(mode.name.capitalize()),
            number(value_text(mode.frequency_rad_per_s, HERTZ, system)),
            number(value_text(mode.damping_ratio, RATIO, system)),
        )
        for mode in design.modes
    )
    return Table(heads("Mode", heading_text("Frequency", HERTZ, system), "Damping ratio"), rows)


def margins(design: MotorDesign, system: UnitSystem) -> Table:
    """Margins by current alone and under the law, at both settings."""
    rows = []
    for setting, low in (("programmed", False), ("low", True)):
        for name, loop in _loops(design, low=low):
            cells = _alone(loop, system) if isinstance(loop, LoopResult) else _law(loop, system)
            end = number("stable" if loop.assessment.stable else "unstable", bad=not loop.assessment.stable)
            rows.append((words(f"{setting} setting"), Cell(configuration(name)), *map(number, cells), end))
    texts = (
        "Gain margin",
        heading_text("Phase margin", ANGLE, system),
        heading_text("Delay that it bears", MILLISECONDS, system),
        "Closed loop",
    )
    return Table((Cell("Loop"), Cell("Configuration"), *heads("", *texts)[1:]), tuple(rows))


def _alone(loop: LoopResult, system: UnitSystem) -> tuple[str, str, str]:
    margins = loop.margins
    return _gain(margins.gain_margin), _angle(margins.phase_margin_rad, system), _delay(delay_s(margins), system)


def _law(loop: LawLoop, system: UnitSystem) -> tuple[str, str, str]:
    margins = loop.margins
    down = f" or {number_text(margins.gain_down, 2)}" if margins.gain_down > 0 else ""
    return f"{_gain(margins.gain_up)}{down}", _angle(margins.phase_rad, system), _delay(margins.delay_s, system)


def _gain(value: float) -> str:
    return "∞" if value == math.inf else number_text(value, 3)


def _angle(value: float, system: UnitSystem) -> str:
    return "∞" if value == math.inf else value_text(value, ANGLE, system)


def _delay(value: float, system: UnitSystem) -> str:
    return "∞" if value == math.inf else value_text(value, MILLISECONDS, system)


def boundary(design: MotorDesign, system: UnitSystem) -> Table:
    """The largest stable stiffness by current alone."""
    highest = design.loader["feel.maximum_stiffness"]
    rows = []
    for link_configuration in design.configurations:
        value = link_configuration.boundary.stiffness_n_m_per_rad
        texts = (
            "∞" if value == math.inf else value_text(value, ROTARY_STIFFNESS, system),
            NONE if value == math.inf else number_text(value / highest, 3),
        )
        note = words(prose_html(link_configuration.boundary.note))
        rows.append((Cell(configuration(f"{link_configuration.name} link")), *map(number, texts), note))
    head = heads("Configuration", heading_text("Largest stable stiffness", ROTARY_STIFFNESS, system), "times G_max")
    return Table((*head[:2], Cell(prose_html("times G_max"), "number"), Cell("How stability is lost")), tuple(rows))


def modes(design: MotorDesign, system: UnitSystem, *, low: bool = False) -> Table:
    """The modes by current alone, with what moves in each, and under the law."""
    rows = [
        (
            Cell(configuration(name) if k == 0 else ""),
            words(mode.name if isinstance(mode, NamedMode) else NONE),
            number(pole(mode), bad=mode.real_per_s > MARGINAL_PER_S),
            *_swing(mode, system),
        )
        for name, loop in _loops(design, low=low)
        for k, mode in enumerate(loop.modes)
    ]
    numbers = heads("", "Pole, 1/s", heading_text("Frequency", HERTZ, system), "Damping ratio")[1:]
    return Table((Cell("Configuration"), Cell("Mode"), *numbers), tuple(rows))


def _swing(mode: Mode, system: UnitSystem) -> tuple[Cell, Cell]:
    frequency, ratio = (mode.frequency_rad_per_s, mode.damping_ratio) if moves(mode) else (0.0, math.nan)
    return number(value_text(frequency, HERTZ, system)), number(value_text(ratio, RATIO, system))
