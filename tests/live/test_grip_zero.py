"""The zero of the force sensor at the grip in service, in virtual time."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.live.state import trips_of
from tests.live.planned import planned
from tests.live.test_running import active

POUND_N = 4.4482216152605
SENSOR = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.02 lb", "grip_sensor.resolution": "0.01 lb"}
NEAR_N = 0.05
"""What the sensor's noise and steps leave of a mean of 10,000 samples, and the creep of the column by it."""
NEAR_DEG = 0.005
"""A few steps of the column's sensor."""
CYCLES = 14_000
"""7 s: the time without a hand, 5 s, and that in which the zero follows."""


def last(loader, force_n):
    """The last row of a run under the law ``grip``, a force of the hand for each cycle."""
    columns = planned(loader, force_n, [(0, "on", [])], law="grip")
    return {name: column[-1] for name, column in columns.items()}


@pytest.mark.parametrize("offset", [1.0, -2.0])
def test_an_offset_of_the_grip_sensor_is_zeroed_and_a_steady_push_stays(offset):
    loader = ff.digital_elevator().replace(SENSOR | {"grip_sensor.offset": f"{offset} lb"})
    rest = np.zeros(CYCLES)
    rested = last(loader, rest)
    assert rested["grip_zero_n"] == pytest.approx(offset * POUND_N, abs=NEAR_N)
    assert np.degrees(rested["column_angle_rad"]) == pytest.approx(0.0, abs=NEAR_DEG)
    pushed = last(loader, np.append(rest, np.full(CYCLES, 20.0)))
    assert pushed["grip_zero_n"] == pytest.approx(offset * POUND_N, abs=NEAR_N)
    expected = np.degrees(20.0 * loader["column.grip_arm"] / loader["feel.stiffness"])
    assert np.degrees(pushed["column_angle_rad"]) == pytest.approx(expected, abs=NEAR_DEG)


def test_noise_that_resembles_a_hand_for_a_sample_does_not_put_off_the_zero():
    loader = ff.digital_elevator().replace(SENSOR | {"grip_sensor.offset": "1 lb"})
    untouched = round(loader["safety.grip_zero_time"] / loader["controller.period"])
    run = planned(loader, np.zeros(CYCLES), [(0, "on", [])], law="grip", seed=1)
    assert np.abs(run["hand_force_n"][:untouched]).max() > loader["safety.hand_force"]
    assert run["grip_zero_n"][-1] == pytest.approx(POUND_N, abs=NEAR_N)
    samples = np.argmax(run["grip_zero_n"] != 0) + 1
    assert untouched <= samples < 1.1 * untouched


def test_an_offset_of_the_grip_sensor_beyond_its_limit_stops_the_loader():
    loader = ff.digital_elevator().replace(SENSOR | {"grip_sensor.offset": "3 lb", "safety.grip_offset": "2 lb"})
    row = last(loader, np.zeros(CYCLES))
    assert ff.live.STATES[int(row["state"])] == "tripped"
    assert [trip.name for trip in trips_of(int(row["trips"]))] == ["offset at the grip"]


@pytest.mark.parametrize("law", ["grip", "robust"])
def test_a_stuck_grip_sensor_stops_the_loader_once_the_hand_changes_its_force(law):
    with ff.live.start(ff.digital_elevator().replace(SENSOR), law, real_time=False) as running:
        active(running)
        running.hand_force_n = 40.0
        running.wait(2_000)
        running.inject_fault("stuck", "grip")
        running.wait(2_000)
        # A hand that holds still is no fault, and no noise alone is none.
        assert running.state.name == "active"
        running.hand_force_n = 0.0
        running.wait(1_000)
        # The stopped loader may also find that the remaining force is an offset.
        assert running.state.trips in (("sensor stuck",), ("sensor stuck", "offset at the grip"))


def test_a_stuck_grip_sensor_without_noise_in_the_file_stops_the_loader():
    quiet = {"grip_sensor.gain": 1.0}
    with ff.live.start(ff.digital_elevator().replace(quiet), "grip", real_time=False) as running:
        active(running)
        running.inject_fault("stuck", "grip")
        running.hand_force_n = 40.0
        running.wait(2_000)
        assert running.state.trips == ("sensor stuck",)
