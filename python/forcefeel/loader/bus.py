"""The bus that a loader's drive is on, as its file states it in the table ``[bus]``."""

import re
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from math import isfinite
from typing import Any

from forcefeel import _core
from forcefeel.errors import InputError, suggestion
from forcefeel.loader.parameters import HYDRAULIC
from forcefeel.units import (
    ANGLE,
    FORCE,
    LENGTH,
    RATIO,
    SECONDS,
    TORQUE,
    VOLTAGE,
    Unit,
    UnitSystem,
    parse,
    show,
    to_text,
)

UDP = "udp"
KINDS = (*(kind for kind, _, _ in _core.bus_kinds()), UDP)
"""Kinds of drives, and a machine that answers the packets of ``docs/reference/live.md``."""

ETHERCAT, ANALOG = "ethercat", "ethercat-analog"

Engine = Mapping[str, str | float | tuple[int, int] | None]
"""Every row of the table by its attribute, an object as index and sub-index."""

_END = 32767
"""Number at the end of an analog input's range."""

_NODES = {kind: (first, last) for kind, first, last in _core.bus_kinds()}
_LONGEST_WATCHDOG_S = 1.0


@dataclass(frozen=True)
class _Row:
    """What there is to say of an attribute of ``Bus``, beside its name, type and default.

    Attributes:
        unit: Its unit; the key of the file is the attribute without it.
        example, meaning: For the file.
        kinds: The kinds that may state it.
        required: Those of them that must.
        object_of: The sensor that this object has.
        terminal: Example at analog terminals, where it is another.
        step_of: The loader's sensor whose resolution is the step of this analog input.
    """

    unit: Unit
    example: str
    meaning: str
    kinds: tuple[str, ...] = KINDS
    required: tuple[str, ...] = ()
    object_of: str = ""
    terminal: str = ""
    step_of: str = ""


def _row(unit: Unit, example: str, meaning: str, **more: Any) -> Mapping[str, _Row]:
    return {"row": _Row(unit, example, meaning, **more)}


def _optional(default: float | None, unit: Unit, example: str, meaning: str, **more: Any) -> Any:
    return field(default=default, metadata=_row(unit, example, meaning, **more))


_MOTORS = tuple(kind for kind in KINDS if kind != ANALOG)
_DRIVE: Any = {"kinds": (ETHERCAT,), "required": (ETHERCAT,)}
_VALVE: Any = {"kinds": (ANALOG,), "required": (ANALOG,)}


