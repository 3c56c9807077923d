"""The lag of the loader's sensors, taken out of a record."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from forcefeel.commission.sensor_lag import without_lag
from forcefeel.commission.simulated_bench import lagged

RATE_HZ = 1000.0
LOADER = ff.digital_elevator().replace({"column_sensor.bandwidth": "100 Hz"})


def swept():
    time_s = np.arange(2001) / RATE_HZ
    return time_s, np.sin(2 * np.pi * 8 * time_s) * np.clip(time_s, 0, 1)


def record(experiment, angle, time_s):
    channels = {"test_signal": angle, "column_angle": angle, "load_pressure": angle}
    return BenchRecord("one", Experiment.read(experiment), time_s, channels)


def test_lag_matches_its_differential_equation():
    turn = 0.3
    ramp = np.arange(200.0)
    # f = x - h / turn (1 - e^-wt) for x = t / h
    expected = ramp - (1 - np.exp(-turn * np.arange(200))) / turn
    assert lagged(ramp, turn) == pytest.approx(expected, abs=1e-12)  # sums of 200


def test_sensor_lag_is_compensated():
    time_s, angle = swept()
    seen = lagged(angle, LOADER["column_sensor.bandwidth"] / RATE_HZ)
    assert np.abs(seen - angle).max() > 0.05  # 8 Hz through 100 Hz is 4.6 deg late
    back = without_lag(record("servo-closed", seen, time_s), LOADER).channels
    # What is left: straight lines between samples against a spline, (w h)^2 / 12 of the lag's 8 %.
    assert np.abs(back["column_angle"] - angle).max() < 2e-3
    assert np.array_equal(back["load_pressure"], seen)


def test_sensors_without_bandwidth_and_releases_are_unchanged():
    time_s, angle = swept()
    assert np.array_equal(
        without_lag(record("servo-closed", angle, time_s), ff.digital_elevator()).channels["column_angle"], angle
    )
    assert without_lag(record("release", angle, time_s), LOADER).channels["column_angle"] is angle
