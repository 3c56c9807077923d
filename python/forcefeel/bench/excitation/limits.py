"""Limits of an excitation: current, travel of the column, force at the load cell, drive; voltage and speed."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, isfinite
from types import MappingProxyType

import numpy as np

from forcefeel import _core
from forcefeel.bench.channels import channel_unit
from forcefeel.bench.experiments import Drive
from forcefeel.bench.identification.digits import percent
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.simulation.inputs.sampled import check_number
from forcefeel.units import Unit, UnitSystem, show, to_text

OF_LIMIT = 0.8
"""Default share of a limit of current or voltage, of the valve's rating or of an end stop, to avoid saturation."""

TRAVEL_RAD = np.radians(10.0)
"""Default limit of travel without a near end stop, rad."""

TEST_SIGNAL_V = 10.0
"""Default limit of the test signal, the range of a usual converter, V."""

OF_SUPPLY = 2 / 3
"""Share of supply pressure times piston area: at two thirds of its pressure across the piston a valve gives the most power."""


STATED = "as given"
"""Reason of a limit that was stated."""


@dataclass(frozen=True)
class Limit:
    """A limit, SI units.

    Attributes:
        name: ``current``, ``travel``, ``force``, ``drive``, or a motor's ``voltage`` or ``speed``.
        channel: The channel that it is on.
        value: The largest magnitude.
        reason: Its origin.
        noise: Peak of the channel at rest under the law, of sensor noise alone; counted for a motor's voltage.
    """

    name: str
    channel: str
    value: float
    reason: str
    noise: float = 0.0

    def used(self, peak: float) -> float:
        """Share of the limit that a signal takes, of what the noise leaves."""
        return (peak - self.noise) / (self.value - self.noise)

    def beside(self, noise: float) -> "Limit":
        """The default limit with the noise at rest: the share is of what it leaves."""
        bound = self.value / OF_LIMIT
        if not 0.0 < noise < bound:
            return self
        left = f"{percent(OF_LIMIT)} of what the noise at rest leaves of"
        reason = self.reason.replace(f"{percent(OF_LIMIT)} of", left)
        return replace(self, value=noise + OF_LIMIT * (bound - noise), reason=reason, noise=noise)

    @property
    def unit(self) -> Unit:
        """Its units."""
        return channel_unit(self.channel)

    def text(self, value: float, system: UnitSystem) -> str:
        """A value with its unit."""
        return f"{to_text(self.unit.from_si(value, system), 3)} {self.unit.shown(system)}"


KINDS: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        HYDRAULIC: {"current": "valve_current", "travel": "column_angle", "force": "load_cell_force"},
        ELECTRIC: {
            "current": "motor_current",
            "voltage": "motor_voltage",
            "speed": "motor_speed",
            "travel": "column_angle",
            "force": "load_cell_force",
        },
    }
)
"""The channel of each limit by kind of drive; ``drive`` limits the drive itself."""

_Bounds = dict[str, tuple[float, str]]


def limits_of(loader: Loader, drive: Drive, stated: Mapping[str, float]) -> tuple[Limit, ...]:
    """The limits of a loader, replaced by stated limits.

    Args:
        loader: The loader.
        drive: Its drive in the experiment.
        stated: By the names of ``KINDS``, or ``drive``, SI units.

    Raises:
        InputError: If a name is unknown, a value is not above 0 or exceeds a limit of the loader itself, or a limit of a motor is
            not stated.
    """
    kinds = {**KINDS[loader.drive], "drive": str(drive)}
    if unknown := [name for name in stated if name not in kinds]:
        raise InputError(f"limits: expected {', '.join(kinds)}, got {show(unknown[0])}")
    electric = loader.drive == ELECTRIC
    bounds = (_motor_bounds if electric else _valve_bounds)(loader, drive) | _travel_bound(loader)
    defaults = (_motor_defaults if electric else _valve_defaults)(loader, drive) | _travel_default(loader)
    limits = []
    for name, channel in kinds.items():
        value, reason = (stated[name], STATED) if name in stated else defaults[name]
        if name not in stated and not isfinite(value):
            raise InputError(
                f"limits: the loader file gives no {reason}; give a {name}, or put its limit into the file"
            )
        check_number("limits", name, value, "number above 0")
        limit = Limit(name, channel, float(value), reason)
        bound, where = bounds[name]
        if value > bound:
            raise InputError(
                f"limits: expected a {name} of at most {limit.text(bound, UnitSystem.US)} ({where}), got "
                f"{limit.text(value, UnitSystem.US)}; lower it"
            )
        limits.append(limit)
    return tuple(limits)


