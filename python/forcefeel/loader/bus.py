"""The bus that a loader's drive is on, as its file states it in the table ``[bus]``."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isfinite, tau
from typing import Any

from forcefeel import _core
from forcefeel.errors import InputError, suggestion
from forcefeel.loader.parameters import HYDRAULIC
from forcefeel.units import UnitSystem, parse, show, to_text

UDP = "udp"
KINDS = (*(kind for kind, _, _ in _core.bus_kinds()), UDP)
"""Kinds of drives, and a machine that answers the packets of ``docs/reference/live.md``."""

_Object = tuple[int, int] | None
_Objects = tuple[_Object, _Object, _Object]
Engine = tuple[
    str,
    str,
    int,
    tuple[float, float, float | None, tuple[float, float] | None, float | None],
    float,
    tuple[float, float, float, _Objects] | None,
    tuple[int, tuple[int, int], tuple[_Object, _Object, _Object, _Object], tuple[float, float, float]] | None,
]
"""Kind, port, node; gear, zero, load cell, gear and zero of the column's encoder, grip sensor; watchdog; of EtherCAT rated torque,
counts of both encoders, objects of the sensors; of a valve's terminals node of the inputs, objects of output and inputs, ranges of
command, drive's end and column."""

ETHERCAT, ANALOG = "ethercat", "ethercat-analog"
_ONLY: Mapping[str, tuple[str, ...]] = {
    ETHERCAT: ("rated_torque_n_m", "encoder_counts", "column_counts"),
    ANALOG: (
        "input_node",
        "output_v",
        "output_object",
        "position_m",
        "position_zero_m",
        "position_object",
        "column_range_rad",
    ),
}
"""What one kind alone has."""

_SENSORS = {
    "load_cell_n": "load_cell_object",
    "column_gear": "column_object",
    "grip_sensor_n": "grip_object",
}
_REQUIRED_OF: Mapping[str, tuple[str, ...]] = {
    ETHERCAT: ("rated_torque_n_m", "encoder_counts"),
    ANALOG: (
        "input_node",
        "output_v",
        "output_object",
        "load_cell_n",
        "load_cell_object",
        "position_m",
        "position_object",
        "column_range_rad",
        "column_object",
    ),
}
_OF_A_MOTOR = {"gear": 1.0, "zero_rad": 0.0, "column_gear": None}
"""What a valve's terminals lack, as it is where it is not stated."""

_OBJECTS = (*_SENSORS.values(), "output_object", "position_object")

_END = 32767
"""Number at the end of an analog input's range."""

_NODES = {kind: (first, last) for kind, first, last in _core.bus_kinds()}
_LONGEST_WATCHDOG_S = 1.0


