"""Settings that a drive forbids to every law, and the demand of ideal releases as a share of the drive's capability.

A setting is forbidden if the drive cannot return fast enough or cannot hold the force (``envelope.forbidden``). A demand above the
capability does not forbid a setting, because the rule has tolerances, above all of times.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.forbidden import NOISE, forbidden
from forcefeel.envelope.plan import Plan
from forcefeel.frontier.second_order_bound import SettingGroup, setting_groups
from forcefeel.linear.release_motion import release_motion
from forcefeel.sizing.demand import PERIODS
from forcefeel.threads import threads_or_cores
from forcefeel.units import PERCENT, SECONDS


@dataclass(frozen=True, eq=False)
class DriveLimits:
    """Limits of the drive over a plan's settings.

    Attributes:
        demand: Peak demand of each setting's ideal, as a share of the drive's capability, (settings,).
        forbidden: Settings that the drive forbids to every law, (settings,).
        unload_s: Shortest time to unload the link of the hand's torque, (settings,).
        frequency: Natural frequencies of the settings, rad/s.
    """

    demand: NDArray[np.float64] = field(repr=False)
    forbidden: NDArray[np.bool_] = field(repr=False)
    unload_s: NDArray[np.float64] = field(repr=False)
    frequency: NDArray[np.float64] = field(repr=False)

    @property
    def forbidden_share(self) -> Annotated[float, PERCENT]:
        """Share of all settings that the drive forbids."""
        return float(self.forbidden.mean())

    @property
    def beyond_ideal_share(self) -> Annotated[float, PERCENT]:
        """Share of the settings with an ideal beyond the limits, forbidden or not."""
        return float((self.demand > 1).mean())

    @property
    def longest_unload_s(self) -> Annotated[float, SECONDS]:
        """Longest time to unload the link."""
        return float(self.unload_s.max())

    @property
    def longest_unload_of_period(self) -> Annotated[float, PERCENT]:
        """Longest time to unload the link as a share of the setting's period."""
        return float((self.unload_s * self.frequency / (2 * np.pi)).max())


Peak = Callable[[SettingGroup], NDArray[np.float64]]
"""Peak demand of each setting's release on a drive, as a share of its capability."""


def demands(plan: Plan, peak: Peak, threads: int | None) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Peak demand of each setting's ideal as a share of the capability, and the settings that the drive forbids."""
    demand = np.zeros(plan.settings.count)
    for group in setting_groups(plan, threads_or_cores(threads)):
        demand[group.which] = peak(group)
    limits = forbidden(plan, threads=threads)
    return demand, limits.settings & ~limits.of(NOISE)


def motion(group: SettingGroup) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]:
    """Velocity, acceleration and jerk of the settings' releases at each sample of the first 1.5 periods."""
    plan, record = group.plan, group.record
    periods = PERIODS * 2 * np.pi / float(plan.settings.rows[group.which, 1].min())
    samples = min(record.samples, int(np.ceil(periods / record.step_s)))
    return release_motion(plan.loader, group.feel, plan.release_rad, record.step_s, samples)
