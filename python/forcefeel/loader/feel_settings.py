"""Settings I, B, G of the feel computer, many at once."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import TABLE, in_range, range_text, value_text


def setting_rows(given: ArrayLike, name: str = "settings") -> NDArray[np.float64]:
    """Settings I, B, G as an array, a row each; ``name`` is what messages call them.

    Raises:
        InputError: If one is not three finite numbers with I > 0, B >= 0, G > 0.
    """
    try:
        rows = np.ascontiguousarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: expected rows of I, B, G ({error})") from error
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InputError(f"{name}: expected rows of I, B, G, got shape {rows.shape}")
    good = np.isfinite(rows).all(axis=1) & (rows[:, 0] > 0) & (rows[:, 1] >= 0) & (rows[:, 2] > 0)
    if not good.all():
        bad = int(np.argmin(good))
        raise InputError(f"{name}: expected finite I > 0, B >= 0, G > 0, got {rows[bad].tolist()} in row {bad}")
    return rows


def check_feel_range(rows: NDArray[np.float64], where: Callable[[int], str]) -> None:
    """Refuses settings that no loader may have.

    Args:
        rows: I, B, G in SI units, (settings, 3).
        where: What a message says of the place of a row, such as ``in setting 2``.

    Raises:
        InputError: If a number is beyond the range of its row.
    """
    for key, column in zip(FEEL_SETTING, rows.T.tolist(), strict=True):
        row = TABLE[key]
        for index, value in enumerate(column):
            if not in_range(row, value):
                raise InputError(f"{key}: expected {range_text(row)}, got {value_text(row, value)} {where(index)}")


def own_feel(loader: Loader) -> NDArray[np.float64]:
    """The loader's own setting I, B, G in SI units, (1, 3)."""
    return np.array([[loader[key] for key in FEEL_SETTING]])
