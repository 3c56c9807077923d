"""Valid measures of a run, and times at its limits."""

from dataclasses import dataclass, fields
from math import inf, isnan, nan
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.conclusions import of_result
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.simulation.demanded import DEMANDED, Demanded
from forcefeel.simulation.inputs import Chirp, Force, Multisine, Release, Step, StopToStop
from forcefeel.simulation.outcome import (
    BAND,
    Measures,
    MotorMeasures,
    Run,
    RunStatus,
    feel_position,
    per_feel_angle,
)
from forcefeel.units import PERCENT, SECONDS

_PEAK = 5.0
"""Standard deviations that noise reaches to either side in a million samples."""

_HIDES = 200.0
"""An overshoot of fewer standard deviations of the noise is not known to 1 %, twice its uncertainty."""

AT = 1e-6
"""Share of a limit that is the limit but for rounding."""


@dataclass(frozen=True)
class LimitTimes:
    """Times at limits during a run; zero where the loader has no such limit.

    Attributes:
        current: Share of the time that the current was at the amplifier's limit.
        voltage: Share of the time that a motor's voltage was at the amplifier's limit; zero for a valve.
        over_current: Share of the time that the current was above the valve's rating; zero for a motor, as the next two.
        over_flow: Share of the time that the flow was above the valve's rating.
        over_pressure: Share of the time that the load pressure was above the supply's.
        stop_low_s: Time of the column at its lower stop.
        stop_high_s: Time at its upper stop.
        feel_low_s: Time of the programmed control at its lower hard stop.
        feel_high_s: Time at its upper hard stop.
        stuck_s: Time for which dry friction held the column after its first motion.
        stuck_at_end: Whether dry friction held it at the end.
    """

    current: Annotated[float, PERCENT]
    voltage: Annotated[float, PERCENT]
    over_current: Annotated[float, PERCENT]
    over_flow: Annotated[float, PERCENT]
    over_pressure: Annotated[float, PERCENT]
    stop_low_s: Annotated[float, SECONDS]
    stop_high_s: Annotated[float, SECONDS]
    feel_low_s: Annotated[float, SECONDS]
    feel_high_s: Annotated[float, SECONDS]
    stuck_s: Annotated[float, SECONDS]
    stuck_at_end: bool


@of_result
def limit_times(run: Run) -> LimitTimes:
    """Times at limits, from the samples of the run up to its divergence.

    Example:
        >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0)))
        >>> ff.simulation.limit_times(run).over_current
        0.0
    """
    loader, outputs, sample_s = run.loader, run.outputs, run.scenario.sample_s
    known = np.isfinite(outputs["column_angle_rad"])
    angle, velocity, feel = (
        outputs[name][known] for name in ("column_angle_rad", "column_velocity_rad_per_s", feel_position(run))
    )
    feel_angle = feel / per_feel_angle(run)
    moved = np.maximum.accumulate(velocity != 0) if len(velocity) else np.zeros(0, bool)
    dry = loader["column.coulomb_friction"] > 0 or loader["column.static_friction"] > 0
    stuck = moved & (velocity == 0) & dry

    def share(beyond: NDArray[np.bool_]) -> float:
        return float(np.mean(beyond)) if len(beyond) else 0.0

    def seconds(beyond: NDArray[np.bool_]) -> float:
        return float(np.count_nonzero(beyond)) * sample_s

    def over(row: Demanded) -> float:
        return share(np.abs(outputs[row.output][known]) > loader[row.whole] * (1 + AT))

    def at_limit(row: Demanded) -> float:
        return share(np.abs(outputs[row.output][known]) >= loader[row.limit] * (1 - AT))

    first, second, _ = rows = DEMANDED[loader.drive]
    over_current, over_flow, over_pressure = map(over, rows) if loader.drive == HYDRAULIC else (0.0, 0.0, 0.0)
    return LimitTimes(
        current=at_limit(first),
        voltage=at_limit(second) if loader.drive == ELECTRIC else 0.0,
        over_current=over_current,
        over_flow=over_flow,
        over_pressure=over_pressure,
        stop_low_s=seconds(angle < loader["column.stop_low"]),
        stop_high_s=seconds(angle > loader["column.stop_high"]),
        feel_low_s=seconds(_reached(-feel_angle, -loader["feel.hard_stop_low"])),
        feel_high_s=seconds(_reached(feel_angle, loader["feel.hard_stop_high"])),
        stuck_s=seconds(stuck),
        stuck_at_end=bool(len(stuck) and stuck[-1]),
    )


@of_result
def known_measures(run: Run) -> Measures | MotorMeasures:
    """The valid measures; for a diverged run only the time of divergence.

    Overshoot and period require an input that leads to a new equilibrium. Final and equilibrium angle and settling time require
    an input that ends before the run.
    """
    kind = type(run.measures)
    values = {field.name: getattr(run.measures, field.name) for field in fields(kind)}
    if run.status is RunStatus.DIVERGED:
        return kind(**dict.fromkeys(values, nan) | {"diverged_at_s": run.measures.diverged_at_s})
    if not goes_to_a_place(run.scenario.force):
        values |= dict.fromkeys(("overshoot", "period_s", "periods"), nan)
    if keeps_moving(run.scenario.force):
        left_alone = ("final_angle_rad", "equilibrium_angle_rad", "settling_time_s", "last_swing_rad")
        values |= dict.fromkeys(left_alone, nan)
    return kind(**values)


def why_no_overshoot(run: Run) -> str:
    """Why there is no overshoot after the end of the input; empty if there is one, or if the input does not end."""
    if run.status is RunStatus.DIVERGED or keeps_moving(run.scenario.force):
        return ""
    if not goes_to_a_place(run.scenario.force):
        return "the input leads to no new place"
    return _why_no_number(run) if isnan(run.measures.overshoot) else ""


def below_noise(run: Run) -> bool:
    """Whether the motion of the column is within sensor noise."""
    return run.measures.maximum_angle_rad - run.measures.minimum_angle_rad < 2 * _PEAK * run.angle_noise_rad


def _why_no_number(run: Run) -> str:
    """Why a run that leads to a new equilibrium has no valid overshoot."""
    measures, met = run.measures, limit_times(run)
    first, end = float(run.outputs["column_angle_rad"][0]), measures.equilibrium_angle_rad
    low, high = measures.minimum_angle_rad, measures.maximum_angle_rad
    travel, excursion, beyond = (
        abs(end - first),
        max(high - first, first - low),
        high - end if end > first else end - low,
    )
    if isnan(end):
        return "the column is not left alone in the end"
    if met.stop_low_s or met.stop_high_s or met.feel_low_s or met.feel_high_s:
        return "the column met a stop"
    if below_noise(run):
        return "the column moved no farther than noise moves it"
    if min(travel, excursion) <= BAND * max(travel, excursion):
        return "the column ended where it began"
    if _HIDES * run.angle_noise_rad > max(beyond, BAND * travel):
        return "the noise of the sensors hides it"
    return "the run ends before it is known"


def goes_to_a_place(force: Force) -> bool:
    """Whether the input takes the column from one rest to another: a step or a release."""
    return isinstance(force, Step | Release)


def keeps_moving(force: Force) -> bool:
    """Whether the input goes on to the end of the run."""
    return isinstance(force, StopToStop | Chirp | Multisine)


def _reached(angle: NDArray[np.float64], bound: float) -> NDArray[np.bool_]:
    return angle >= bound - AT * abs(bound) if bound < inf else np.zeros(len(angle), bool)
