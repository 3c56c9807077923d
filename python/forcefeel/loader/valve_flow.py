"""Flow that a hydraulic loader's valve lets through, at no load and against a load pressure: eqs. (1), (3), (4).

``q_r``, ``i_r`` rated flow and current · ``i_max`` the amplifier's limit · ``q_max`` the spool's · ``p`` load pressure ·
``p_s`` supply
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader


def spool_flow(loader: Loader) -> float:
    """Largest flow at no load, m^3/s: of the current, eq. (1) or (3), and of the spool's stroke."""
    limit, rated = loader["amplifier.current_limit"], loader["valve.rated_current"]
    by_current = loader["valve.rated_flow"] / rated if loader["valve.orifice"] else loader["valve.current_gain"]
    return min(loader["valve.flow_limit"], by_current * (limit if np.isfinite(limit) else rated))


def no_load_flow(loader: Loader, flow: NDArray[np.float64], pressure: NDArray[np.float64]) -> NDArray[np.float64]:
    """Flow that the spool must let through at no load for so much against a load pressure; infinite where there is none."""
    share = np.sign(flow) * pressure / loader["valve.supply_pressure"]
    if loader["valve.orifice"]:
        needed = np.abs(flow) / np.sqrt(np.where(share < 1, 1 - share, 1.0))
    else:
        needed = np.abs(flow + loader["valve.pressure_gain"] * pressure)
    return np.asarray(np.where(share < 1, needed, np.inf))
