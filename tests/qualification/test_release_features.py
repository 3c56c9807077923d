"""Features of releases: against what second-order records have in closed form, and how well the program says it knows them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.errors import InputError
from forcefeel.qualification import Record, measure_release
from forcefeel.qualification.release_batch import measure_releases
from tests.qualification_records import exact, lasts, released, second_order

RATES = (50, 60, 100, 500, 1000)
UNDERDAMPED = ((0.1, 0.5), (0.1, 4.0), (0.2, 2.0), (0.5, 1.0), (0.5, 4.0))
OVERDAMPED = ((1.0, 0.5), (1.0, 4.0), (1.5, 0.5), (1.5, 4.0))
SHARE = 0.05
"""Of the rule's tightest tolerance, 10 % of a figure: what interpolation may take of it at the lowest rate."""
END = 5e-6
"""Of the angle held: what is left of the swing where a record ends. Measured: 5e-7."""
FINE = 1e-6
"""Of a figure, beside what it says of itself; rounding of times, and of what is left at the end."""
UNEVEN = 3e-5
"""Of a figure: samples 4 to 16 ms apart, interpolated, of a period of half a second. Measured: 3e-6."""
EVEN = 2e-6
"""The same of samples 5 ms apart. Measured: 1.2e-7."""
WITHIN = 0.3
"""Of a sample: where between two samples a control is found to have been let go. Measured: 0.17."""
RISE = 0.02
"""Of the angle: where a control that creeps has a tenth of its way left, as far as interpolation tells. Measured: 0.011."""
MOVED = 1e-9
"""Relative: an offset of 2 on 0.002 rad and a clock at 50 s cost five digits. Measured: 4e-13."""
ROUNDING = 1e-12
"""Relative: the same sums of one record and of many. Measured: 0."""
CUT = 0.03
"""Of a figure: a record that is taken for one at rest has been at rest for long enough; a tenth is the rule's tolerance.
Measured: 4e-3."""
SURE = 3.0
"""Standard uncertainties within which every figure without noise lies."""


