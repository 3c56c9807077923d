"""A column at rest away from its programmed angle: held by an end stop, dry friction or the drive's limit."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.conclusions import of_result
from forcefeel.simulation.demanded import DEMANDED
from forcefeel.simulation.limits_met import AT
from forcefeel.simulation.outcome import BAND, Run, RunStatus, feel_position, per_feel_angle
from forcefeel.units import ANGLE

_TAIL = 10
"""The final angle is the mean over the last ``1 / _TAIL`` of the run, as in the measures."""


@dataclass(frozen=True)
class Hang:
    """A column at rest away from its programmed angle, over the last tenth of a run.

    Attributes:
        angle_rad: Mean of the column's angle.
        feel_rad: Mean of the programmed angle.
        held_by: The cause: an end stop or dry friction; empty if only the drive holds it.
        current: Whether the current was at its limit throughout.
    """

    angle_rad: Annotated[float, ANGLE]
    feel_rad: Annotated[float, ANGLE]
    held_by: str
    current: bool


@of_result
def hang(run: Run) -> Hang | None:
    """The hang of a settled column, more than ``BAND`` of its swing from the programmed angle; ``None`` without a cause.

    Example:
        >>> from forcefeel.simulation.hangs import hang
        >>> hang(ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0))))
    """
    if run.status is not RunStatus.SETTLED:
        return None
    loader, outputs = run.loader, run.outputs
    tail = slice(-max(len(outputs["time_s"]) // _TAIL, 1), None)

    def over_tail(name: str) -> NDArray[np.float64]:
        return np.asarray(outputs[name][tail])

    angle, feel = over_tail("column_angle_rad"), over_tail(feel_position(run)) / per_feel_angle(run)
    swing = run.measures.maximum_angle_rad - run.measures.minimum_angle_rad
    if not abs(feel.mean() - angle.mean()) > BAND * swing:
        return None
    first, *_ = DEMANDED[loader.drive]
    dry = loader["column.coulomb_friction"] > 0 or loader["column.static_friction"] > 0
    stuck = dry and not over_tail("column_velocity_rad_per_s").any()
    holders = {
        "on the lower end stop": bool((angle < loader["column.stop_low"]).all()),
        "on the upper end stop": bool((angle > loader["column.stop_high"]).all()),
        "in its dry friction": stuck,
    }
    held_by = next((name for name, holds in holders.items() if holds), "")
    current = bool((np.abs(over_tail(first.output)) >= loader[first.limit] * (1 - AT)).all())
    return Hang(float(angle.mean()), float(feel.mean()), held_by, current) if held_by or current else None