def _object_of(sensor: str, channel: int) -> Any:
    """The object of a sensor, at analog terminals of a channel."""
    required = () if sensor == "grip_sensor_n" else (ANALOG,)
    terminal = f"0x60{channel}0:17"
    return {"kinds": (ETHERCAT, ANALOG), "required": required, "object_of": sensor, "terminal": terminal}


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
        input_node: Terminal with the inputs, as ``node``. Of ``ethercat-analog`` ``node`` is that with the output; of ``ethercat``
            load cell and force sensor at the grip are there, ``None`` if at the drive.
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

    kind: str = field(
        metadata=_row(RATIO, "moteus", f"{', '.join(KINDS[:-1])}, or {UDP} for a machine over the network")
    )
    port: str = field(
        metadata=_row(RATIO, "/dev/ttyACM0", "serial port of the adapter; of ethercat the interface; of udp host:port")
    )
    node: int = _optional(
        1, RATIO, "1", "number of the drive on the bus; of ethercat its position, or from 128 on its alias"
    )
    gear: float = _optional(
        1.0,
        RATIO,
        "1",
        "turns of the motor per turn that the drive states; negative if they run against each other",
        kinds=_MOTORS,
    )
    zero_rad: float = _optional(
        0.0, ANGLE, "0 deg", "angle that the drive states with the column at neutral", kinds=_MOTORS
    )
    watchdog_s: float = _optional(
        0.1, SECONDS, "100 ms", "time without a command after which a moteus or EtherCAT drive stops"
    )
    load_cell_n: float | None = _optional(
        None,
        FORCE,
        "400 N",
        "force at the end of the input's range; none unless given",
        required=(ANALOG,),
        step_of="load_cell",
    )
    column_gear: float | None = _optional(
        None, RATIO, "1", "turns of the column per turn of its encoder; none unless given", kinds=_MOTORS
    )
    column_zero_rad: float = _optional(0.0, ANGLE, "0 deg", "angle of that encoder with the column at neutral")
    grip_sensor_n: float | None = _optional(
        None, FORCE, "100 N", "the same of the force sensor at the grip", step_of="grip_sensor"
    )
    rated_torque_n_m: float | None = _optional(
        None, TORQUE, "2 N m", "ethercat: rated torque of the drive, 0x6076", **_DRIVE
    )
    encoder_counts: float | None = _optional(
        None, RATIO, "1048576", "ethercat: counts of 0x6064 per revolution", **_DRIVE
    )
    column_counts: float | None = _optional(
        None, RATIO, "1048576", "ethercat: counts of the encoder at the column per revolution", kinds=(ETHERCAT,)
    )
    load_cell_object: str | None = _optional(
        None, RATIO, "0x2100:1", "ethercat: object of the load cell's input of 16 bits", **_object_of("load_cell_n", 0)
    )
    column_object: str | None = _optional(
        None, RATIO, "0x60E4:1", "ethercat: object of the encoder at the column", **_object_of("column_gear", 2)
    )
    grip_object: str | None = _optional(
        None,
        RATIO,
        "0x2100:2",
        "ethercat: object of the grip sensor's input of 16 bits",
        **_object_of("grip_sensor_n", 3),
    )
    input_node: int | None = _optional(
        None,
        RATIO,
        "2",
        "ethercat: terminal with the force sensors' inputs, none if at the drive; ethercat-analog: with all inputs",
        kinds=(ETHERCAT, ANALOG),
        required=(ANALOG,),
    )
    output_v: float | None = _optional(
        None, VOLTAGE, "10 V", "ethercat-analog: command at the end of the output's range", **_VALVE
    )
    output_object: str | None = _optional(
        None, RATIO, "0x7000:1", "ethercat-analog: object of the output of 16 bits", **_VALVE
    )
    position_m: float | None = _optional(
        None,
        LENGTH,
        "4 in",
        "ethercat-analog: drive's end at the end of its input's range",
        **_VALVE,
        step_of="potentiometer",
    )
    position_zero_m: float | None = _optional(
        None, LENGTH, "0 in", "ethercat-analog: what it shows with the column at neutral", kinds=(ANALOG,)
    )
    position_object: str | None = _optional(None, RATIO, "0x6010:17", "ethercat-analog: object of that input", **_VALVE)
    column_range_rad: float | None = _optional(
        None,
        ANGLE,
        "30 deg",
        "ethercat-analog: column at the end of its input's range",
        **_VALVE,
        step_of="column_sensor",
    )

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"kind: expected {', '.join(KINDS)}, got {show(self.kind)}{suggestion(str(self.kind), KINDS)}"
            )
        if not isinstance(self.port, str) or not self.port:
            raise InputError(f"port: expected a serial port such as /dev/ttyACM0, got {show(self.port)}")
        first, last = _NODES.get(self.kind, (0, 255))
        for name in _WHOLE:
            number = getattr(self, name)
            whole = isinstance(number, int) and not isinstance(number, bool)
            if number is not None and not (whole and first <= number <= last):
                raise InputError(f"{name}: expected {first} to {last}, got {show(number)}")
        for name in _NUMBERS:
            value = getattr(self, name)
            if value is not None and not (isinstance(value, int | float) and isfinite(value)):
                raise InputError(f"{name}: expected a finite number, got {show(value)}")
            if value == 0 and "zero" not in name:
                raise InputError(f"{name}: expected a number other than zero")
        if not 0 < self.watchdog_s <= _LONGEST_WATCHDOG_S:
            raise InputError(f"watchdog: expected up to {_LONGEST_WATCHDOG_S:g} s, got {self.watchdog_s:g} s")
        self._check_kind()

    def _check_kind(self) -> None:
        """Check that what a kind requires is stated, and nothing of another kind."""
        for name, row in _ROWS.items():
            value = getattr(self, name)
            if self.kind not in row.kinds and value != _DEFAULTS[name]:
                if row.kinds == _MOTORS:
                    raise InputError(f'{_KEYS[name]}: not with kind = "{ANALOG}"; change position and column instead')
                stated = " or ".join(f'"{kind}"' for kind in row.kinds)
                raise InputError(
                    f"{_KEYS[name]}: expected it with kind = {stated} only, got kind {show(self.kind)}; leave it out"
                )
            if row.kinds == (ETHERCAT,) and value is not None and value <= 0:
                raise InputError(f"{_KEYS[name]}: expected a positive number, got {value:g}")
        for name, row in _ROWS.items():
            wired = bool(row.object_of) and getattr(self, row.object_of) is not None and self.kind in row.kinds
            counted = name == "column_counts" and self.kind == ETHERCAT and self.column_gear is not None
            if getattr(self, name) is None and (self.kind in row.required or wired or counted):
                source = "from the drive's manual" if self.kind == ETHERCAT else "as it is wired"
                key = _KEYS[name]
                raise InputError(f"{key}: missing value; add {key} = {_example(name, self.kind)}, {source}")
            if name in _OBJECTS:
                _object(name, getattr(self, name))
        if self.kind == ETHERCAT and self.input_node is not None:
            if self.load_cell_n is None and self.grip_sensor_n is None:
                raise InputError(
                    "input_node: expected load_cell or grip_sensor with it; add one, or leave input_node out"
                )
            if self.input_node == self.node:
                raise InputError(
                    f"input_node: expected another slave than the drive, {self.node}; leave it out if the drive has the sensors"
                )

    @property
    def senses(self) -> bool:
        """Whether load cell and column encoder are on the bus."""
        return self.load_cell_n is not None and (self.column_gear or self.column_range_rad) is not None

    @property
    def resolution(self) -> Mapping[str, float]:
        """Steps of a terminal's inputs by the row of the loader that states them, SI; without a terminal none."""
        if self.input_node is None:
            return {}
        ends = {f"{row.step_of}.resolution": getattr(self, name) for name, row in _ROWS.items() if row.step_of}
        return {row: abs(end) / _END for row, end in ends.items() if end is not None}

    @property
    def engine(self) -> Engine:
        """Every row in the engine's form."""
        values = {name: getattr(self, name) for name in _ROWS}
        return values | {name: _object(name, values[name]) for name in _OBJECTS}


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


