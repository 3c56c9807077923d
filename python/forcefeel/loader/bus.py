"""The bus that a loader's drive is on, as its file states it in the table ``[bus]``."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isfinite, tau
from typing import Any

from forcefeel import _core
from forcefeel.errors import InputError, suggestion
from forcefeel.units import UnitSystem, parse, show, to_text

UDP = "udp"
KINDS = (*(kind for kind, _, _ in _core.bus_kinds()), UDP)
"""Kinds of drives, and a machine that answers the packets of ``docs/reference/live.md``."""

Engine = tuple[str, str, int, tuple[float, float, float | None, tuple[float, float] | None, float | None], float]
"""Kind, port, node; gear, zero, load cell, gear and zero of the column's encoder, grip sensor; watchdog."""

_NODES = {kind: (first, last) for kind, first, last in _core.bus_kinds()}
_LONGEST_WATCHDOG_S = 1.0


@dataclass(frozen=True)
class Bus:
    """Where a loader's drive is, and what is wired to it.

    Attributes:
        kind: ``moteus``; ``odrive`` with firmware 0.6 or ``odrive-0.5``; or ``udp`` for a machine over the network.
        port: Serial port of the adapter, such as ``/dev/ttyACM0``; of ``udp`` its address, ``host:port``.
        node: Number of the drive on the bus.
        gear: Turns of the motor per turn that the drive states; negative if they run against each other.
        zero_rad: Angle that the drive states with the column at neutral.
        watchdog_s: Time without a command after which a moteus damps by itself; an ODrive has a setting of its own.
        load_cell_n: Force of the load cell at the end of the input's range; ``None`` without one.
        column_gear: Turns of the column per turn of its encoder at the drive; ``None`` without one.
        column_zero_rad: Angle of that encoder with the column at neutral.
        grip_sensor_n: As ``load_cell_n``, of the force sensor at the grip.

    Without load cell and column encoder the loop works them out from the motor's torque and angle: for the law ``torque-mode``.

    Raises:
        InputError: If a value is invalid.

    Example:
        >>> ff.loader.Bus("moteus", "/dev/ttyACM0", gear=-1.0).node
        1
    """

    kind: str
    port: str
    node: int = 1
    gear: float = 1.0
    zero_rad: float = 0.0
    watchdog_s: float = 0.1
    load_cell_n: float | None = None
    column_gear: float | None = None
    column_zero_rad: float = 0.0
    grip_sensor_n: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"kind: expected {', '.join(KINDS)}, got {show(self.kind)}{suggestion(str(self.kind), KINDS)}"
            )
        if not isinstance(self.port, str) or not self.port:
            raise InputError(f"port: expected a serial port such as /dev/ttyACM0, got {show(self.port)}")
        first, last = _NODES.get(self.kind, (0, 255))
        if isinstance(self.node, bool) or not isinstance(self.node, int) or not first <= self.node <= last:
            raise InputError(f"node: expected {first} to {last}, got {show(self.node)}")
        for name in (
            "gear",
            "zero_rad",
            "watchdog_s",
            "load_cell_n",
            "column_gear",
            "column_zero_rad",
            "grip_sensor_n",
        ):
            value = getattr(self, name)
            if value is not None and not (isinstance(value, int | float) and isfinite(value)):
                raise InputError(f"{name}: expected a finite number, got {show(value)}")
            if value == 0 and name not in {"zero_rad", "column_zero_rad"}:
                raise InputError(f"{name}: expected a number other than zero")
        if not 0 < self.watchdog_s <= _LONGEST_WATCHDOG_S:
            raise InputError(f"watchdog: expected up to {_LONGEST_WATCHDOG_S:g} s, got {self.watchdog_s:g} s")

    @property
    def senses(self) -> bool:
        """Whether load cell and column encoder are on the bus."""
        return self.load_cell_n is not None and self.column_gear is not None

    @property
    def engine(self) -> Engine:
        """Kind, port, node, wiring and watchdog in the engine's form."""
        column = None if self.column_gear is None else (self.column_gear, self.column_zero_rad / tau)
        wiring = (self.gear, self.zero_rad / tau, self.load_cell_n, column, self.grip_sensor_n)
        return self.kind, self.port, self.node, wiring, self.watchdog_s


