"""Inputs over time: against closed forms, against NumPy's and SciPy's own interpolation and chirp; what must be refused."""

import math
from pathlib import Path

import numpy as np
import pytest
import scipy.integrate
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.errors import InputError
from forcefeel.simulation.inputs import (
    Chirp,
    Doublet,
    HandsOff,
    Multisine,
    Pulse,
    Recorded,
    Release,
    Sampled,
    Schedule,
    Step,
    StopToStop,
    read_recorded,
)

POUND = 4.4482216152605  # N, exact: 0.45359237 kg times 9.80665 m/s^2
ROUNDING = 1e-12  # relative; a few multiplications, and times that are off by 1e4 steps times 1e-16
ON_THE_GRID_S = 1e-8  # a point so near to the grid is taken to be on it, which shifts the steepest line by so much
PHASE_ROUNDING = 1e-9  # relative; sines of up to 1e4 rad, each good to 1e-16 of that, summed
PEAK_FOUND = 1e-10  # relative; the search stops within 1e-4 of a 64th of a cycle or a little more: (1e-4 pi / 64)^2 / 2
PEAK = 1e-5  # relative; the densest grid here has 2000 points a cycle: (pi / 2000)^2 / 2
H = 1e-3  # s, the step where nothing else is said

LINES = tuple((np.arange(1, 31) / 10).tolist())  # 0.1 to 3 Hz, a period of 10 s
SPREAD = tuple((np.unique(np.geomspace(1, 300, 25).round()) / 10).tolist())  # 0.1 to 30 Hz
KINDS = [
    HandsOff(),
    Step(3.0, 0.5),
    Pulse(3.0, 0.5, 0.25),
    Doublet(3.0, 0.25, 0.5),
    StopToStop(3.0, 2.0),
    Chirp(3.0, 1.0, 5.0, 1.0),
    Multisine(3.0, LINES, 10.0),
    Recorded(np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, 1.0])),
    Release(0.2, 0.5),
    Schedule((0.0, 0.5, 0.5, 1.0), (0.0, 1.0, 2.0, 3.0)),
]
CONTINUOUS = [
    StopToStop(3.0, 2.0),
    Chirp(3.0, 1.0, 10.0, 2.0),
    Multisine(3.0, LINES, 10.0, seed=1),
    KINDS[7],
    HandsOff(),
]


def of_kind(kinds: list) -> dict:
    return {"argnames": "kind", "argvalues": kinds, "ids": [type(kind).__name__ for kind in kinds]}


def area(sampled: Sampled, step_s: float = H) -> float:
    """The integral, exact for what is straight within each step."""
    return math.fsum((sampled.start + sampled.end) / 2) * step_s


def grid(time_s: float, step_s: float = H) -> np.ndarray:
    return np.arange(round(time_s / step_s) + 1) * step_s


def at_steps(sampled: Sampled) -> np.ndarray:
    """The values at all n + 1 times of a continuous input."""
    np.testing.assert_array_equal(sampled.end[:-1], sampled.start[1:])
    return np.append(sampled.start, sampled.end[-1])


# What all kinds have in common


@pytest.mark.parametrize(**of_kind(KINDS))
@pytest.mark.parametrize(("time_s", "step_s", "steps"), [(2.0, 1e-3, 2000), (0.3, 0.05, 6), (1.0, 0.0625, 16)])
def test_a_run_has_a_value_after_and_before_each_time(kind, time_s, step_s, steps):
    start, end = sampled = kind.sample(time_s, step_s)
    assert (start.shape, end.shape) == ((steps,), (steps,))
    assert start.dtype == end.dtype == np.float64
    assert start.flags.c_contiguous
    assert end.flags.c_contiguous
    assert np.isfinite(sampled).all()
    for row in sampled:
        with pytest.raises(ValueError, match="read-only"):
            row[0] = 1.0


@pytest.mark.parametrize(**of_kind(KINDS))
@pytest.mark.parametrize(
    ("time_s", "step_s", "message"),
    [
        (
            1.0005,
            H,
            "run: ends at 1.0005 s, between the steps' times 1 s and 1.001 s; expected a multiple of the step of",
        ),
        (
            0.0004,
            H,
            "run: ends at 0.0004 s, between the steps' times 0 s and 0.001 s; expected a multiple of the step of",
        ),
        (1e-12, H, "run: ends at 1e-12 s, between the steps' times 0 s and 0.001 s"),
        (0.0, H, "run: expected time_s to be a number above 0, got 0.0"),
        (-1.0, H, "run: expected time_s to be a number above 0, got -1.0"),
        (math.nan, H, "run: expected time_s to be a number above 0, got nan"),
        (math.inf, H, "run: expected time_s to be a number above 0, got inf"),
        (10**400, H, "run: expected time_s to be a number above 0, got a huge number"),
        ("1 s", H, "run: expected time_s to be a number above 0, got '1 s'"),
        (1.0, 0.0, "run: expected step_s to be a number above 0, got 0.0"),
        (1.0, True, "run: expected step_s to be a number above 0, got true"),
        (1.0, 1e-300, "run: expected at most 1000000000 steps, got 1 s in steps of 1e-300 s"),
    ],
)
def test_a_run_that_is_no_whole_number_of_steps_is_refused(kind, time_s, step_s, message):
    with pytest.raises(InputError) as caught:
        kind.sample(time_s, step_s)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(**of_kind(CONTINUOUS))
def test_continuous_kinds_do_not_jump(kind):
    at_steps(kind.sample(2.0, H))


@pytest.mark.parametrize(**of_kind([kind for kind in KINDS if not isinstance(kind, Recorded)]))
def test_shorter_run_equals_start_of_longer_run(kind):
    short, long = kind.sample(0.7, H), kind.sample(1.9, H)
    for one, other in zip(short, long, strict=True):
        np.testing.assert_array_equal(one, other[:700])


# Jumps