@dataclass(frozen=True)
class Bus:
    """Where a loader's drive is, and what is wired to it.

    Attributes:
        kind: ``moteus``; ``odrive`` with firmware 0.6 or ``odrive-0.5``; ``ethercat`` for a drive of CiA 402; ``ethercat-analog``
            for a valve and its sensors at analog terminals; ``udp`` for a machine over the network.
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
        load_cell_object, column_object, grip_object: Objects of that drive, or of the input terminal, with the sensors, such as
            ``0x2100:1``; an analog input has 16 bits, with its sign.
        input_node: Of ``ethercat-analog`` the terminal with the inputs, as ``node``; ``node`` is that with the output.
        output_v: Command at the end of the output's range, V; negative if the valve moves the other way.
        output_object: Object of the output.
        position_m, column_range_rad: Position of the drive's end and angle of the column at the end of their inputs' ranges.
        position_zero_m: Position that the input shows with the drive's end at neutral; ``column_zero_rad`` likewise.
        position_object: Object of that input.

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
    input_node: int | None = None
    output_v: float | None = None
    output_object: str | None = None
    position_m: float | None = None
    position_zero_m: float | None = None
    position_object: str | None = None
    column_range_rad: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"kind: expected {', '.join(KINDS)}, got {show(self.kind)}{suggestion(str(self.kind), KINDS)}"
            )
        if not isinstance(self.port, str) or not self.port:
            raise InputError(f"port: expected a serial port such as /dev/ttyACM0, got {show(self.port)}")
        first, last = _NODES.get(self.kind, (0, 255))
        for name in ("node", "input_node"):
            number = getattr(self, name)
            whole = isinstance(number, int) and not isinstance(number, bool)
            if number is not None and not (whole and first <= number <= last):
                raise InputError(f"{name}: expected {first} to {last}, got {show(number)}")
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
            "output_v",
            "position_m",
            "position_zero_m",
            "column_range_rad",
        ):
            value = getattr(self, name)
            if value is not None and not (isinstance(value, int | float) and isfinite(value)):
                raise InputError(f"{name}: expected a finite number, got {show(value)}")
            if value == 0 and name not in {"zero_rad", "column_zero_rad", "position_zero_m"}:
                raise InputError(f"{name}: expected a number other than zero")
        if not 0 < self.watchdog_s <= _LONGEST_WATCHDOG_S:
            raise InputError(f"watchdog: expected up to {_LONGEST_WATCHDOG_S:g} s, got {self.watchdog_s:g} s")
        self._check_kind()

    def _check_kind(self) -> None:
        """Check that what a kind requires is stated, and nothing of another kind."""
        required = set(_REQUIRED_OF.get(self.kind, ()))
        if self.kind in _ONLY:
            required |= {of for sensor, of in _SENSORS.items() if getattr(self, sensor) is not None}
        if self.kind == ETHERCAT and self.column_gear is not None:
            required.add("column_counts")
        kinds: dict[str, tuple[str, ...]] = {name: (kind,) for kind, names in _ONLY.items() for name in names}
        kinds |= dict.fromkeys(_SENSORS.values(), tuple(_ONLY))
        for name, of in kinds.items():
            if self.kind not in of and getattr(self, name) is not None:
                stated = " or ".join(f'"{kind}"' for kind in of)
                raise InputError(
                    f"{_KEYS[name]}: expected it with kind = {stated} only, got kind {show(self.kind)}; leave it out"
                )
        for key, (name, *_) in _FILE.items():
            if name in required and getattr(self, name) is None:
                source = "from the drive's manual" if self.kind == ETHERCAT else "as it is wired"
                raise InputError(f"{key}: missing value; add {key} = {_example(key, self.kind)}, {source}")
        for name in _ONLY[ETHERCAT]:
            if (value := getattr(self, name)) is not None and value <= 0:
                raise InputError(f"{_KEYS[name]}: expected a positive number, got {value:g}")
        if self.kind == ANALOG:
            for name, unstated in _OF_A_MOTOR.items():
                if getattr(self, name) != unstated:
                    raise InputError(f'{_KEYS[name]}: not with kind = "{ANALOG}"; change position and column instead')
        for name in _OBJECTS:
            _object(name, getattr(self, name))

    @property
    def senses(self) -> bool:
        """Whether load cell and column encoder are on the bus."""
        return self.load_cell_n is not None and (self.column_gear or self.column_range_rad) is not None

    @property
    def resolution(self) -> Mapping[str, float]:
        """Steps of analog inputs by the row of the loader that states them, SI; of other kinds none."""
        if self.kind != ANALOG:
            return {}
        ranges = {
            "load_cell.resolution": self.load_cell_n,
            "potentiometer.resolution": self.position_m,
            "column_sensor.resolution": self.column_range_rad,
            "grip_sensor.resolution": self.grip_sensor_n,
        }
        return {row: abs(end) / _END for row, end in ranges.items() if end is not None}

    @property
    def engine(self) -> Engine:
        """Kind, port, node, wiring and watchdog in the engine's form."""
        column = None if self.column_gear is None else (self.column_gear, self.column_zero_rad / tau)
        gear, zero, units, analog = self.gear, self.zero_rad / tau, None, None
        load_cell, angle, grip = (
            _object(of, getattr(self, of)) if wired is not None else None
            for of, wired in zip(
                _SENSORS.values(),
                (self.load_cell_n, self.column_gear or self.column_range_rad, self.grip_sensor_n),
                strict=True,
            )
        )
        if self.kind == ETHERCAT:
            rated, counts, column_counts = self.rated_torque_n_m, self.encoder_counts, self.column_counts
            units = (rated or 1.0, counts or 1.0, column_counts or 1.0, (load_cell, angle, grip))
        if self.kind == ANALOG:
            position, output = self.position_m or 1.0, _object("output_object", self.output_object) or (0, 0)
            zero, column = (self.position_zero_m or 0.0) / position, (1.0, self.column_zero_rad / tau)
            inputs = (load_cell, _object("position_object", self.position_object), angle, grip)
            ranges = (self.output_v or 1.0, position, (self.column_range_rad or 1.0) / tau)
            analog = (self.input_node or 0, output, inputs, ranges)
        wiring = (gear, zero, self.load_cell_n, column, self.grip_sensor_n)
        return self.kind, self.port, self.node, wiring, self.watchdog_s, units, analog


