"""The axes of a cockpit, and the built-in loaders by the axis that each is of.

It imports nothing heavy, so that help, which names the loaders, waits for no numerical library.
"""

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Literal

FlightAxis = Literal["pitch", "roll", "yaw"]
RuleAxis = Literal[FlightAxis, "collective"]

_STICK = "stick-"

_COLLECTIVE = "collective"

_SECOND = "-first-officer"

_FIRST_AXES = ("pitch", "roll", "yaw", f"{_STICK}pitch", f"{_STICK}roll", _COLLECTIVE)

PROJECT_AXES = (*_FIRST_AXES, *(f"{axis}{_SECOND}" for axis in _FIRST_AXES))
"""Names of the axes: of column, wheel and pedals, of a stick, and of a collective lever; of a second pilot likewise."""

HYDRAULIC_AXES: Mapping[str, str] = MappingProxyType({"elevator-2khz": "pitch", "elevator-1974": "pitch"})
"""The built-in loaders with a valve, and the axis of each."""

ELECTRIC_AXES: Mapping[str, str] = MappingProxyType(
    {
        "elevator-electric": "pitch",
        "aileron-wheel": "roll",
        "rudder-pedals": "yaw",
        "sidestick-pitch": "stick-pitch",
        "sidestick-roll": "stick-roll",
        "desktop-yoke": "roll",
    }
)
"""The built-in loaders with a motor, each the file of its name in ``data/loaders``, and the axis of each."""

AXIS_OF: Mapping[str, str] = MappingProxyType({**HYDRAULIC_AXES, **ELECTRIC_AXES})
"""All built-in loaders, and the axis of each."""


def motion_axis(axis: str) -> str:
    """The axis without the pilot: that of a first officer is that of the captain."""
    return axis.removesuffix(_SECOND)


def judged_alone(axes: Iterable[str]) -> tuple[str, ...]:
    """The sentence for axes that are judged one by one if some are a second pilot's; none otherwise."""
    second = any(axis.endswith(_SECOND) for axis in axes)
    return (
        "Each axis is judged by itself, without its link. To run linked controls, use forcefeel simulate.",
    ) * second


def control_of(axis: str) -> str:
    """Which control an axis is of where sticks count as one: ``pitch``, ``roll``, ``yaw``, ``collective`` or ``stick``."""
    return "stick" if axis.startswith(_STICK) else motion_axis(axis)


def flight_axis(axis: str) -> FlightAxis:
    """The axis of the aircraft that a control moves; pitch of a collective, which no flight has."""
    of: dict[str, FlightAxis] = {"pitch": "pitch", "roll": "roll", "yaw": "yaw"}
    return of.get(motion_axis(axis).removeprefix(_STICK), "pitch")


def rule_axis(axis: str) -> RuleAxis:
    """The axis of a qualification rule, which has no rows of a stick's own."""
    return "collective" if motion_axis(axis) == _COLLECTIVE else flight_axis(axis)


def usual_axis(name: str) -> str:
    """The axis of a loader of that name by default: that of a built-in loader, else pitch."""
    return AXIS_OF.get(name, "pitch")
