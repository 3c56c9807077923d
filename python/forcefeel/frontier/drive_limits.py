"""What a drive forbids, whatever the law, and what the ideal releases ask of it beside what it gives.

Forbidden is what the drive cannot fall fast enough for, or not hold (``envelope.forbidden``). An ideal that asks for more than the
drive gives at some moment is not forbidden by that: the rule's tolerances leave room, of times most of all.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.forbidden import NOISE, forbidden
from forcefeel.envelope.plan import Plan
from forcefeel.frontier.second_order_bound import Referee, referees
from forcefeel.threads import threads_or_cores
from forcefeel.units import PERCENT, SECONDS


@dataclass(frozen=True, eq=False)
class DriveLimits:
    """What the drive forbids.

    Attributes:
        demand: What each setting's ideal asks of the drive at the worst moment, as a share of what it gives, (settings,).
        forbidden: Which settings the drive forbids whatever the law, (settings,).
        unload_s: How long the link takes at least to let go of the hand's torque, (settings,).
        frequency: The settings' natural frequencies, rad/s.
    """

    demand: NDArray[np.float64] = field(repr=False)
    forbidden: NDArray[np.bool_] = field(repr=False)
    unload_s: NDArray[np.float64] = field(repr=False)
    frequency: NDArray[np.float64] = field(repr=False)

    @property
    def forbidden_share(self) -> Annotated[float, PERCENT]:
        """Share of all settings."""
        return float(self.forbidden.mean())

    @property
    def beyond_ideal_share(self) -> Annotated[float, PERCENT]:
        """Share of the settings whose very ideal asks for more than the limits, forbidden or not."""
        return float((self.demand > 1).mean())

    @property
    def longest_unload_s(self) -> Annotated[float, SECONDS]:
        """The longest time to let go of the hand's torque."""
        return float(self.unload_s.max())

    @property
    def longest_unload_of_period(self) -> Annotated[float, PERCENT]:
        """The same as a share of the setting's period, the largest of any setting."""
        return float((self.unload_s * self.frequency / (2 * np.pi)).max())


Peak = Callable[[Referee, NDArray[np.float64]], NDArray[np.float64]]
"""Largest demand of each release I', B', G on a drive, as a share of what it gives."""


def demands(plan: Plan, peak: Peak, threads: int | None) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Share of what the drive gives that each setting's ideal takes, and which settings the drive forbids."""
    demand = np.zeros(plan.settings.count)
    for referee in referees(plan, threads_or_cores(threads)):
        demand[referee.which] = peak(referee, referee.feel)
    limits = forbidden(plan, threads=threads)
    return demand, limits.settings & ~limits.of(NOISE)


def motion(
    referee: Referee, feel: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]:
    """Velocity, acceleration and jerk of the releases at each sample of the first period and a half."""
    inertia, damping, stiffness = feel.T
    step = _core.feel_transitions(feel, np.array([referee.record.step_s]))[:, 0]
    state = np.tile([referee.plan.release_rad, 0.0], (len(feel), 1))
    periods = 1.5 * 2 * np.pi / float(np.sqrt(stiffness / inertia).min())  # later swings are smaller
    for _ in range(min(referee.record.samples, int(np.ceil(periods / referee.record.step_s)))):
        velocity = state[:, 1]
        acceleration = -(damping * velocity + stiffness * state[:, 0]) / inertia
        yield velocity, acceleration, -(damping * acceleration + stiffness * velocity) / inertia
        state = np.einsum("sij,sj->si", step, state)
