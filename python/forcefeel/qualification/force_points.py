"""Points of force over position, as measured in flight or on the ground: in any order, with or without time."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.records import PositionUnit
from forcefeel.tables.faults import LARGEST
from forcefeel.tables.header import by_standard_name, locate, need
from forcefeel.tables.table import Columns
from forcefeel.tables.table_file import open_table
from forcefeel.units import factor, parse, show, to_text

EXAMPLE = "position (deg),force (lb)"
"""Example of a header."""

_CONDITIONS = {"dynamic_pressure": ("Pa",), "airspeed": ("m/s",), "mach": ("",), "flap": ("rad",), "trim": ("rad",)}
"""Columns that state a flight condition, with their SI units."""
_SHOWN = {"Pa": "lb/ft^2", "m/s": "knot", "rad": "deg", "": ""}
"""Units in which conditions are shown, by SI unit."""
_ACCEPTED = {
    "position": ("rad", "m"),
    "force": ("N",),
    "time": ("s",),
    "direction": ("",),
    "force_uncertainty": ("N",),
    **_CONDITIONS,
}
_ALSO = {"column_angle": "position", "pilot_force": "force", "q": "dynamic_pressure", "flaps": "flap"}

_SAME_CONDITION = 0.05
"""Share of the largest value within which values are one flight condition."""
_WINDOW = 0.01
"""Share of the points over which a direction is taken from the order in time."""
_STILL = 1e-3
"""Share of the travel within which a control stands still."""
_SAME_PLACE, _APART = 0.02, 0.05
"""Share of the travel within which positions are equal, and share of the largest force above which forces differ."""

_MOST, _CELLS = 400, 100
"""Points above which a record is thinned, and cells of its travel."""

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ForcePoints:
    """Points of force over position, the control at rest or in slow motion.

    Attributes:
        position: Position from neutral, rad or m (points,).
        force_n: Force at the grip, N (points,); positive towards positive positions.
        direction: +1 where the position rises, -1 where it falls, 0 where this is not known (points,). Default: not known.
        force_uncertainty_n: Standard uncertainty of each force (points,). Default: from the scatter.
        in_order: Whether the points are in the order in which they were measured.
        conditions: Each point's flight condition in SI units, by name (points,).
        position_unit: ``rad`` or ``m``.
        shown_unit: The position's unit in messages; ``position_unit`` if empty.
        condition: The selected flight condition as text.
        name: Name for messages.
        data_hash: SHA-256 of the file, in hexadecimal; empty for points in memory.

    Raises:
        InputError: If arrays differ in length, or a number is not finite or out of range.

    Example:
        >>> ff.qualification.ForcePoints([-0.1, 0.1, 0.2], [-30.0, 28.0, 50.0]).position_unit
        'rad'
    """

    position: _Array
    force_n: _Array
    direction: _Array | None = None
    force_uncertainty_n: _Array | None = None
    in_order: bool = False
    conditions: Mapping[str, _Array] = field(default_factory=dict)
    position_unit: PositionUnit = "rad"
    shown_unit: str = ""
    condition: str = ""
    name: str = "points"
    data_hash: str = ""

    def __post_init__(self) -> None:
        count = np.size(self.position)
        for name in ("position", "force_n", "direction", "force_uncertainty_n"):
            given = getattr(self, name)
            if given is None and name == "direction":
                given = np.zeros(count)
            if given is not None:
                object.__setattr__(self, name, _row(self.name, name, given, count))
        directions, known = self.directions, self.force_uncertainty_n
        if not np.isin(directions, (-1.0, 0.0, 1.0)).all():
            wrong = directions[~np.isin(directions, (-1.0, 0.0, 1.0))][0]
            raise InputError(
                f"{self.name}: direction: expected 1 where the position rises, -1 where it falls, or 0, got {wrong:g}"
            )
        if known is not None and not (known > 0).all():
            raise InputError(f"{self.name}: force_uncertainty: expected forces above 0, got {known.min():g} N")

    @property
    def directions(self) -> _Array:
        """The directions, zeros where none was stated."""
        return np.zeros(np.size(self.position)) if self.direction is None else self.direction

    def taken(self, which: NDArray[np.bool_] | NDArray[np.intp]) -> "ForcePoints":
        """Some of the points, or all in another order."""
        known = self.force_uncertainty_n
        return replace(
            self,
            position=self.position[which],
            force_n=self.force_n[which],
            direction=self.directions[which],
            force_uncertainty_n=None if known is None else known[which],
            conditions={name: values[which] for name, values in self.conditions.items()},
        )

    def about(self, neutral: float) -> "ForcePoints":
        """The points with positions counted from another neutral, rad or m."""
        return replace(self, position=self.position - neutral)

    def outward(self) -> "ForcePoints":
        """The points with unknown directions taken as away from neutral.

        Raises:
            InputError: If two forces differ at the same position, so that one of them is on a way back.
        """
        unknown = self.directions == 0
        order = np.argsort(self.position)
        x, force = self.position[order], self.force_n[order]
        same = (np.diff(x) <= _SAME_PLACE * np.ptp(x)) & (np.abs(np.diff(force)) > _APART * np.abs(force).max())
        if unknown.all() and same.any():
            k = int(np.argmax(same))
            raise InputError(
                f"{self.name}: has {force[k]:.4g} N and {force[k + 1]:.4g} N at {self.shown(x[k])}; expected the direction of "
                "each point; add a column 'direction', 1 where the position rises and -1 where it falls, or 'time (s)'"
            )
        return replace(self, direction=np.where(unknown, np.sign(self.position), self.directions))

    def shown(self, position: float) -> str:
        """A position as text in the unit of its file."""
        unit = self.shown_unit or self.position_unit
        return f"{to_text(position * factor(self.position_unit, unit))} {unit}"

    def thinned(self) -> "ForcePoints":
        """The points of a record as means over short travels in one direction; a few points as they are.

        Samples of a record at which the control stands still are left out: there friction takes any value.
        """
        moving = self.taken(self.directions != 0) if self.in_order and self.directions.any() else self
        if len(moving.position) <= _MOST:
            return moving
        part = moving if self.in_order else moving.taken(np.lexsort((moving.position, moving.directions)))
        cell = np.round(part.position / np.ptp(part.position) * _CELLS)
        begins = np.concatenate(([True], (np.diff(cell) != 0) | (np.diff(part.directions) != 0)))
        number = np.cumsum(begins) - 1
        count = np.bincount(number)
        known = np.ones(len(number)) if part.force_uncertainty_n is None else part.force_uncertainty_n
        position, force, uncertainty = (np.bincount(number, of) / count for of in (part.position, part.force_n, known))
        return replace(
            part,
            position=position,
            force_n=force,
            direction=part.directions[begins],
            force_uncertainty_n=uncertainty / np.sqrt(count),
            conditions={},
        )

    def groups(self) -> dict[str, NDArray[np.bool_]]:
        """The points of each flight condition, by its text; a single one without text if none is stated."""
        labels = [_labels(name, values) for name, values in self.conditions.items()]
        texts = [", ".join(parts) for parts in zip(*labels, strict=True)] if labels else [""] * len(self.position)
        return {text: np.array([other == text for other in texts]) for text in dict.fromkeys(texts)}

    def axes(self) -> dict[str, tuple[str, float]]:
        """Title with unit, and its number of one SI unit, of each condition that has several values."""
        several = (name for name, values in self.conditions.items() if len(set(_labels(name, values))) > 1)
        units = {name: _SHOWN[_CONDITIONS[name][0]] for name in several}
        return {
            name: (f"{name.replace('_', ' ')} ({unit})" if unit else name, factor(_CONDITIONS[name][0], unit))
            for name, unit in units.items()
        }

    def of_condition(self, texts: tuple[str, ...] = ()) -> "ForcePoints":
        """The points of one flight condition.

        Args:
            texts: Conditions ``NAME=VALUE``, such as ``dynamic pressure=120 lb/ft^2``.

        Raises:
            InputError: If a condition is unknown, or there are several and none is selected.
        """
        part = self
        for text in texts:
            name, equals, value = (word.strip() for word in text.partition("="))
            key = _ALSO.get(name.replace(" ", "_"), name.replace(" ", "_"))
            if not equals or key not in self.conditions:
                known = ", ".join(name.replace("_", " ") for name in self.conditions) or "none"
                raise InputError(
                    f"condition: expected NAME=VALUE with a condition of {self.name} ({known}), got {show(text)}"
                )
            (si,) = _CONDITIONS[key]
            try:
                wanted = parse(value, si, "5 kPa") if si else float(value)
            except ValueError as error:
                raise InputError(f"condition: {error}") from error
            near = np.abs(part.conditions[key] - wanted) <= _SAME_CONDITION * np.abs(self.conditions[key]).max()
            if not near.any():
                known = "; ".join(self.groups())
                raise InputError(f"condition: {self.name} has no {name} of {value}; its conditions are {known}")
            part = part.taken(near)
        groups = part.groups()
        if len(groups) > 1:
            raise InputError(
                f"{self.name}: has {len(groups)} flight conditions: {'; '.join(groups)}; expected one; select it, such as "
                f"--condition '{next(iter(groups)).partition(',')[0]}'"
            )
        return replace(part, condition=next(iter(groups)))


def read_force_points(
    path: str | Path, *, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> ForcePoints:
    r"""Read points of force over position from a ``.csv``, ``.parquet``, ``.mat`` or ``.mcap`` file.

    Required columns are ``position`` and ``force``, each with its unit. Optional are ``direction`` (1 where the position rises, -1
    where it falls), ``time``, ``force uncertainty``, and flight conditions: ``dynamic pressure`` or ``q``, ``airspeed``, ``mach``,
    ``flap``, ``trim``. With a time the points may be in any order; directions follow from it.

    Args:
        path: The file.
        columns: The file's own column names: ``{"position": "theta"}``.
        units: Units of columns without one in the header, by either name.

    Raises:
        InputError: With the file, the fault, the expected value and the remedy.

    Example:
        >>> size = Path("flight.csv").write_text("position (deg),force (N)\n-4,-40\n-2,-26\n2,26\n4,40\n8,68\n")
        >>> len(ff.qualification.read_force_points("flight.csv").force_n)
        5
    """
    table = open_table(path, EXAMPLE)
    own = by_standard_name(str(path), "columns", columns or {}, _ACCEPTED, _ALSO)
    stated = by_standard_name(str(path), "units", units or {}, (*_ACCEPTED, *own.values()), _ALSO)
    located = locate(table, _ACCEPTED, stated, own, _ALSO)
    need(table, located, ("position", "force"), EXAMPLE)
    read = table.take(located)
    _check_numbers(read)
    values = read.values
    order = np.argsort(values["time"], kind="stable") if "time" in values else np.arange(len(values["position"]))
    values = {name: column[order] for name, column in values.items()}
    direction = values.get("direction")
    if direction is None and "time" in values:
        direction = _from_order(values["position"])
    return ForcePoints(
        values["position"],
        values["force"],
        direction,
        values.get("force_uncertainty"),
        "time" in values,
        MappingProxyType({name: values[name] for name in _CONDITIONS if name in values}),
        "m" if read.units["position"] == "m" else "rad",
        read.own_units["position"],
        name=Path(path).name,
        data_hash=table.data_hash,
    )


def _check_numbers(read: Columns) -> None:
    for name, values in read.values.items():
        bad = ~(np.abs(values) <= LARGEST)
        if bad.any():
            k = int(np.argmax(bad))
            raise InputError(
                f"{read.places[k + 1]}: {name}: expected a finite number, got {values[k]:g}; leave the row out"
            )


def _from_order(position: _Array) -> _Array:
    """Direction of each point from its neighbors in time; 0 where the control stands still."""
    if len(position) < 2:
        return np.zeros(len(position))
    reach = max(round(_WINDOW * len(position)), 1)
    k = np.arange(len(position))
    before = position[np.maximum(k - reach, 0)]
    after = position if reach == 1 else position[np.minimum(k + reach, len(position) - 1)]
    moved = after - before
    moved[0] = position[min(reach, len(position) - 1)] - position[0]
    return np.where(np.abs(moved) <= _STILL * np.ptp(position), 0.0, np.sign(moved))


def _labels(name: str, values: _Array) -> list[str]:
    """The condition of each point as text; values that are nearly equal are one."""
    (si,) = _CONDITIONS[name]
    shown = _SHOWN[si]
    near = _SAME_CONDITION * float(np.abs(values).max())
    starts: list[float] = []
    for value in np.unique(values).tolist():
        if not starts or value > starts[-1] + near:
            starts.append(value)
    cell = np.searchsorted(starts, values, side="right") - 1
    texts = []
    for k in range(len(starts)):
        mean = float(np.mean(values[cell == k])) * factor(si, shown)
        texts.append(f"{name.replace('_', ' ')}={to_text(mean)} {shown}".rstrip())
    return [texts[k] for k in cell]


def _row(name: str, field_name: str, given: ArrayLike, count: int) -> _Array:
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: expected {field_name} to be a row of numbers ({error})") from error
    if values.shape != (count,) or not (np.abs(values) <= LARGEST).all():
        raise InputError(f"{name}: expected {field_name} to be {count} finite numbers, got {show(values.tolist())}")
    values.setflags(write=False)
    return values
