"""Tables of what the loops do: margins, boundary of stability, modes."""

import math

from markupsafe import Markup

from forcefeel.design.page.glance import edge, smallest
from forcefeel.design.workflow import Design
from forcefeel.linear.frequency import Margins
from forcefeel.linear.modes import MARGINAL_PER_S, Mode, is_stable
from forcefeel.page.table import Cell, Table, Text, configuration, heads, number, words
from forcefeel.page.typography import NONE, heading_text, number_text, percent_text, prose_html, value_text
from forcefeel.units import ANGLE, HERTZ, RATIO, UnitSystem


def margins(design: Design, system: UnitSystem) -> Table:
    """Gain and phase margins of the servo and of the overall loop."""
    rows = []
    for servo in design.servos:
        stable = is_stable(max(mode.real_per_s for mode in servo.closed_modes))
        name = Markup("{} link").format(configuration(str(servo.linkage)))
        rows.append((words("Servo, position loop"), Cell(name), *_margins(servo.margins, system, stable=stable)))
    for setting in ("programmed", "low"):
        for loop_configuration in design.configurations:
            loop = loop_configuration.low if setting == "low" else loop_configuration.programmed
            cells = _margins(loop.margins, system, stable=loop.assessment.stable)
            rows.append(
                (words(f"Overall loop, {setting} setting"), Cell(configuration(loop_configuration.name)), *cells)
            )
    at_phase, at_gain = (heading_text(name, HERTZ, system) for name in ("at phase −180°", "at gain 1"))
    phase = heading_text("Phase margin", ANGLE, system)
    numbers = heads("", "Gain margin", at_phase, phase, at_gain, "Closed loop")[1:]
    return Table((Cell("Loop"), Cell("Configuration"), *numbers), tuple(rows))


def boundary(design: Design, system: UnitSystem) -> Table:
    """The smallest stable stiffness of each configuration."""
    rows = []
    for loop_configuration in design.configurations:
        share = loop_configuration.boundary.stiffness_n_m_per_rad / design.loader["feel.stiffness"]
        rows.append(
            (
                Cell(configuration(loop_configuration.name)),
                number(edge(loop_configuration.boundary, system)),
                number(percent_text(share) if share > 0 else NONE),
                words(prose_html(loop_configuration.boundary.note)),
            )
        )
    head = heads("Configuration", smallest(system), "of the programmed")
    return Table((*head, Cell("How stability is lost")), tuple(rows))


def modes(design: Design, system: UnitSystem, *, low: bool = False) -> Table:
    """The modes of the three configurations."""
    groups: list[tuple[Text, tuple[Mode, ...]]] = [
        (
            configuration(loop_configuration.name),
            (loop_configuration.low if low else loop_configuration.programmed).modes,
        )
        for loop_configuration in design.configurations
    ]
    return _modes(groups, system)


def servo_modes(design: Design, system: UnitSystem) -> Table:
    """The modes of the servo, position loop open and closed."""
    groups: list[tuple[Text, tuple[Mode, ...]]] = [
        (f"{servo.linkage} link, loop {how}", loop_modes)
        for servo in design.servos
        for how, loop_modes in (("open", servo.open_modes), ("closed", servo.closed_modes))
    ]
    return _modes(groups, system)


def _modes(groups: list[tuple[Text, tuple[Mode, ...]]], system: UnitSystem) -> Table:
    rows = tuple(
        (
            Cell(name if mode is loop_modes[0] else ""),
            number(pole(mode), bad=mode.real_per_s > MARGINAL_PER_S),
            number(value_text(mode.frequency_rad_per_s if moves(mode) else 0.0, HERTZ, system)),
            number(value_text(mode.damping_ratio if moves(mode) else math.nan, RATIO, system)),
        )
        for name, loop_modes in groups
        for mode in loop_modes
    )
    return Table(heads("Configuration", "Pole, 1/s", heading_text("Frequency", HERTZ, system), "Damping ratio"), rows)


def pole(mode: Mode) -> str:
    """A pole or a pair of them in 1/s."""
    real = number_text(mode.real_per_s) if abs(mode.real_per_s) > MARGINAL_PER_S else "0"
    return f"{real} ± {number_text(mode.imaginary_per_s)} j" if mode.imaginary_per_s > 0 else real


def moves(mode: Mode) -> bool:
    """Whether it is more than an integrator, or rounding of one."""
    return mode.frequency_rad_per_s > MARGINAL_PER_S


def _margins(margins: Margins, system: UnitSystem, *, stable: bool) -> tuple[Cell, ...]:
    gain, phase = margins.gain_margin, margins.phase_margin_rad
    decibels = f" ({number_text(20 * math.log10(gain), 3)} dB)" if 0 < gain < math.inf else ""
    return (
        number("∞" if gain == math.inf else value_text(gain, RATIO, system) + decibels),
        number(value_text(margins.phase_crossover_rad_per_s, HERTZ, system)),
        number("∞" if phase == math.inf else value_text(phase, ANGLE, system)),
        number(value_text(margins.gain_crossover_rad_per_s, HERTZ, system)),
        number("stable" if stable else "unstable", bad=not stable),
    )
