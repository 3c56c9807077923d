"""What a bench measures: the channels, their SI units and how headers call them."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.parameters import DRIVES, ELECTRIC, HYDRAULIC
from forcefeel.tables.header import heading
from forcefeel.units import (
    ANGLE,
    ANGULAR_VELOCITY,
    CURRENT,
    FLOW,
    FORCE,
    LENGTH,
    MOTOR_CURRENT,
    PRESSURE,
    TEMPERATURE,
    VOLTAGE,
    Unit,
    show,
)

_INPUTS: Mapping[str, Mapping[str, str]] = {
    HYDRAULIC: {"test_signal": "V", "pilot_force": "N", "command_signal": "V"},
    ELECTRIC: {"test_current": "A", "pilot_force": "N", "command_current": "A"},
}


@cache
def inputs(drive: str) -> Mapping[str, str]:
    """What drives the bench of a loader with that drive, and its SI unit, in the order of the model's.

    The signal at the amplifier, e_T, or the current asked of the current loop; the pilot's force F_p at the grip; and a signal e_C
    that a digital controller adds to its command, so that it is sampled and comes with the controller's delay.
    """
    return MappingProxyType(dict(_INPUTS[drive]))


@cache
def outputs(drive: str) -> Mapping[str, str]:
    """What is measured of it, and its SI unit, in the order of the model's channels."""
    return MappingProxyType(dict(_core.channels(drive)))


INPUTS = MappingProxyType({name: si for drive in DRIVES for name, si in inputs(drive).items()})
"""What drives a bench, whatever the drive of its loader."""

OUTPUTS = MappingProxyType({name: si for drive in DRIVES for name, si in outputs(drive).items()})
"""What is measured of it."""

CHANNELS = MappingProxyType({**INPUTS, **OUTPUTS})
"""What of a bench is held against the model."""

GRIP_FORCE = "grip_force"
"""What a force sensor between hand and column shows, in a record in time: of the hand and not of the machine."""

RECORDED = MappingProxyType({**CHANNELS, GRIP_FORCE: "N"})
"""What a record in time may hold."""


def channel(text: str) -> str:
    """The channel that a header or an option calls ``text``: ``column angle`` is ``column_angle``.

    Raises:
        InputError: If there is none.
    """
    name = "_".join(text.strip().lower().split())
    if name not in CHANNELS:
        raise InputError(f"unknown channel {show(text)}; the channels are {', '.join(CHANNELS)}")
    return name


def channel_and_unit(text: str) -> tuple[str, str]:
    """Channel and unit of ``test_signal (V)``; the unit is empty where none is given.

    Raises:
        InputError: If there is no such channel.
    """
    column = heading(text, CHANNELS)
    return channel(column.name), column.unit


_UNITS = {
    quantity.si: quantity
    for quantity in (ANGLE, LENGTH, FORCE, PRESSURE, FLOW, CURRENT, ANGULAR_VELOCITY, VOLTAGE, TEMPERATURE)
}
_AMPERES = ("motor_current", "test_current", "command_current")
"""Currents that are no valve's: people read them in A."""


def channel_unit(channel: str) -> Unit:
    """The units of a channel."""
    return MOTOR_CURRENT if channel in _AMPERES else _UNITS[RECORDED[channel]]
