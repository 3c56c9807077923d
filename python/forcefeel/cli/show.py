"""Results as tables for a terminal."""

from collections.abc import Callable
from math import isfinite

from rich.table import Table
from rich.text import Text

from forcefeel.cli.terminal import Terminal, titled
from forcefeel.design.analysis import Analysis
from forcefeel.design.assessment import AnyPeaks, Assessment, Peaks
from forcefeel.design.workflow import ServoAnalysis
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS, GainDesign
from forcefeel.linear.frequency import Margins
from forcefeel.linear.models import DESIGN_STATES
from forcefeel.linear.modes import Mode, least_damped
from forcefeel.loader.beyond_linear import left_out
from forcefeel.loader.loader import Loader
from forcefeel.reproduction import Section, Verdict, summary
from forcefeel.units import ANGLE, CURRENT, FLOW, HERTZ, ROTARY_STIFFNESS, UnitSystem, to_text

_COLOURS = {Verdict.AGREES: "green", Verdict.EXPLAINED: "yellow", Verdict.REFUTED: "yellow", Verdict.OPEN: "red"}


def analysis(console: Terminal, servo_analysis: ServoAnalysis, units: UnitSystem) -> None:
    """The original system."""
    frequency, ratio = hertz(servo_analysis.feel_frequency_rad_per_s), to_text(servo_analysis.feel_damping_ratio, 3)
    programmed = f"{frequency} Hz, damping ratio {ratio}"
    console.print(f"{servo_analysis.loader.name}: programmed feel {programmed}")
    for configuration in servo_analysis.configurations:
        console.show(_modes(f"Modes, {configuration.name} link", configuration.programmed.modes))
    servo = titled(
        "Servo, position loop closed", "link", "least damped mode", "damping ratio", "gain margin", "phase margin"
    )
    for result in servo_analysis.servos:
        mode = least_damped(result.closed_modes)
        servo.add_row(
            str(result.linkage),
            f"{hertz(mode.frequency_rad_per_s)} Hz",
            to_text(mode.damping_ratio, 3),
            *_margins(result.margins),
        )
    console.show(servo)
    loops = titled(
        "Overall loop, step of pilot force", "link, setting", "stable", "gain margin", "phase", "at rest", "r.m.s."
    )
    show_loops(console, loops, servo_analysis, _loop)
    show_boundary(console, "Stability as G falls, I and B scaled along", "smallest stable G", servo_analysis, units)
    _say_left_out(console, servo_analysis.loader)


def show_loops(
    console: Terminal,
    loops: Table,
    analysis: Analysis,
    columns: Callable[[Assessment, Margins], tuple[str | Text, ...]],
) -> None:
    """The steps of an analysis, a row for each link and setting."""
    for configuration in analysis.configurations:
        for setting, loop in (("programmed", configuration.programmed), ("low", configuration.low)):
            loops.add_row(f"{configuration.name}, {setting}", *columns(loop.assessment, loop.margins))
    console.show(loops)
    console.print(
        "at rest: share of the programmed deflection; r.m.s.: deviation from the ideal over 2 s", highlight=False
    )


def show_boundary(console: Terminal, title: str, stiffness: str, analysis: Analysis, units: UnitSystem) -> None:
    """Where an analysis finds the edge of stability, a row for each link."""
    edge = titled(title, "link", f"{stiffness}, {ROTARY_STIFFNESS.shown(units)}", "")
    for configuration in analysis.configurations:
        found_at = ROTARY_STIFFNESS.from_si(configuration.boundary.stiffness_n_m_per_rad, units)
        edge.add_row(configuration.name, to_text(found_at), configuration.boundary.note)
    console.show(edge)


def compensation(
    console: Terminal,
    loader: Loader,
    design: GainDesign,
    judged: Assessment,
    demand: AnyPeaks | None,
    units: UnitSystem,
) -> None:
    """Gains and the loop that they close."""
    gains = titled("Feedback gains", "gain", "on", "value", "unit")
    for symbol, state, value, unit in zip(GAIN_SYMBOLS, DESIGN_STATES, design.gains, GAIN_UNITS, strict=True):
        gains.add_row(symbol, state_text(state), to_text(unit.from_si(float(value), units)), unit.shown(units))
    console.show(gains)
    console.print("c_7 is not fed back: the pilot's force is not measured.", highlight=False)
    console.print(f"recursion (22): {design.note}", style="" if design.reached else "bold red", highlight=False)
    residual = (
        f"residual of eqs. (22) at these gains over an infinite horizon: {design.riccati_residual:.1e}"
        if isfinite(design.riccati_residual)
        else "residual of eqs. (22): none, because a state does not decay under these gains"
    )
    console.print(residual)
    _say_left_out(console, loader)
    if not isinstance(demand, Peaks):
        console.print("the loop with these gains is unstable", style="bold red")
        return
    loop = titled("Loop closed on the compliant model with valve dynamics, step of pilot force", "quantity", "value")
    for name, value in _closed_loop(judged, demand, units):
        loop.add_row(name, value)
    console.show(loop)


