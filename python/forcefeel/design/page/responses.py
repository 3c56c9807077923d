"""The curves of a figure as a wide table of comma-separated values."""

import numpy as np

from forcefeel.design.figure import Figure
from forcefeel.page.signals import signal
from forcefeel.tables.csv_table import csv_text
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import UnitSystem

_PLAIN_AXES = ("time_s", "frequency_hz")
_DIGITS = ".9g"


def table(figure: Figure, system: UnitSystem) -> LabeledArrays:
    """Every curve of ``figure`` over their common axis, in the units of ``system``.

    Args:
        figure: The figure; its curves share their axis.
        system: Units of the columns.

    Returns:
        An array per column, named ``label: quantity [unit]``; quantities without a unit that people read are left out.
    """
    columns: dict[str, tuple[str, np.ndarray]] = {}
    curves = list(figure.curves.items())
    first = curves[0][1]
    (axis,) = first.coordinates
    axis_signal = signal(axis, first.unit(axis), system)
    header = axis if axis in _PLAIN_AXES or axis_signal is None else f"{axis_signal.name} [{axis_signal.unit}]"
    for label, data in curves:
        for name in data:
            curve_signal = signal(name, data.unit(name), system)
            if curve_signal is not None:
                named = f"{label}: {curve_signal.name} [{curve_signal.unit}]"
                columns[named] = header, data[name] * curve_signal.scale
    return LabeledArrays(columns, {header: first[axis] * (axis_signal.scale if axis_signal else 1.0)})


def csv(data: LabeledArrays) -> str:
    """``data`` as comma-separated values with nine significant digits, its axis first."""
    columns = column_names(data)
    rows = zip(*(data[name].tolist() for name in columns), strict=True)
    return csv_text(columns, rows, _DIGITS)


def column_names(data: LabeledArrays) -> list[str]:
    """The columns in the order of ``csv``."""
    return [*data.coordinates, *data]
