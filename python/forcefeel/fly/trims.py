"""Forces that hold the column in flights that JSBSim trims, for the feel without the loader."""

from collections.abc import Mapping

import numpy as np

from forcefeel import _core
from forcefeel.fly.aircraft import Aircraft, flight_row, with_surface
from forcefeel.loader.loader import Loader

_PULLS = (1.2, 1.4)


def held_force(loader: Loader, state: Mapping[str, float], angle_rad: float) -> float:
    """Force at the grip, N, that holds the column at an angle in a flight state: feel and hinge moment at rest, without friction.

    Args:
        loader: With the aircraft's surface, as ``Flown.loader``.
        state: Flight state by the names of a host's packet.
        angle_rad: Angle of the column.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> loader = ff.fly.with_surface(ff.digital_elevator(), aircraft)
        >>> round(ff.fly.held_force(loader, aircraft.state(), 0.0), 6) + 0
        0.0
    """
    (force,) = _core.feel_held_in_flight(loader.si_values, np.array([[*flight_row(state), angle_rad]])).tolist()
    return float(force)


def trimmed_force(loader: Loader, trim: Aircraft, flown: Aircraft) -> float:
    """Force at the grip, N, that holds a flight which JSBSim trims, with the tab of another.

    Args:
        loader: With the surface of ``trim``, as by ``with_surface``.
        trim: The flight without a force.
        flown: The held flight.

    Example:
        >>> trim, faster = (ff.fly.Aircraft("c172p", speed, 900.0) for speed in (51.4, 56.0))
        >>> ff.fly.trimmed_force(ff.fly.with_surface(ff.digital_elevator(), trim), trim, faster) > 0
        True
    """
    return held_force(loader, flown.state(), flown.angle_from(trim))


def force_per_g(loader: Loader, aircraft: str, speed_m_per_s: float, altitude_m: float) -> float:
    """Force at the grip per load factor, N, between pull-ups of 1.2 and 1.4 g that JSBSim trims, for the feel without the loader.

    Example:
        >>> round(ff.fly.force_per_g(ff.digital_elevator(), "c172p", 51.4, 900.0))
        -35
    """
    trim = Aircraft(aircraft, speed_m_per_s, altitude_m)
    loader = with_surface(loader, trim)
    pulls = [Aircraft(aircraft, speed_m_per_s, altitude_m, load_factor) for load_factor in _PULLS]
    forces = [trimmed_force(loader, trim, pull) for pull in pulls]
    load_factors = [pull.state()["load_factor"] for pull in pulls]
    return (forces[1] - forces[0]) / (load_factors[1] - load_factors[0])
