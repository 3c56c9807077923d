"""Deviations of a machine's parameters from the loader's values, with their sources.

A tolerance of the loader file sets the cases and draws of its parameter. Defaults, marked as assumed: uniform, 20 %; valve gain
30 %; lengths 1 %, which a ruler measures. Tolerances of the built-in loaders are also assumed, as their source states.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from math import isfinite
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.known import ORIFICE
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import (
    ELECTRIC,
    MOTOR_PARAMETERS,
    OFF,
    PLANT_PARAMETERS,
    TABLE,
    a_drive,
    did_you_mean,
    has,
    is_switch,
)
from forcefeel.loader.tolerances import LENGTHS, Distribution, Tolerance, assumed, beyond
from forcefeel.units import show

VALVE_GAIN_CHANGE = 0.3

FRICTION = "column.coulomb_friction"
"""Friction that a law compensates; its deviation counts if the loader has friction."""

_MOTOR_RUBS = ("motor.coulomb_friction", "motor.cogging_torque", "motor.cogging_torque_2")
"""What a law cancels at the rotor; a deviation counts if the loader has it."""

CHANGES: Mapping[str, float] = MappingProxyType(
    {key: assumed(key) for key in (*PLANT_PARAMETERS, FRICTION)} | {"valve.current_gain": VALVE_GAIN_CHANGE}
)
"""Assumed deviation of each plant parameter, to either side. Sensor gains are calibrated; gains of the feel computer are exact."""

MOTOR_CHANGES: Mapping[str, float] = MappingProxyType(
    {key: assumed(key) for key in (*MOTOR_PARAMETERS, FRICTION, *_MOTOR_RUBS)}
)
"""Assumed deviations of an electric loader."""

_IDLE = {False: {*ORIFICE.values(), "valve.rated_current"}, True: set(ORIFICE)}
"""Valve rows without effect, without the orifice and with it."""

_MACHINE = ("amplifier", "valve", "actuator", "motor", "winding", "current_loop", "transmission", "linkage", "column")
"""Parts whose tolerances count. Sensors are calibrated; controller, feel and pilot are not the machine."""


class Origin(StrEnum):
    """Source of a deviation."""

    FILE = "loader file"
    GIVEN = "by option"
    RULER = "a ruler"
    ASSUMED = "assumed"


@dataclass(frozen=True)
class Deviation:
    """Deviation of one parameter.

    Attributes:
        spread: Distribution in shares of the loader's value; 0 is the value itself.
        origin: Source.
    """

    spread: Tolerance
    origin: Origin

    @classmethod
    def within(cls, share: float, origin: Origin = Origin.GIVEN) -> "Deviation":
        """A uniform deviation by a share to either side."""
        return cls(Tolerance(Distribution.UNIFORM, -share, share), origin)

    @property
    def ends(self) -> tuple[float, float]:
        """Deviations of the parameter's cases: see ``Tolerance.ends``."""
        return self.spread.ends

    @property
    def size(self) -> float:
        """Half the distance of its ends; for a symmetric deviation the share itself."""
        low, high = self.ends
        return (high - low) / 2

    @property
    def lean(self) -> float:
        """Offset of its middle from the loader's value, as a share of ``size``; 0 for a symmetric deviation."""
        low, high = self.ends
        return (high + low) / (high - low)

    def drawn(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Deviations of machines from uniform numbers between 0 and 1."""
        return self.spread.quantile(u)

    def scaled(self, factor: float) -> "Deviation":
        """The deviation times a factor, about the loader's value."""
        spread = self.spread
        numbers = {name: getattr(spread, name) for name in ("low", "high", "peak", "deviation")}
        moved = {name: factor * value for name, value in numbers.items() if value is not None}
        return replace(self, spread=replace(spread, **moved))


def deviations_of(loader: Loader) -> Mapping[str, Deviation]:
    """Deviations of a loader's parameters: its own tolerances, otherwise assumed ones.

    Args:
        loader: The loader. If its flow follows the orifice, the orifice's rows replace the valve's gains.

    Raises:
        InputError: If a tolerance leaves the range of its row.
    """
    orifice = bool(loader["valve.orifice"])
    of_drive = MOTOR_CHANGES if loader.drive == ELECTRIC else CHANGES
    usual = {key: share for key, share in of_drive.items() if key not in OFF or _has_shares(loader, key)}
    deviations = {
        ORIFICE.get(key, key) if orifice else key: Deviation.within(
            share, Origin.RULER if key in LENGTHS else Origin.ASSUMED
        )
        for key, share in usual.items()
    }
    stated = {key: tolerance for key, tolerance in loader.tolerances.items() if _counts(loader, key)}
    if wrong := beyond(stated):
        raise InputError("\n".join(wrong))
    deviations |= {
        key: Deviation(_in_shares(tolerance, loader[key]), _origin(loader, key)) for key, tolerance in stated.items()
    }
    return MappingProxyType(deviations)


def uncounted(loader: Loader) -> tuple[str, ...]:
    """Tolerances of a loader that have no case although they may have an effect."""
    idle = _IDLE[bool(loader["valve.orifice"])]
    return tuple(key for key in loader.tolerances if key not in idle and not _counts(loader, key))


def chosen_deviations(loader: Loader, changes: Mapping[str, float | Deviation] | None) -> Mapping[str, Deviation]:
    """The requested deviations; ``deviations_of`` the loader if ``changes`` is ``None``.

    Args:
        loader: The loader.
        changes: Shares to either side, or deviations, by parameter.

    Raises:
        InputError: If a parameter cannot deviate, or a share is not above 0 and below 1.
    """
    if changes is None:
        return deviations_of(loader)
    for key in changes:
        _check_key(loader, key)
    return MappingProxyType({key: _deviation(key, change) for key, change in changes.items()})


def _deviation(key: str, change: float | Deviation) -> Deviation:
    if isinstance(change, Deviation):
        return change
    if isinstance(change, bool) or not (isinstance(change, int | float) and 0 < change < 1):
        raise InputError(f"changes: {key}: expected a share above 0 and below 1, got {show(change)}")
    return Deviation.within(change)


def _check_key(loader: Loader, key: str) -> None:
    if key not in TABLE or is_switch(TABLE[key]):
        raise InputError(f"changes: expected parameters of the plant, got {show(key)}; {did_you_mean(key)}")
    if TABLE[key].part in {"controller", "feel", "pilot"}:
        what = "controller, feel and pilot are not part of the plant"
        raise InputError(f"changes: expected parameters of the plant, got {show(key)}; {what}")
    if not has(loader.drive, TABLE[key]):
        raise InputError(
            f"changes: {key}: is of a loader with {a_drive(str(TABLE[key].drive))}; {loader.name} has {a_drive(loader.drive)}"
        )
    if not _has_shares(loader, key):
        raise InputError(f"changes: {key}: has no shares, because it is off or zero; give it a value, or leave it out")


def _has_shares(loader: Loader, key: str) -> bool:
    return loader[key] not in {0.0, OFF.get(key)} and isfinite(loader[key])


def _counts(loader: Loader, key: str) -> bool:
    """Whether a tolerance of ``key`` has cases."""
    idle = _IDLE[bool(loader["valve.orifice"])]
    return TABLE[key].part in _MACHINE and key not in idle and _has_shares(loader, key)


def _in_shares(tolerance: Tolerance, value: float) -> Tolerance:
    """A tolerance in SI units, converted to shares of the value's size."""
    size = abs(value)
    places = {name: getattr(tolerance, name) for name in ("low", "high", "peak")}
    moved = {name: (bound - value) / size for name, bound in places.items() if bound is not None}
    deviation = None if tolerance.deviation is None else tolerance.deviation / size
    return replace(tolerance, **moved, deviation=deviation, nominal=None)


def _origin(loader: Loader, key: str) -> Origin:
    """Source of a tolerance: the loader file, or assumed for an unchanged tolerance of a built-in loader."""
    if loader.name not in BUILT_IN:
        return Origin.FILE
    own = BUILT_IN[loader.name]()
    if key not in own.tolerances or not loader.source.startswith(own.source):
        return Origin.FILE
    stated, built_in = (_in_shares(source.tolerances[key], source[key]) for source in (loader, own))
    same = stated.distribution is built_in.distribution and np.allclose(stated.ends, built_in.ends, rtol=_SAME, atol=0)
    return Origin.ASSUMED if same else Origin.FILE


_SAME = 1e-9
"""Relative difference of tolerances that counts as rounding."""
