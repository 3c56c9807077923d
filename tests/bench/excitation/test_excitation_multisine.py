"""Multisines of unequal lines, and phases with low peaks in several signals."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forcefeel import InputError
from forcefeel.bench.excitation.crest_factor import PeakProblem, low_crest_phases
from forcefeel.simulation.inputs import Multisine
from tests.parametrization import mostly_slow

LINES = tuple(k / 8 for k in (1, 2, 3, 5, 8, 13, 21, 34, 55, 60))
WEIGHTS = (1.0, 0.5, 2.0, 0.1, 0.3, 1.0, 3.0, 0.2, 0.7, 1.5)
ROUNDING = 1e-12
"""Of the highest peak, 25 V: sums of ten lines, and a transform of a thousand points. Measured: 5e-15."""
PEAK_FOUND = 1e-10
"""Relative: the search for the peak stops within 1e-4 of a 64th of a cycle or a little more: (1e-4 pi / 64)^2 / 2."""
DIFFERENCED = 1e-6
"""Relative: the third derivative of ln L_p along a unit step is some 1e4 at most, and h^2 of it 1e-6. Measured: 7e-9."""
SEEN = math.cos(math.pi / 2000)  # M. Riesz: what 2000 points a cycle of the highest line show of a peak at least


def period(multisine, points):
    """One period."""
    return multisine.sample(multisine.duration_s, multisine.duration_s / points).start


@pytest.mark.parametrize("seed", [None, 3])
def test_lines_have_the_specified_weights(seed):
    multisine = Multisine(4.0, LINES, 8.0, seed, WEIGHTS)
    spectrum = np.abs(np.fft.rfft(period(multisine, 1000))) * 2 / 1000
    expected = np.zeros(501)
    expected[[round(8 * line) for line in LINES]] = multisine.amplitude_n * np.array(WEIGHTS)
    np.testing.assert_allclose(spectrum, expected, atol=4 * ROUNDING)


@pytest.mark.slow
@given(
    st.dictionaries(st.integers(1, 60), st.floats(0.01, 100.0), min_size=1, max_size=12),
    st.none() | st.integers(0, 2**32),
)
def test_peak_equals_the_force_for_any_weights(lines, seed):
    harmonics = sorted(lines)
    multisine = Multisine(1.0, tuple(k / 8 for k in harmonics), 8.0, seed, tuple(lines[k] for k in harmonics))
    force = np.abs(period(multisine, 2000 * harmonics[-1]))
    assert SEEN <= force.max() <= 1 + PEAK_FOUND


def test_phases_of_unequal_lines_match_schroeder():
    power = np.array(WEIGHTS) ** 2 / np.sum(np.square(WEIGHTS))
    expected = [-2 * math.pi * sum((i - k) * power[k] for k in range(i)) for i in range(len(power))]
    np.testing.assert_allclose(Multisine(1.0, LINES, 8.0, None, WEIGHTS).phases_rad, expected, atol=ROUNDING)


@pytest.mark.parametrize("seed", [None, 3])
def test_equal_weights_match_no_weights(seed):
    even = Multisine(1.0, LINES, 8.0, seed, (2.0,) * len(LINES))
    plain = Multisine(1.0, LINES, 8.0, seed)
    np.testing.assert_allclose(period(even, 1000), period(plain, 1000), atol=ROUNDING)


def test_clipping_reduces_the_peak_of_unequal_lines():
    chance = np.random.default_rng(7).uniform(0, 2 * np.pi, (200, len(LINES)))
    t = np.arange(0, 8, 0.005)
    waves = [np.array(WEIGHTS) @ np.cos(2 * np.pi * np.outer(LINES, t) + phases[:, None]) for phases in chance]
    lowest = min(np.abs(wave).max() for wave in waves)
    for seed in range(4):
        assert 1 / Multisine(1.0, LINES, 8.0, seed, WEIGHTS).amplitude_n < lowest


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ((1.0,), "expected as many weights as lines, got 1 weights for 10 lines"),
        ((1.0,) * 9 + (0.0,), r"expected weights\[9\] to be a number above 0, got 0.0"),
        (3.0, "expected weights to be a row of numbers, got 3.0"),
    ],
)
def test_invalid_weights_raise_input_error(weights, message):
    with pytest.raises(InputError, match=message):
        Multisine(1.0, LINES, 8.0, weights=weights)


# Several signals


def problem(seed):
    """Three signals, as a drive and two low-pass responses of it have them, amplitudes over two decades."""
    rng = np.random.default_rng(seed)
    harmonics = np.unique(np.rint(np.geomspace(1, 120, 40))).astype(np.int64)
    drive = np.exp(rng.normal(0, 1, len(harmonics)))
    first, second = 1 / (1 + 1j * harmonics / 20), 1 / (1 + 0.02j * harmonics - (harmonics / 40) ** 2)
    amplitude = drive * np.array([np.ones(len(harmonics)), first, second])
    return PeakProblem(harmonics, amplitude / np.linalg.norm(amplitude, axis=1, keepdims=True) * math.sqrt(2))


@pytest.mark.parametrize("p", [4, 32])
def test_norm_gradient_matches_differences(p):
    found = problem(1)
    rng = np.random.default_rng(2)
    phases, along = rng.uniform(0, 6, len(found.harmonics)), rng.normal(0, 1, len(found.harmonics))
    _, slope = found.norm(phases, p)
    h = 1e-5
    measured = (found.norm(phases + h * along, p)[0] - found.norm(phases - h * along, p)[0]) / (2 * h)
    assert slope @ along == pytest.approx(measured, rel=DIFFERENCED)


def test_norm_converges_to_the_peak():
    found = problem(1)
    phases = np.linspace(0, 5, len(found.harmonics))
    value, _ = found.norm(phases, 400)
    # L_p lies between the peak times (1 / points)^(1/2p), its share of the mean, and the peak.
    least = found.waves(phases).size ** (-1 / 800)
    assert least * found.peak(phases) <= math.exp(value) <= found.peak(phases) * (1 + PEAK_FOUND)


@pytest.mark.parametrize("seed", mostly_slow(range(3)))
def test_all_signals_have_low_peaks(seed):
    # Each signal has an r.m.s. of 1, so a peak is a crest factor. Random phases have 3 and more, one clipped signal 1.5 to 2.
    found = problem(seed)
    phases = low_crest_phases(found)
    chance = np.random.default_rng(9).uniform(0, 2 * np.pi, (300, len(phases)))
    assert found.peak(phases) < 0.85 * min(map(found.peak, chance))
    np.testing.assert_array_equal(low_crest_phases(found), phases)  # the same again
