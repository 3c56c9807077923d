"""Drives on a bus: what a loop needs of them, and machines emulated behind one."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import Literal, get_args

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.analog.gains import FixedGains
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.torque_mode import TORQUE_MODE
from forcefeel.live.ending import EndsWithBlock
from forcefeel.live.setup import live_law, made_of, script_of
from forcefeel.loader.bus import ANALOG, ETHERCAT, UDP, Bus, check_drive
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.loader.sensors import sensors_of
from forcefeel.simulation.scenario import Scenario
from forcefeel.units import show, to_text

WireFault = Literal["lost", "late", "repeated", "corrupt", "gone", "bus_off", "miscounted"]
WIRE_FAULTS = get_args(WireFault)

_DRIVE_S = 1 / 30_000
"""Time after which a drive reads its sensors anew, s: a moteus's own loop has 30 kHz."""

_ALMOST = 0.99
"""Share of an input's step that a file must state: of numbers with a few digits."""


def bus_of(loader: Loader) -> Bus:
    """The bus of a loader's drive.

    Raises:
        InputError: If it has none.
    """
    bus = loader.bus
    if bus is None or bus.kind == UDP:
        raise InputError(
            f"{loader.name}: expected a drive on a bus; add the table [bus] with kind, port and node to its file"
        )
    return bus


def check_bus(bus: Bus, loader: Loader, law: Law) -> None:
    """Check that a law can run with the sensors of a bus, and the loader with its delay.

    Raises:
        InputError: If the law needs what the bus does not sense, the bus is for another drive or coarser than the loader states, or
            the delay is shorter than a period.
    """
    if bus.kind == UDP:
        return
    check_drive(bus.kind, loader.drive)
    if isinstance(law.numbers, FixedGains):
        raise InputError(f"law: {law.name} requires the pilot's force, which a bus does not sense; use robust")
    if not bus.senses and law.name != TORQUE_MODE:
        raise InputError(
            f"law: {law.name} requires a load cell and an encoder at the column, and [bus] has none; use {TORQUE_MODE}, or add "
            "load_cell and column_gear"
        )
    if coarser := coarser_inputs(bus, loader):
        rows = ", ".join(f"{row} = {to_text(step, 4)} {TABLE[row].unit_si}" for row, step in coarser.items())
        raise InputError(f"the inputs of [bus] are coarser than the loader's sensors, and a law must know; set {rows}")
    period, delay = loader["controller.period"], loader["controller.delay"]
    if delay < period * (1 - 1e-9):
        raise InputError(
            f"controller.delay: a bus answers a period later: expected at least {1e3 * period:g} ms, got {1e3 * delay:g} ms; "
            "change it in the loader file"
        )


def coarser_inputs(bus: Bus, loader: Loader) -> dict[str, float]:
    """Rows of a loader that state finer sensors than the inputs of a bus, with the steps of these, SI."""
    sensed = {f"{sensor}.resolution" for sensor in sensors_of(loader)}
    return {row: step for row, step in bus.resolution.items() if row in sensed and loader[row] < _ALMOST * step}