def check_drive(kind: str, drive: str) -> None:
    """Check that a kind of bus is for a loader's drive.

    Raises:
        InputError: If a motor is at analog terminals, or a valve elsewhere.
    """
    if kind == UDP or (drive == HYDRAULIC) == (kind == ANALOG):
        return
    others = f"{ANALOG} or {UDP}" if drive == HYDRAULIC else ", ".join(name for name in KINDS if name != ANALOG)
    raise InputError(
        f'kind: expected a kind for {drive} drives, {others}, got "{kind}"; change kind, or the loader\'s drive'
    )


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
    "kind": (
        "kind",
        "",
        "moteus",
        "moteus, odrive, odrive-0.5, ethercat, ethercat-analog, or udp for a machine over the network",
    ),
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
    "input_node": ("input_node", "", "2", "ethercat-analog: terminal with the inputs; node is that with the output"),
    "output": ("output_v", "V", "10 V", "ethercat-analog: command at the end of the output's range"),
    "output_object": ("output_object", "", "0x7000:1", "ethercat-analog: object of the output of 16 bits"),
    "position": ("position_m", "m", "4 in", "ethercat-analog: drive's end at the end of its input's range"),
    "position_zero": ("position_zero_m", "m", "0 in", "ethercat-analog: what it shows with the column at neutral"),
    "position_object": ("position_object", "", "0x6010:17", "ethercat-analog: object of that input"),
    "column_range": ("column_range_rad", "rad", "30 deg", "ethercat-analog: column at the end of its input's range"),
}
"""Key of the file: attribute, unit, example, meaning."""

_KEYS = {name: key for key, (name, *_) in _FILE.items()}
_REQUIRED = ("kind", "port")
_TEXT, _WHOLE = (*_REQUIRED, *_OBJECTS), ("node", "input_node")


_OF_TERMINALS = {"load_cell_object": "0x6000:17", "column_object": "0x6020:17", "grip_object": "0x6030:17"}


def _example(key: str, kind: str) -> str:
    _, unit, example, _ = _FILE[key]
    if kind == ANALOG:
        example = _OF_TERMINALS.get(key, example)
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
            stated[name] = value if key in (*_TEXT, *_WHOLE) else parse(value, unit, example)
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
    from forcefeel.units import ANGLE, FORCE, LENGTH, TORQUE, VOLTAGE  # noqa: PLC0415  beside what is written

    if of := {"rad": ANGLE, "N": FORCE, "N m": TORQUE, "m": LENGTH, "V": VOLTAGE}.get(unit):
        return f"{of.from_si(value, units):.12g} {of.shown(units)}"
    return f"{1e3 * value:.12g} ms" if unit else (to_text(value, 12) if isinstance(value, float) else str(value))
