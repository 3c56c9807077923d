"""Frequency responses from records: exact on known systems, as wide as theory says with noise."""

import numpy as np
import pytest
import scipy.signal
import scipy.stats

import forcefeel as ff
from forcefeel.bench.estimate import estimate_response
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.periods import Periods, find_periods, settled
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.spectra import independent_averages
from forcefeel.errors import InputError
from tests.parametrization import mostly_slow

CLOSED = Experiment.read("servo-closed")
H = 1e-3  # s
PERIOD = 1000  # samples
LINES_HZ = tuple(np.arange(1.0, 21.0).tolist())
PERIODIC = 1e-9  # relative; a thousand sums of rounded products, on lines of a twentieth of the power
SEED = 11

# Known systems, sampled. The second one's transient is below rounding after a second: exp(-60).
DISCRETE = scipy.signal.dlti([0.02, 0.01], [1.0, -1.8, 0.83], dt=H)
SECOND_ORDER = scipy.signal.lti([100.0**2], [1.0, 2 * 0.6 * 100.0, 100.0**2])


def multisine(periods):
    period = np.sum([np.cos(2 * np.pi * f * np.arange(PERIOD) * H + f**2) for f in LINES_HZ], axis=0)
    return np.tile(period, periods)


def record(drive, output, channel="column_angle", hold="straight", step=H, **others):
    channels = {"test_signal": drive, channel: output, **others}
    return BenchRecord("bench", CLOSED, np.arange(len(drive)) * step, channels, hold, "abc")


def in_delays(system):
    """Numerator and denominator in powers of 1/z."""
    return np.r_[np.zeros(len(system.den) - len(system.num)), system.num], system.den


def sampled_response(system, frequency_hz):
    return scipy.signal.freqz(*in_delays(system), 2 * np.pi * np.asarray(frequency_hz) * H)[1]


def filtered(system, drive):
    return scipy.signal.lfilter(*in_delays(system), drive)


def test_response_to_periodic_drive_is_exact():
    drive = multisine(8)
    found = estimate_response(record(drive, filtered(DISCRETE, drive), "valve_current"), "valve_current")
    assert found.frequency_hz == pytest.approx(LINES_HZ, rel=1e-12)  # rounding
    assert found.value == pytest.approx(sampled_response(DISCRETE, LINES_HZ), rel=PERIODIC)
    assert (found.name, found.input, found.output) == (
        "bench test_signal to valve_current",
        "test_signal",
        "valve_current",
    )
    assert (found.experiment, found.data_hash) == (CLOSED, "abc")
    assert found.coherence == pytest.approx(1, abs=1e-12)  # rounding
    assert np.all((found.deviation > 0) & (found.deviation < 1e-6))  # noise of rounding


@pytest.mark.parametrize("hold", ["straight", "staircase"])
def test_response_matches_the_hold_between_samples(hold):
    method = {"straight": "foh", "staircase": "zoh"}[hold]
    drive = multisine(6)
    num, den, _ = scipy.signal.cont2discrete((SECOND_ORDER.num, SECOND_ORDER.den), H, method)
    found = estimate_response(record(drive, scipy.signal.lfilter(num.ravel(), den, drive), hold=hold), "column_angle")
    exact = scipy.signal.freqresp(SECOND_ORDER, 2 * np.pi * found.frequency_hz)[1]
    # What is above half the sampling rate folds back: images at 1000 - f and beyond, pi f/1000 of the line for a staircase and
    # that squared for straight lines, times the response there over that at f.
    images = 1000.0 + np.array([-1, 1])[:, None] * found.frequency_hz
    folded = np.abs(scipy.signal.freqresp(SECOND_ORDER, 2 * np.pi * images.ravel())[1]).reshape(images.shape)
    order = 2 if hold == "straight" else 1
    bound = (
        2 * np.sum(folded * (found.frequency_hz / images) ** order, axis=0) / np.abs(exact)
    )  # 2: the images after these
    assert np.all(np.abs(found.value / exact - 1) < bound)
    assert np.max(bound) < 1e-3  # the bound asks for something; measured: 3e-5


def test_measured_input_is_taken_as_sampled():
    drive = multisine(8)
    force = filtered(DISCRETE, drive)
    both = record(drive, force, "load_cell_force", hold="staircase", column_angle=-2 * force)
    found = estimate_response(both, "column_angle", input="load_cell_force")
    assert found.value == pytest.approx(np.full(len(LINES_HZ), -2.0), rel=PERIODIC)
    assert found.input == "load_cell_force"


def test_transient_is_omitted():
    slow = scipy.signal.dlti([0.002], [1.0, -0.998], dt=H)  # 0.5 s: exp(-2) of it is left after a period
    drive = multisine(12)
    noise = 1e-4 * np.random.default_rng(SEED).standard_normal(len(drive))
    output = filtered(slow, drive + 1.0) + noise
    exact = sampled_response(slow, LINES_HZ)
    found = estimate_response(record(drive, output, "valve_current"), "valve_current")
    whole = estimate_response(record(drive, output, "valve_current"), "valve_current", segments=12)
    assert np.max(np.abs(found.value / exact - 1) / found.deviation) < 5  # 20 lines within 5 standard deviations
    assert np.max(np.abs(whole.value / exact - 1)) > 5 * np.max(np.abs(found.value / exact - 1))


