"""The analysis of an electric loader as tables for a terminal."""

from rich.table import Table
from rich.text import Text

from forcefeel.cli.show import hertz, show_boundary, show_loops
from forcefeel.cli.terminal import Terminal, titled
from forcefeel.design.assessment import Assessment
from forcefeel.design.motor import MotorAnalysis
from forcefeel.design.motor_findings import MILLISECONDS, NO_REPORT, delay_s, plant_lines
from forcefeel.linear.electric_modes import NamedMode
from forcefeel.linear.frequency import Margins
from forcefeel.linear.modes import Mode
from forcefeel.loader.beyond_linear import left_out
from forcefeel.units import ANGLE, PERCENT, UnitSystem, to_text


def motor_analysis(console: Terminal, motor: MotorAnalysis, units: UnitSystem) -> None:
    """A motor without a law."""
    programmed = f"{hertz(motor.feel_frequency_rad_per_s)} Hz, damping ratio {to_text(motor.feel_damping_ratio, 3)}"
    console.print(f"{motor.loader.name}: programmed feel {programmed}")
    console.show(_modes("Motor, link and column without a feel", motor.modes))
    for configuration in motor.configurations:
        console.show(_modes(f"Modes by current alone, {configuration.name} link", configuration.programmed.modes))
    loops = titled(
        "By current alone, step of pilot force",
        "link, setting",
        "stable",
        "phase margin",
        "delay it bears",
        "at rest",
        "r.m.s.",
    )
    show_loops(console, loops, motor, _loop)
    title = "Stability as G grows, I and B scaled along, under the controller"
    show_boundary(console, title, "largest stable G", motor, units)
    for line in filter(None, (*plant_lines(motor, units), NO_REPORT, left_out(motor.loader))):
        console.print(f"- {line}", highlight=False)


def _modes(title: str, modes: tuple[Mode, ...]) -> Table:
    table = titled(title, "what moves", "frequency, Hz", "damping ratio")
    for mode in modes:
        name = mode.name if isinstance(mode, NamedMode) else ""
        table.add_row(name, hertz(mode.frequency_rad_per_s), to_text(mode.damping_ratio, 3))
    return table


def _loop(assessment: Assessment, margins: Margins) -> tuple[str | Text, ...]:
    borne = to_text(MILLISECONDS.from_si(delay_s(margins), UnitSystem.SI), 3)
    phase = f"{to_text(ANGLE.from_si(margins.phase_margin_rad, UnitSystem.SI), 3)} deg"
    if not assessment.stable:
        return Text("no", "red"), phase, f"{borne} ms", "-", "-"
    shares = (
        PERCENT.from_si(share, UnitSystem.SI) for share in (1 + assessment.static_error, assessment.tracking_error)
    )
    return "yes", phase, f"{borne} ms", *(f"{to_text(share, 3)} %" for share in shares)
