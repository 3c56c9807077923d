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

from forcefeel import _core
from forcefeel.envelope.plan import Plan
from forcefeel.frontier.drive_limits import DriveLimits, demands, motion
from forcefeel.frontier.second_order_bound import Referee
from forcefeel.loader.loader import Loader
from forcefeel.sizing.valve import Valve
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
        plan: The envelope: its settings, rule and angle; its laws are not used.
        threads: How many; all cores if not given.
    """
    demand, forbidden = demands(plan, _peak, threads)
    feel = plan.settings.feel(plan.loader)
    unload = _unload_s(plan.loader, feel, plan.release_rad)
    return ValveLimits(demand, forbidden, unload, plan.settings.rows[:, 1], Valve(plan.loader).flow_m3_per_s)


def _peak(referee: Referee, feel: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest flow at no load that each release asks for, as a share of what the spool lets through."""
    loader, valve, found = referee.plan.loader, Valve(referee.plan.loader), np.zeros(len(feel))
    arm, per_pressure = loader["column.grip_arm"], valve.force_per_pressure
    for velocity, acceleration, jerk in motion(referee, feel):
        pressure, pressure_rate = (
            _core.column_grip_force(loader.si_values, one) / per_pressure for one in (acceleration, jerk)
        )
        flow = per_pressure * arm * velocity + valve.statics.oil_compliance * pressure_rate
        found = np.maximum(found, valve.statics.needed(flow, pressure) / valve.flow_m3_per_s)
    return found


def _unload_s(loader: Loader, feel: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """t_0 of the settings, with the flow that is left at the worse of both pressures."""
    valve = Valve(loader)
    held = -feel[:, 2] * angle / (valve.force_per_pressure * loader["column.grip_arm"])
    free = held * loader["column.inertia"] / feel[:, 0]
    jump, limit = free - held, valve.flow_m3_per_s
    worse = np.maximum(*(valve.statics.needed(np.sign(jump) * limit, one) for one in (held, free))) / limit
    return np.asarray(valve.statics.oil_compliance * np.abs(jump) * worse / limit)