def test_step_is_exact_on_both_sides_of_its_jump():
    start, end = Step(-7.0, 0.003).sample(0.006, H)
    np.testing.assert_array_equal(start, [0, 0, 0, -7, -7, -7])
    np.testing.assert_array_equal(end, [0, 0, 0, -7, -7, -7])


def test_step_from_the_first_moment():
    np.testing.assert_array_equal(Step(2.0).sample(0.003, H), np.full((2, 3), 2.0))


def test_pulse_has_its_area():
    start, end = sampled = Pulse(0.1, 0.002, 0.003).sample(0.007, H)
    np.testing.assert_array_equal(start, [0, 0, 0.1, 0.1, 0.1, 0, 0])
    np.testing.assert_array_equal(end, start)
    assert area(sampled) == pytest.approx(0.1 * 0.003, rel=ROUNDING)


def test_doublet_has_two_halves_and_zero_mean():
    start, end = sampled = Doublet(0.1, 0.001, 0.002).sample(0.006, H)
    np.testing.assert_array_equal(start, [0, 0.1, 0.1, -0.1, -0.1, 0])
    np.testing.assert_array_equal(end, start)
    assert area(sampled) == 0.0


STEPS = st.sampled_from([1e-3, 5e-4, 2.5e-4, 1e-4, 1 / 3000, 1 / 1024, 0.1, 0.01])


@given(STEPS, st.integers(0, 5000), st.integers(1, 5000), st.sampled_from(["product", "decimal", "quotient"]))
def test_jump_on_grid_is_found_despite_rounding(step_s, first, wide, how):
    rounded = {
        "product": lambda k: k * step_s,
        "decimal": lambda k: float(f"{k * step_s:.12g}"),
        "quotient": lambda k: k / round(1 / step_s),
    }[how]
    n = first + 2 * wide + 3
    expected = np.zeros(n)
    expected[first : first + wide] = 1.5
    expected[first + wide : first + 2 * wide] = -1.5
    sampled = Doublet(1.5, rounded(first), rounded(wide)).sample(rounded(n), step_s)
    np.testing.assert_array_equal(sampled, [expected, expected])


JUMPS = [
    (Step(1.0, 0.0105), "Step", "0.0105", "0.01", "0.011"),
    (Pulse(1.0, 0.0102, 0.01), "Pulse", "0.0102", "0.01", "0.011"),
    (Pulse(1.0, 0.01, 0.0107), "Pulse", "0.0207", "0.02", "0.021"),
    (Doublet(1.0, 0.01, 0.0105), "Doublet", "0.0205", "0.02", "0.021"),
    (Chirp(1.0, 1.0, 2.0, 0.5009), "Chirp", "0.5009", "0.5", "0.501"),
    (Release(0.2, 0.0001), "Release", "0.0001", "0", "0.001"),
    (Schedule((0.0, 0.3333, 0.3333), (0.0, 0.0, 1.0)), "Schedule", "0.3333", "0.333", "0.334"),
    (Schedule((0.3333, 0.3333), (0.0, 1.0), "shaker"), "shaker", "0.3333", "0.333", "0.334"),
]


@pytest.mark.parametrize(("kind", "name", "at", "below", "above"), JUMPS)
def test_a_jump_within_a_step_is_refused_with_the_nearest_times(kind, name, at, below, above):
    with pytest.raises(InputError) as caught:
        kind.sample(1.0, H)
    assert str(caught.value) == (
        f"{name}: jumps at {at} s, between the steps' times {below} s and {above} s; "
        "expected a multiple of the step of 0.001 s, so take one of the two or another step"
    )


@pytest.mark.parametrize(("kind", "at"), [(jump[0], jump[2]) for jump in JUMPS])
def test_jump_after_run_or_on_finer_grid_is_accepted(kind, at):
    kind.sample(1.0, 1e-4)
    if float(at) > 0.02:
        assert np.isfinite(kind.sample(0.02, H)).all()


@pytest.mark.parametrize("start_s", [0.0, 0.5])
@pytest.mark.parametrize("width_s", [1e-30, 1e-17, 1e-12])
def test_input_shorter_than_rounding_raises_input_error(start_s, width_s):
    for kind in (Pulse(1.0, start_s, width_s), Doublet(1.0, start_s, width_s)):
        with pytest.raises(InputError, match=f"comes and goes within 1e-06 of a step at {start_s:g} s"):
            kind.sample(1.0, H)
    with pytest.raises(InputError, match=r"^Schedule: comes and goes within 1e-06 of a step at 0\.5 s;"):
        Schedule((0.5, 0.5, 0.5 + 1e-12), (0.0, 5.0, 0.0)).sample(1.0, H)


@pytest.mark.parametrize(
    "kind", [Pulse(1.0, 0.0, 1e308), Doublet(1.0, 0.0, 1e308), Doublet(1.0, 1e308, 1e308), StopToStop(1.0, 1e308)]
)
def test_infinite_duration_is_sampled(kind):
    assert np.isfinite(kind.sample(0.01, H)).all()


# StopToStop


@pytest.mark.parametrize("duration_s", [1.0, 60.0])
def test_sweep_moves_stop_to_stop_at_constant_rate(duration_s):
    force = at_steps(StopToStop(90.0, duration_s).sample(duration_s, H))
    t = grid(duration_s)
    triangle = 90 * 2 / np.pi * np.arcsin(np.sin(2 * np.pi * t / duration_s))
    np.testing.assert_allclose(
        force, triangle, atol=90 * 1e-7
    )  # arcsin has a square root at its ends: sqrt(1e-16) there
    assert force[[0, -1]].tolist() == [0.0, 0.0]
    assert force[round(duration_s / 4 / H)] == force.max() == 90.0
    assert force[round(duration_s * 3 / 4 / H)] == force.min() == -90.0
    np.testing.assert_allclose(
        np.abs(np.diff(force)), 4 * 90 * H / duration_s, rtol=1e-10
    )  # a thousandth of the force, as a difference of it
    assert abs(force.sum()) < 90 * ROUNDING * len(t)


