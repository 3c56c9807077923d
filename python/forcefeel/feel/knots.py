"""Knots of a flight schedule from points at several flight conditions: a fit for each."""

from dataclasses import replace

import numpy as np

from forcefeel.errors import InputError
from forcefeel.feel.fit import fit_feel
from forcefeel.feel.result import FeelFit
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.qualification import ForcePoints
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import UnitSystem

_DIGITS = ".6g"
_ROWS = {"I": "feel.inertia", "B": "feel.damping", "G": "feel.stiffness"}


def check_conditions(points: ForcePoints) -> None:
    """Refuses points of a single condition, before any is fitted.

    Raises:
        InputError: If there are not two conditions.
    """
    if not points.axes():
        raise InputError(
            f"{points.name}: expected two flight conditions for knots, got one; add a column such as 'q (Pa)'"
        )


def knots_csv(points: ForcePoints, fit: FeelFit, units: UnitSystem) -> str:
    """A file of knots for ``forcefeel schedule``: the spring rate of each condition, with the inertia and damping of one.

    Inertia and damping belong to the control run, and stay where the dynamic pressure changes.

    Args:
        points: The points of all conditions.
        fit: The fit of one of them.
        units: Units of the setting.

    Raises:
        InputError: If there are not two conditions, or the points of one cannot be fitted, with the condition.
    """
    check_conditions(points)
    axes, plan = points.axes(), replace(fit.plan, release=None)
    rows = []
    for text, which in points.groups().items():
        group = points.taken(which)
        try:
            loader = fit_feel(group, plan).loader
        except InputError as error:
            raise InputError(f"{text}: {error}") from error
        setting = {key: fit.loader[key] for key in _ROWS.values()} | {"feel.stiffness": loader["feel.stiffness"]}
        numbers = [unit(TABLE[key]).from_si(value, units) for key, value in setting.items()]
        places = [float(np.mean(group.conditions[name])) * scale for name, (_, scale) in axes.items()]
        rows.append([*places, *numbers])
    heads = [
        *(title for title, _ in axes.values()),
        *(f"{name} ({unit(TABLE[key]).shown(units)})" for name, key in _ROWS.items()),
    ]
    return csv_text(heads, sorted(rows), _DIGITS)
