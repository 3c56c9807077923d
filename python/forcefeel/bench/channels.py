"""Channels of a bench, their SI units and their names in headers."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.parameters import DRIVES, ELECTRIC, HYDRAULIC
from forcefeel.tables.header import heading
from forcefeel.units import BY_SI, MOTOR_CURRENT, Unit, show

_INPUTS: Mapping[str, Mapping[str, str]] = {
    HYDRAULIC: {"test_signal": "V", "pilot_force": "N", "command_signal": "V"},
    ELECTRIC: {"test_current": "A", "pilot_force": "N", "command_current": "A"},
}


@cache
def inputs(drive: str) -> Mapping[str, str]:
    """Input channels of a bench with that drive and their SI units, in the order of the model.

    The signal at the amplifier, e_T, or the current asked of the current loop; the pilot's force F_p at the grip; and a signal e_C
    that a digital controller adds to its command, so that it is sampled and comes with the controller's delay.
    """
    return MappingProxyType(dict(_INPUTS[drive]))


@cache
def outputs(drive: str) -> Mapping[str, str]:
    """Measured channels and their SI units, in the order of the model."""
    return MappingProxyType(dict(_core.channels(drive)))


INPUTS = MappingProxyType({name: si for drive in DRIVES for name, si in inputs(drive).items()})
"""Input channels of a bench, of either drive."""

OUTPUTS = MappingProxyType({name: si for drive in DRIVES for name, si in outputs(drive).items()})
"""Measured channels of a bench."""

CHANNELS = MappingProxyType({**INPUTS, **OUTPUTS})
"""Channels that are compared with the model."""

GRIP_FORCE = "grip_force"
"""Reading of a force sensor between hand and column in a time record; a quantity of the hand, not of the machine."""

RECORDED = MappingProxyType({**CHANNELS, GRIP_FORCE: "N"})
"""Channels of a time record."""


def channel(text: str) -> str:
    """The channel that a header or an option names: ``column angle`` is ``column_angle``.

    Raises:
        InputError: If the channel is unknown.
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


_AMPERES = ("motor_current", "test_current", "command_current")
"""Motor currents, which are stated in A."""


def channel_unit(channel: str) -> Unit:
    """The units of a channel."""
    return MOTOR_CURRENT if channel in _AMPERES else BY_SI[RECORDED[channel]]
