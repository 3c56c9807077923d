"""Flow that a hydraulic loader's valve lets through, at no load and against a load pressure: eqs. (1), (3), (4).

``q_r``, ``i_r`` rated flow and current · ``i_max`` the amplifier's limit · ``q_max`` the spool's · ``p`` load pressure ·
``p_s`` supply · ``A`` piston · ``k`` link · ``V_E``, ``beta`` oil
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader


def spool_flow(loader: Loader) -> float:
    """Largest flow at no load, m^3/s: of the current, eq. (1) or (3), and of the spool's stroke."""
    limit = loader["amplifier.current_limit"]
    return min(
        loader["valve.flow_limit"],
        flow_of_current(loader, limit if np.isfinite(limit) else loader["valve.rated_current"]),
    )


def flow_of_current(loader: Loader, current: float) -> float:
    """Flow at no load of a current in A, m^3/s, whatever the spool's stroke: eq. (1) or (3)."""
    rated = loader["valve.rated_current"]
    return current * (loader["valve.rated_flow"] / rated if loader["valve.orifice"] else loader["valve.current_gain"])


def oil_compliance(loader: Loader) -> float:
    """Oil that a rise of the load pressure takes, m^3/Pa: ``A^2 / k`` into the link, ``V_E / (4 beta)`` into itself."""
    area = loader["actuator.area"]
    return area**2 / loader["linkage.stiffness"] + loader["actuator.oil_volume"] / (4 * loader["actuator.bulk_modulus"])


def no_load_flow(loader: Loader, flow: NDArray[np.float64], pressure: NDArray[np.float64]) -> NDArray[np.float64]:
    """Flow that the spool must let through at no load for so much against a load pressure; infinite where there is none."""
    share = np.sign(flow) * pressure / loader["valve.supply_pressure"]
    if loader["valve.orifice"]:
        needed = np.abs(flow) / np.sqrt(np.where(share < 1, 1 - share, 1.0))
    else:
        needed = np.abs(flow + loader["valve.pressure_gain"] * pressure)
    return np.asarray(np.where(share < 1, needed, np.inf))
