"""The analysis of an electric loader as tables for a terminal."""

from rich.table import Table
from rich.text import Text

from forcefeel.cli.show import hertz, show_boundary, show_loops, titled
from forcefeel.cli.terminal import Terminal
from forcefeel.design.assessment import Assessment
from forcefeel.design.motor import MotorAnalysis
from forcefeel.design.motor_findings import MILLISECONDS, NO_REPORT, delay_s, plant_lines
from forcefeel.linear.electric_modes import NamedMode
from forcefeel.linear.frequency import Margins
from forcefeel.linear.modes import Mode
from forcefeel.loader.beyond_linear import left_out
from forcefeel.units import ANGLE, PERCENT, UnitSystem, to_text


def motor_analysis(console: Terminal, found: MotorAnalysis, units: UnitSystem) -> None:
    """A motor without a law."""
    programmed = f"{hertz(found.feel_frequency_rad_per_s)} Hz, damping ratio {to_text(found.feel_damping_ratio, 3)}"
    console.print(f"{found.loader.name}: programmed feel {programmed}")
    console.show(_modes("Motor, link and column without a feel", found.modes))
    for one in found.configurations:
        console.show(_modes(f"Modes by current alone, {one.name} link", one.programmed.modes))
    loops = titled(
        "By current alone, step of pilot force",
        "link, setting",
        "stable",
        "phase margin",
        "delay it bears",
        "at rest",
        "r.m.s.",
    )
    show_loops(console, loops, found, _loop)
    title = "Stability as G grows, I and B scaled along, under the controller"
    show_boundary(console, title, "largest stable G", found, units)
    for line in filter(None, (*plant_lines(found, units), NO_REPORT, left_out(found.loader))):
        console.print(f"- {line}", highlight=False)


def _modes(title: str, found: tuple[Mode, ...]) -> Table:
    table = titled(title, "what moves", "frequency, Hz", "damping ratio")
    for mode in found:
        name = mode.name if isinstance(mode, NamedMode) else ""
        table.add_row(name, hertz(mode.frequency_rad_per_s), to_text(mode.damping_ratio, 3))
    return table


def _loop(found: Assessment, margins: Margins) -> tuple[str | Text, ...]:
    borne = to_text(MILLISECONDS.from_si(delay_s(margins), UnitSystem.SI), 3)
    phase = f"{to_text(ANGLE.from_si(margins.phase_margin_rad, UnitSystem.SI), 3)} deg"
    if not found.stable:
        return Text("no", "red"), phase, f"{borne} ms", "-", "-"
    shares = (PERCENT.from_si(share, UnitSystem.SI) for share in (1 + found.static_error, found.tracking_error))
    return "yes", phase, f"{borne} ms", *(f"{to_text(share, 3)} %" for share in shares)
