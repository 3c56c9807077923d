"""What a bridge asks of an aircraft simulator."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol


class Axis(StrEnum):
    """The control that a loader is.

    Example:
        >>> ff.bridge.Axis("pitch").value
        'pitch'
    """

    PITCH = "pitch"
    ROLL = "roll"
    YAW = "yaw"


@dataclass(frozen=True)
class SimulatorState:
    """What a simulator tells of the flight.

    Attributes:
        numbers: By the names of a host's packet, SI units; ``tab`` is a share of its travel, -1 to 1.
        frozen: Whether the simulator stands still.
        jammed: Whether the control is jammed.
        shaken: Whether the stick shaker is on.

    Example:
        >>> ff.bridge.SimulatorState({"dynamic_pressure": 1500.0, "true_airspeed": 50.0}).frozen
        False
    """

    numbers: Mapping[str, float] = field(default_factory=dict)
    frozen: bool = False
    jammed: bool = False
    shaken: bool = False


class Simulator(Protocol):
    """A simulator that a bridge speaks with.

    Example:
        >>> class Still:
        ...     def receive(self):
        ...         return ff.bridge.SimulatorState({"dynamic_pressure": 1500.0, "true_airspeed": 50.0})
        ...     def move(self, share):
        ...         pass
        ...     def close(self):
        ...         pass
        >>> ends = iter([False, True])
        >>> ff.bridge.bridge(Still(), ("127.0.0.1", 9), ff.bridge.BridgeSettings(0.25), lambda: next(ends)).states
        1
    """

    def receive(self) -> SimulatorState | None:
        """The newest state since the last call; ``None`` without a new one."""

    def move(self, share: float) -> None:
        """Put the aircraft's control to a share of its travel, -1 to 1."""

    def close(self) -> None:
        """Give the control back, and close the sockets."""