def figures(features):
    """All figures with the ones that must be there."""
    way = abs(features.displacement.value)
    sizes = [(size.value / way, size.uncertainty / way) for size in features.overshoots[: features.count]]
    return [(cycle.value, cycle.uncertainty) for cycle in features.cycles[: features.count // 2 + 1]], sizes


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(("zeta", "frequency"), UNDERDAMPED)
def test_noiseless_record_is_measured_within_tolerance(zeta, frequency, rate):
    features = measure_release(released(zeta, frequency, rate))
    fall, cycles, sizes = exact(zeta, frequency)
    assert features.underdamped
    assert features.count == sum(size > 0.05 for size in sizes)
    assert features.displacement.value == pytest.approx(0.2, rel=END)
    found_cycles, found_sizes = figures(features)
    for (found, known), expected in zip(found_cycles, cycles, strict=False):
        assert abs(found - expected) < min(SHARE / 10 * expected, SURE * known + FINE * expected)
    for (found, known), expected in zip(found_sizes, sizes, strict=False):
        assert abs(found - expected) < min(SHARE / 10 * sizes[0], SURE * known + FINE)
    assert features.fall_time.value == pytest.approx(fall, rel=SHARE / 10)
    assert features.release_s.value == pytest.approx(0.5037, abs=WITHIN / rate)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(("zeta", "frequency"), OVERDAMPED)
def test_overdamped_release_has_fall_time(zeta, frequency, rate):
    features = measure_release(released(zeta, frequency, rate))
    assert not features.underdamped
    assert features.count_range == (0, 0)
    expected = exact(zeta, frequency)[0]
    assert abs(features.fall_time.value - expected) < SHARE / 10 * expected
    rises = features.rise_time.value
    assert float(second_order(zeta, frequency, rises)) == pytest.approx(
        0.1, abs=RISE + WITHIN * 2 * math.pi * frequency / rate
    )


@pytest.mark.parametrize("noise", [0.001, 0.01])
@pytest.mark.parametrize("rate", [60, 1000])
def test_stated_uncertainty_covers_noise_scatter(rate, noise):
    """Of repetitions, about 95 % lie within two standard uncertainties, and these are not many times too wide."""
    _, cycles, sizes = exact(0.2, 2.0)
    off, stated = [], []
    for seed in range(60):
        features = measure_release(released(0.2, 2.0, rate, noise=noise, seed=seed))
        found = [*features.cycles[:2], *features.overshoots[:3]]
        expected = [*cycles[:2], *(0.2 * size for size in sizes[:3])]
        off.append([figure.value - value for figure, value in zip(found, expected, strict=True)])
        stated.append([figure.uncertainty for figure in found])
    off, stated = np.array(off), np.array(stated)
    within = np.mean(np.abs(off) < 2 * stated, axis=0)
    assert np.all(within >= 0.85), within
    assert np.all(np.median(stated, axis=0) < 3 * np.std(off, axis=0))


def test_sensor_resolution_enters_uncertainty():
    record = released(0.2, 2.0, 200)
    step = 0.002
    stepped = Record(record.time_s, np.round(record.position / step) * step)
    features = measure_release(stepped)
    assert features.resolution == pytest.approx(step)
    _, cycles, sizes = exact(0.2, 2.0)
    for figure, expected in zip(
        (*features.cycles[:2], features.overshoots[0]), (*cycles[:2], 0.2 * sizes[0]), strict=True
    ):
        assert abs(figure.value - expected) < SURE * figure.uncertainty
        assert figure.uncertainty > 0


def test_irregular_samples_are_measured():
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.uniform(0.004, 0.016, 1200))
    features = measure_release(Record(t, 0.2 * second_order(0.2, 2.0, t - 0.5)))
    _, cycles, sizes = exact(0.2, 2.0)
    assert [cycle.value for cycle in features.cycles[:3]] == pytest.approx(cycles[:3], rel=UNEVEN)
    assert [size.value / 0.2 for size in features.overshoots[:4]] == pytest.approx(sizes[:4], abs=UNEVEN)


def test_overshoot_near_band_edge_counts_by_size():
    """4.9 % and 5.1 %: damping ratios from A1 = exp(-pi z / sqrt(1 - z^2))."""
    for size, count in ((0.049, 0), (0.051, 1)):
        log = math.log(size)
        features = measure_release(released(-log / math.hypot(math.pi, log), 2.0, 100))
        assert features.count == count
        assert features.count_range == (count, count)
        coarse = measure_release(released(-log / math.hypot(math.pi, log), 2.0, 100, noise=0.01))
        assert coarse.count_range == (0, 1)


@given(
    scale=st.floats(0.01, 100),
    mirror=st.sampled_from([-1.0, 1.0]),
    offset=st.floats(-2, 2),
    shift=st.floats(-50, 50),
)
def test_features_are_independent_of_scale_offset_side_and_time(scale, mirror, offset, shift):
    record = released(0.2, 2.0, 100)
    moved = Record(record.time_s + shift, mirror * scale * record.position + offset)
    one, other = measure_release(record), measure_release(moved)
    assert other.count == one.count
    assert other.displacement.value == pytest.approx(mirror * scale * one.displacement.value, rel=MOVED)
    assert [it.value for it in other.cycles[:3]] == pytest.approx([it.value for it in one.cycles[:3]], rel=MOVED)
    sizes = [scale * it.value for it in one.overshoots[:4]]
    assert [it.value for it in other.overshoots[:4]] == pytest.approx(sizes, rel=MOVED)


def test_batch_measurement_equals_single_measurement():
    t = np.arange(0, lasts(0.1, 2.0), 1 / 200)
    settings = [(0.1, 2.0), (0.2, 2.0), (0.6, 3.0), (1.0, 2.0), (1.5, 2.0)]
    runs = np.stack([-0.1 + 0.3 * second_order(zeta, frequency, t) for zeta, frequency in settings])
    batch = measure_releases(t, runs, threads=1)
    assert np.array_equal(batch.values, measure_releases(t, runs, threads=2).values, equal_nan=True)
    assert batch.settled.all()
    for k, run in enumerate(runs):
        one = measure_release(Record(t, run))
        assert batch.count[k] == one.count
        assert batch.fall_time_s[k] == pytest.approx(one.fall_time.value, rel=ROUNDING)
        kept = min(len(one.cycles), one.count // 2 + 1) if one.underdamped else 0
        assert batch.cycles_s[k, :kept] == pytest.approx([it.value for it in one.cycles[:kept]], rel=ROUNDING)
        assert batch.overshoots[k, : one.count] == pytest.approx(
            [it.value for it in one.overshoots[: one.count]], rel=ROUNDING
        )
        fall, cycles, sizes = exact(*settings[k])
        assert batch.fall_time_s[k] == pytest.approx(fall, rel=EVEN)
        assert batch.overshoots[k, : one.count] == pytest.approx([0.3 * size for size in sizes[: one.count]], rel=EVEN)
        assert batch.cycles_s[k, :kept] == pytest.approx(cycles[:kept], rel=EVEN)


def test_runs_with_nan_or_without_rest_are_marked_unmeasured():
    t = np.arange(0, 20, 1 / 100)
    runs = np.tile(second_order(0.2, 2.0, t), (5, 1))
    runs[1, 700] = np.nan
    runs[2, -1] = np.inf
    runs[3] = np.cos(t)
    runs[4] = 0.0
    batch = measure_releases(t, runs)
    assert batch.measured.tolist() == [True, False, False, True, False]
    assert batch.settled.tolist() == [True, False, False, False, False]
    assert np.isnan(batch.values[1]).all()
    assert len(batch[1:3]) == 2


@pytest.mark.parametrize(
    ("time", "runs", "options", "message"),
    [
        (np.arange(30.0), np.zeros(30), {}, r"got shapes \(30,\) and \(30,\)"),
        (np.arange(30.0), np.zeros((2, 29)), {}, "got shapes"),
        (np.arange(30.0), np.zeros((2, 30)), {"held": 11}, "held: expected 1 to 10 of 30 samples"),
        (np.arange(30.0), np.zeros((2, 30)), {"tail": 0.6}, "tail: expected a share above 0, at most 0.5, got 0.6"),
        (np.zeros(30), np.zeros((2, 30)), {}, "time_s: expected rising numbers"),
    ],
)
def test_invalid_batch_is_refused(time, runs, options, message):
    with pytest.raises(InputError, match=message):
        measure_releases(time, runs, **options)


def cut(record, end_s):
    return record.between(0.0, end_s)


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (
            cut(released(0.2, 2.0, 500, name="short"), 0.6),
            r"short: ends at 0\.6 s, 0\.09\d* s after the release, before its first",
        ),
        (cut(released(0.2, 2.0, 200, name="early"), 0.62), r"early: ends at 0\.62 s"),
        (
            cut(released(0.1, 2.0, 200, name="swings"), 1.9),
            r"swings: ends at 1\.895 s, .* before it comes to rest; expected",
        ),
        (
            cut(released(0.2, 2.0, 200, name="cut"), 0.55),
            r"cut: ends at 0\.55 s, \d+ samples after the release; expected 20",
        ),
        (released(0.2, 2.0, 40, name="slow"), r"slow: has 40 samples a second; expected 50 at least"),
        (
            Record(np.arange(500) / 100, np.full(500, 0.1), name="still"),
            r"still: has no release: the position is 0\.1 rad at 0 s and 0\.1 rad at its end, 4\.99 s",
        ),
        (
            Record(np.arange(500) / 100, np.sin(np.minimum(np.arange(500) / 100, 3) * math.pi / 3) ** 2, name="pulse"),
            "pulse: has no release",
        ),
    ],
)
def test_insufficient_record_raises_input_error(record, message):
    with pytest.raises(InputError, match=message):
        measure_release(record)


def test_a_clipped_record_is_refused_with_the_time():
    record = released(0.1, 2.0, 200, name="clipped", steady=0.0)
    clipped = Record(record.time_s, np.maximum(record.position, -0.09), name="clipped")
    with pytest.raises(InputError, match=r"clipped: is clipped at -0\.09 rad from 0\.6\d* s to 0\.8\d* s"):
        measure_release(clipped)
    both = Record(record.time_s, np.clip(record.position, -0.05, None), name="both")
    with pytest.raises(InputError, match="both: is clipped"):
        measure_release(both)


@pytest.mark.parametrize("end", np.linspace(0.56, 1.6, 14))
@pytest.mark.parametrize("zeta", [0.1, 0.2, 0.4])
def test_record_truncated_while_moving_is_not_at_rest(zeta, end):
    """Wherever it is cut: the figures of a record that is taken are those of the whole."""
    whole = released(zeta, 2.0, 200)
    try:
        features = measure_release(cut(whole, end))
    except InputError:
        return
    expected = exact(zeta, 2.0)
    assert features.displacement.value == pytest.approx(0.2, rel=CUT)
    assert features.cycles[0].value == pytest.approx(expected[1][0], rel=CUT)
