"""Removal of the lag of the loader's sensors from a record.

A sensor of bandwidth w shows f of what is, x:  ``f' = w (x - f)``,  so  ``x = f + f' / w``.

The rate is that of a cubic spline through the samples. White noise of a record at 1 kHz through sensors of 500 Hz grows by a
quarter.
"""

from dataclasses import replace
from math import isfinite

from scipy.interpolate import CubicSpline

from forcefeel.bench.channels import GRIP_FORCE
from forcefeel.bench.experiments import Drive
from forcefeel.bench.records import BenchRecord
from forcefeel.loader.loader import Loader
from forcefeel.loader.sensors import GRIP_SENSOR

SENSOR_OF = {
    "column_angle": "column_sensor",
    "piston_position": "potentiometer",
    "drive_position": "potentiometer",
    "load_cell_force": "load_cell",
    GRIP_FORCE: GRIP_SENSOR,
}
"""Sensor of the loader by channel; other channels are of the bench's own instruments."""

_SLOWEST = 0.1
"""Least bandwidth of the inverse filter relative to the rate of the record, to limit the noise; the remaining lag is attributed
to the bench."""


def without_lag(record: BenchRecord, loader: Loader) -> BenchRecord:
    """The record without the sensors' lags; a release, with its fitted time, is unchanged."""
    if record.experiment.drive is Drive.RELEASE:
        return record
    channels = dict(record.channels)
    rate = (len(record.time_s) - 1) / float(record.time_s[-1] - record.time_s[0])
    for name, sensor in SENSOR_OF.items():
        bandwidth = loader[f"{sensor}.bandwidth"]
        if name in channels and isfinite(bandwidth) and bandwidth > _SLOWEST * rate:
            channels[name] = channels[name] + CubicSpline(record.time_s, channels[name])(record.time_s, 1) / bandwidth
    return replace(record, channels=channels)
