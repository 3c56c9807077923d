"""``forcefeel bridge``."""

import time
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group, Parameter

from forcefeel.bridge.simulator import Axis
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OutputOptions, option
from forcefeel.cli.scenario_text import seconds, value
from forcefeel.cli.stop_signals import stop_signals
from forcefeel.cli.terminal import Terminal, answer
from forcefeel.errors import InputError
from forcefeel.units import show

if TYPE_CHECKING:
    from forcefeel.bridge import BridgeReport, Simulator

BRIDGE = Group("Bridge", sort_key=10)


class SimulatorKind(StrEnum):
    """The simulators."""

    X_PLANE = "x-plane"
    TEXT = "text"


@dataclass(frozen=True, kw_only=True)
class BridgeOptions(OutputOptions):
    """The options of ``forcefeel bridge``."""

    loader: Annotated[
        str, option("Host port of the loader: the --host of forcefeel run.", BRIDGE, metavar="HOST:PORT")
    ] = "127.0.0.1:8732"
    at: Annotated[
        str | None,
        option(
            "Address of X-Plane, or the one at which lines of text arrive.",
            BRIDGE,
            default="127.0.0.1:49000 of x-plane, 127.0.0.1:49010 of text",
            metavar="HOST:PORT",
        ),
    ] = None
    answers: Annotated[
        str | None,
        option(
            "Address to which text answers, such as FlightGear's input socket.",
            BRIDGE,
            default="where the lines come from",
            metavar="HOST:PORT",
        ),
    ] = None
    axis: Annotated[Axis, option("Control of the loader.", BRIDGE)] = Axis.PITCH
    travel: Annotated[
        str, option("Angle of the column at which the aircraft's control is fully over.", BRIDGE, metavar="ANGLE")
    ] = "15 deg"
    tab_travel: Annotated[
        str, option("Angle of the trim tab at which the simulator's trim is at its end.", BRIDGE, metavar="ANGLE")
    ] = "20 deg"
    jam_force: Annotated[
        str, option("Force at the grip that breaks a jam of the simulator.", BRIDGE, metavar="FORCE")
    ] = "400 N"
    duration: Annotated[
        str | None, option("Duration, such as '10 s'.", BRIDGE, default="until Ctrl-C", metavar="TIME")
    ] = None


def run(
    simulator: Annotated[str, Parameter(help="x-plane or text.")], /, *, options: BridgeOptions = BridgeOptions()
) -> None:
    """Connect an aircraft simulator to a running loader: the flight to the loader, the column's angle to the aircraft.

    Start the loader with forcefeel run LOADER --host 8732. x-plane connects X-Plane 11 or 12 by its UDP interface; text
    takes lines of text over UDP from FlightGear's generic protocol or a script in DCS. The loader's surface has its hinge moment
    in that flight. Ctrl-C ends the bridge and gives the aircraft's control back. Exit status 1 if simulator or loader never
    answered, or the loader refused the last packet.

    Example: forcefeel bridge x-plane --loader 127.0.0.1:8732 --travel '15 deg'
    """
    from forcefeel.bridge import BridgeSettings, bridge

    lasts = float("inf") if options.duration is None else seconds("--duration", options.duration)
    settings = BridgeSettings(
        travel_rad=_positive("--travel", options.travel, "rad", "15 deg"),
        tab_rad=value("--tab-travel", options.tab_travel, "rad", "20 deg"),
        jam_n=_positive("--jam-force", options.jam_force, "N", "400 N"),
    )
    loader = _address("--loader", options.loader)
    kind = _kind(simulator)
    speaks = _simulator(kind, options)
    with stop_signals() as stopped:
        until = time.monotonic() + lasts
        report = bridge(speaks, loader, settings, lambda: stopped.is_set() or time.monotonic() >= until)
    answer({}, lambda: asdict(report), lambda terminal: _show(terminal, report, kind), as_json=options.json)
    if not report.states or not report.answers or report.refused:
        raise SystemExit(BAD_ANSWER)


def _kind(given: str) -> SimulatorKind:
    if given not in set(SimulatorKind):
        raise InputError(f"SIMULATOR: expected {' or '.join(SimulatorKind)}, got {show(given)}")
    return SimulatorKind(given)


def _simulator(kind: SimulatorKind, options: BridgeOptions) -> "Simulator":
    from forcefeel.bridge import Text, XPlane
    from forcefeel.bridge.text import PORT as TEXT_PORT
    from forcefeel.bridge.x_plane import PORT as X_PLANE_PORT

    if kind is SimulatorKind.X_PLANE:
        if options.answers is not None:
            raise InputError("--answers: X-Plane is answered at --at; leave it out")
        return XPlane(_address("--at", options.at or f"127.0.0.1:{X_PLANE_PORT}"), options.axis)
    at = options.at or f"127.0.0.1:{TEXT_PORT}"
    try:
        return Text(_address("--at", at), None if options.answers is None else _address("--answers", options.answers))
    except OSError as error:
        raise InputError(f"--at: cannot listen at {at} ({error.strerror}); take another port") from error


def _address(name: str, text: str) -> tuple[str, int]:
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise InputError(f"{name}: expected an address such as 127.0.0.1:8732, got {show(text)}")
    return host, int(port)


def _positive(name: str, text: str, unit: str, example: str) -> float:
    number = value(name, text, unit, example)
    if not number > 0:
        raise InputError(f"{name}: expected a value above 0, got {text}")
    return number


def _show(terminal: Terminal, report: "BridgeReport", simulator: SimulatorKind) -> None:
    if not report.states:
        terminal.print(f"{simulator}: no state came; is the simulator running, and is its address right?")
    elif not report.answers:
        terminal.print(f"{report.states} states went to the loader, and no answer came; is it running with --host?")
    else:
        terminal.print(
            f"{report.states} states went to the loader, {report.answers} answers came; the loader is {report.loader_state}, "
            f"the column at {report.angle_rad:.3g} rad"
        )
        if report.refused:
            terminal.print("The loader refused the last packet: it cannot render the spring or damping of this flight.")
