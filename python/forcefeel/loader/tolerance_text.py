"""Tolerances as a loader file writes them, in its section ``[tolerances]``, by ``part.name``.

=====================================================================  ===================================================
``"20 %"``                                                             uniform within 20 % to either side of the value
``{ uniform = ["1 lb", "5 lb"] }``                                     uniform between these
``{ triangular = ["0.0045 V/lb", "0.0055 V/lb"] }``                    triangular, its peak at the value
``{ triangular = ["1 lb", "2 lb", "5 lb"] }``                          triangular, its peak at the second
``{ normal = "5 %", low = "-10 %", high = "10 %" }``                   normal about the value, cut off at the bounds
``{ normal = "1 lb", mean = "3 lb", low = "0 lb", high = "9 lb" }``    normal about the mean, cut off at the bounds
=====================================================================  ===================================================

A percentage is a share of the loader's value, also where the value is itself a ratio. A tolerance in nothing but
percentages goes with the value when that changes.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from forcefeel._core import Parameter
from forcefeel.errors import InputError
from forcefeel.loader.parameters import TABLE, value_text, with_unit
from forcefeel.loader.tolerances import ZERO, Distribution, Tolerance, nothing, share_of_nothing, unsuited
from forcefeel.units import UnitSystem, parse, show

_EXAMPLE = '"20 %", { uniform = ["-10 %", "20 %"] } or { normal = "5 %", low = "-10 %", high = "10 %" }'


def entries(section: object) -> dict[str, Any]:
    """The section's entries by ``part.name``, which TOML reads as tables within a table.

    Raises:
        InputError: If it is no table, or has an entry twice; without the section's name.
    """
    if not isinstance(section, dict):
        raise InputError(f"expected the table [tolerances], got {show(section)}")
    entries_by_key: dict[str, Any] = {}
    for part, given in section.items():
        tables = isinstance(given, dict) and part not in TABLE  # else the key stands in quotes, dot and all
        for key, entry in ({f"{part}.{name}": it for name, it in given.items()} if tables else {part: given}).items():
            if key in entries_by_key:
                raise InputError(f"{show(key)} is given twice; leave one out")
            entries_by_key[key] = entry
    return entries_by_key


def read(key: str, given: object, value: float, known: Mapping[str, Parameter] = TABLE) -> Tolerance:
    """A tolerance as a loader file states it.

    Args:
        key: The row's ``part.name``.
        given: Text or table; the forms are listed at the head of this module.
        value: The loader's value in SI units.
        known: The rows that a loader of this drive has.

    Raises:
        InputError: If it has another form, or a share of nothing; with ``key``.
    """
    if complaint := unsuited(key, known):
        raise InputError(complaint)
    try:
        return of_row(TABLE[key], given, value)
    except InputError as error:
        raise InputError(f"tolerances.{key}: {error}") from error


def of_row(row: Parameter, given: object, value: float) -> Tolerance:
    """A tolerance of a row of any table, whose value in SI units is ``value``.

    Raises:
        InputError: If it has another form, or a share of nothing.
    """
    reader = _Reader(row, value)
    return reader.share(given) if isinstance(given, str) else reader.table(given)


@dataclass(frozen=True)
class _Reader:
    """Reads a tolerance of a row whose value in SI units is ``value``."""

    row: Parameter
    value: float

    def share(self, given: str) -> Tolerance:
        """A bare percentage."""
        share = _share(given)
        if share is None or share <= 0:
            raise InputError(f"expected a tolerance such as {_EXAMPLE}, got {show(given)}")
        return self._tolerance(Distribution.UNIFORM, [given], (self._value_off_by(-share), self._value_off_by(share)))

    def table(self, given: object) -> Tolerance:
        """One of the forms that name their distribution."""
        names = [name for name in Distribution if isinstance(given, dict) and name in given]
        if not isinstance(given, dict) or len(names) != 1:
            raise InputError(f"expected a tolerance such as {_EXAMPLE}, got {_spec_text(given)}")
        name = names[0]
        known = (name, "low", "high", "mean") if name is Distribution.NORMAL else (name,)
        if unknown := [key for key in given if key not in known]:
            raise InputError(f"unknown key {show(unknown[0])}; known are {', '.join(known)}")
        return self._normal(given) if name is Distribution.NORMAL else self._between(name, given[name])

    def _between(self, name: Distribution, bounds: object) -> Tolerance:
        peaked = name is Distribution.TRIANGULAR
        if not isinstance(bounds, list) or len(bounds) not in ({2, 3} if peaked else {2}):
            what = "two bounds, or lower bound, peak and upper bound," if peaked else "two bounds"
            raise InputError(f'{name}: expected {what} such as ["-10 %", "20 %"], got {show(bounds)}')
        low, *between, high = (self._value(name, bound) for bound in bounds)
        peak = between[0] if between else self._nominal("peak") if peaked else None
        return self._tolerance(name, bounds, (low, high), peak)

    def _normal(self, given: Mapping[str, object]) -> Tolerance:
        if missing := [key for key in ("low", "high") if key not in given]:
            raise InputError(f"normal: expected bounds at which it is cut off; add {' and '.join(missing)}")
        share = _share(given["normal"])
        deviation = (
            self._quantity("normal", given["normal"]) if share is None else self._value_off_by(share) - self.value
        )
        mean = self._value("mean", given["mean"]) if "mean" in given else self._nominal("mean")
        ends = (self._value("low", given["low"]), self._value("high", given["high"]))
        return self._tolerance(Distribution.NORMAL, given.values(), ends, mean, deviation)

    def _tolerance(
        self,
        name: Distribution,
        stated: Iterable[object],
        ends: tuple[float, float],
        peak: float | None = None,
        deviation: float | None = None,
    ) -> Tolerance:
        """The tolerance; what is wrong with its numbers is said in the units that people read."""
        bounds = " and ".join(value_text(self.row, end) for end in ends)
        if not ends[0] < ends[1]:
            raise InputError(f"expected a lower bound below the upper one, got {bounds}")
        if peak is not None and not ends[0] <= peak <= ends[1]:
            what = "peak" if deviation is None else "mean"
            raise InputError(f"expected a {what} between the bounds {bounds}, got {value_text(self.row, peak)}")
        relative = all(_share(it) is not None for it in stated)
        return Tolerance(name, *ends, peak, deviation, self.value if relative else None)

    def _value(self, name: str, given: object) -> float:
        share = _share(given)
        return self._quantity(name, given) if share is None else self._value_off_by(share)

    def _quantity(self, name: str, given: object) -> float:
        try:
            return parse(given, self.row.unit_si, value_text(self.row, self.row.default_si))
        except InputError as error:
            raise InputError(f"{name}: {error}") from error

    def _value_off_by(self, share: float) -> float:
        """The loader's value, moved by a share of its size."""
        if nothing(self.row, self.value):
            raise InputError(share_of_nothing(self.row))
        if self.value == 0:
            raise InputError(ZERO)
        return self.value + share * abs(self.value)

    def _nominal(self, what: str) -> float:
        """The loader's value as what has not been stated."""
        if nothing(self.row, self.value):
            key = f"{self.row.part}.{self.row.name}"
            raise InputError(f"expected a {what}, because {key} is off and has no value; state it")
        return self.value