def test_negative_sweep_starts_in_negative_direction_and_ends_at_zero():
    sweep = StopToStop(-90.0, 1.0).sample(2.0, H)
    assert sweep.start[1] < 0
    assert not sweep.start[1000:].any()
    assert not sweep.end[999:].any()


def test_a_corner_within_a_step_is_cut_by_no_more_than_promised():
    force = at_steps(StopToStop(90.0, 1.002).sample(1.1, H))  # corners at 0.2505 s and 0.7515 s
    promised = 2 * 90 * H / 1.002
    assert 0 < 90 - force.max() <= promised * (1 + ROUNDING)
    assert 0 < 90 + force.min() <= promised * (1 + ROUNDING)


def test_sweep_and_chirp_too_fast_for_step_are_refused():
    with pytest.raises(
        InputError, match=r"^StopToStop: expected duration_s to be 4 steps of 0.001 s at least, got 0.0035 s; "
    ):
        StopToStop(1.0, 0.0035).sample(1.0, H)
    with pytest.raises(
        InputError, match=r"^Chirp: expected duration_s to be 1 steps of 0.001 s at least, got 1e-12 s; "
    ):
        Chirp(1.0, 1.0, 2.0, 1e-12).sample(1.0, H)
    assert np.abs(StopToStop(1.0, 0.004).sample(1.0, H)).max() == 1.0


# Chirp

CHIRPS = [
    Chirp(5.0, 0.5, 8.0, 10.0),
    Chirp(5.0, 0.0, 8.0, 10.0),
    Chirp(5.0, 8.0, 0.5, 10.0),
    Chirp(5.0, 3.0, 3.0, 10.0),
    Chirp(5.0, 0.1, 8.0, 10.0, "logarithmic"),
    Chirp(5.0, 8.0, 0.5, 10.0, "logarithmic"),
    Chirp(5.0, 3.0, 3.0, 10.0, "logarithmic"),
    Chirp(5.0, 3.0, 3.0 * (1 + 1e-13), 10.0, "logarithmic"),
]


def frequency_hz(chirp: Chirp, t: np.ndarray | float) -> np.ndarray | float:
    part = t / chirp.duration_s
    if chirp.spacing == "linear":
        return (1 - part) * chirp.from_hz + part * chirp.to_hz
    return chirp.from_hz ** (1 - part) * chirp.to_hz**part


@pytest.mark.parametrize("chirp", CHIRPS)
def test_chirp_has_its_frequency_at_each_time(chirp):
    h = 1e-4
    force, t = at_steps(chirp.sample(10.0, h)), grid(10.0, h)
    slope = (force[2:] - force[:-2]) / (2 * h)
    steep = np.abs(force[1:-1]) < 0.7 * 5.0  # near the crests the slope says nothing
    found = np.abs(slope[steep]) / (2 * np.pi * np.sqrt(5.0**2 - force[1:-1][steep] ** 2))
    # Central differences of a sine are off by (2 pi f h)^2 / 6, and by half a step's change of frequency.
    np.testing.assert_allclose(
        found, frequency_hz(chirp, t[1:-1])[steep], rtol=(2 * np.pi * 8 * h) ** 2 / 4, atol=2 * h * 2
    )


@pytest.mark.parametrize("chirp", CHIRPS)
def test_chirp_crosses_zero_when_the_integral_of_the_frequency_is_whole(chirp):
    h = 1e-4
    force, t = at_steps(chirp.sample(10.0, h)), grid(10.0, h)
    i = np.flatnonzero(force[1:-1] * force[2:] < 0) + 1
    crossings = t[i] + h * force[i] / (force[i] - force[i + 1])
    for half_cycles, crossing in enumerate(crossings[:20], start=1):
        cycles, _ = scipy.integrate.quad(lambda at: frequency_hz(chirp, at), 0, crossing)
        assert cycles == pytest.approx(half_cycles / 2, abs=1e-6)  # a line instead of the sine over 1e-4 s
    assert len(crossings) > 20


@pytest.mark.parametrize("chirp", CHIRPS[:-1])  # the last is where SciPy's formula cancels
def test_chirp_matches_scipy(chirp):
    expected = 5 * scipy.signal.chirp(grid(10.0), chirp.from_hz, 10.0, chirp.to_hz, chirp.spacing, phi=-90)
    np.testing.assert_allclose(at_steps(chirp.sample(10.0, H)), expected, atol=5 * PHASE_ROUNDING)


def test_chirp_with_nonzero_end_jumps_to_zero():
    start, end = Chirp(5.0, 0.25, 0.25, 1.0).sample(2.0, 0.5)  # a quarter of a cycle
    np.testing.assert_allclose(start, [0, 5 * math.sqrt(0.5), 0, 0], rtol=ROUNDING)
    np.testing.assert_allclose(end, [5 * math.sqrt(0.5), 5, 0, 0], rtol=ROUNDING)


@pytest.mark.parametrize(
    "kind", [Chirp(1.0, 500.0, 1.0, 1.0), Chirp(1.0, 1.0, 500.0, 1.0), Multisine(1.0, (1.0, 500.0), 1.0)]
)
def test_frequency_too_high_for_step_is_refused(kind):
    message = (
        f"{type(kind).__name__}: has 500 Hz; a step of 0.001 s shows only what is below 500 Hz; take a smaller step"
    )
    with pytest.raises(InputError) as caught:
        kind.sample(1.0, H)
    assert str(caught.value) == message
    kind.sample(1.0, H / 2)


# Multisine

MULTISINES = [
    Multisine(4.0, LINES, 10.0),
    Multisine(4.0, LINES, 10.0, seed=1),
    Multisine(4.0, SPREAD, 10.0),
    Multisine(4.0, SPREAD, 10.0, seed=2),
    Multisine(4.0, (0.7,), 10.0, seed=3),
    Multisine(4.0, (0.1, 0.2, 0.3), 10.0),
]


