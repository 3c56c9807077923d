"""Varied parameters of a sweep as text: ``part.name=tolerance`` and ``part.name=grid``.

==================================================  ===================================================================
``20 %``                                            uniform within 20 % to either side of the loader's value
``1 lb..5 lb``, ``1..5 lb``, ``-10 %..20 %``        uniform between these
``{ normal = "5 %", low = "-9 %", high = "9 %" }``  any tolerance in the form of a loader file
``none``                                            the loader's value, without its tolerance
``288..28800 lb in/rad:40:log``                     a grid: from, to, how many values; ``log`` for even steps in proportion
==================================================  ===================================================================
"""

import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np

from forcefeel.errors import InputError
from forcefeel.loader.parameters import TABLE, did_you_mean, in_range, is_switch, range_text, value_text
from forcefeel.simulation.engine import SHARED
from forcefeel.units import ends, parse, show

MOST_STEPS = 10_000
"""Largest number of values of a grid along one parameter."""

_LOG, _NONE = "log", "none"


def assignment(text: str, example: str) -> tuple[str, str]:
    """Key and value of ``part.name=value``.

    Raises:
        InputError: If the text is not of that form.
    """
    key, value = (part.strip() for part in text.partition("=")[::2])
    if not (key and value):
        raise InputError(f"expected part.name=value such as {example!r}, got {show(text)}")
    return key, value


def assignments(option: str, texts: Sequence[str] | None, example: str) -> dict[str, str]:
    """All values of a repeatable option, by key.

    Raises:
        InputError: If one is not of the form of ``example``, or a key stands twice.
    """
    values: dict[str, str] = {}
    for text in texts or ():
        try:
            key, value = assignment(text, example)
        except InputError as error:
            raise InputError(f"{option}: {error}") from error
        if key in values:
            raise InputError(f"{option}: {key} is given twice; give it once")
        values[key] = value
    return values


def check_key(key: str) -> None:
    """Refuse a parameter that no sweep can vary.

    Raises:
        InputError: If ``key`` is no row of the parameter table, is a switch, or is shared by all runs.
    """
    if key not in TABLE:
        raise InputError(f"unknown parameter {show(key)}; {did_you_mean(key)}")
    if key in SHARED or is_switch(TABLE[key]):
        raise InputError(f"{key}: all runs of a sweep share it; make a sweep for each value, or keep it ({_NONE})")


def tolerance(key: str, text: str) -> str | dict[str, Any] | None:
    """A tolerance for ``Loader.with_tolerances``.

    Raises:
        InputError: If a table is not written as TOML writes it.
    """
    text = text.strip()
    if text == _NONE:
        return None
    if text.startswith("{"):
        try:
            return dict(tomllib.loads(f"it = {text}")["it"])
        except tomllib.TOMLDecodeError as error:
            raise InputError(f"{key}: expected a table as a loader file has it, got {show(text)}: {error}") from error
    return {"uniform": list(ends(text))} if ".." in text else text


def grid(key: str, text: str) -> tuple[float, ...]:
    """The values (SI) of a grid along ``key``.

    Raises:
        InputError: If the text is not ``low..high unit:count`` or ``low..high unit:count:log``, or a value is out of range.
    """
    row = TABLE[key]
    example = f"{value_text(row, row.default_si)}..{value_text(row, 2 * row.default_si)}:20"
    span, *rest = (part.strip() for part in text.split(":"))
    if ".." not in span or len(rest) not in {1, 2} or rest[1:] not in ([], [_LOG]):
        forms = f"from..to:how many, or from..to:how many:{_LOG}"
        raise InputError(f"{key}: expected {forms}, such as {example!r}, got {show(text)}")
    if not (rest[0].isdecimal() and rest[0].isascii() and 2 <= int(rest[0][:9]) <= MOST_STEPS):
        raise InputError(f"{key}: expected 2 to {MOST_STEPS:,} values, got {show(rest[0])} in {show(text)}")
    try:
        low, high = (parse(end, row.unit_si, value_text(row, row.default_si)) for end in ends(span))
    except InputError as error:
        raise InputError(f"{key}: {error}") from error
    if not low < high or (rest[1:] and low <= 0):
        above = "" if low < high else " below the last"
        raise InputError(f"{key}: expected a first value{above or f' above 0 ({_LOG})'}, got {show(span)}")
    for end in (low, high):
        check_in_range(key, end)
    values = np.geomspace(low, high, int(rest[0])) if rest[1:] else np.linspace(low, high, int(rest[0]))
    return tuple(values.tolist())


def check_in_range(key: str, value: float) -> None:
    """Refuse a value (SI) out of the row's range.

    Raises:
        InputError: If so.
    """
    row = TABLE[key]
    if not in_range(row, value):
        value_with_unit = value_text(row, value)
        raise InputError(
            f"{key}: out of range: expected values within {range_text(row)}, got {value_with_unit}; narrow it"
        )
