"""Settings of an envelope: stiffness, natural frequency and damping ratio on a grid, and I, B, G from them.

``I = G / w^2``, ``B = 2 zeta w I`` of eq. (11), ``G`` a share of ``G_max``.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.refinement import FEWEST, LARGEST_RATIO
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.units import HERTZ, PERCENT, RATIO, Unit, UnitSystem, parse, show, to_text

MOST_SETTINGS = 200_000
"""Largest number of settings of an envelope: some minutes for each law."""


_BARE = re.compile(r"[-+0-9.eE]+")


@dataclass(frozen=True)
class Axis:
    """One axis of the grid.

    Attributes:
        name: Name in ``--grid``.
        title: Meaning, for text.
        unit: Displayed unit; the text of a grid may use any unit of the same kind.
        low, high: Range of the values, SI.
        default: Default grid.
    """

    name: str
    title: str
    unit: Unit
    low: float
    high: float
    default: str


_HZ = 2 * np.pi

AXES: Mapping[str, Axis] = MappingProxyType(
    {
        axis.name: axis
        for axis in (
            Axis("damping", "damping ratio", RATIO, 0.05, 3.0, "0.1, 0.2, 0.4, 0.7, 1, 1.5"),
            Axis("frequency", "natural frequency", HERTZ, 0.1 * _HZ, 20 * _HZ, "0.5..4 Hz:16:log"),
            Axis("stiffness", "stiffness as a share of G_max", PERCENT, 1e-3, 10.0, "1..100 %:25:log"),
        )
    }
)
"""Axes in the order of the result's dimensions; stiffness runs fastest."""


@dataclass(frozen=True)
class Settings:
    """A grid of settings.

    Attributes:
        damping: Damping ratios.
        frequency: Natural frequencies, rad/s.
        stiffness: G, as shares of G_max.

    Raises:
        InputError: If an axis has fewer than two values, if they do not rise or are out of range, or with too many settings.
    """

    damping: tuple[float, ...]
    frequency: tuple[float, ...]
    stiffness: tuple[float, ...]

    def __post_init__(self) -> None:
        for axis in AXES.values():
            _check(axis, getattr(self, axis.name))
        if self.count > MOST_SETTINGS:
            raise InputError(
                f"grid: expected at most {MOST_SETTINGS:,} settings, got {self.count:,}; take fewer values"
            )

    @classmethod
    def of(cls, grid: Mapping[str, str | Sequence[float]]) -> "Settings":
        """Settings from text such as ``{"stiffness": "1..100 %:40:log"}`` or SI values; other axes have their default.

        Raises:
            InputError: As the class, and if an axis is unknown or its text cannot be read.
        """
        for name in grid:
            if name not in AXES:
                raise InputError(f"grid: unknown axis {show(name)}; expected {', '.join(AXES)}")
        return cls(**{name: _values(axis, grid.get(name, axis.default)) for name, axis in AXES.items()})

    @property
    def shape(self) -> tuple[int, int, int]:
        """Values along each of ``AXES``."""
        return len(self.damping), len(self.frequency), len(self.stiffness)

    @property
    def fine(self) -> bool:
        """Whether frequency and stiffness have enough and close values, so that outcomes can be inferred from neighbors."""
        axes = np.array(self.frequency), np.array(self.stiffness)
        return all(len(axis) >= FEWEST and bool((axis[1:] <= LARGEST_RATIO * axis[:-1]).all()) for axis in axes)

    @property
    def count(self) -> int:
        """Number of settings."""
        return int(np.prod(self.shape))

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """Damping ratio, frequency in rad/s and share of G_max of each setting, a row each."""
        axes = np.meshgrid(self.damping, self.frequency, self.stiffness, indexing="ij")
        return np.column_stack([axis.ravel() for axis in axes])

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """Logarithmic volume of each setting's cell along all three axes, as a share of the whole grid.

        The edges between cells lie halfway between neighboring values; the grid ends at its first and last value.
        """
        axes = []
        for name in AXES:
            along = np.log(getattr(self, name))
            edges = np.concatenate([along[:1], (along[1:] + along[:-1]) / 2, along[-1:]])
            axes.append(np.diff(edges) / (along[-1] - along[0]))
        return np.asarray(np.einsum("i,j,k->ijk", *axes).ravel())

    def feel(self, loader: Loader) -> NDArray[np.float64]:
        """I, B, G of each setting in SI units, (settings, 3)."""
        damping, frequency, share = self.rows.T
        stiffness = share * loader["feel.maximum_stiffness"]
        return np.column_stack([*_core.feel_from_frequencies(frequency, damping, stiffness), stiffness])