_FILE: Mapping[str, tuple[str, str, str, str]] = {
    "kind": ("kind", "", "moteus", "moteus, odrive, odrive-0.5, or udp for a machine over the network"),
    "port": ("port", "", "/dev/ttyACM0", "serial port of the adapter; of udp host:port"),
    "node": ("node", "", "1", "number of the drive on the bus"),
    "gear": (
        "gear",
        "",
        "1",
        "turns of the motor per turn that the drive states; negative if they run against each other",
    ),
    "zero": ("zero_rad", "rad", "0 deg", "angle that the drive states with the column at neutral"),
    "watchdog": ("watchdog_s", "s", "100 ms", "time without a command after which a moteus damps by itself"),
    "load_cell": ("load_cell_n", "N", "400 N", "force at the end of the input's range; none unless given"),
    "column_gear": ("column_gear", "", "1", "turns of the column per turn of its encoder; none unless given"),
    "column_zero": ("column_zero_rad", "rad", "0 deg", "angle of that encoder with the column at neutral"),
    "grip_sensor": ("grip_sensor_n", "N", "100 N", "the same of the force sensor at the grip"),
}
"""Key of the file: attribute, unit, example, meaning."""

_TEXT, _WHOLE = ("kind", "port"), "node"
_DEFAULTS = {field.name: field.default for field in fields(Bus)}


def read(given: object) -> Bus:
    """The bus of a loader file.

    Raises:
        InputError: If a key or a value is invalid.
    """
    if not isinstance(given, dict):
        raise InputError(f"expected the table [bus] with {', '.join(_FILE)}, got {show(given)}")
    if unknown := [key for key in given if key not in _FILE]:
        raise InputError(f"{unknown[0]}: unknown key; known are {', '.join(_FILE)}{suggestion(unknown[0], _FILE)}")
    if missing := [key for key in _TEXT if key not in given]:
        raise InputError(f'{missing[0]}: missing value; add {missing[0]} = "{_FILE[missing[0]][2]}"')
    stated: dict[str, Any] = {}
    for key, value in given.items():
        name, unit, example, _ = _FILE[key]
        try:
            stated[name] = value if key in (*_TEXT, _WHOLE) else parse(value, unit, example)
        except InputError as error:
            raise InputError(f"{key}: {error}") from error
    return Bus(**stated)


def write(bus: Bus | None, units: UnitSystem) -> list[str]:
    """The lines of a bus in a loader file; without one an example, as comments."""
    lines = []
    for key, (name, unit, example, meaning) in _FILE.items():
        value = None if bus is None else getattr(bus, name)
        given = bus is not None and value is not None and (key in _TEXT or value != _DEFAULTS[name])
        shown = _stated(value, unit, units) if given else example
        quoted = f'"{shown}"' if unit or key in _TEXT else shown
        lines.append((f"{'' if given else '# '}{key} = {quoted}", meaning))
    width = max(len(line) for line, _ in lines)
    head = "[bus]" if bus else "# [bus]"
    return [head, *(f"{line:{width}}  # {meaning}" for line, meaning in lines)]


def _stated(value: Any, unit: str, units: UnitSystem) -> str:
    from forcefeel.units import ANGLE, FORCE  # noqa: PLC0415  beside what is written

    if unit in {"rad", "N"}:
        of = ANGLE if unit == "rad" else FORCE
        return f"{of.from_si(value, units):.12g} {of.shown(units)}"
    return f"{1e3 * value:.12g} ms" if unit else (to_text(value, 12) if isinstance(value, float) else str(value))
