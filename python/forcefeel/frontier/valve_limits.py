"""What the valve forbids, whatever the law, and the flow that the free responses ask for.

Of the hands-off release of I', B', G from ``theta_0``, with its velocity, acceleration and jerk:

    p      = J theta'' / (alpha R_b A)                        load pressure, eqs. (6), (7) with T_p = 0
    x_p'   = alpha R_b theta' + A p' / k                      the piston moves the column and stretches the link, eq. (9)
    q      = A x_p' + V_E / (4 beta) p'                       eq. (5)
    q_0    = |q| / sqrt(1 - sgn(q) p / p_s)                   flow that the spool must let through at no load, eq. (1)
    q_0    = |q + C_p p|                                      where the flow follows the gains, eq. (4)
    q_0   <= min(q_max, (q_r / i_r) i_max)                    or C_i i_max; i_r for i_max where no limit is given

and p below the supply's pressure. The link's damper is left out: it lags the stretch by c / k.

**The first instant.** As the hand lets go the link's torque jumps from -G theta_0 to -J (G / I) theta_0. Until the link has let go
of that,

    t_0 = (A^2 / k + V_E / (4 beta)) |dp| / q,      dp = (1 - J / I) G theta_0 / (alpha R_b A),

the column is not yet in free motion; a law can make this no shorter than the largest flow lets it.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.plan import Plan
from forcefeel.frontier.drive_limits import DriveLimits, demands, motion
from forcefeel.frontier.referee import Referee
from forcefeel.loader.loader import Loader
from forcefeel.loader.valve_flow import no_load_flow, oil_compliance, spool_flow
from forcefeel.units import FLOW


@dataclass(frozen=True, eq=False)
class ValveLimits(DriveLimits):
    """What the valve forbids; ``demand`` is infinite where the load presses harder than the supply.

    Attributes:
        flow_m3_per_s: Flow at no load that the spool and the current let through.
    """

    flow_m3_per_s: Annotated[float, FLOW]


def valve_limits(plan: Plan, *, threads: int | None = None) -> ValveLimits:
    """What the valve of a plan's loader forbids at its settings.

    Args:
        plan: The envelope: its settings, rule and angle; its compensators are not used.
        threads: How many; all cores if not given.
    """
    demand, forbidden = demands(plan, _peak, threads)
    feel = plan.settings.feel(plan.loader)
    unload = _unload_s(plan.loader, feel, plan.release_rad)
    return ValveLimits(demand, forbidden, unload, plan.settings.rows[:, 1], spool_flow(plan.loader))


def _peak(referee: Referee, feel: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest flow at no load that each release asks for, as a share of what the spool lets through."""
    loader, found = referee.plan.loader, np.zeros(len(feel))
    limit = spool_flow(loader)
    for velocity, acceleration, jerk in motion(referee, feel):
        pressure, pressure_rate = (loader["column.inertia"] * one / _lever(loader) for one in (acceleration, jerk))
        piston = loader["linkage.ratio"] * loader["column.base_arm"] * velocity  # x_p' but for the stretch
        flow = loader["actuator.area"] * piston + oil_compliance(loader) * pressure_rate
        found = np.maximum(found, no_load_flow(loader, flow, pressure) / limit)
    return found


def _lever(loader: Loader) -> float:
    """Torque on the column per load pressure, ``alpha R_b A``, N m/Pa."""
    return loader["linkage.ratio"] * loader["column.base_arm"] * loader["actuator.area"]


def _unload_s(loader: Loader, feel: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """t_0 of the settings, with the flow that is left at the worse of both pressures."""
    held = -feel[:, 2] * angle / _lever(loader)
    free = held * loader["column.inertia"] / feel[:, 0]
    jump = free - held
    limit = spool_flow(loader)
    worse = np.maximum(*(no_load_flow(loader, np.sign(jump) * limit, one) for one in (held, free))) / limit
    return np.asarray(oil_compliance(loader) * np.abs(jump) * worse / limit)
