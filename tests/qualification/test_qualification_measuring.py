"""Static sweeps: loops of known friction, breakout, freeplay and gradient."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.errors import InputError
from forcefeel.qualification import Record
from forcefeel.qualification.sweep import measure_sweep
from tests.parametrization import mostly_slow
from tests.qualification_records import swept

SURE = 3.0
"""Standard uncertainties within which every figure lies."""
ROUNDING_N = 1e-10
"""Of some 100 N, by means of samples in another order. Measured: 3e-14."""
SURE_N = 1e-3
"""Beside a force's own uncertainty, which is none without noise."""
A_POSITION = 1e-3
"""One of the 401 positions, to which a mean of samples may belong, of 0.4 rad. Measured: 4e-4."""
FINE = 1e-6
"""Of a figure; what a loop without noise leaves of it where it is a straight line."""


def near(figure, expected):
    """Whether a figure says the truth about itself."""
    return abs(figure.value - expected) <= SURE * figure.uncertainty + FINE * max(abs(expected), 1e-3)


@pytest.mark.parametrize("noise", [0.0, 0.5])
@pytest.mark.parametrize("rate", mostly_slow([50, 100, 1000]))
@pytest.mark.parametrize(("breakout", "friction"), [(10.0, 5.0), (0.0, 8.0), (10.0, 0.0), (20.0, 20.0)])
def test_sweep_of_known_parts_is_measured(breakout, friction, rate, noise):
    features = measure_sweep(swept(breakout=breakout, friction=friction, rate=rate, noise_n=noise))
    assert near(features.friction, friction)
    assert near(features.gradient, 400.0)
    assert near(features.gradient_low, 400.0)
    assert near(features.gradient_high, 400.0)
    assert near(features.breakout_high, breakout + friction)
    assert near(features.breakout_low, breakout + friction)
    assert near(features.freeplay, 0.0)
    assert near(features.centring, max(friction - breakout, 0.0) / 400.0)
    assert features.stops == pytest.approx((-0.2, 0.2), rel=FINE)
    assert features.neutral == pytest.approx(0.0, abs=FINE)
    assert features.friction.uncertainty < 0.5
    assert features.gradient.uncertainty < 4.0
    at = np.interp([-0.1, 0.1], features.position, features.force_up_n)
    assert at == pytest.approx(
        [-40 - breakout + friction, 40 + breakout + friction], abs=5 * features.force_uncertainty_n + SURE_N
    )


@pytest.mark.parametrize("freeplay", [0.004, 0.01, 0.03])
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_freeplay_is_measured(freeplay, noise):
    features = measure_sweep(swept(breakout=0.0, friction=2.0, freeplay=freeplay, noise_n=noise))
    assert near(features.freeplay, freeplay)
    assert near(features.friction, 2.0)
    assert features.freeplay.uncertainty < 0.003


def test_breakout_is_read_at_static_friction_peak():
    """20 N hold it, 5 N drag it: the first move is at 20 N, not on the line through what follows."""
    record = swept(breakout=0.0, friction=5.0)
    force = np.array(record.force_n)
    moved = int(np.argmax(record.position > 0))
    force[:moved] = np.linspace(0, 20, moved)
    found = measure_sweep(Record(record.time_s, record.position, force)).breakout_high
    assert found.value == pytest.approx(20.0, rel=FINE)


def test_sweep_is_measured_in_both_orders_of_stops():
    record = swept(breakout=10.0, friction=5.0)
    one, other = measure_sweep(record), measure_sweep(Record(record.time_s, -record.position, -record.force_n))
    assert other.breakout_low.value == pytest.approx(one.breakout_high.value)
    assert other.breakout_high.value == pytest.approx(one.breakout_low.value)
    assert other.friction.value == pytest.approx(one.friction.value)
    assert other.force_up_n == pytest.approx(-one.force_down_n[::-1], abs=ROUNDING_N, nan_ok=True)


@given(
    stiffness=st.floats(50, 2000),
    breakout=st.floats(0, 40),
    friction=st.floats(0, 40),
    scale=st.floats(0.1, 10),
    offset=st.floats(-1, 1),
)
def test_sweeps_of_any_size_are_measured(stiffness, breakout, friction, scale, offset):
    record = swept(stiffness=stiffness, breakout=breakout, friction=friction, duration_s=40.0)
    moved = Record(record.time_s + 7, record.position * scale + offset, record.force_n)
    features = measure_sweep(moved)
    assert near(features.friction, friction)
    assert near(features.gradient, stiffness / scale)
    assert features.duration_s == pytest.approx(record.duration_s)


def test_surface_position_follows_control():
    features = measure_sweep(swept(surface_gain=1.5))
    known = np.isfinite(features.surface_up_rad)
    assert features.surface_up_rad[known] == pytest.approx(1.5 * features.position[known], abs=A_POSITION)
    assert measure_sweep(swept()).surface_up_rad is None


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (Record(np.arange(99.0), np.zeros(99), name="bare"), "bare: expected a force for the position"),
        (
            Record(np.arange(99.0), np.zeros(99), np.zeros(99), name="still"),
            "still: has no sweep: the position stays at 0 rad",
        ),
        (swept(name="half").between(0, 30), r"half: begins at .* expected a sweep from neutral to both sides"),
        (
            swept(name="cut").between(0, 77),
            r"cut: covers .* % of the travel while the position rises, up to its end at 77 s",
        ),
    ],
)
def test_invalid_sweep_raises_input_error(record, message):
    with pytest.raises(InputError, match=message):
        measure_sweep(record)


def test_sweep_has_requested_points_within_range():
    assert len(measure_sweep(swept(), points=101).position) == 101
    with pytest.raises(InputError, match="points: expected 21 to 10001, got 3"):
        measure_sweep(swept(), points=3)
