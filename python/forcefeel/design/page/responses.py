"""The curves of a figure as a wide table of comma-separated values."""

import xarray as xr

from forcefeel.design.figure import Figure
from forcefeel.page.signals import signal
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import UnitSystem

_PLAIN_AXES = ("time_s", "frequency_hz")
_DIGITS = ".9g"


def table(figure: Figure, system: UnitSystem) -> xr.Dataset:
    """Every curve of ``figure`` over their common axis, in the units of ``system``.

    Args:
        figure: The figure; its curves share their axis.
        system: Units of the columns.

    Returns:
        A variable per column, named ``label: quantity [unit]``; quantities that do not say their unit are left out.
    """
    columns: dict[str, tuple[str, xr.DataArray]] = {}
    curves = list(figure.curves.items())
    axis = str(next(iter(curves[0][1].coords)))
    along = curves[0][1][axis]
    axis_signal = signal(along, system)
    header = axis if axis in _PLAIN_AXES or axis_signal is None else f"{axis_signal.name} [{axis_signal.unit}]"
    for label, data in curves:
        for values in data.data_vars.values():
            curve_signal = signal(values, system)
            if curve_signal is not None:
                columns[f"{label}: {curve_signal.name} [{curve_signal.unit}]"] = (
                    header,
                    values.data * curve_signal.scale,
                )
    return xr.Dataset(columns, {header: along.data * (axis_signal.scale if axis_signal else 1.0)})


def csv(data: xr.Dataset) -> str:
    """``data`` as comma-separated values with nine significant digits, its axis first."""
    columns = [*data.coords.values(), *data.data_vars.values()]
    rows = zip(*(column.values.tolist() for column in columns), strict=True)
    return csv_text((str(column.name) for column in columns), rows, _DIGITS)
