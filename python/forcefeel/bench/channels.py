"""What a bench measures: the channels, their SI units and how headers call them."""

from types import MappingProxyType

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.tables.header import heading
from forcefeel.units import ANGLE, ANGULAR_VELOCITY, CURRENT, FLOW, FORCE, LENGTH, PRESSURE, VOLTAGE, Unit, show

INPUTS = MappingProxyType({"test_signal": "V", "pilot_force": "N", "command_signal": "V"})
"""What drives the bench, and its SI unit: the test signal e_T at the amplifier, the pilot's force F_p at the grip, and a signal e_C
that a digital controller adds to its command, so that it is sampled and comes with the controller's delay."""

OUTPUTS = MappingProxyType(dict(_core.channels()))
"""What is measured of it, and its SI unit, in the order of the model's channels."""

CHANNELS = MappingProxyType({**INPUTS, **OUTPUTS})
"""All of them."""


def channel(given: str) -> str:
    """The channel that a header or an option calls ``given``: ``column angle`` is ``column_angle``.

    Raises:
        InputError: If there is none.
    """
    name = "_".join(given.strip().lower().split())
    if name not in CHANNELS:
        raise InputError(f"unknown channel {show(given)}; the channels are {', '.join(CHANNELS)}")
    return name


def channel_and_unit(text: str) -> tuple[str, str]:
    """Channel and unit of ``test_signal (V)``; the unit is empty where none is given.

    Raises:
        InputError: If there is no such channel.
    """
    found = heading(text, CHANNELS)
    return channel(found.name), found.unit


_UNITS = {one.si: one for one in (ANGLE, LENGTH, FORCE, PRESSURE, FLOW, CURRENT, ANGULAR_VELOCITY, VOLTAGE)}


def channel_unit(channel: str) -> Unit:
    """The units of a channel."""
    return _UNITS[CHANNELS[channel]]