def _say_left_out(console: Terminal, loader: Loader) -> None:
    """What the linear models do not have of a loader."""
    if text := left_out(loader):
        console.print(text, highlight=False)


def reproduction(console: Terminal, sections: tuple[Section, ...]) -> None:
    """The comparison with the 1974 report."""
    console.print(summary(sections), style="bold", highlight=False)
    for section in sections:
        table = titled(section.title, "item", "printed", "computed", "unit", "verdict")
        for row in section.rows:
            item = f"{row.item} ({row.where})"
            table.add_row(item, row.printed, row.computed, row.unit, Text(row.verdict, _COLOURS[row.verdict]))
        console.show(table)
        for row in section.rows:
            if row.reason:
                console.print(f"- {row.item}: {row.reason}", style="dim", highlight=False)


def state_text(state: str) -> str:
    """A state's name without its unit: ``piston_position_m`` is ``piston position``."""
    words = state.removesuffix("_per_s")
    return words.rsplit("_", 1)[0].replace("_", " ")


def _modes(title: str, modes: tuple[Mode, ...]) -> Table:
    table = titled(title, "frequency, Hz", "damping ratio", "pole, 1/s")
    for mode in modes:
        swing = f" ± {to_text(mode.imaginary_per_s)}j" if mode.imaginary_per_s > 0 else ""
        table.add_row(hertz(mode.frequency_rad_per_s), to_text(mode.damping_ratio, 3), to_text(mode.real_per_s) + swing)
    return table


def _loop(assessment: Assessment, loop_margins: Margins) -> tuple[str | Text, ...]:
    if not assessment.stable:
        return Text("no", "red"), *_margins(loop_margins), "-", "-"
    return (
        "yes",
        *_margins(loop_margins),
        _percent(1 + assessment.static_error, ".3g"),
        f"{100 * assessment.tracking_error:.3g} %",
    )


def _closed_loop(judged: Assessment, demand: Peaks, units: UnitSystem) -> list[tuple[str, str]]:
    angle = to_text(ANGLE.from_si(judged.static_angle_rad, units))
    current, flow = (CURRENT.from_si(demand.current_a, units), FLOW.from_si(demand.flow_m3_per_s, units))
    return [
        ("frequency", f"{hertz(judged.frequency_rad_per_s)} Hz"),
        ("damping ratio", to_text(judged.damping_ratio, 3)),
        ("least damping ratio of any mode", to_text(judged.least_damping_ratio, 3)),
        (
            "deflection at rest",
            f"{angle} {ANGLE.shown(units)}, {_percent(judged.static_error, '+.2g')} off the programmed",
        ),
        ("deviation from the ideal over 2 s (r.m.s.)", f"{100 * judged.tracking_error:.3g} % of the deflection"),
        ("cost index V over 2 s", to_text(judged.cost)),
        (
            "peak valve current",
            f"{to_text(current, 3)} {CURRENT.shown(units)}, {100 * demand.current_share:.3g} % of rated",
        ),
        ("peak flow", f"{to_text(flow, 3)} {FLOW.shown(units)}, {100 * demand.flow_share:.3g} % of rated"),
    ]


def _margins(margins: Margins) -> tuple[str, str]:
    gain = to_text(margins.gain_margin, 3)
    phase = to_text(ANGLE.from_si(margins.phase_margin_rad, UnitSystem.SI), 3)
    return gain, phase if phase == "infinite" else f"{phase} deg"


def _percent(share: float, digits: str) -> str:
    return f"{100 * share:{digits}} %" if isfinite(share) else to_text(share)


def hertz(frequency_rad_per_s: float) -> str:
    """A frequency as a number of Hz."""
    return to_text(HERTZ.from_si(frequency_rad_per_s, UnitSystem.SI))
