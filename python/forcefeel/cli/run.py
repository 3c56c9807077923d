"""``forcefeel run``."""

import sys
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from math import isfinite, pi
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Group

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.law_option import chosen_law
from forcefeel.cli.options import (
    OUTPUT,
    FolderOptions,
    LawOption,
    LoaderOptions,
    LoaderOrProject,
    OutputOptions,
    SoftenOption,
    option,
)
from forcefeel.cli.scenario_text import seconds, size, speed_and_altitude, value
from forcefeel.cli.stop_signals import stop_signals
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from forcefeel.fly import LiveFlight
    from forcefeel.live import Histogram, LiveCockpit, LiveSession, Udp
    from forcefeel.loader.bus import Bus
    from forcefeel.loader.loader import Loader
    from forcefeel.units import UnitSystem

LIVE = Group("Live run", sort_key=10)
CONSOLE = Group("Console", sort_key=20)

RECORD, PREVIOUS = "record.mcap", "record-previous.mcap"


@dataclass(frozen=True, kw_only=True)
class RunOptions(LoaderOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel run``."""

    law: LawOption = None
    soften: SoftenOption = False
    machine: Annotated[
        str | None,
        option(
            "Machine over the network, such as 127.0.0.1:5005, or bus: the drive of the file's table [bus]. Of a project "
            "pitch=127.0.0.1:5005 or pitch=bus, with commas between axes, or bus for all.",
            LIVE,
            default="simulated",
            metavar="MACHINE",
        ),
    ] = None
    host: Annotated[
        str | None,
        option(
            "UDP port for an aircraft simulator on this machine, or address:port such as 0.0.0.0:8732.",
            LIVE,
            default="no simulator",
            metavar="PORT",
        ),
    ] = None
    aircraft: Annotated[
        str | None,
        option(
            "Fly an aircraft of JSBSim as the simulator: 737, T38, c172p, f16, or a TOML file with data of its controls. Its feel "
            "and surface replace the loader's; the console shows the flight, trim and throttle.",
            LIVE,
            default="none",
            metavar="NAME|FILE",
        ),
    ] = None
    speed: Annotated[
        str | None,
        option("Calibrated airspeed of the trimmed flight.", LIVE, default="the aircraft's", metavar="SPEED"),
    ] = None
    altitude: Annotated[
        str | None, option("Altitude of the trimmed flight.", LIVE, default="the aircraft's", metavar="LENGTH")
    ] = None
    duration: Annotated[
        str | None, option("Duration, such as '10 s'.", LIVE, default="until Ctrl-C", metavar="TIME")
    ] = None
    headless: Annotated[bool, option("Run without the browser console and switch the law on at once.", LIVE)] = False
    port: Annotated[int, option("Port of the console; 0 for any free port.", CONSOLE)] = 8731
    bind: Annotated[
        str, option("Address of the console. The default is reachable from this machine only.", CONSOLE)
    ] = "127.0.0.1"
    no_token: Annotated[
        bool, option("Start the console without a token: every user of this machine can move the column.", CONSOLE)
    ] = False
    out: Annotated[Path | None, option(f"Folder for {RECORD}, a record of all inputs and outputs.", OUTPUT)] = None
    record_rate: Annotated[
        str | None,
        option(
            "Rows per second: the loop's rate divided by a whole number.", OUTPUT, default="every cycle", metavar="RATE"
        ),
    ] = None
    max_size: Annotated[
        str | None,
        option(
            f"Drop the oldest rows at this size, such as '200 MB': {RECORD} has the newest rows, {PREVIOUS} the previous "
            "ones.",
            OUTPUT,
            default="the record ends at 1 GiB",
            metavar="SIZE",
        ),
    ] = None


def run(path: LoaderOrProject = None, /, *, options: RunOptions = RunOptions()) -> None:
    """Run the loader live: a real-time loop on a machine, simulated or over the network. Of a project, run all axes in one loop.

    Prints the address of the console, a page of this machine. The first client that opens it has control. Ctrl-C or SIGTERM fades
    out the feel and stops the loop. The loop has its own thread and the period of the loader's controller. A Linux process is no
    safety function: wire an emergency stop that cuts the drive's power. Exit status 1 if the loader tripped, the drive reports a
    fault, the record ended before the run, for example on a full disk, or the loader refused the flight of --aircraft.

    Example: forcefeel run elevator-2khz --law robust --out run
    """
    from forcefeel.live import LiveSession, Simulated, start, start_cockpit
    from forcefeel.live.starting import MOST_RECORD_BYTES

    lasts = float("inf") if options.duration is None else seconds("--duration", options.duration)
    if not lasts > 0:
        raise InputError(f"--duration: expected a time above 0, got {options.duration}")
    rate = None if options.record_rate is None else value("--record-rate", options.record_rate, "rad/s", "100 Hz")
    most_bytes = MOST_RECORD_BYTES if options.max_size is None else size("--max-size", options.max_size)
    project = options.project(path, aircraft=options.aircraft)
    loaders = {"": options.loader(path)} if project is None else dict(project.loaders)
    flight = _flight(options, loaders)
    laws = {axis: chosen_law(options.law, loader) for axis, loader in loaders.items()}
    record = None if options.out is None else _record(options.out, replace=options.replace)
    given: dict[str, Any] = {
        "host": options.host if flight is None else 0,
        "soften": options.soften,
        "record": record,
        "record_rate_hz": None if rate is None else rate / (2 * pi),
        "most_bytes": most_bytes,
        "ring": options.max_size is not None,
        "expected_s": lasts,
    }
    if project is not None:
        running: LiveSession | LiveCockpit = start_cockpit(
            project, laws, endpoints=_machines(options.machine, project.loaders), **given
        )
    else:
        endpoint = Simulated() if options.machine is None else _machine(options.machine, loaders[""])
        running = start(loaders[""], laws[""], endpoint=endpoint, **given)
    axes = {"": running} if isinstance(running, LiveSession) else dict(running)
    for axis, session in axes.items():
        if softened := _softened(session, options.units):
            _tell(f"{axis}: {softened}" if axis else softened)
    with running, stop_signals() as ended, _flown(flight, running), _console(running, axes, options):
        _wait(next(iter(axes.values())), lasts, ended)
        running.off()
        time.sleep(_OFF_S)
    answer(
        {} if record is None else {"record": record, **_previous(record)},
        lambda: (
            _json(axes[""], options.units, flight)
            if project is None
            else _cockpit_json(project.name, axes, options.units)
        ),
        lambda terminal: _show(terminal, axes, options.units, flight),
        as_json=options.json,
    )
    refused = flight is not None and flight.report.refused
    states = [session.state for session in axes.values()]
    if refused or any(state.trips or state.drive_fault or state.record_ended for state in states):
        raise SystemExit(BAD_ANSWER)


def _flight(options: RunOptions, loaders: "dict[str, Loader]") -> "LiveFlight | None":
    """The aircraft that is flown as the simulator; the one loader takes its surface and feel.

    Raises:
        InputError: If an option does not go with another, or the aircraft does not trim.
    """
    if options.aircraft is None:
        for name, text in (("--speed", options.speed), ("--altitude", options.altitude)):
            if text is not None:
                raise InputError(f"{name}: requires --aircraft; remove {name} or name an aircraft")
        return None
    if options.host is not None:
        raise InputError("--host: --aircraft is the simulator; leave one out")
    from forcefeel.fly import FlightCase, LiveFlight

    case = FlightCase.of(loaders[""], options.aircraft, *speed_and_altitude(options.speed, options.altitude))
    loaders[""] = case.feel
    return LiveFlight(case.at)


@contextmanager
def _flown(flight: "LiveFlight | None", running: "LiveSession | LiveCockpit") -> Iterator[None]:
    """The flight beside the loop, where there is one; what JSBSim prints is left out."""
    from forcefeel.live import LiveSession

    if flight is None or not isinstance(running, LiveSession):
        yield
        return
    from forcefeel.fly import fly_live
    from forcefeel.fly.aircraft import silent

    with silent(), fly_live(running, flight):
        yield


BUS = "bus"


def _machine(given: str, loader: "Loader") -> "Udp | Bus":
    """The machine at an address, or on the loader's bus.

    Raises:
        InputError: If the address is invalid, or the loader has no bus.
    """
    from forcefeel.live import Udp

    if given != BUS:
        return Udp(given)
    if loader.bus is None:
        raise InputError(f"--machine: {loader.name} has no table [bus]; add it to its file, as in docs/how-to/bus.md")
    return loader.bus


def _machines(given: str | None, loaders: "Mapping[str, Loader]") -> "dict[str, Udp | Bus]":
    """The machines of a project's axes.

    Raises:
        InputError: If an axis or an address is missing.
    """
    if given == BUS:
        return {axis: _machine(BUS, loader) for axis, loader in loaders.items()}
    machines: dict[str, Udp | Bus] = {}
    for text in [] if given is None else given.split(","):
        axis, equals, address = text.strip().partition("=")
        if not equals:
            raise InputError(
                f"--machine: expected an axis and its address, such as pitch=127.0.0.1:5005, or bus for all, got {text.strip()}"
            )
        if axis not in loaders:
            raise InputError(f"--machine: expected an axis out of {', '.join(loaders)}, got {axis}")
        machines[axis] = _machine(address, loaders[axis])
    return machines


_OFF_S = 0.3
"""Time for the supervisor to take the feel away."""

_LOOK_S = 0.05


@contextmanager
def _console(
    running: "LiveSession | LiveCockpit", axes: "dict[str, LiveSession]", options: RunOptions
) -> Iterator[None]:
    """The console, where it is wanted; without one the law is switched on here.

    Raises:
        InputError: If it cannot listen there.
    """
    if options.headless:
        running.wait(1)
        running.on()
        yield
        return
    from forcefeel.live.console.listener import Listener
    from forcefeel.live.console.process import ConsoleProcess
    from forcefeel.qualification.plan.run import QualificationSetup

    door = Listener.at(options.port, options.bind, token=not options.no_token)
    with ConsoleProcess(axes, door, QualificationSetup(system=options.units), _tell):
        _tell(f"console: {door.address}")
        if not options.no_token:
            _tell(f"to look on and stop: {door.watch_address}")
        yield


def _tell(sentence: str) -> None:
    # Not to the output, which --json leaves to the result; at once, since whoever waits for it opens it.
    print(sentence, file=sys.stderr, flush=True)


def _wait(running: "LiveSession", lasts_s: float, end_event: threading.Event) -> None:
    end, ended = time.monotonic() + lasts_s, ""
    while (left := end - time.monotonic()) > 0 and not running.state.ended and not end_event.wait(min(left, _LOOK_S)):
        if (why := running.state.record_ended) != ended:
            _tell(f"the record has ended, and the loop goes on: {why}")
            ended = why


def _record(out: Path, *, replace: bool) -> Path:
    """Where the record goes.

    Raises:
        InputError: If it cannot be there, or is there and not to be replaced.
    """
    from forcefeel.files import make_folder
    from forcefeel.page.folder import OutputFolder

    OutputFolder("the run", (RECORD, PREVIOUS), plots=False).check(out, replace=replace)
    make_folder(out)
    return out / RECORD


def _previous(record: Path) -> dict[str, Path]:
    """The older part of a ring, if there is one."""
    previous = record.with_name(PREVIOUS)
    return {"previous_record": previous} if previous.exists() else {}


def _softened(running: "LiveSession", units: "UnitSystem") -> str:
    """What became of the feel; empty if it is as programmed."""
    return running.softened.sentence(units) if running.softened else ""


def _json(running: "LiveSession", units: "UnitSystem", flight: "LiveFlight | None" = None) -> dict[str, object]:
    from forcefeel.live.state import QUANTILE_ERROR

    state, timing = running.state, running.timing
    of = {"late_us": timing.late, "work_us": timing.work}
    return {
        "loader": running.loader.name,
        "law": running.law.name,
        "cycles": state.cycle,
        "period_s": running.period_s,
        "missed": state.missed,
        "cycles_without_sample": state.silent,
        "rows_lost": state.lost_rows + state.unrecorded_rows,
        "record_ended": state.record_ended or None,
        **({} if running.host is None else {"host": asdict(running.host)}),
        **({} if flight is None else {"flight_refused": flight.report.refused}),
        "trips": [trip.name for trip in running.trips],
        "drive_fault": state.drive_fault or None,
        **{
            name: {key: value if isfinite(value) else None for key, value in _quantiles(quantiles).items()}
            for name, quantiles in of.items()
        },
        "quantile_error": QUANTILE_ERROR,
        "realtime_status": list(running.realtime_status),
        "softened": running.softened and running.softened.as_json(units),
        "findings": _findings(running, units),
    }


def _cockpit_json(name: str, axes: "dict[str, LiveSession]", units: "UnitSystem") -> dict[str, object]:
    return {"project": name, "axes": {axis: _json(running, units) for axis, running in axes.items()}}


def _findings(running: "LiveSession", units: "UnitSystem") -> list[str]:
    remarks = (_softened(running, units), running.law.made_for_another(running.loader))
    return [remark for remark in remarks if remark]


def _quantiles(histogram: "Histogram") -> dict[str, float]:
    return {
        name: histogram.quantile_us(share)
        for name, share in (("p50", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("worst", 1.0))
    }


def _show(console: Terminal, axes: "dict[str, LiveSession]", units: "UnitSystem", flight: "LiveFlight | None") -> None:
    from forcefeel.live.state import QUANTILE_ERROR
    from forcefeel.units import to_text

    first = next(iter(axes.values()))
    for axis, running in axes.items():
        name = f"{axis}: {running.loader.name}" if axis else running.loader.name
        console.print(f"{name} under {running.law.name}, {1 / running.period_s:,.0f} Hz", highlight=False)
    table = titled(f"Timing, quantiles within +{QUANTILE_ERROR:.1%}", "", "p50", "p99", "p99.9", "worst")
    rows = {"thread woke late by": first.timing.late}
    rows |= {f"work of a cycle{axis and f', {axis}'}": running.timing.work for axis, running in axes.items()}
    for label, quantiles in rows.items():
        table.add_row(label, *(f"{to_text(value, 3)} us" for value in _quantiles(quantiles).values()))
    console.show(table)
    for line in first.realtime_status:
        console.print(f"- the loop's thread {line}" if line.startswith("runs") else f"- {line}", highlight=False)
    for axis, running in axes.items():
        _show_axis(console, f"{axis}: " if axis else "", running, units)
    if (host := first.host) is not None:
        packets_text = f"{host.packets:,} packets, {host.refused:,} left out"
        softened_text = f", {host.softened:,} softened to what the loader renders" if host.softened else ""
        console.print(f"- simulator at {host.listens}: {packets_text}{softened_text}", highlight=False)
    if flight is not None and flight.report.refused:
        refused = "the loader refused the flight: the law cannot render its spring or damping; take another law, speed or aircraft"
        console.print(f"- {refused}", style="bold red", highlight=False)
    if first.state.record_ended:
        console.print(
            f"- the record ended before the run: {first.state.record_ended}", style="bold red", highlight=False
        )


def _show_axis(console: Terminal, axis: str, running: "LiveSession", units: "UnitSystem") -> None:
    state = running.state
    for line in _findings(running, units):
        console.print(f"- {axis}{line}", highlight=False)
    counts = f"{state.cycle:,} cycles, {state.missed:,} missed, {state.silent:,} without a sample"
    console.print(f"- {axis}{counts}", highlight=False)
    if lost := state.lost_rows + state.unrecorded_rows:
        console.print(f"- {axis}{lost:,} rows were lost", highlight=False)
    for trip in running.trips:
        console.print(f"- {axis}tripped: {trip.name}. {trip.sentence}", style="bold red", highlight=False)
    if state.drive_fault:
        console.print(f"- {axis}drive: {state.drive_fault}", style="bold red", highlight=False)
