"""Settings that the valve forbids to every law, and the flow demand of free responses.

For the hands-off release of I', B', G from ``theta_0``, with its velocity, acceleration and jerk:

    p      = J theta'' / (alpha R_b A)                        load pressure, eqs. (6), (7) with T_p = 0
    x_p'   = alpha R_b theta' + A p' / k                      the piston moves the column and stretches the link, eq. (9)
    q      = A x_p' + V_E / (4 beta) p'                       eq. (5)
    q_0    = |q| / sqrt(1 - sgn(q) p / p_s)                   flow that the spool must let through at no load, eq. (1)
    q_0    = |q + C_p p|                                      if the flow follows the gains, eq. (4)
    q_0   <= min(q_max, (q_r / i_r) i_max)                    or C_i i_max; i_r for i_max without a limit

and p below the supply's pressure. The link's damper is neglected: it delays the stretch by c / k.

**The first instant.** At the release the link's torque changes from -G theta_0 to -J (G / I) theta_0. This takes at least

    t_0 = (A^2 / k + V_E / (4 beta)) |dp| / q,      dp = (1 - J / I) G theta_0 / (alpha R_b A),

at the largest flow, whatever the law; until then the column is not in free motion.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.plan import Plan
from forcefeel.frontier.drive_limits import DriveLimits, demands, motion
from forcefeel.frontier.second_order_bound import SettingGroup
from forcefeel.loader.loader import Loader
from forcefeel.sizing.valve import Valve
from forcefeel.units import FLOW


@dataclass(frozen=True, eq=False)
class ValveLimits(DriveLimits):
    """Limits of the valve; ``demand`` is infinite for a load pressure above the supply.

    Attributes:
        flow_m3_per_s: Largest flow at no load, limited by spool and current.
    """

    flow_m3_per_s: Annotated[float, FLOW]


def valve_limits(plan: Plan, *, threads: int | None = None) -> ValveLimits:
    """Compute the limits of a plan's valve at its settings, from its rule and angle; its laws are not used."""
    demand, forbidden = demands(plan, _peak, threads)
    feel = plan.settings.feel(plan.loader)
    unload = _unload_s(plan.loader, feel, plan.release_rad)
    return ValveLimits(demand, forbidden, unload, plan.settings.rows[:, 1], Valve(plan.loader).flow_m3_per_s)


def _peak(group: SettingGroup) -> NDArray[np.float64]:
    """Peak demand of each release for flow at no load, as a share of the largest flow."""
    valve = Valve(group.plan.loader)
    return np.asarray(np.max([valve.moving_shares(*moment)[1] for moment in motion(group)], axis=0))


def _unload_s(loader: Loader, feel: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """t_0 of the settings, with the available flow at the worse of both pressures."""
    valve = Valve(loader)
    held = -feel[:, 2] * angle / (valve.force_per_pressure * loader["column.grip_arm"])
    free = held * loader["column.inertia"] / feel[:, 0]
    jump, limit = free - held, valve.flow_m3_per_s
    worse = np.maximum(*(valve.statics.needed(np.sign(jump) * limit, pressure) for pressure in (held, free))) / limit
    return np.asarray(valve.statics.oil_compliance * np.abs(jump) * worse / limit)
