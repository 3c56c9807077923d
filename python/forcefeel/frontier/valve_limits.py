"""What the valve forbids, whatever the law: settings whose free response asks for more flow than the orifice lets through.

Of the hands-off release of I', B', G from ``theta_0``, with its velocity, acceleration and jerk:

    p      = J theta'' / (alpha R_b A)                        load pressure, eqs. (6), (7) with T_p = 0
    x_p'   = alpha R_b theta' + A p' / k                      the piston moves the column and stretches the link, eq. (9)
    q      = A x_p' + V_E / (4 beta) p'                       eq. (5)
    q_0    = |q| / sqrt(1 - sgn(q) p / p_s)                   flow that the spool must let through at no load, eq. (1)
    q_0    = |q + C_p p|                                      where the flow follows the gains, eq. (4)
    q_0   <= min(q_max, (q_r / i_r) i_max)                    or C_i i_max; i_r for i_max where no limit is given

and p below the supply's pressure. The link's damper is left out: it lags the stretch by c / k.

A response may differ from the ideal as far as the rule's tolerances go. Forbidden is a setting of which *no* trial response
that passes, ``SLOWER`` in frequency at the programmed damping ratio, stays within the limits all the time.

**The first instant.** As the hand lets go the link's torque jumps from -G theta_0 to -J (G / I) theta_0. Until the link has let go
of that,

    t_0 = (A^2 / k + V_E / (4 beta)) |dp| / q,      dp = (1 - J / I) G theta_0 / (alpha R_b A),

the column is not yet in free motion; a law can make this no shorter than the largest flow lets it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.plan import Plan
from forcefeel.frontier.referee import Referee, referees
from forcefeel.loader.loader import Loader
from forcefeel.loader.valve_flow import no_load_flow, spool_flow
from forcefeel.threads import threads_or_cores
from forcefeel.units import FLOW, PERCENT, SECONDS

SLOWER = (1.0, 0.97, 0.94, 0.91, 0.88)
"""Frequencies of the trial responses as shares of the programmed one: the slower, the less flow."""


@dataclass(frozen=True, eq=False)
class ValveLimits:
    """What the valve forbids.

    Attributes:
        flow_m3_per_s: Flow at no load that the spool and the current let through.
        demand: Flow that each setting's ideal asks of the spool at the worst moment, as a share of it; infinite where the load
            presses harder than the supply, (settings,).
        least: The least of any trial response that passes, (settings,).
        unload_s: How long the link takes at least to let go of the hand's torque, (settings,).
        frequency: The settings' natural frequencies, rad/s.
    """

    flow_m3_per_s: Annotated[float, FLOW]
    demand: NDArray[np.float64] = field(repr=False)
    least: NDArray[np.float64] = field(repr=False)
    unload_s: NDArray[np.float64] = field(repr=False)
    frequency: NDArray[np.float64] = field(repr=False)

    @property
    def forbidden(self) -> NDArray[np.bool_]:
        """Which settings the valve forbids whatever the law, (settings,)."""
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


def valve_limits(plan: Plan, *, threads: int | None = None) -> ValveLimits:
    """What the valve of a plan's loader forbids at its settings.

    Args:
        plan: The envelope: its settings, rule and angle; its compensators are not used.
        threads: How many; all cores if not given.
    """
    count = plan.settings.count
    demand, least = np.zeros(count), np.zeros(count)
    for referee in referees(plan, threads_or_cores(threads)):
        demand[referee.which], least[referee.which] = _demands(referee)
    feel = plan.settings.feel(plan.loader)
    unload = _unload_s(plan.loader, feel, plan.release_rad)
    return ValveLimits(spool_flow(plan.loader), demand, least, unload, plan.settings.rows[:, 1])


def _demands(referee: Referee) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Share of the spool's flow that the ideal takes, and the least of any trial response that passes."""
    ideal = least = np.full(len(referee.which), np.inf)
    for share in SLOWER:
        trial = referee.feel / [share**2, share, 1.0]  # I' = G / w'^2, B' = 2 zeta w' I'
        asked = _peak(referee, trial)
        if share == 1.0:
            ideal = asked
        least = np.where(referee.passes(trial), np.minimum(least, asked), least)
        if (least <= 1).all():
            break
    return ideal, least


def _peak(referee: Referee, feel: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest flow at no load that each release asks for, as a share of what the spool lets through."""
    loader, found = referee.plan.loader, np.zeros(len(feel))
    limit = spool_flow(loader)
    for velocity, acceleration, jerk in _motion(referee, feel):
        pressure, pressure_rate = (loader["column.inertia"] * one / _lever(loader) for one in (acceleration, jerk))
        piston = loader["linkage.ratio"] * loader["column.base_arm"] * velocity  # x_p' but for the stretch
        flow = loader["actuator.area"] * piston + oil_compliance(loader) * pressure_rate
        found = np.maximum(found, no_load_flow(loader, flow, pressure) / limit)
    return found


def oil_compliance(loader: Loader) -> float:
    """Oil that a rise of the load pressure takes, m^3/Pa: ``A^2 / k`` into the link, ``V_E / (4 beta)`` into itself."""
    area = loader["actuator.area"]
    return area**2 / loader["linkage.stiffness"] + loader["actuator.oil_volume"] / (4 * loader["actuator.bulk_modulus"])


def _lever(loader: Loader) -> float:
    """Torque on the column per load pressure, ``alpha R_b A``, N m/Pa."""
    return loader["linkage.ratio"] * loader["column.base_arm"] * loader["actuator.area"]


def _motion(
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


def _unload_s(loader: Loader, feel: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """t_0 of the settings, with the flow that is left at the worse of both pressures."""
    held = -feel[:, 2] * angle / _lever(loader)
    free = held * loader["column.inertia"] / feel[:, 0]
    jump = free - held
    limit = spool_flow(loader)
    worse = np.maximum(*(no_load_flow(loader, np.sign(jump) * limit, one) for one in (held, free))) / limit
    return np.asarray(oil_compliance(loader) * np.abs(jump) * worse / limit)
