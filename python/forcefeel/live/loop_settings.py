"""What a running loop is held by: what is asked of it, and what it offers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.law import LawLike
from forcefeel.loader.loader import Loader


@dataclass(frozen=True)
class LoopSettings:
    """What is asked of a loop, but for the states of the supervisor and the hand.

    Attributes:
        loader: The loader with the feel as programmed.
        law: As ``Law.of`` takes it.
        simulated: Whether the machine is simulated in the loop's process.
        around: Trim, factor on the spring, shaker.
        fault: What is broken of a simulated machine.
    """

    loader: Loader
    law: LawLike
    simulated: bool
    around: Mapping[str, float] = field(
        default_factory=lambda: {"trim_rad": 0.0, "stiffness_factor": 1.0, "shaker": 0.0}
    )
    fault: str = ""


class Loop(Protocol):
    """What a loop under way offers: ``_core.LiveLoop``, or one of another process."""

    def request(self, name: str, numbers: list[float]) -> bool:
        """Asks something of it; whether there was room for that."""
        ...

    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> bool:
        """Does something to a simulated machine; whether there was room for that."""
        ...

    def status(self) -> tuple[int, int, int, int, int, int, int, bool]:
        """Cycles, beats, missed, silent, lost, state, trips, ended."""
        ...

    def recorded(self) -> tuple[int, int, str | None]:
        """Bytes of the record, rows that it lacks because it ended before the loop, and why it did."""
        ...

    def host_status(self) -> tuple[str, int, int, tuple[str, float] | None] | None:
        """Status of the aircraft simulator."""
        ...

    def history(self, since: float, most: int) -> NDArray[np.float64]:
        """The newest ``most`` rows of cycles after ``since``."""
        ...

    def timing(self) -> tuple[list[int], tuple[list[int], int], tuple[list[int], int]]:
        """Edges in ns; how late it woke and how long it worked, each as counts and the longest in ns."""
        ...

    def refused(self) -> list[str | None] | None:
        """Why there is no priority, no locked memory, no processor that stays awake."""
        ...

    def end(self) -> None:
        """Ends it."""
        ...
