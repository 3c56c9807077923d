"""``forcefeel emulate``."""

import json
from dataclasses import dataclass, replace
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group

from forcefeel.cli.options import LoaderOptions, LoaderOrProject, OutputOptions, option
from forcefeel.cli.scenario_text import seconds
from forcefeel.cli.stop_signals import stop_signals
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from forcefeel.loader.loader import Loader

BUS = Group("Bus", sort_key=10)

_OBJECTS: dict[str, Any] = {
    "encoder_counts": 2.0**24,
    "column_counts": 2.0**24,
    "load_cell_object": "0x2100:1",
    "column_object": "0x60E4:1",
}
"""Encoders and objects of an emulated drive on EtherCAT."""

COLUMN_RANGE_RAD = radians(40.0)
"""Angle of a column at the end of its sensor's range."""

TERMINALS: dict[str, Any] = {
    "output_object": "0x7000:1",
    "load_cell_object": "0x6000:17",
    "position_object": "0x6010:17",
    "column_object": "0x6020:17",
}
"""Objects of a valve's terminals that no file states."""

_DIGITS = 4
"""Of the step of an input."""


@dataclass(frozen=True, kw_only=True)
class EmulateOptions(LoaderOptions, OutputOptions):
    """The options of ``forcefeel emulate``."""

    bus: Annotated[
        Literal["moteus", "odrive", "odrive-0.5", "ethercat", "ethercat-analog"] | None,
        option(
            "Kind of drive, for a loader without the table [bus]: with load cell and column encoder at the drive.",
            BUS,
            default="that of the file's table [bus]",
        ),
    ] = None
    port: Annotated[
        Path | None,
        option(
            "Path of a link to the port, for the loader file. On EtherCAT: network interface on which the drive answers.",
            BUS,
            default="a pseudo terminal of the system's name",
        ),
    ] = None
    power_time: Annotated[
        str | None,
        option(
            "Time that each drive takes to act once it is enabled, such as '0.8 s'; a valve's amplifier acts at once.",
            BUS,
            default="0 s",
            metavar="TIME",
        ),
    ] = None
    duration: Annotated[
        str | None, option("Duration, such as '10 s'.", BUS, default="until Ctrl-C", metavar="TIME")
    ] = None


def run(path: LoaderOrProject = None, /, *, options: EmulateOptions = EmulateOptions()) -> None:
    """Run a loader's simulated machine behind its drive's bus: a serial port that any client of the drive opens.

    Prints the port, then the table [bus] of each loader, and the rows of its file that state finer sensors than the inputs of a
    terminal. forcefeel run --machine bus and any client of the drive open it.
    A moteus is behind an fdcanusb adapter, for moteus_tool and the Python package moteus; an ODrive behind an slcan adapter, for
    python-can with interface="slcan"; a drive on EtherCAT at a network interface, for any master. All axes of a project are on one
    bus.

    Example: forcefeel emulate desktop-yoke --bus moteus --port yoke-bus
    """
    from forcefeel.live import BusEmulator

    lasts = float("inf") if options.duration is None else seconds("--duration", options.duration)
    power_s = 0.0 if options.power_time is None else seconds("--power-time", options.power_time)
    if not power_s >= 0:
        raise InputError(f"--power-time: expected a time of 0 s or more, got {options.power_time}")
    project = options.project(path)
    loaders = {"": options.loader(path)} if project is None else dict(project.loaders)
    wired = [_on_bus(loader, options, node) for node, loader in enumerate(loaders.values(), 1)]
    with stop_signals() as stopped, BusEmulator(wired, power_s=power_s) as emulator:
        link = None if _on_ethercat(wired) else options.port
        port = emulator.port if link is None else _link(link, emulator.port)
        try:
            _show(wired, port, options)
            stopped.wait(None if lasts == float("inf") else lasts)
        finally:
            if link is not None:
                link.unlink(missing_ok=True)


def _show(loaders: "list[Loader]", port: str, options: EmulateOptions) -> None:
    """Prints the port and the tables at once: others wait for them."""
    from forcefeel.live.bus import bus_of, coarser_inputs
    from forcefeel.loader.bus import write
    from forcefeel.loader.parameters import TABLE, with_unit

    rows = {
        loader.name: {
            row: with_unit(TABLE[row], step, options.units, _DIGITS)
            for row, step in coarser_inputs(bus_of(loader), loader).items()
        }
        for loader in loaders
    }
    tables = {
        loader.name: [
            line.split("  #")[0].rstrip()
            for line in write(loader.bus and replace(loader.bus, port=port), options.units)
            if not line.startswith("# ")
        ]
        for loader in loaders
    }
    if options.json:
        print(json.dumps({"port": port, "buses": tables, "rows": rows}), flush=True)
        return
    print(f"port: {port}", flush=True)
    for name, lines in tables.items():
        print(f"\n# {name}")
        if rows[name]:
            print("# Replace these rows of its file: the inputs are coarser than its sensors.")
        for row, stated in rows[name].items():
            part, _, key = row.partition(".")
            print(f'[{part}]\n{key} = "{stated}"')
        print(*lines, sep="\n", flush=True)


def _on_ethercat(loaders: "list[Loader]") -> bool:
    from forcefeel.loader.bus import ANALOG, ETHERCAT

    return any(loader.bus is not None and loader.bus.kind in {ETHERCAT, ANALOG} for loader in loaders)


def ethercat_drive(loader: "Loader") -> dict[str, Any]:
    """Settings ``[bus]`` of an emulated EtherCAT drive for a loader: rated torque, encoders and objects."""
    largest = loader["motor.torque_constant"] * loader["current_loop.current_limit"]
    return {"rated_torque_n_m": largest, **_OBJECTS}


def _on_bus(loader: "Loader", options: EmulateOptions, node: int) -> "Loader":
    """A loader with a bus: its own, or that which is asked for; on EtherCAT at the interface of the option.

    Raises:
        InputError: If EtherCAT has no interface.
    """
    from forcefeel.loader.bus import ANALOG, ETHERCAT, Bus, check_drive

    bus = loader.bus
    if options.bus is not None and bus is None:
        check_drive(options.bus, loader.drive)
        wiring: dict[str, Any] = {"column_gear": 1.0}
        if options.bus == ETHERCAT:
            wiring |= ethercat_drive(loader)
        if options.bus == ANALOG:
            ranges = {
                "output_v": 10.0,
                "position_m": loader["safety.position_range"],
                "column_range_rad": COLUMN_RANGE_RAD,
            }
            # Two terminals a loader.
            node, wiring = 2 * node - 1, {"input_node": 2 * node, **ranges, **TERMINALS}
        bus = Bus(options.bus, "pty", node, load_cell_n=loader["safety.force_range"], **wiring)
    if bus is not None and bus.kind in {ETHERCAT, ANALOG}:
        if options.port is None:
            raise InputError("--port: required for EtherCAT; add the network interface on which the drive answers")
        bus = replace(bus, port=str(options.port))
    return replace(loader, bus=bus)


def _link(link: Path, port: str) -> str:
    """A link to the port; one that an emulator left is replaced.

    Raises:
        InputError: If there is something else.
    """
    if link.is_symlink() and str(link.readlink()).startswith("/dev/"):
        link.unlink()
    try:
        link.symlink_to(port)
    except OSError as error:
        raise InputError(f"--port: cannot make a link at {link}: {error.strerror}; name another path") from error
    return str(link.absolute())
