"""The machines of a case as rows of parameters, one for each setting.

Gains that differ from setting to setting take the arm of the load cell's torque, ``alpha R_b``, from each row's geometry, while a
law is designed with the nominal one's. A feel computer that hears a torque ``s`` times too large and has ``s I``, ``s B``, ``s G``
moves as one that hears it right: where the geometry is off, the rows hold that feel, and the law is the nominal one's exactly.
"""

from math import prod

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case
from forcefeel.laws.law import Law
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.loader import FEEL_SETTING, Loader

_GEOMETRY = ("linkage.ratio", "column.base_arm")


def feel_json(loader: Loader) -> tuple[Loader, tuple[str, ...]]:
    """The loader with the feel I, B, G alone and no arm at its grip, and what was left out of it.

    What is programmed in an envelope is I, B and G; friction, breakout, stops or a curve of the feel would be another feel.
    """
    rows = [key for key in loader.given if key.startswith(("feel.", "pilot."))]
    bare = loader.with_tolerances(dict.fromkeys(key for key in rows if key in loader.tolerances))
    left = bare.replace(dict.fromkeys(rows)) if rows else loader
    return _without_curves(left), (*rows, *(f"feel.{name}" for name in loader.curves))


def _without_curves(loader: Loader) -> Loader:
    return (
        Loader(loader.name, loader.source, loader.si_values, tolerances=loader.tolerances) if loader.curves else loader
    )


def columns(case: Case) -> list[str]:
    """The rows of the parameter table in which the machines of a case differ from the loader."""
    return [*FEEL_SETTING, *ARM_ROWS, *case.off]


def machines(loader: Loader, case: Case, feel: NDArray[np.float64], laws: Law) -> NDArray[np.float64]:
    """SI values of ``columns(case)`` for settings I, B, G, a row each."""
    scale = prod(1 + case.off.get(key, 0.0) for key in _GEOMETRY) if laws.gains is not None else 1.0
    arm = case.arm.values if case.arm else (0.0, 0.0, 0.0)
    rest = (*arm, *(loader[key] + share * abs(loader[key]) for key, share in case.off.items()))
    return np.column_stack([feel * scale, np.tile(rest, (len(feel), 1))])


def full_rows(loader: Loader, case: Case, feel: NDArray[np.float64], laws: Law) -> NDArray[np.float64]:
    """The same as whole rows of the parameter table."""
    return loader.rows(columns(case), machines(loader, case, feel, laws))