class ListedSettings(Settings):
    """Settings that form no grid.

    Args:
        rows: Damping ratio, frequency in rad/s and share of G_max, (settings, 3).
    """

    def __init__(self, rows: NDArray[np.float64]) -> None:
        for name, values in zip(AXES, rows.T, strict=True):
            object.__setattr__(self, name, tuple(np.unique(values).tolist()))
        object.__setattr__(self, "rows", rows)

    @property
    def shape(self) -> tuple[int, int, int]:
        """All settings along the first axis."""
        return len(self.rows), 1, 1

    @property
    def fine(self) -> bool:
        """False: neighbors are unknown."""
        return False


_SHOWN_VALUES = 6
"""Number of values that an error message quotes."""


def _check(axis: Axis, values: Iterable[float]) -> None:
    array = np.array(tuple(values), dtype=np.float64)
    if array.ndim != 1 or len(array) < 2 or not np.all(np.isfinite(array)) or np.any(np.diff(array) <= 0):
        quoted = ", ".join(f"{value:g}" for value in array.ravel()[:_SHOWN_VALUES]) or "none"
        raise InputError(f"grid: {axis.name}: expected two or more rising values, as {axis.name}=0.3,1, got {quoted}")
    rounding = 1e-9  # relative, so that a limit converted from other units is accepted
    if array[0] < axis.low * (1 - rounding) or array[-1] > axis.high * (1 + rounding):
        low, high, first, last = (_range_text(axis, value) for value in (axis.low, axis.high, array[0], array[-1]))
        raise InputError(f"grid: {axis.name}: expected values from {low} to {high}, got {first} to {last}; narrow it")


def _range_text(axis: Axis, value: float) -> str:
    return f"{to_text(axis.unit.from_si(value, UnitSystem.US))} {axis.unit.shown(UnitSystem.US)}".strip()


def _values(axis: Axis, values: str | Sequence[float]) -> tuple[float, ...]:
    try:
        if not isinstance(values, str):
            return tuple(map(float, values))
        return _span(axis, values) if ".." in values else _list(axis, values.split(","))
    except InputError as error:
        raise InputError(f"grid: {axis.name}: {error}") from error
    except (TypeError, ValueError) as error:
        raise InputError(f"grid: {axis.name}: expected text or numbers, got {show(values)}") from error


def _list(axis: Axis, texts: Sequence[str]) -> tuple[float, ...]:
    """Values of a list; values without a unit have the unit of the last."""
    *others, last = (text.strip() for text in texts)
    unit = _BARE.sub("", last, count=1).strip()
    example = f"{_range_text(axis, axis.low)}..{_range_text(axis, axis.high)}:20"
    filled = [f"{text} {unit}".strip() if _BARE.fullmatch(text) else text for text in others]
    return tuple(parse(text, axis.unit.si, example) for text in (*filled, last))


def _span(axis: Axis, text: str) -> tuple[float, ...]:
    """Values of a span, with linear or logarithmic spacing."""
    span, *rest = (part.strip() for part in text.split(":"))
    whole = bool(rest) and rest[0].isdecimal() and rest[0].isascii() and 2 <= int(rest[0][:9]) <= MOST_SETTINGS
    if not whole or rest[1:] not in ([], ["log"]):
        forms = "from..to:count, from..to:count:log, or values separated by commas"
        raise InputError(f"expected {forms}, such as {axis.default!r}, got {show(text)}")
    first, last = _list(axis, span.split("..", 1))
    if not (last > first and (first > 0 or not rest[1:])):
        raise InputError(f"expected a first value below the last, above 0 with log, got {show(text)}")
    make = np.geomspace if rest[1:] else np.linspace
    return tuple(make(first, last, int(rest[0])).tolist())
