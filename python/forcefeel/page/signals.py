"""The quantities of the curves: what they are called and in which units people read them."""

from dataclasses import dataclass

from forcefeel.units import ANGLE, CURRENT, FLOW, FORCE, LENGTH, PRESSURE, UnitSystem, factor

_PLAIN = ("dB", "deg", "Hz", "s", "V")
_UNITS = {
    "rad": ANGLE,
    "m": LENGTH,
    "N": FORCE,
    "A": CURRENT,
    "m^3/s": FLOW,
    "Pa": PRESSURE,
}
_SUFFIXES = ("_m3_per_s", "_rad", "_deg", "_pa", "_hz", "_db", "_m", "_n", "_v", "_a", "_s")


@dataclass(frozen=True)
class Signal:
    """One variable of a curve.

    Attributes:
        name: What it is, in words with underscores and without its unit.
        unit: The unit that people read.
        scale: How many of ``unit`` one of the data's unit is.
    """

    name: str
    unit: str
    scale: float


def signal(name: str, unit: str, system: UnitSystem) -> Signal | None:
    """How an array of this name and unit is shown under ``system``; ``None`` where people read it in no unit."""
    bare = next((name.removesuffix(end) for end in _SUFFIXES if name.endswith(end)), name)
    if unit in _PLAIN or bare == "motor_current":  # a valve's current is a thousandth of a motor's
        return Signal(bare, unit, 1.0)
    if unit not in _UNITS:
        return None
    shown = _UNITS[unit].shown(system)
    return Signal(bare, shown, factor(unit, shown))