@pytest.mark.parametrize("multisine", MULTISINES)
def test_multisine_has_only_its_lines_with_equal_amplitude(multisine):
    force = multisine.sample(10.0, H).start
    spectrum = np.abs(np.fft.rfft(force)) * 2 / len(force)
    expected = np.zeros(len(spectrum))
    expected[[round(10 * line) for line in multisine.lines_hz]] = multisine.amplitude_n
    np.testing.assert_allclose(spectrum, expected, atol=4 * PHASE_ROUNDING)


@pytest.mark.parametrize("multisine", MULTISINES)
def test_multisine_reaches_and_does_not_exceed_peak(multisine):
    highest = round(10 * multisine.lines_hz[-1])
    force = at_steps(multisine.sample(10.0, 10.0 / (2000 * highest)))
    assert np.abs(force).max() == pytest.approx(4.0, rel=PEAK)
    assert np.abs(force).max() <= 4.0 * (1 + PEAK_FOUND)


@pytest.mark.slow
@given(st.sets(st.integers(1, 60), min_size=1, max_size=12), st.none() | st.integers(0, 2**32))
def test_peak_of_random_lines_is_found(harmonics, seed):
    multisine = Multisine(1.0, tuple(k / 8 for k in sorted(harmonics)), 8.0, seed)
    points = 2000 * max(harmonics)
    force = np.abs(at_steps(multisine.sample(8.0, 8.0 / points)))
    assert 1 - PEAK <= force.max() <= 1 + PEAK_FOUND


def test_multisine_repeats_its_period():
    force = at_steps(Multisine(4.0, LINES, 10.0, seed=1).sample(30.0, H))
    np.testing.assert_allclose(force[10_000:20_001], force[:10_001], atol=4 * PHASE_ROUNDING)
    np.testing.assert_allclose(force[20_000:], force[:10_001], atol=4 * PHASE_ROUNDING)


def crest(multisine: Multisine) -> float:
    """Peak over root mean square."""
    return multisine.force_n / (abs(multisine.amplitude_n) * math.sqrt(len(multisine.lines_hz) / 2))


def test_schroeder_phases_match_formula():
    # phi_i = phi_1 - 2 pi sum over l < i of (i - l) p_l, his equation (10), with equal powers p_l = 1 / N.
    count = len(LINES)
    expected = [-2 * math.pi * sum((i - line) / count for line in range(1, i)) for i in range(1, count + 1)]
    np.testing.assert_allclose(Multisine(1.0, LINES, 10.0).phases_rad, expected, rtol=ROUNDING)
    assert crest(Multisine(1.0, LINES, 10.0)) < 1.75  # his figure for even lines is about 1.7


@pytest.mark.parametrize("lines", [LINES, SPREAD], ids=["even", "spread"])
@pytest.mark.parametrize("seed", range(4))
def test_seeded_phases_have_lower_peak_than_schroeder_and_random(lines, seed):
    seeded = Multisine(1.0, lines, 10.0, seed)
    chance = np.random.default_rng(7).uniform(0, 2 * np.pi, (200, len(lines)))
    t = np.arange(0, 10, 0.005)
    waves = np.array([np.cos(2 * np.pi * np.outer(t, lines) + phases).sum(axis=1) for phases in chance])
    lowest = np.abs(waves).max(axis=1).min() / math.sqrt(len(lines) / 2)
    assert crest(seeded) < min(lowest, crest(Multisine(1.0, lines, 10.0)))


def test_equal_seeds_give_equal_force_and_other_seeds_differ():
    one, again, other = (Multisine(1.0, LINES, 10.0, seed).sample(1.0, H).start for seed in (5, 5, 6))
    np.testing.assert_array_equal(one, again)
    assert np.abs(one - other).max() > 0.1


# Hands off, release, schedule


def test_hands_off_and_release_have_zero_force():
    assert not np.any(HandsOff().sample(1.0, H))
    assert not np.any(Release(-0.2, 0.5).sample(1.0, H))
    assert (Release(-0.2, 0.5).angle_rad, Release(-0.2, 0.5).start_s, Release(1.0).start_s) == (-0.2, 0.5, 0.0)


def test_schedule_of_a_shaker():
    start, end = Schedule((0.002, 0.002, 0.004, 0.004), (0, 1, 1, 0)).sample(0.006, H)
    np.testing.assert_array_equal(start, [0, 0, 1, 1, 0, 0])
    np.testing.assert_array_equal(end, start)


def test_schedule_holds_its_ends_and_ramps_between():
    start, end = Schedule((0.001, 0.003), (10.0, 20.0)).sample(0.005, H)
    np.testing.assert_allclose(start, [10, 10, 15, 20, 20], rtol=ROUNDING)
    np.testing.assert_allclose(end, [10, 15, 20, 20, 20], rtol=ROUNDING)


def test_schedule_jumps_between_ramps():
    start, end = Schedule((-0.002, 0.002, 0.002, 0.004), (-2.0, 2.0, 8.0, 6.0)).sample(0.004, H)
    np.testing.assert_allclose(start, [0, 1, 8, 7], atol=8 * ROUNDING)
    np.testing.assert_allclose(end, [1, 2, 7, 6], atol=8 * ROUNDING)


def test_schedule_of_single_point_is_constant():
    np.testing.assert_array_equal(Schedule((0.0,), (0.1,)).sample(0.01, H), np.full((2, 10), 0.1))
    np.testing.assert_array_equal(Schedule((99.0,), (0.1,)).sample(0.01, H), np.full((2, 10), 0.1))


VALUES = st.floats(-1e6, 1e6)


