"""What a drive forbids, whatever the law: settings whose free response asks for more than it gives.

A response may differ from the ideal as far as the rule's tolerances go. Forbidden is a setting of which *no* trial response
that passes, ``SLOWER`` in frequency at the programmed damping ratio, stays within the limits all the time.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.plan import Plan
from forcefeel.frontier.referee import Referee, referees
from forcefeel.threads import threads_or_cores
from forcefeel.units import PERCENT, SECONDS

SLOWER = (1.0, 0.97, 0.94, 0.91, 0.88)
"""Frequencies of the trial responses as shares of the programmed one: the slower, the less is asked for."""


@dataclass(frozen=True, eq=False)
class DriveLimits:
    """What the drive forbids.

    Attributes:
        demand: What each setting's ideal asks of the drive at the worst moment, as a share of what it gives, (settings,).
        least: The least of any trial response that passes, (settings,).
        unload_s: How long the link takes at least to let go of the hand's torque, (settings,).
        frequency: The settings' natural frequencies, rad/s.
    """

    demand: NDArray[np.float64] = field(repr=False)
    least: NDArray[np.float64] = field(repr=False)
    unload_s: NDArray[np.float64] = field(repr=False)
    frequency: NDArray[np.float64] = field(repr=False)

    @property
    def forbidden(self) -> NDArray[np.bool_]:
        """Which settings the drive forbids whatever the law, (settings,)."""
        return np.asarray(self.least > 1)

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


def demands(plan: Plan, peak: Peak, threads: int | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Share of what the drive gives that each setting's ideal takes, and the least of any trial response that passes."""
    demand, least = np.zeros(plan.settings.count), np.zeros(plan.settings.count)
    for referee in referees(plan, threads_or_cores(threads)):
        demand[referee.which], least[referee.which] = _demands(referee, peak)
    return demand, least


def _demands(referee: Referee, peak: Peak) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    ideal = least = np.full(len(referee.which), np.inf)
    for share in SLOWER:
        trial = referee.feel / [share**2, share, 1.0]  # I' = G / w'^2, B' = 2 zeta w' I'
        asked = peak(referee, trial)
        if share == 1.0:
            ideal = asked
        least = np.where(referee.passes(trial), np.minimum(least, asked), least)
        if (least <= 1).all():
            break
    return ideal, least


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
