"""The bus that a loader's drive is on, as its file states it in the table ``[bus]``."""

import re
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

_Objects = tuple[tuple[int, int] | None, tuple[int, int] | None, tuple[int, int] | None]
Engine = tuple[
    str,
    str,
    int,
    tuple[float, float, float | None, tuple[float, float] | None, float | None],
    float,
    tuple[float, float, float, _Objects] | None,
]
"""Kind, port, node; gear, zero, load cell, gear and zero of the column's encoder, grip sensor; watchdog; of EtherCAT rated torque,
counts of both encoders, objects of the sensors."""

ETHERCAT = "ethercat"
_UNITS = ("rated_torque_n_m", "encoder_counts")
_SENSORS = {
    "load_cell_n": "load_cell_object",
    "column_gear": "column_object",
    "grip_sensor_n": "grip_object",
}

_NODES = {kind: (first, last) for kind, first, last in _core.bus_kinds()}
_LONGEST_WATCHDOG_S = 1.0


@dataclass(frozen=True)
class Bus:
    """Where a loader's drive is, and what is wired to it.

    Attributes:
        kind: ``moteus``; ``odrive`` with firmware 0.6 or ``odrive-0.5``; ``ethercat`` for a drive of CiA 402; ``udp`` for a machine
            over the network.
        port: Serial port of the adapter, such as ``/dev/ttyACM0``; of ``ethercat`` the network interface, such as ``eth0``; of
            ``udp`` its address, ``host:port``.
        node: Number of the drive on the bus; of ``ethercat`` its position on the wire from 1, or from 128 on its alias.
        gear: Turns of the motor per turn that the drive states; negative if they run against each other.
        zero_rad: Angle that the drive states with the column at neutral.
        watchdog_s: Time without a command after which a moteus damps by itself; an ODrive has a setting of its own.
        load_cell_n: Force of the load cell at the end of the input's range; ``None`` without one.
        column_gear: Turns of the column per turn of its encoder at the drive; ``None`` without one.
        column_zero_rad: Angle of that encoder with the column at neutral.
        grip_sensor_n: As ``load_cell_n``, of the force sensor at the grip.
        rated_torque_n_m: Rated torque of a drive on EtherCAT, whose unit of torque is a thousandth of it.
        encoder_counts: Counts of that drive per revolution.
        column_counts: The same of the encoder at the column.
        load_cell_object, column_object, grip_object: Objects of that drive with the sensors, such as ``0x2100:1``; an analog input
            has 16 bits, with its sign.

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
    rated_torque_n_m: float | None = None
    encoder_counts: float | None = None
    column_counts: float | None = None
    load_cell_object: str | None = None
    column_object: str | None = None
    grip_object: str | None = None

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
            "rated_torque_n_m",
            "encoder_counts",
            "column_counts",
        ):
            value = getattr(self, name)
            if value is not None and not (isinstance(value, int | float) and isfinite(value)):
                raise InputError(f"{name}: expected a finite number, got {show(value)}")
            if value == 0 and name not in {"zero_rad", "column_zero_rad"}:
                raise InputError(f"{name}: expected a number other than zero")
        if not 0 < self.watchdog_s <= _LONGEST_WATCHDOG_S:
            raise InputError(f"watchdog: expected up to {_LONGEST_WATCHDOG_S:g} s, got {self.watchdog_s:g} s")
        self._check_ethercat()

    def _check_ethercat(self) -> None:
        """Check that units and objects are stated for a drive on EtherCAT, and for no other."""
        stated = (*_UNITS, "column_counts", *_SENSORS.values())
        required = [*_UNITS, *(of for sensor, of in _SENSORS.items() if getattr(self, sensor) is not None)]
        if self.column_gear is not None:
            required.append("column_counts")
        for name in stated:
            key = _KEYS[name]
            value = getattr(self, name)
            if self.kind != ETHERCAT and value is not None:
                raise InputError(
                    f'{key}: expected it with kind = "{ETHERCAT}" only, got kind {show(self.kind)}; leave it out'
                )
            if self.kind == ETHERCAT and value is None and name in required:
                raise InputError(f"{key}: missing value; add {key} = {_example(key)}, from the drive's manual")
            if value is not None and name not in _SENSORS.values() and value <= 0:
                raise InputError(f"{key}: expected a positive number, got {value:g}")
        for name in _SENSORS.values():
            _object(name, getattr(self, name))

    @property
    def senses(self) -> bool:
        """Whether load cell and column encoder are on the bus."""
        return self.load_cell_n is not None and self.column_gear is not None

    @property
    def engine(self) -> Engine:
        """Kind, port, node, wiring and watchdog in the engine's form."""
        column = None if self.column_gear is None else (self.column_gear, self.column_zero_rad / tau)
        wiring = (self.gear, self.zero_rad / tau, self.load_cell_n, column, self.grip_sensor_n)
        units = None
        if self.kind == ETHERCAT:
            load_cell, column_encoder, grip = (
                None if getattr(self, sensor) is None else _object(name, getattr(self, name))
                for sensor, name in _SENSORS.items()
            )
            rated, counts, column_counts = self.rated_torque_n_m, self.encoder_counts, self.column_counts
            units = (rated or 1.0, counts or 1.0, column_counts or 1.0, (load_cell, column_encoder, grip))
        return self.kind, self.port, self.node, wiring, self.watchdog_s, units