@given(st.lists(st.floats(-1.0, 2.0), min_size=1, max_size=8, unique=True), st.data())
def test_schedule_without_jumps_matches_numpy_interp(times, data):
    times = sorted(times)
    if np.any(np.diff(times) < 1e-6):  # so near that rounding to the grid shows
        return
    values = data.draw(st.lists(VALUES, min_size=len(times), max_size=len(times)))
    found = at_steps(Schedule(times, values).sample(1.0, 0.01))
    rise = np.abs(np.diff(values)) / np.diff(times) if len(times) > 1 else np.zeros(1)
    tolerance = ON_THE_GRID_S * rise.max(initial=0) + 1e6 * ROUNDING
    np.testing.assert_allclose(found, np.interp(grid(1.0, 0.01), times, values), atol=tolerance)


@given(st.lists(st.tuples(st.integers(0, 50), VALUES, VALUES), min_size=1, max_size=8, unique_by=lambda p: p[0]))
def test_schedule_with_jumps_has_both_values_exactly(points):
    points.sort()
    times = [k * 0.02 for k, *_ in points for _ in range(2)]
    start, end = Schedule(times, [value for _, *both in points for value in both]).sample(1.0, 0.02)
    for k, before, after in points:
        if k < 50:
            assert start[k] == after
        if k > 0:
            assert end[k - 1] == before


# What must be refused when built

