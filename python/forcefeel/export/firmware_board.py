"""A whole project for one board around a firmware export: scales of its converters, start, interrupt, watchdog, telemetry.

A converter of ``2^n`` codes shows ``value = (code - 2^(n-1)) range / 2^(n-1)``: zero in its middle, the range at its ends.
"""

from dataclasses import dataclass
from math import ceil, inf, isclose
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor

BOARD = "stm32f405"
BOARD_TARGET = "thumbv7em-none-eabihf"
BOARD_FILES = ("stm32f405.h", "stm32f405.ld", "startup.c", "board.c", "inputs.c", "emulated.c")
"""Files that are the same for every loader, in ``board/stm32f405``."""

BOARD_SAMPLES = 10_500
"""Golden vectors that fit into a mebibyte of flash beside law and settings."""

_CODES = 2**12
_FRAME_BITS, _BAUD, _MOST_LOAD = 380, 921_600, 0.5
_LEAST_PERIOD_S = 2e-4
"""A period takes 50 us of converters and law on a Cortex-M4F."""
_PLACES = Path(__file__).parent / "board" / BOARD


@dataclass(frozen=True)
class Channel:
    """A channel of the board's converters.

    Attributes:
        name: What it shows.
        pin: Pin of the board.
        range: Largest value either way.
        unit: Unit of the range.
        rows: Rows of the loader file that the range is from.
    """

    name: str
    pin: str
    range: float
    unit: str
    rows: str

    @property
    def step(self) -> float:
        """Value of one code."""
        return 2.0 * self.range / _CODES


def sensor_channels(loader: Loader) -> tuple[Channel, ...]:
    """Channels of the four sensors, in the order of the firmware's input.

    A valve's load cell and potentiometer reach as far as ``controller.input_range``, if it is given; every other range is the
    supervisor's, for the loader file has none.
    """
    volts = loader["controller.input_range"] if loader.drive != ELECTRIC else inf
    analog = volts < inf
    force = volts / loader["load_cell.gain"] if analog else loader["safety.force_range"]
    travel = volts / loader["potentiometer.gain"] if analog else loader["safety.position_range"]
    given = "controller.input_range, "
    return (
        Channel("load cell", "PA0", force, "N", given + "load_cell.gain" if analog else "safety.force_range"),
        Channel("drive", "PA1", travel, "m", given + "potentiometer.gain" if analog else "safety.position_range"),
        Channel(
            "column's base",
            "PA2",
            loader["safety.angle_range"] * loader["column.base_arm"],
            "m",
            "safety.angle_range, column.base_arm",
        ),
        Channel("grip", "PA3", loader["safety.absolute_force"], "N", "safety.absolute_force"),
    )


def command_channel(loader: Loader) -> Channel:
    """Channel of the command: what the converter gives, or else what the drive answers."""
    if loader.drive == ELECTRIC:
        return Channel("command", "PA4", loader["current_loop.current_limit"], "A", "current_loop.current_limit")
    if (volts := loader["controller.output_range"]) < inf:
        return Channel("command", "PA4", volts, "V", "controller.output_range")
    volts = loader["amplifier.current_limit"] / loader["amplifier.admittance"]
    return Channel("command", "PA4", volts, "V", "amplifier.current_limit, amplifier.admittance")


def board_fields(loader: Loader) -> dict[str, object]:
    """Fields of the board's templates.

    Raises:
        InputError: If the delay is not the period, or the period is too short for the board.
    """
    period, delay = loader["controller.period"], loader["controller.delay"]
    if not isclose(delay, period, rel_tol=1e-6):  # as rows of the file are rounded
        raise InputError(
            f"controller.delay: expected the period of {period * 1e3:.6g} ms for {BOARD}, which gives a command as the next period "
            f"begins, got {delay * 1e3:.6g} ms; set 'controller.delay={period * 1e3:.6g} ms'"
        )
    if period < _LEAST_PERIOD_S:
        raise InputError(
            f"controller.period: expected at least {_LEAST_PERIOD_S * 1e3:.6g} ms for {BOARD}, got {period * 1e3:.6g} ms; "
            "set a longer one, or export for a faster target"
        )
    sensors, command = sensor_channels(loader), command_channel(loader)
    every = ceil(_FRAME_BITS / (_BAUD * _MOST_LOAD * period))
    return {
        "channels": sensors,
        "command_channel": command,
        "grip_sensor": int(has_grip_sensor(loader)),
        "ranges": ", ".join(f"{channel.range!r}F" for channel in sensors),
        "command_range": repr(command.range),
        "command_rows": command.rows,
        "telemetry_every": every,
        "frames": f"{1.0 / (period * every):.0f}",
    }


def board_files() -> dict[str, str]:
    """Files that are the same for every loader."""
    return {name: (_PLACES / name).read_text(encoding="utf-8") for name in BOARD_FILES}