class BusEmulator(EndsWithBlock):
    """Machines of loaders as nodes of one bus, behind a pseudo terminal that any client opens, or on a network interface.

    Args:
        loaders: The loaders, each with a ``bus`` whose node is its own. Its port is used on EtherCAT only: the interface on which
            the slaves answer, in this order; of ``ethercat-analog`` output and inputs of each loader.
        scenario: Inputs of their machines, as in a simulation.
        real_time: Whether the machines go on by the clock. Otherwise each takes a period at a command for its node, for a loop in
            virtual time.
        power_s: Time that each drive takes to act once it is enabled, s; a valve's amplifier acts at once.

    Raises:
        InputError: If a loader has no bus for its drive or no digital controller; if two have one node; if ``power_s`` is no
            time; if the pseudo terminal or the interface cannot be opened.

    Example:
        >>> from dataclasses import replace
        >>> yoke = ff.loader.electric("desktop-yoke")
        >>> yoke = replace(yoke, bus=ff.loader.Bus("moteus", "pty", load_cell_n=400.0, column_gear=1.0))
        >>> with ff.live.BusEmulator([yoke], real_time=False) as emulator:
        ...     bus = replace(yoke.bus, port=emulator.port)
        ...     with ff.live.start(yoke, "robust", endpoint=bus, real_time=False) as running:
        ...         running.on()
        ...         running.wait(3000)
        ...         running.state.name
        'active'
    """

    def __init__(
        self,
        loaders: Sequence[Loader],
        *,
        scenario: Scenario | None = None,
        real_time: bool = True,
        power_s: float = 0.0,
    ) -> None:
        if not (power_s >= 0 and isfinite(power_s)):
            raise InputError(f"power_s: expected a time of 0 s or more, got {show(power_s)}")
        nodes = []
        for loader in loaders:
            bus = bus_of(loader)
            law, period = live_law(None, loader), loader["controller.period"]
            played = scenario or Scenario(duration_s=period, sample_s=period)
            if real_time:
                played = replace(played, step_s=period / max(round(period / _DRIVE_S), 1))
            setup, steps = made_of(loader, law, supervised=False, scenario=played)
            nodes.append((setup, bus.engine, script_of(steps, scenario) if scenario else None))
        kinds, numbers = ([node[1][of] for node in nodes] for of in ("kind", "node"))
        if len(set(kinds)) != 1 or len(set(numbers)) < len(numbers):
            raise InputError("loaders: expected one or more of one kind of bus, each with a node of its own")
        self._on_ethercat = kinds[0] in {ETHERCAT, ANALOG}
        try:
            self._emulator = _core.BusEmulator(nodes, by_clock=real_time, power_s=power_s)
        except OSError as error:
            raise InputError(f"cannot emulate a bus at {nodes[0][1]['port']}: {error}") from error

    def end(self) -> None:
        """Close the port."""
        self._emulator.end()

    @property
    def port(self) -> str:
        """Path of the pseudo terminal, or the interface."""
        return str(Path(self._emulator.port))

    @property
    def commands(self) -> list[float]:
        """Command of each machine's drive, A, of a valve V."""
        return [command for command, _ in self._emulator.seen()]

    @property
    def angles_rad(self) -> list[float]:
        """Angle of each machine's column, rad."""
        return [angle for _, angle in self._emulator.seen()]

    def break_wire(self, fault: WireFault | None, every: int = 1, by: int = 1) -> None:
        """Break the wire, or mend it with ``None``.

        Args:
            fault: One of ``lost``, ``late``, ``repeated``, ``corrupt``, of answers; ``gone``, the node; ``bus_off``, the adapter;
                ``miscounted``, of ``ethercat``: frames pass the slaves without their share.
            every: Of so many answers one.
            by: Commands by which a late answer is late.

        Raises:
            InputError: If the fault is unknown.
        """
        if fault is not None and fault not in WIRE_FAULTS:
            raise InputError(f"fault: expected one of {', '.join(WIRE_FAULTS)}, got {show(fault)}")
        self._emulator.break_wire(fault or "", every, by)

    def fail(self, code: int, axis: int = 0) -> None:
        """Have a drive fail with a code of its own.

        Args:
            code: Of a moteus, such as 40, under voltage; a bit of an ODrive's error; a code of 0x603F; of terminals one of the
                application layer.
            axis: Whose drive.
        """
        self._emulator.fail(axis, code)

    def restart(self, axis: int = 0) -> None:
        """Have a drive lose its supply for a moment."""
        self._emulator.restart(axis)

    def add_twin(self, axis: int = 0) -> None:
        """Add a second drive with the number of an axis's, as of two boards from the box; on CAN only.

        Raises:
            InputError: On EtherCAT, where the place on the wire is the number.
        """
        if self._on_ethercat:
            raise InputError("add_twin: is for drives on CAN; on EtherCAT the place on the wire is the number")
        self._emulator.add_twin(axis)

    def hold(self, angle_rad: float | None, axis: int = 0) -> None:
        """Have a hand move the grip to an angle and hold it there, rad; ``None``: it lets go."""
        self._emulator.disturb(axis, "hold_at", number=angle_rad)

    def push(self, force_n: float, axis: int = 0) -> None:
        """Set the force of a hand at the grip, N."""
        self._emulator.disturb(axis, "force", number=force_n)