def _object(name: str, text: str | None) -> tuple[int, int] | None:
    """Index and sub-index of an object.

    Raises:
        InputError: If the text is not of that form.
    """
    if text is None:
        return None
    if not (isinstance(text, str) and (match := re.fullmatch(r"0x([0-9a-fA-F]{4}):(\d{1,3})", text))):
        raise InputError(f'{name}: expected an object such as "0x2100:1", got {show(text)}')
    index, sub = int(match[1], 16), int(match[2])
    if sub > 255:
        raise InputError(f"{name}: expected a sub-index up to 255, got {sub}")
    return index, sub


_FILE: Mapping[str, tuple[str, str, str, str]] = {
    "kind": ("kind", "", "moteus", "moteus, odrive, odrive-0.5, ethercat, or udp for a machine over the network"),
    "port": ("port", "", "/dev/ttyACM0", "serial port of the adapter; of ethercat the interface; of udp host:port"),
    "node": ("node", "", "1", "number of the drive on the bus; of ethercat its position, or from 128 on its alias"),
    "gear": (
        "gear",
        "",
        "1",
        "turns of the motor per turn that the drive states; negative if they run against each other",
    ),
    "zero": ("zero_rad", "rad", "0 deg", "angle that the drive states with the column at neutral"),
    "watchdog": ("watchdog_s", "s", "100 ms", "time without a command after which a moteus or EtherCAT drive stops"),
    "load_cell": ("load_cell_n", "N", "400 N", "force at the end of the input's range; none unless given"),
    "column_gear": ("column_gear", "", "1", "turns of the column per turn of its encoder; none unless given"),
    "column_zero": ("column_zero_rad", "rad", "0 deg", "angle of that encoder with the column at neutral"),
    "grip_sensor": ("grip_sensor_n", "N", "100 N", "the same of the force sensor at the grip"),
    "rated_torque": ("rated_torque_n_m", "N m", "2 N m", "ethercat: rated torque of the drive, 0x6076"),
    "encoder_counts": ("encoder_counts", "", "1048576", "ethercat: counts of 0x6064 per revolution"),
    "column_counts": ("column_counts", "", "1048576", "ethercat: counts of the encoder at the column per revolution"),
    "load_cell_object": ("load_cell_object", "", "0x2100:1", "ethercat: object of the load cell's input of 16 bits"),
    "column_object": ("column_object", "", "0x60E4:1", "ethercat: object of the encoder at the column"),
    "grip_object": ("grip_object", "", "0x2100:2", "ethercat: object of the grip sensor's input of 16 bits"),
}
"""Key of the file: attribute, unit, example, meaning."""

_KEYS = {name: key for key, (name, *_) in _FILE.items()}
_REQUIRED = ("kind", "port")
_TEXT, _WHOLE = (*_REQUIRED, *_SENSORS.values()), "node"


def _example(key: str) -> str:
    _, unit, example, _ = _FILE[key]
    return f'"{example}"' if unit or key in _TEXT else example


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
    if missing := [key for key in _REQUIRED if key not in given]:
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
        given = bus is not None and value is not None and (key in _REQUIRED or value != _DEFAULTS[name])
        shown = _stated(value, unit, units) if given else example
        quoted = f'"{shown}"' if unit or key in _TEXT else shown
        lines.append((f"{'' if given else '# '}{key} = {quoted}", meaning))
    width = max(len(line) for line, _ in lines)
    head = "[bus]" if bus else "# [bus]"
    return [head, *(f"{line:{width}}  # {meaning}" for line, meaning in lines)]


def _stated(value: Any, unit: str, units: UnitSystem) -> str:
    from forcefeel.units import ANGLE, FORCE, TORQUE  # noqa: PLC0415  beside what is written

    if of := {"rad": ANGLE, "N": FORCE, "N m": TORQUE}.get(unit):
        return f"{of.from_si(value, units):.12g} {of.shown(units)}"
    return f"{1e3 * value:.12g} ms" if unit else (to_text(value, 12) if isinstance(value, float) else str(value))