@pytest.mark.parametrize(
    ("drive", "expected"),
    [
        (multisine(5), Periods(0, PERIOD, 5)),
        (np.r_[np.zeros(700), multisine(5), np.zeros(300)], Periods(700, PERIOD, 5)),
        (np.tile(scipy.signal.chirp(np.arange(1500) * H, 1, 1.5, 40), 4), Periods(0, 1500, 4)),
        (np.tile(np.random.default_rng(SEED).standard_normal(777), 3), Periods(0, 777, 3)),
        (np.tile(np.random.default_rng(SEED).standard_normal(777), 2), Periods(0, 777, 2)),
    ],
    ids=["multisine", "with rests", "chirps", "noise again and again", "twice"],
)
def test_periods_are_detected(drive, expected):
    found = find_periods(drive)
    assert (found.samples, found.count) == (expected.samples, expected.count)
    assert abs(found.begin - expected.begin) <= 1  # the rest may belong to the first period


def test_periods_are_detected_under_ramp_and_noise():
    drive = multisine(7) * np.minimum(np.arange(7 * PERIOD) / 500, 1)
    found = find_periods(drive)
    assert (found.samples, found.count) == (PERIOD, 6)
    assert found.begin >= 400  # the ramp's last part repeats itself to 3 %
    noisy = drive + 0.01 * np.std(drive) * np.random.default_rng(SEED).standard_normal(len(drive))
    assert find_periods(noisy).samples == PERIOD


@pytest.mark.parametrize(
    "drive",
    [
        np.random.default_rng(SEED).standard_normal(5000),
        scipy.signal.chirp(np.arange(20000) * H, 0.5, 20, 20, method="log", phi=-90),
        scipy.signal.chirp(np.arange(60000) * H, 0.5, 60, 2),
        np.r_[np.zeros(100), np.ones(900)],
        multisine(1),
    ],
    ids=["noise", "chirp", "slow chirp", "step", "one period"],
)
def test_aperiodic_signal_has_no_periods(drive):
    assert find_periods(drive) is None


def test_at_least_two_periods_are_kept():
    growing = np.repeat([5.0, 1.0, 0.9, 0.89], 10) + np.tile(np.arange(10.0), 4)
    assert settled(Periods(0, 10, 4), growing).count == 2
    assert settled(Periods(0, 10, 4), np.tile(np.arange(10.0), 4)).count == 4


# Student's t with two degrees of freedom for each average beyond the first: real and imaginary part of the residual.
def within(found, exact, averages):
    """Whether gain and phase of each line lie within their 95 % interval."""
    quantile = scipy.stats.t.ppf(0.975, 2 * (averages - 1))
    off = np.log(found.value / exact)
    return np.abs([off.real, off.imag]) <= quantile * found.deviation


@pytest.mark.parametrize("periods", mostly_slow([2, 4, 20]))
def test_intervals_from_periods_have_stated_coverage(periods):
    rng, held = np.random.default_rng(SEED), []
    drive = multisine(periods)
    exact = sampled_response(DISCRETE, LINES_HZ)
    steady = filtered(DISCRETE, multisine(periods + 2))[2 * PERIOD :]
    for _ in range(150):
        output = steady + 0.05 * rng.standard_normal(len(drive))
        given = record(drive, output, "valve_current")
        found = estimate_response(given, "valve_current", period_s=PERIOD * H, segments=periods)
        held.append(within(found, exact, periods))
    share = np.mean(held)
    spread = np.sqrt(0.95 * 0.05 / np.size(held))  # all 6000 are independent
    assert abs(share - 0.95) < 4 * spread


def test_intervals_from_hann_segments_have_stated_coverage():
    rng, held, averages = np.random.default_rng(SEED), [], None
    for _ in range(60):
        drive = rng.standard_normal(33 * 250)
        output = 0.5 * drive + 0.2 * rng.standard_normal(len(drive))  # no memory, so that nothing leaks
        found = estimate_response(record(drive, output, "valve_current"), "valve_current", segments=32)
        averages = independent_averages(scipy.signal.windows.hann(500, sym=False), 250, 32)
        held.append(within(found, 0.5, averages)[:, ::3])  # Hann's neighbors go together, the third is by itself
    share = np.mean(held)
    spread = np.sqrt(0.95 * 0.05 / np.size(held))
    # 4 standard deviations of the count, and half a percent for a t distribution of averages that are not quite independent.
    assert abs(share - 0.95) < 4 * spread + 0.005