_FIELDS = {of.name: of for of in fields(Bus)}
_ROWS: Mapping[str, _Row] = {name: of.metadata["row"] for name, of in _FIELDS.items()}
_KEYS = {name: name.removesuffix(f"_{row.unit.suffix}") for name, row in _ROWS.items()}
"""Key of the file of each attribute."""

_NAMES = {key: name for name, key in _KEYS.items()}
_DEFAULTS = {name: of.default for name, of in _FIELDS.items()}
_REQUIRED = tuple(name for name, default in _DEFAULTS.items() if default is MISSING)


def _of_type(wanted: type) -> tuple[str, ...]:
    return tuple(name for name, of in _FIELDS.items() if of.type in (wanted, wanted | None))


_TEXT, _WHOLE, _NUMBERS = (_of_type(wanted) for wanted in (str, int, float))
_OBJECTS = tuple(name for name in _TEXT if name not in _REQUIRED)


def _example(name: str, kind: str) -> str:
    row = _ROWS[name]
    example = row.terminal if kind == ANALOG and row.terminal else row.example
    return f'"{example}"' if row.unit is not RATIO or name in _TEXT else example


def read(given: object) -> Bus:
    """The bus of a loader file.

    Raises:
        InputError: If a key or a value is invalid.
    """
    if not isinstance(given, dict):
        raise InputError(f"expected the table [bus] with {', '.join(_NAMES)}, got {show(given)}")
    if unknown := [key for key in given if key not in _NAMES]:
        raise InputError(f"{unknown[0]}: unknown key; known are {', '.join(_NAMES)}{suggestion(unknown[0], _NAMES)}")
    if missing := [key for key in _REQUIRED if key not in given]:
        raise InputError(f'{missing[0]}: missing value; add {missing[0]} = "{_ROWS[missing[0]].example}"')
    stated: dict[str, Any] = {}
    for key, value in given.items():
        name = _NAMES[key]
        row = _ROWS[name]
        try:
            stated[name] = parse(value, row.unit.si, row.example) if name in _NUMBERS else value
        except InputError as error:
            raise InputError(f"{key}: {error}") from error
    return Bus(**stated)


def write(bus: Bus | None, units: UnitSystem) -> list[str]:
    """The lines of a bus in a loader file; without one an example, as comments."""
    lines = []
    for name, row in _ROWS.items():
        value = None if bus is None else getattr(bus, name)
        given = value is not None and value != _DEFAULTS[name]
        shown = _stated(value, row.unit, units) if given else row.example
        quoted = f'"{shown}"' if row.unit is not RATIO or name in _TEXT else shown
        lines.append((f"{'' if given else '# '}{_KEYS[name]} = {quoted}", row.meaning))
    width = max(len(line) for line, _ in lines)
    head = "[bus]" if bus else "# [bus]"
    return [head, *(f"{line:{width}}  # {meaning}" for line, meaning in lines)]


def _stated(value: Any, unit: Unit, units: UnitSystem) -> str:
    if unit is SECONDS:
        return f"{1e3 * value:.12g} ms"
    if unit is RATIO:
        return to_text(value, 12) if isinstance(value, float) else str(value)
    return f"{unit.from_si(value, units):.12g} {unit.shown(units)}"
