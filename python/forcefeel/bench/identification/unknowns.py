"""Unknowns of an identification: parameters with bounds, prior and start of the search."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from forcefeel.errors import InputError
from forcefeel.loader.consistency import AT_LEAST
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import (
    HYDRAULIC,
    OFF,
    TABLE,
    a_drive,
    did_you_mean,
    has,
    is_switch,
    limits_si,
    table,
    value_text,
)
from forcefeel.loader.tolerances import Distribution, Tolerance
from forcefeel.simulation.engine import SHARED
from forcefeel.units import show

_FARTHEST = 2.0
"""Largest factor of a start from the file's value without a tolerance."""

_SEED = 1974

_PHASES = ("motor.cogging_phase", "motor.cogging_phase_2")
"""Phases, whose zero is arbitrary: they are scaled in radians, not in shares of their value."""

_RADIAN = 1.0


@dataclass(frozen=True)
class Unknown:
    """A parameter to be identified, SI units.

    Attributes:
        key: Its row ``part.name``.
        nominal: The loader file's value, the first start of the search.
        low, high: Bounds of its tolerance, or the table's range without one.
        tolerance: Tolerance of the file; a normal one is a prior, the others only bounds.
    """

    key: str
    nominal: float
    low: float
    high: float
    tolerance: Tolerance | None

    @property
    def symbol(self) -> str:
        """Its letter in the report."""
        return TABLE[self.key].symbol

    @property
    def scale(self) -> float:
        """Unit of its shares: the file's value, or a radian for a phase."""
        return _RADIAN if self.is_phase else abs(self.nominal)

    @property
    def is_phase(self) -> bool:
        """Whether it is an angle scaled in radians."""
        return self.key in _PHASES

    @property
    def prior(self) -> tuple[float, float] | None:
        """Mean and standard deviation of its prior."""
        tolerance = self.tolerance
        if (
            tolerance is None
            or tolerance.distribution is not Distribution.NORMAL
            or tolerance.peak is None
            or tolerance.deviation is None
        ):
            return None
        return tolerance.peak, tolerance.deviation

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values spread by its tolerance, or within a factor of the nominal; ``share`` from 0 to 1."""
        if self.tolerance is not None:
            return self.tolerance.quantile(share)
        if self.is_phase:
            return np.asarray(self.low + share * (self.high - self.low))
        return np.clip(self.nominal * _FARTHEST ** (2 * share - 1), self.low, self.high)


def parameter_keys(spec: str | Sequence[str], drive: str = HYDRAULIC) -> tuple[str, ...]:
    """Rows of the parameter table from their symbols or names: ``k,c,J,C_i`` or ``linkage.stiffness``.

    Args:
        spec: Names as a sequence, or as text separated by commas.
        drive: Of the loader, whose rows the symbols are.

    Raises:
        InputError: If the text is empty, or a name is unknown or stands twice.
    """
    names = [name.strip() for name in (spec.split(",") if isinstance(spec, str) else spec)]
    names = [name for name in names if name]
    if not names:
        raise InputError("fit: expected symbols or names of parameters, such as k,c,J,C_i, got none")
    by_symbol = {row.symbol: key for key, row in (*TABLE.items(), *table(drive).items())}
    keys = []
    for name in names:
        key = name if name in TABLE else by_symbol.get(name)
        if key is None:
            raise InputError(f"fit: unknown parameter {show(name)}; {_meant(name, by_symbol)}")
        if key in keys:
            raise InputError(f"fit: {show(name)} stands twice ({key}); name each parameter once")
        keys.append(key)
    return tuple(keys)


def unknowns_of(loader: Loader, keys: Sequence[str]) -> tuple[Unknown, ...]:
    """The parameters to be identified, with the properties of the loader file.

    Raises:
        InputError: If one is a switch, is off in the loader, or is shared by the whole engine.
    """
    return tuple(_within(_unknown(loader, key), loader, keys) for key in keys)


def _within(unknown: Unknown, loader: Loader, keys: Sequence[str]) -> Unknown:
    """The unknown with bounds by values not fitted: a breakaway force is no smaller than the dry friction."""
    for larger, smaller in AT_LEAST:
        if unknown.key == larger and smaller not in keys:
            unknown = replace(unknown, low=max(unknown.low, loader[smaller]))
        if unknown.key == smaller and larger not in keys and loader[larger] != OFF[larger]:
            unknown = replace(unknown, high=min(unknown.high, loader[larger]))
    return unknown


def starts(unknowns: Sequence[Unknown], count: int) -> NDArray[np.float64]:
    """Starts of the search, (count, unknowns): the file's values, then a Sobol sequence."""
    starts = np.empty((count, len(unknowns)))
    starts[0] = [unknown.nominal for unknown in unknowns]
    if count > 1:
        # Rows of a power of two, as the sequence is balanced; a fixed seed, so that a fit repeats to the bit.
        sequence = qmc.Sobol(len(unknowns), seed=_SEED).random_base2(math.ceil(math.log2(count - 1)))
        starts[1:] = np.column_stack([unknown.at(sequence[: count - 1, j]) for j, unknown in enumerate(unknowns)])
    return starts


def _unknown(loader: Loader, key: str) -> Unknown:
    row, value = TABLE[key], loader[key]
    if not has(loader.drive, row):
        raise InputError(
            f"fit: {key} is of {a_drive(row.drive or '')}, and {loader.name} has {a_drive(loader.drive)}; leave it out"
        )
    if is_switch(row):
        raise InputError(f"fit: {key} is a switch; it is on or off, not fitted")
    if key in SHARED:
        raise InputError(f"fit: {key} is a setting of the controller, not a property of the machine; leave it out")
    if not math.isfinite(value) or (value == 0 and key not in _PHASES):
        example = value_text(row, row.default_si)
        raise InputError(
            f"fit: {key} is {value_text(row, value)} in the loader; expected a value to begin from; give it one in the loader file "
            f'or with --set {key}="{example}"'
        )
    tolerance = loader.tolerances.get(key)
    low, high = limits_si(row)
    if key in _PHASES:
        low, high = max(low, value - math.pi), min(high, value + math.pi)
    if tolerance is not None:
        low, high = max(low, tolerance.low), min(high, tolerance.high)
    return Unknown(key, value, low, high, tolerance)


def _meant(name: str, by_symbol: dict[str, str]) -> str:
    close = [symbol for symbol in by_symbol if symbol.lower() == name.lower()]
    if close:
        return "did you mean " + " or ".join(f"{symbol} ({by_symbol[symbol]})" for symbol in close) + "?"
    return did_you_mean(name)
