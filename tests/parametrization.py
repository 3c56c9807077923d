"""Parametrizations of which the fast tests take a few values."""

from collections.abc import Iterable

import pytest


def mostly_slow(values: Iterable, fast: int = 1) -> list:
    """The values: ``fast`` of them, spread evenly from the first on, and the others with the mark ``slow``.

    A tuple holds the values of several arguments.
    """
    given = list(values)
    kept = {k * len(given) // fast for k in range(fast)}
    return [value if k in kept else _slow(value) for k, value in enumerate(given)]


def _slow(value):
    if hasattr(value, "marks"):  # of pytest.param
        return value._replace(marks=[*value.marks, pytest.mark.slow])
    return pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.slow)
