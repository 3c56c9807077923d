"""Settings and interface of a running loop."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.law import LawLike
from forcefeel.loader.links import Link
from forcefeel.loader.loader import Loader


@dataclass(frozen=True)
class LoopSettings:
    """Requested settings of a loop, without the states of supervisor and hand.

    Attributes:
        loader: The loader with the current feel.
        law: The law, as in ``Law.of``.
        simulated: Whether the machine is simulated in the loop's process.
        around: Trim, spring factor and shaker.
        fault: Fault of a simulated machine.
        link: The link of its axis in a cockpit.
        link_holds: Whether the link was last requested to hold.
        priority: Whether the priority button is pressed.
        soften: Whether feels and values of a host are softened to what the drive renders.
        programmed: Stiffness of the programmed feel in N m/rad, and what softened it: a place in ``forbidden.REASONS``, -1 if
            nothing.
    """

    loader: Loader
    law: LawLike
    simulated: bool
    around: Mapping[str, float] = field(
        default_factory=lambda: {"trim_rad": 0.0, "stiffness_factor": 1.0, "shaker": 0.0}
    )
    fault: str = ""
    link: Link | None = None
    link_holds: bool = True
    priority: bool = False
    soften: bool = False
    programmed: tuple[float, int] = (0.0, -1)


class Loop(Protocol):
    """Interface of a running loop: ``_core.LiveLoop``, or a proxy of one in another process."""

    def request(self, name: str, numbers: list[float]) -> bool:
        """Send a request; return whether the ring had space."""
        ...

    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> bool:
        """Send an input to a simulated machine; return whether the ring had space."""
        ...

    def status(self) -> tuple[int, int, int, int, int, int, int, int, bool]:
        """Cycles, periods, missed, silent, lost, state, trips, number of the drive's fault, ended."""
        ...

    def recorded(self) -> tuple[int, int, str | None]:
        """Bytes of the record, rows missing after its early end, and the reason for that end."""
        ...

    def host_status(self) -> tuple[str, tuple[int, int, int], tuple[str, float | None] | None, str | None] | None:
        """Status of the aircraft simulator."""
        ...

    def history(self, since: float, most: int) -> NDArray[np.float64]:
        """The newest ``most`` rows of cycles after ``since``."""
        ...

    def timing(self) -> tuple[list[int], tuple[list[int], int], tuple[list[int], int]]:
        """Edges in ns; wake-up latency and working time, each as counts and the longest in ns."""
        ...

    def refused(self) -> list[str | None] | None:
        """Why priority, locked memory and an awake processor were refused."""
        ...

    def end(self) -> None:
        """End the loop."""
        ...