@pytest.mark.slow
def test_coherence_matches_theory():
    rng = np.random.default_rng(SEED)
    drive = rng.standard_normal(600_000)
    output = 2 * drive + 3 * rng.standard_normal(len(drive))
    found = estimate_response(record(drive, output, "valve_current"), "valve_current", segments=4000)
    # gamma^2 = 4 / (4 + 9), biased by (1 - gamma^2)^2 / n upwards (Carter, Knapp and Nuttall 1973): 1e-4.
    assert np.mean(found.coherence) == pytest.approx(4 / 13, abs=2e-3)
    # sqrt((1 - g2) / (2 n g2)), n = 0.947 * 4000
    assert np.median(found.deviation) == pytest.approx(np.sqrt(9 / 4 / (2 * 3790)), rel=0.02)  # gamma^2's own scatter


def test_independent_averages_match_welch():
    hann = scipy.signal.windows.hann(1024, sym=False)
    # The closed form for Hann and half overlap: rho_1 = (1/6)^2.
    assert independent_averages(hann, 512, 8) == pytest.approx(8 / (1 + 2 * (1 - 1 / 8) / 36), rel=1e-9)  # rounding
    assert independent_averages(np.ones(64), 64, 5) == 5
    assert independent_averages(hann, 512, 1) == 1


def test_chirp_response_covers_its_band():
    drive = ff.simulation.Chirp(1.0, 1.0, 30.0, 40.0).sample(48.0, H).start
    num, den, _ = scipy.signal.cont2discrete((SECOND_ORDER.num, SECOND_ORDER.den), H, "foh")
    given = record(drive, scipy.signal.lfilter(num.ravel(), den, drive))
    found = estimate_response(given, "column_angle")
    exact = scipy.signal.freqresp(SECOND_ORDER, 2 * np.pi * found.frequency_hz)[1]
    assert (found.frequency_hz[0] < 2, 28 < found.frequency_hz[-1] < 33) == (True, True)
    off = np.abs(found.value / exact - 1)
    # Leakage: a settling time of 1/60 s in segments of 48 * 2/9 s is 0.0016; three times that away from the chirp's ends, which the
    # outermost segments' weights let through only in part.
    assert np.max(off[(found.frequency_hz > 5) & (found.frequency_hz < 25)]) < 0.005
    assert np.max(off[(found.frequency_hz > 2) & (found.frequency_hz < 28)]) < 0.02
    assert found.coherence.shape == found.frequency_hz.shape


def test_single_average_has_no_deviation():
    drive = np.random.default_rng(SEED).standard_normal(4000)
    found = estimate_response(record(drive, drive, "valve_current"), "valve_current", segments=1)
    assert (found.coherence, found.deviation) == (None, None)
    assert found.value == pytest.approx(np.ones(len(found.value)), rel=PERIODIC)


def release():
    return BenchRecord("bench", Experiment.read("release"), np.arange(200) * H, {"column_angle": np.arange(200.0)})


def uneven():
    given = record(multisine(4), multisine(4))
    time = given.time_s + np.where(np.arange(len(given.time_s)) == 7, 0.02 * H, 0)
    return BenchRecord("bench", CLOSED, time, given.channels)


GIVEN = record(multisine(4), multisine(4))
SINE = record(np.sin(2 * np.pi * 5 * np.arange(4000) * H), np.ones(4000))
BAD = {
    "no channel": (
        GIVEN,
        {"output": "potentiometer"},
        "has no channel potentiometer; it has test_signal, column_angle",
    ),
    "unknown": (GIVEN, {"output": "angle"}, "unknown channel 'angle'"),
    "itself": (GIVEN, {"output": "test_signal"}, "expected two channels, got test_signal twice"),
    "release": (release(), {}, "a release has no drive; fit its record in time"),
    "uneven": (uneven(), {}, r"uneven times, up to \d\.\d% of a step of 0\.001 s early or late; expected 1% at most"),
    "part of a sample": (
        GIVEN,
        {"period_s": 0.9995},
        r"period_s: expected a whole number of steps of 0\.001 s, got 0\.9995 s",
    ),
    "not a period": (GIVEN, {"period_s": 0.9}, r"test_signal does not repeat every 0\.9 s"),
    "infinite": (GIVEN, {"period_s": np.inf}, "period_s: expected a whole number of steps"),
    "none": (GIVEN, {"segments": 0}, "segments: expected a whole number above 0, got 0"),
    "a half": (GIVEN, {"segments": 1.5}, r"segments: expected a whole number above 0, got 1\.5"),
    "too many periods": (GIVEN, {"segments": 9}, "segments: expected 4 at most, as many as there are periods, got 9"),
    "too many": (
        record(np.random.default_rng(1).standard_normal(200), np.arange(200.0)),
        {"segments": 50},
        "50 of 200 samples are too short",
    ),
    "one line": (SINE, {}, "test_signal drives 1 lines; expected at least 3"),
}


@pytest.mark.parametrize(("given", "arguments", "message"), BAD.values(), ids=BAD)
def test_record_without_a_response_raises_input_error(given, arguments, message):
    with pytest.raises(InputError, match=message):
        estimate_response(given, **{"output": "column_angle", **arguments})
