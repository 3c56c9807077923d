"""Machines of a case as rows of parameters, one row for each setting.

A law is designed with the nominal torque arm of the load cell, ``alpha R_b``. Gains that differ between settings take the arm from
each row's geometry instead. Scaling I, B, G by the torque scale ``s`` cancels this: a feel computer with torque input ``s T`` and
``s I``, ``s B``, ``s G`` moves as with ``T`` and ``I``, ``B``, ``G``. Rows with a geometry deviation contain the scaled feel.
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
    """The loader with only I, B, G as its feel and without an arm, and the omitted rows.

    An envelope programs only I, B and G; friction, breakout, stops or a curve would change the feel.
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
    """Parameter rows that differ from the loader in the machines of a case."""
    return [*FEEL_SETTING, *ARM_ROWS, *case.off]


def machines(loader: Loader, case: Case, feel: NDArray[np.float64], laws: Law) -> NDArray[np.float64]:
    """SI values of ``columns(case)``, a row for each setting I, B, G."""
    scale = prod(1 + case.off.get(key, 0.0) for key in _GEOMETRY) if laws.numbers.by_machine else 1.0
    arm = case.arm.values if case.arm else (0.0, 0.0, 0.0)
    rest = (*arm, *(loader[key] + share * abs(loader[key]) for key, share in case.off.items()))
    return np.column_stack([feel * scale, np.tile(rest, (len(feel), 1))])


def full_rows(loader: Loader, case: Case, feel: NDArray[np.float64], laws: Law) -> NDArray[np.float64]:
    """SI values of all parameters, a row for each setting I, B, G."""
    return loader.rows(columns(case), machines(loader, case, feel, laws))