def _valve_defaults(loader: Loader, drive: Drive) -> _Bounds:
    current, which = min(
        (loader["amplifier.current_limit"], "the amplifier's limit"),
        (loader["valve.rated_current"], "the valve's rating"),
    )
    signal = min((TEST_SIGNAL_V, "a usual converter's"), _drive_bound(loader, drive))
    return {
        "current": (OF_LIMIT * current, f"{percent(OF_LIMIT)} of {which}"),
        "force": (
            OF_SUPPLY * loader["valve.supply_pressure"] * loader["actuator.area"],
            "two thirds of supply pressure times piston area",
        ),
        "drive": (loader["pilot.force"], "the pilot's force") if drive is Drive.PILOT_FORCE else signal,
    }


def _valve_bounds(loader: Loader, drive: Drive) -> _Bounds:
    """Limits of the loader itself."""
    return {
        "current": (loader["amplifier.current_limit"], "the amplifier's limit"),
        "force": (loader["valve.supply_pressure"] * loader["actuator.area"], "supply pressure times piston area"),
        "drive": _drive_bound(loader, drive),
    }


def _motor_defaults(loader: Loader, drive: Drive) -> _Bounds:
    shares = {
        name: (OF_LIMIT * value, f"{percent(OF_LIMIT)} of {where}" if isfinite(value) else where)
        for name, (value, where) in _motor_bounds(loader, drive).items()
    }
    if drive is Drive.PILOT_FORCE:
        shares["drive"] = loader["pilot.force"], "the pilot's force"
    return shares


def _motor_bounds(loader: Loader, drive: Drive) -> _Bounds:
    """Limits of the motor itself: no-load speed at the voltage limit and force at the current limit."""
    current, voltage = loader["current_loop.current_limit"], loader["current_loop.voltage_limit"]
    # x_m, x_m', i, .. and x_m, F_c, i, u, omega of the model: u per omega, and F_c per i where x_m'' = 0.
    a, _, c, _ = _core.electric_plant(loader.si_values)
    speed, force = c[5, 1] / c[4, 1] * voltage, -a[1, 2] / a[1, 0] * c[2, 0] * current
    bounds = {
        "current": (current, "current_loop.current_limit"),
        "voltage": (voltage, "current_loop.voltage_limit"),
        "speed": (float(speed), "no-load speed at current_loop.voltage_limit"),
        "force": (float(force), "force of the motor at current_loop.current_limit"),
    }
    return bounds | {"drive": (inf, "") if drive is Drive.PILOT_FORCE else bounds["current"]}


def _travel_default(loader: Loader) -> _Bounds:
    stop, _ = _travel_bound(loader)["travel"]
    return {
        "travel": (OF_LIMIT * stop, f"{percent(OF_LIMIT)} of the nearer end stop")
        if OF_LIMIT * stop < TRAVEL_RAD
        else (TRAVEL_RAD, "the default")
    }


def _travel_bound(loader: Loader) -> _Bounds:
    return {"travel": (min(-loader["column.stop_low"], loader["column.stop_high"]), "the nearer end stop")}


def _drive_bound(loader: Loader, drive: Drive) -> tuple[float, str]:
    """Range of the controller for a command signal; other drives do not pass through it."""
    return loader["controller.output_range"] if drive is Drive.COMMAND_SIGNAL else inf, "the controller's range"
