"""What an excitation must not exceed: valve current, travel of the column, force at the load cell, the drive itself."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from types import MappingProxyType

import numpy as np

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.experiments import Drive
from forcefeel.bench.identification.digits import percent
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.simulation.inputs.sampled import check_number
from forcefeel.units import Unit, UnitSystem, show, to_text

OF_LIMIT = 0.8
"""Share that a default leaves of the amplifier's limit, the valve's rating, an end stop: what saturates teaches nothing."""

TRAVEL_RAD = np.radians(10.0)
"""Where no end stop is near."""

TEST_SIGNAL_V = 10.0
"""Of a usual converter."""

OF_SUPPLY = 2 / 3
"""Share of supply pressure times piston area: at two thirds of its pressure across the piston a valve gives the most power."""


@dataclass(frozen=True)
class Limit:
    """A limit, SI units.

    Attributes:
        name: ``current``, ``travel``, ``force`` or ``drive``.
        channel: The channel that it is on.
        value: The largest magnitude.
        reason: Where it comes from.
    """

    name: str
    channel: str
    value: float
    reason: str

    @property
    def unit(self) -> Unit:
        """Its units."""
        return channel_unit(self.channel)

    def shown(self, value: float, system: UnitSystem) -> str:
        """A value on its scale, as people read it."""
        return f"{to_text(self.unit.from_si(value, system), 3)} {self.unit.shown(system)}"


KINDS: Mapping[str, str] = MappingProxyType(
    {"current": "valve_current", "travel": "column_angle", "force": "load_cell_force"}
)
"""The channel that each limit on the loader is on; ``drive`` is on what moves it."""


def limits_of(loader: Loader, drive: Drive, given: Mapping[str, float]) -> tuple[Limit, ...]:
    """The limits of a loader, with those that are given in their place.

    Args:
        loader: The loader.
        drive: What moves it.
        given: By the names of ``KINDS``, or ``drive``, SI units.

    Raises:
        InputError: If a name is unknown, a value not above 0, or one beyond what the loader itself stops at.
    """
    kinds = {**KINDS, "drive": str(drive)}
    if unknown := [name for name in given if name not in kinds]:
        raise InputError(f"limits: expected {', '.join(kinds)}, got {show(unknown[0])}")
    bounds, defaults = _bounds(loader, drive), _defaults(loader, drive)
    found = []
    for name, channel in kinds.items():
        value, reason = (given[name], "as given") if name in given else defaults[name]
        check_number("limits", name, value, "number above 0")
        limit = Limit(name, channel, float(value), reason)
        bound, where = bounds[name]
        if value > bound:
            raise InputError(
                f"limits: expected a {name} of at most {limit.shown(bound, UnitSystem.US)} ({where}), got "
                f"{limit.shown(value, UnitSystem.US)}; lower it"
            )
        found.append(limit)
    return tuple(found)


def _defaults(loader: Loader, drive: Drive) -> dict[str, tuple[float, str]]:
    current, which = min(
        (loader["amplifier.current_limit"], "the amplifier's limit"),
        (loader["valve.rated_current"], "the valve's rating"),
    )
    stop = min(-loader["column.stop_low"], loader["column.stop_high"])
    signal = min((TEST_SIGNAL_V, "a usual converter's"), _drive_bound(loader, drive))
    return {
        "current": (OF_LIMIT * current, f"{percent(OF_LIMIT)} of {which}"),
        "travel": (OF_LIMIT * stop, f"{percent(OF_LIMIT)} of the nearer end stop")
        if OF_LIMIT * stop < TRAVEL_RAD
        else (TRAVEL_RAD, "as nothing else is said"),
        "force": (
            OF_SUPPLY * loader["valve.supply_pressure"] * loader["actuator.area"],
            "two thirds of supply pressure times piston area",
        ),
        "drive": (loader["pilot.force"], "the pilot's force") if drive is Drive.PILOT_FORCE else signal,
    }


def _bounds(loader: Loader, drive: Drive) -> dict[str, tuple[float, str]]:
    """What the loader itself stops at."""
    return {
        "current": (loader["amplifier.current_limit"], "the amplifier's limit"),
        "travel": (min(-loader["column.stop_low"], loader["column.stop_high"]), "the nearer end stop"),
        "force": (loader["valve.supply_pressure"] * loader["actuator.area"], "supply pressure times piston area"),
        "drive": _drive_bound(loader, drive),
    }


def _drive_bound(loader: Loader, drive: Drive) -> tuple[float, str]:
    """What the controller sends stays within its range; what comes in at the amplifier or at the grip is not its own."""
    return loader["controller.output_range"] if drive is Drive.COMMAND_SIGNAL else inf, "the controller's range"
