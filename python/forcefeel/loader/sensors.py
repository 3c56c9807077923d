"""What a controller's samples of the sensors are worth, and when it answers them."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE

SENSORS = ("load_cell", "potentiometer", "column_sensor")
"""In the order in which a law samples them: F_c, x_p, theta."""


GRIP_SENSOR = "grip_sensor"
"""What a law samples after them where a loader has it: F_g."""


def has_grip_sensor(loader: Loader) -> bool:
    """Whether the loader has a force sensor at the grip.

    Example:
        >>> from forcefeel.loader.sensors import has_grip_sensor
        >>> has_grip_sensor(ff.digital_elevator().replace({"grip_sensor.gain": 1.0}))
        True
    """
    return bool(loader["grip_sensor.gain"])


def without_grip_sensor(loader: Loader) -> Loader:
    """The loader as it is before the sensor at its grip is trusted: its laws and its motion know nothing of it."""
    return loader.replace({key: None for key in TABLE if key.startswith(f"{GRIP_SENSOR}.")})


def sensors_of(loader: Loader) -> tuple[str, ...]:
    """The sensors that a loader's controller samples, in their order."""
    return (*SENSORS, GRIP_SENSOR) if has_grip_sensor(loader) else SENSORS


def unseen_inertia(loader: Loader) -> float:
    """Inertia in N m s²/rad between the hand and the nearest force sensor: J, or ``m_o R_p^2`` with one at the grip."""
    if has_grip_sensor(loader):
        return float(loader["grip_sensor.mass"] * loader["column.grip_arm"] ** 2)
    return float(loader["column.inertia"])


def sample_variance(loader: Loader) -> NDArray[np.float64]:
    """Variance of a sample of each sensor: noise and rounding, ``sigma^2 + q^2 / 12``, in N^2, m^2, rad^2 and N^2."""
    sensors = sensors_of(loader)
    noise = np.array([loader[f"{sensor}.noise"] for sensor in sensors])
    step = np.array([loader[f"{sensor}.resolution"] for sensor in sensors])
    return np.asarray(noise**2 + step**2 / 12)


def current_lag_s(loader: Loader) -> float:
    """From a motion of the drive's end to the middle of the motor's current that answers it.

    Lags of the encoder and the current loop, delay, and half a period of holding: ``tau + T / 2 + 1 / w_c + 1 / f_x``.
    """
    held = loader["controller.delay"] + loader["controller.period"] / 2
    return float(held + 1 / loader["current_loop.bandwidth"] + 1 / loader["potentiometer.bandwidth"])


def sensor_lag_s(loader: Loader) -> float:
    """Lag of the slower of the drive's two sensors, ``1 / min(f_F, f_x)``; 0 if both are at once there.

    Example:
        >>> from forcefeel.loader.sensors import sensor_lag_s
        >>> f"{1e3 * sensor_lag_s(ff.digital_elevator().replace({'load_cell.bandwidth': '500 Hz'})):.3f} ms"
        '0.318 ms'
    """
    return float(1 / min(loader["load_cell.bandwidth"], loader["potentiometer.bandwidth"]))