def _share(given: object) -> float | None:
    """A percentage as a share; ``None`` for other text."""
    if not isinstance(given, str) or not given.rstrip().endswith("%"):
        return None
    return parse(given, "", "20 %")


def _spec_text(given: object) -> str:
    """What came; of a table its keys."""
    return f"a table of {', '.join(map(show, given))}" if isinstance(given, dict) and given else show(given)


def write(row: Parameter, tolerance: Tolerance, units: UnitSystem) -> str:
    """A tolerance as a loader file has it."""
    nominal = tolerance.nominal

    def text(value: float) -> str:
        if nominal is None:
            return f'"{with_unit(row, value, units)}"'
        return f'"{_percent(value - nominal, nominal)}"'

    low, high = text(tolerance.low), text(tolerance.high)
    if tolerance.peak is None:
        return high if nominal is not None and low == f'"-{high[1:]}' else f"{{ uniform = [{low}, {high}] }}"
    peak = [] if tolerance.peak == nominal else [text(tolerance.peak)]
    if tolerance.deviation is None:
        return f"{{ triangular = [{', '.join([low, *peak, high])}] }}"
    by_itself = with_unit(row, tolerance.deviation, units)
    deviation = by_itself if nominal is None else _percent(tolerance.deviation, nominal)
    mean = "".join(f"mean = {it}, " for it in peak)
    return f'{{ normal = "{deviation}", {mean}low = {low}, high = {high} }}'


def _percent(part: float, whole: float) -> str:
    return f"{100 * part / abs(whole):.10g} %"
