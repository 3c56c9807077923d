"""The curves of a figure as a wide table of comma-separated values."""

import xarray as xr

from forcefeel.design.figure import Figure
from forcefeel.page.signals import signal
from forcefeel.units import UnitSystem

_PLAIN_AXES = ("time_s", "frequency_hz")
_DIGITS = "%.9g"


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
    shown = signal(along, system)
    header = axis if axis in _PLAIN_AXES or shown is None else f"{shown.name} [{shown.unit}]"
    for label, data in curves:
        for values in data.data_vars.values():
            found = signal(values, system)
            if found is not None:
                columns[f"{label}: {found.name} [{found.unit}]"] = (header, values.data * found.scale)
    return xr.Dataset(columns, {header: along.data * (shown.scale if shown else 1.0)})


def csv(data: xr.Dataset) -> str:
    """``data`` as comma-separated values with nine significant digits, its axis first."""
    return str(data.to_dataframe().to_csv(float_format=_DIGITS, lineterminator="\n"))