BUILT = [
    (lambda: Step(math.nan), "Step: expected force_n to be a finite number, got nan"),
    (
        lambda: Step("3 s"),
        "Step: force_n: expected a number with its unit such as '100 N', got '3 s': 's' measures a time, not a force",
    ),
    (lambda: Step(10**400), "Step: expected force_n to be a finite number, got a huge number"),
    (lambda: Step(True), "Step: expected force_n to be a finite number, got true"),
    (lambda: Step(1.0, -0.1), "Step: expected start_s to be a number of 0 or more, got -0.1"),
    (lambda: Pulse(math.inf, 0.0, 1.0), "Pulse: expected force_n to be a finite number, got inf"),
    (lambda: Pulse(1.0, math.inf, 1.0), "Pulse: expected start_s to be a number of 0 or more, got inf"),
    (lambda: Pulse(1.0, 0.0, 0.0), "Pulse: expected width_s to be a number above 0, got 0.0"),
    (lambda: Doublet(None, 0.0, 1.0), "Doublet: expected force_n to be a finite number, got None"),
    (lambda: Doublet(1.0, -1.0, 1.0), "Doublet: expected start_s to be a number of 0 or more, got -1.0"),
    (lambda: Doublet(1.0, 0.0, -1.0), "Doublet: expected width_s to be a number above 0, got -1.0"),
    (lambda: StopToStop(math.nan, 1.0), "StopToStop: expected force_n to be a finite number, got nan"),
    (lambda: StopToStop(1.0, 0.0), "StopToStop: expected duration_s to be a number above 0, got 0.0"),
    (lambda: Chirp(math.nan, 1.0, 2.0, 1.0), "Chirp: expected force_n to be a finite number, got nan"),
    (lambda: Chirp(1.0, -1.0, 2.0, 1.0), "Chirp: expected from_hz to be a number of 0 or more, got -1.0"),
    (lambda: Chirp(1.0, 1.0, math.inf, 1.0), "Chirp: expected to_hz to be a number of 0 or more, got inf"),
    (lambda: Chirp(1.0, 0.0, 2.0, 1.0, "logarithmic"), "Chirp: expected from_hz to be a number above 0, got 0.0"),
    (lambda: Chirp(1.0, 2.0, 0.0, 1.0, "logarithmic"), "Chirp: expected to_hz to be a number above 0, got 0.0"),
    (lambda: Chirp(1.0, 1.0, 2.0, 0.0), "Chirp: expected duration_s to be a number above 0, got 0.0"),
    (lambda: Chirp(1.0, 1.0, 2.0, 1.0, "log"), "Chirp: expected spacing to be 'linear' or 'logarithmic', got 'log'"),
    (lambda: Release(math.nan), "Release: expected angle_rad to be a finite number, got nan"),
    (lambda: Release(0.1, -1.0), "Release: expected start_s to be a number of 0 or more, got -1.0"),
    (lambda: Multisine(math.nan, (1.0,), 1.0), "Multisine: expected force_n to be a finite number, got nan"),
    (lambda: Multisine(1.0, (1.0,), 0.0), "Multisine: expected duration_s to be a number above 0, got 0.0"),
    (lambda: Multisine(1.0, (), 1.0), "Multisine: expected one line at least in lines_hz, got none"),
    (lambda: Multisine(1.0, 3.0, 1.0), "Multisine: expected lines_hz to be a row of numbers, got 3.0"),
    (lambda: Multisine(1.0, (0.0, 1.0), 1.0), "Multisine: expected lines_hz[0] to be a number above 0, got 0.0"),
    (lambda: Multisine(1.0, (2.0, 1.0), 1.0), "Multisine: expected rising lines_hz, got 2, then 1 Hz"),
    (lambda: Multisine(1.0, (2.0, 2.0), 1.0), "Multisine: expected rising lines_hz, got 2, then 2 Hz"),
    (
        lambda: Multisine(1.0, (0.1, 0.25), 10.0),
        "Multisine: expected lines_hz[1] to be a multiple of 1 / duration_s, so that the force is periodic, got 0.25 Hz; "
        "near are 0.2 Hz and 0.3 Hz",
    ),
    (
        lambda: Multisine(1.0, (0.01,), 10.0),
        "Multisine: expected lines_hz[0] to be a multiple of 1 / duration_s, so that the force is periodic, got 0.01 Hz; "
        "near are 0.1 Hz",
    ),
    (
        lambda: Multisine(1.0, (1000.0,), 1000.0),
        "Multisine: expected at most 100000 cycles of lines_hz[0] in a period, got 1000000",
    ),
    (
        lambda: Multisine(1.0, (1.0,), 1.0, -1),
        "Multisine: expected seed to be a whole number of 0 or more, or None, got -1",
    ),
    (
        lambda: Multisine(1.0, (1.0,), 1.0, 0.5),
        "Multisine: expected seed to be a whole number of 0 or more, or None, got 0.5",
    ),
    (lambda: Schedule((), ()), "Schedule: expected as many values as times, one at least, got 0 times and 0 values"),
    (
        lambda: Schedule((0.0, 1.0), (0.0,), "trim"),
        "trim: expected as many values as times, one at least, got 2 times and 1 values",
    ),
    (lambda: Schedule(0.0, (0.0,)), "Schedule: expected times_s to be a row of numbers, got 0.0"),
    (lambda: Schedule((0.0, math.nan), (0.0, 1.0)), "Schedule: expected times_s[1] to be a finite number, got nan"),
    (lambda: Schedule((0.0, 1.0), ("on", "off")), "Schedule: expected values[0] to be a finite number, got 'on'"),
    (lambda: Schedule((0.0, 2.0, 1.0), (0.0,) * 3), "Schedule: time goes back from 2 s to 1 s; sort it"),
    (lambda: Schedule((1.0,) * 3, (0.0,) * 3), "Schedule: 1 s stands three times; a jump is two points at one time"),
    (
        lambda: Recorded(["a", "b"], [1.0, 2.0]),
        "Recorded: expected time_s to be a row of numbers (could not convert string to float: 'a')",
    ),
    (
        lambda: Recorded([0.0, 1.0], [1.0]),
        "Recorded: expected time_s and force_n to be rows of one length, got shapes (2,) and (1,)",
    ),
    (
        lambda: Recorded([[0.0, 1.0]], [[0.0, 1.0]]),
        "Recorded: expected time_s and force_n to be rows of one length, got shapes (1, 2) and (1, 2)",
    ),
    (
        lambda: Recorded([0.0], [1.0], "bench"),
        "bench: row 1, counted from 1: expected two rows of numbers at least, got 1; record for longer",
    ),
    (
        lambda: Recorded([0.0, 1.0], [1.0, math.inf]),
        "Recorded: row 2, counted from 1: expected finite numbers, got 1 s and inf N; leave the row out if the sample was lost",
    ),
    (
        lambda: Recorded([0.0, 2.0, 1.0], [0.0, 0.0, 0.0]),
        "Recorded: row 3, counted from 1: time runs backwards from 2 s to 1 s; expected rising times; "
        "sort the rows and leave one of each time",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("build", "message"), BUILT, ids=range(len(BUILT)))
def test_invalid_input_raises_at_construction(build, message):
    with pytest.raises(InputError) as caught:
        build()
    assert str(caught.value) == message


# Recorded


@given(
    st.lists(st.floats(1.0, 4.9), min_size=1, max_size=20),
    st.floats(-0.5, 0.0),
    st.data(),
)
def test_recorded_force_matches_numpy_interp_at_any_sampling(steps, first, data):
    times = first + np.cumsum([0.0, *steps]) * 0.1
    force = np.array(data.draw(st.lists(VALUES, min_size=len(times), max_size=len(times))))
    n = int(times[-1] / 0.01)
    if n < 1:
        return
    found = at_steps(Recorded(times, force).sample(n * 0.01, 0.01))
    rise = np.abs(np.diff(force)) / np.diff(times)
    tolerance = ON_THE_GRID_S * rise.max() + 1e6 * ROUNDING
    np.testing.assert_allclose(found, np.interp(np.arange(n + 1) * 0.01, times, force), atol=tolerance)


def test_recorded_force_at_its_own_points_is_exact():
    time, force = grid(5.0), np.random.default_rng(1).normal(size=5001)
    np.testing.assert_array_equal(at_steps(Recorded(time, force).sample(5.0, H)), force)


def test_recorded_data_is_copied_and_read_only():
    time = np.array([0.0, 1.0])
    recorded = Recorded(time, [2, 3], "bench")
    time[0] = 99.0
    assert recorded.time_s.tolist() == [0.0, 1.0]
    assert recorded.force_n.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        recorded.force_n[0] = 1.0


def test_a_run_beyond_the_recording_is_refused():
    recorded = Recorded([0.25, 1.0, 1.5], [1.0, 2.0, 3.0], "bench")
    with pytest.raises(InputError) as caught:
        recorded.sample(1.0, H)
    assert str(caught.value) == (
        "bench: expected a recording of all the run, 0 s to 1 s, got 0.25 s to 1.5 s; take from_zero() or give a file "
        "that covers it"
    )
    shifted = recorded.from_zero()
    assert (shifted.time_s.tolist(), shifted.name) == ([0.0, 0.75, 1.25], "bench")
    assert shifted.sample(1.25, H).end[-1] == 3.0
    with pytest.raises(InputError, match=r"got 0 s to 1\.25 s; simulate a shorter time or give a file that covers it$"):
        shifted.sample(1.251, H)


def test_recording_before_run_start_is_skipped():
    start, _ = Recorded([-1.0, 1.0], [0.0, 2.0]).sample(0.5, 0.25)
    np.testing.assert_allclose(start, [1.0, 1.25], rtol=ROUNDING)


@pytest.mark.parametrize(("step", "good"), [(4.99, True), (5.0, True), (5.01, False)])
def test_a_gap_is_more_than_five_times_the_median_step(step, good):
    times = np.append(np.arange(11), 10 + step) * 0.01 + 1523.7  # 5 steps exactly, but for rounding
    if good:
        Recorded(times, np.zeros(12))
        return
    with pytest.raises(InputError) as caught:
        Recorded(times, np.zeros(12))
    assert str(caught.value) == (
        "Recorded: row 12, counted from 1: a gap of 0.0501 s after 1523.8 s; expected at most 5 times the median step of "
        "0.01 s; cut the recording there"
    )


# CSV


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Where a test writes its file; shared, since each test writes it anew."""
    return tmp_path_factory.mktemp("recorded") / "bench 7.csv"


def read(path: Path, text: str | bytes) -> Recorded:
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_recorded(path)


ROWS = "0,1\n0.5,-2.5\n1.5e0,+.25\n"


@pytest.mark.parametrize(
    ("header", "second", "newton"),
    [
        ("time (s),force (lb)", 1.0, POUND),
        ("time (s),force (lbf)", 1.0, POUND),
        ("time [s], force [N]", 1.0, 1.0),
        ("time_s,force_n", 1.0, 1.0),
        ("time_ms,force_lb", 1e-3, POUND),
        ("Time_S,FORCE_kN", 1.0, 1e3),
        ("time[ms],force(kN)", 1e-3, 1e3),
        (" Time ( s ) , FORCE\t[ N ] ", 1.0, 1.0),
        ('"time (min)","force (kgf)"', 60.0, 9.80665),
        ("time (s),force (kg m/s^2)", 1.0, 1.0),
    ],
)
def test_headers_with_units_are_read(path, header, second, newton):
    recorded = read(path, f"{header}\n{ROWS}")
    np.testing.assert_allclose(recorded.time_s, np.array([0, 0.5, 1.5]) * second, rtol=ROUNDING)
    np.testing.assert_allclose(recorded.force_n, np.array([1, -2.5, 0.25]) * newton, rtol=ROUNDING)
    assert recorded.name == "bench 7"


@pytest.mark.parametrize(
    "text",
    [
        "time_s,force_n\n0,1\n1,2",
        "time_s,force_n\r\n0,1\r\n1,2\r\n",
        "time_s,force_n\r0,1\r1,2\r",
        "\ufefftime_s,force_n\n0,1\n1,2\n",
        "\n\ntime_s,force_n\n\n0,1\n\n1,2\n\n\n",
        "force_n,time_s\n1,0\n2,1\n",
        "position (mm),force_n,time_s,remark,\n7,1,0,start,\nnan,2,1,,\n",
        'time_s,force_n\n"0","1"\n" 1 ", 2 \n',
    ],
)
def test_files_of_other_programs_are_read(path, text):
    recorded = read(path, text)
    assert (recorded.time_s.tolist(), recorded.force_n.tolist()) == ([0.0, 1.0], [1.0, 2.0])


def test_text_path_is_accepted(path):
    read(path, f"time_s,force_n\n{ROWS}")
    assert len(read_recorded(str(path)).time_s) == 3


@given(
    st.lists(st.tuples(st.floats(1.0, 4.9), st.floats(-1e9, 1e9)), min_size=2, max_size=20),
    st.sampled_from([("s", "N", 1.0, 1.0), ("ms", "lb", 1e-3, POUND)]),
)
def test_full_precision_numbers_round_trip(path, points, units):
    second, newton, s, n = units
    times = np.cumsum([step for step, _ in points])
    rows = "".join(f"{t!r},{f!r}\n" for t, f in zip(times.tolist(), (f for _, f in points), strict=True))
    recorded = read(path, f"time ({second}),force ({newton})\n{rows}")
    np.testing.assert_allclose(recorded.time_s, times * s, rtol=ROUNDING)
    np.testing.assert_allclose(recorded.force_n, [f * n for _, f in points], rtol=ROUNDING)


HEADER = "time (s),force (lb)"
EXPECTED_HEADER = f"expected a header such as '{HEADER}'"
RENAME = "rename the column, or name it by the argument columns"
UNIT = "add it to the header or by the argument units"
BAD = {
    "empty": ("", f"line 1: is empty; {EXPECTED_HEADER} and rows of numbers"),
    "blank": ("\n \n\n", f"line 1: is empty; {EXPECTED_HEADER} and rows of numbers"),
    "blank lines": ("\n\n", f"line 1: is empty; {EXPECTED_HEADER} and rows of numbers"),
    "no header": (
        "0,1\n1,2\n",
        f"line 1: has no column 'time'; {EXPECTED_HEADER}, got '0,1'; {RENAME}",
    ),
    "missing column": (
        "time (s),load (lb)\n0,1\n1,2\n",
        f"line 1: has no column 'force'; {EXPECTED_HEADER}, got 'time (s),load (lb)'; {RENAME}",
    ),
    "semicolons": (
        "time (s);force (lb)\n0;1\n1;2\n",
        "line 1: is parted by semicolons; use commas, and points in numbers",
    ),
    "column twice": (
        "time (s),force (lb),force_n\n0,1,1\n1,2,2\n",
        "line 1: has 2 columns 'force', 'force (lb)' and 'force_n'; leave one of them, or name one by the argument columns",
    ),
    "missing unit": (
        "time (s),force\n0,1\n1,2\n",
        f"line 1: force: has no unit; expected one such as N; {UNIT}",
    ),
    "empty unit": (
        "time (),force (lb)\n0,1\n1,2\n",
        f"line 1: time: has no unit; expected one such as s; {UNIT}",
    ),
    "unknown unit": (
        "time (s),force (parsec)\n0,1\n1,2\n",
        "line 1: force: unknown unit 'parsec'; units are m,",
    ),
    "unknown suffix": (
        "time_s,force_pilot\n0,1\n1,2\n",
        f"line 1: has no column 'force'; {EXPECTED_HEADER}, got 'time_s,force_pilot'; {RENAME}",
    ),
    "unit with a percent": (
        "time (s),force (N%)\n0,1\n1,2\n",
        "line 1: force: unknown unit 'N%'; a percent is a unit by itself, of a ratio; expected a unit such as N",
    ),
    "capital letters": ("time (s),force (LB)\n0,1\n1,2\n", "line 1: force: unknown unit 'LB'; units are m,"),
    "unit of digits": (
        "time (s),force (s^9^9^9^9)\n0,1\n1,2\n",  # 9^9^9^9 would be worked out by the units' parser
        "line 1: force: unknown unit 's^9^9^9^9'; write a power as one whole number of one or two digits, such as s^2; "
        "expected a unit such as N",
    ),
    "force in seconds": (
        "time (s),force (s)\n0,1\n1,2\n",
        "line 1: force: 's' measures a time, not a force; expected a unit such as N",
    ),
    "mass": (
        "time (s),force (lbm)\n0,1\n1,2\n",
        "line 1: force: 'lbm' measures a mass, not a force; expected a unit such as N",
    ),
    "torque": (
        "time_s,force (lb in)\n0,1\n1,2\n",
        "line 1: force: 'lb in' measures a torque, not a force; expected a unit such as N",
    ),
    "time in pounds": (
        "time (lb),force (lb)\n0,1\n1,2\n",
        "line 1: time: 'lb' measures a force, not a time; expected a unit such as s",
    ),
    "no rows": (f"{HEADER}\n", "line 1: expected two rows of numbers at least, got 0; record for longer"),
    "one row": (f"{HEADER}\n\n0,1\n", "line 3: expected two rows of numbers at least, got 1; record for longer"),
    "text": (
        f"{HEADER}\n0,1\n1,two\n",
        "line 3: force: expected a number such as '0.25', got 'two'; correct it or leave the row out",
    ),
    "nothing": (
        f"{HEADER}\n0,1\n,2\n",
        "line 3: time: expected a number such as '0.25', got ''; correct it or leave the row out",
    ),
    "underscore": (
        f"{HEADER}\n0,1\n1_0,2\n",
        "line 3: time: expected a number such as '0.25', got '1_0'; correct it or leave the row out",
    ),
    "other digits": (
        f"{HEADER}\n0,1\n١,2\n",
        "line 3: time: expected a number such as '0.25', got '١'; correct it or leave the row out",
    ),
    "value with unit": (
        f"{HEADER}\n0,1\n1,2 lb\n",
        "line 3: force: expected a number such as '0.25', got '2 lb'; correct it or leave the row out",
    ),
    "NaN": (
        f"{HEADER}\n0,1\n1,NaN\n",
        "line 3: force: expected a finite number, got 'NaN'; leave the row out if the sample was lost",
    ),
    "infinite": (
        f"{HEADER}\n0,1\n1,-inf\n",
        "line 3: force: expected a finite number, got '-inf'; leave the row out if the sample was lost",
    ),
    "too large": (
        f"{HEADER}\n0,1\n1,1e999\n",
        "line 3: expected finite numbers, got 1 s and inf N; leave the row out if the sample was lost",
    ),
    "short row": (
        f"{HEADER}\n0,1\n1\n",
        "line 3: expected 2 values as in the header, got 1; write numbers with a decimal point and part them with one comma",
    ),
    "decimal commas": (
        f"{HEADER}\n0,0,1,0\n",
        "line 2: expected 2 values as in the header, got 4; write numbers with a decimal point and part them with one comma",
    ),
    "backwards": (
        f"{HEADER}\n0,1\n2,1\n\n1,2\n",
        "line 5: time runs backwards from 2 s to 1 s; expected rising times; sort the rows and leave one of each time",
    ),
    "repeated": (
        "time (ms),force (lb)\n0,1\n1,1\n1,2\n",
        "line 4: time stands still at 0.001 s; expected rising times; sort the rows and leave one of each time",
    ),
    "gap": (
        f"{HEADER}\n0,1\n1,1\n2,1\n3,1\n8.5,2\n",
        "line 6: a gap of 5.5 s after 3 s; expected at most 5 times the median step of 1 s; cut the recording there",
    ),
    "open quote": (
        f'{HEADER}\n0,1\n1,"2\n',
        f"line 3: is not CSV (unexpected end of data); expected rows as under '{HEADER}'",
    ),
    "not UTF-8": (
        HEADER.encode() + b"\n0,1\n1,2 \xb5\n",
        "line 3: is not UTF-8 text (byte 28); save the file as UTF-8",
    ),
    "UTF-16": (HEADER.encode("utf-16"), "line 1: is not UTF-8 text (byte 0); save the file as UTF-8"),
}


@pytest.mark.parametrize(("text", "message"), BAD.values(), ids=BAD)
def test_bad_file_error_gives_line_number(path, text, message):
    with pytest.raises(InputError) as caught:
        read(path, text)
    found = str(caught.value)
    assert found.startswith(f"{path}: {message}")
    assert "\n" not in found
    if not message.endswith("units are m,"):
        assert found == f"{path}: {message}"


def test_a_file_that_cannot_be_read_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv: cannot be read \(No such file or directory\); expected a table"):
        read_recorded(tmp_path / "none.csv")
    (tmp_path / "run.csv").mkdir()
    with pytest.raises(InputError, match=r"run\.csv: is a folder; expected a table with columns such as 'time \(s\)"):
        read_recorded(tmp_path / "run.csv")
    with pytest.raises(InputError, match=r"cannot be read \(.*embedded null"):
        read_recorded("a\0b.csv")


def is_recorded_or_refused(path: Path, text: str | bytes) -> None:
    """Other errors than an input error pass through and fail the test."""
    try:
        recorded = read(path, text)
    except InputError as error:
        refusal = str(error)
    else:
        assert np.isfinite([recorded.time_s, recorded.force_n]).all()
        return
    assert refusal.startswith(f"{path}: line ")


@given(st.binary(max_size=200))
def test_random_bytes_are_read_or_refused(path, data):
    is_recorded_or_refused(path, data)


@given(st.text(alphabet='0123456789.,eE+-"\n\r \t()[]_smNlbtimeforc\0;'))
def test_random_rows_are_read_or_refused(path, text):
    is_recorded_or_refused(path, text)
    is_recorded_or_refused(path, f"{HEADER}\n{text}")


@given(st.lists(st.tuples(st.floats(), st.floats()), max_size=6))
def test_random_numbers_are_read_or_refused(path, numbers):
    rows = "".join(f"{t!r},{f!r}\n" for t, f in numbers)
    is_recorded_or_refused(path, f"time_s,force_n\n{rows}")
