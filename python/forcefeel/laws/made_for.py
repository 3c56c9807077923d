"""Whom a law was made for: the rows of a loader that a law's design depends on, by which it is known again.

A design takes the linear machine, its controller, the noise of its sensors and its dry friction from the loader file. It does
not ask for the loader's name, the pilot, what ends a motion or a force, offsets and play, or the supervisor's limits. Of the feel
it takes I, B and G, which a law holds for itself, the shaker's force, which is no contact, and the load cell's scale;
on a motor ``torque-mode`` also asks how steep the feel can be.
"""

from collections.abc import Mapping
from functools import cache
from math import inf, isclose, isfinite

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, table

_PARTS = ("feel.", "pilot.", "safety.", "thermal.", "brake.", "winding.")
"""Parts that no design asks for, but for the rows of the feel below."""

_ROWS = (
    ".offset",
    ".backlash",
    "motor.static_friction",
    ".seal_friction",
    ".antiwindup",
    "efficiency",
    "_limit",
    ".relief_pressure",
    ".relief_gain",
    ".gravity_torque",
    ".gravity_angle",
    ".stop_low",
    ".stop_high",
    ".stop_stiffness",
    ".stop_damping",
)
"""How the rows of other parts end that no design asks for, but for the motor's largest current."""

_LARGEST_CURRENT = "current_loop.current_limit"

_SCALE, _SHAKER = "feel.maximum_stiffness", "feel.shaker_force"
_STEEP = ("coulomb_friction", "static_friction", "breakout", "detent_", "hysteresis", "soft_stop_")
"""How the rows of the feel begin that can make it steep."""

_FRICTION = ("column.coulomb_friction", "motor.coulomb_friction")
"""Of these a law gives back as much as their tolerances allow."""

_SAME = 1e-8
"""Relative; a number that went through a loader file or another unit is still the same."""


def design_rows(loader: Loader) -> dict[str, float]:
    """What a law's design depends on, SI units: rows that are finite, and the tolerances of dry friction.

    Example:
        >>> from forcefeel.laws.made_for import design_rows
        >>> rows = design_rows(ff.digital_elevator())
        >>> "linkage.stiffness" in rows, "pilot.force" in rows
        (True, False)
    """
    keys = _asked_for(loader.drive, bool(loader["grip_sensor.gain"]))
    rows = {key: value for key in keys if isfinite(value := loader[key])}
    for key in _FRICTION:
        if loader[key] and key in loader.tolerances:
            low, high = loader.tolerances[key].ends
            rows |= {f"least {key}": low, f"most {key}": high}
    return rows


def differing(rows: Mapping[str, float], loader: Loader) -> tuple[str, ...]:
    """The rows that are others in a loader than where a law was made."""
    own = design_rows(loader)
    both = {key: (rows.get(key, inf), own.get(key, inf)) for key in (*rows, *own)}
    return tuple(key for key, (known, here) in both.items() if not isclose(known, here, rel_tol=_SAME))


def is_steep(key: str) -> bool:
    """Whether a row can make the feel steep, which ``torque-mode`` on a motor is designed for.

    Example:
        >>> from forcefeel.laws.made_for import is_steep
        >>> is_steep("feel.breakout"), is_steep("feel.deadband")
        (True, False)
    """
    return key.removeprefix("feel.").startswith(_STEEP)


@cache
def _asked_for(drive: str, grip_sensor: bool) -> tuple[str, ...]:
    """The rows that a design asks for, of a loader with that drive."""

    def asked_for(key: str) -> bool:
        if key.startswith("grip_sensor."):
            return grip_sensor
        others = not key.startswith(_PARTS) and not key.endswith(_ROWS)
        return (drive == ELECTRIC and is_steep(key)) or others or key in {_SCALE, _SHAKER, _LARGEST_CURRENT}

    return tuple(key for key in table(drive) if asked_for(key))
