"""The signal itself: within its limits on the nonlinear loader, from rest to rest, periodic, with the lines that it claims."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.excitation import ExcitationPlan, excite
from forcefeel.bench.excitation.limits import limits_of
from forcefeel.bench.excitation.lines import CREST, lines_of
from forcefeel.bench.excitation.plan import FEWEST_PERIODS, spectral_lines, timing
from forcefeel.bench.excitation.rehearsal import NEAR
from forcefeel.bench.excitation.waves import envelope
from forcefeel.bench.experiments import Drive, Experiment
from forcefeel.simulation.scenario import Scenario
from tests.parametrization import mostly_slow

LB = 4.4482216152605
PLAN = ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0)
ROUGH = ff.elevator().replace(
    {
        "valve.orifice": True,
        "amplifier.current_limit": "12 mA",
        "column.coulomb_friction": "3 lb",
        "column.gravity_torque": "50 lb in",
        "column.stop_low": "-9 deg",
        "column.stop_high": "12 deg",
    }
)
LOADERS = {"linear": ff.elevator(), "rough": ROUGH, "digital": ff.digital_elevator()}
FITS = {"linear": "k,c,J,C_i", "rough": "k,c,J,C_i", "digital": "k,c,J,q_r"}
ROUNDING = 1e-12
"""Of a signal of 10 V and lines of 20 V^2: sums of 65 lines, and a transform of a thousand points. Measured: 1e-14."""
SAMPLED = 1e-3
"""Of a peak: the run here ends on another step and has another step, so that it meets a peak between two samples elsewhere."""


def played(found):
    """The run of the loader through the signal, put together here."""
    loader = found.loader
    step = loader["controller.period"] or 1e-3
    steps = int((len(found.time_s) - 1) / found.plan.rate_hz / step)
    scenario = Scenario(duration_s=steps * step, step_s=step, sample_s=step)
    if found.experiment.drive is Drive.PILOT_FORCE:
        scenario = replace(scenario, force=ff.Recorded(found.time_s, found.signal))
    else:
        scenario = replace(scenario, test_signal_v=ff.simulation.Schedule(tuple(found.time_s), tuple(found.signal)))
    law = {
        "servo-open": ff.laws.GainLaw.none(loader.si_values),
        "servo-closed": ff.laws.GainLaw.position_loop(loader.si_values),
        "loader": "original",
    }[str(found.experiment.loop)]
    return ff.simulate(loader, scenario, law)


@pytest.mark.parametrize(
    ("name", "kind", "experiment"),
    mostly_slow(
        [
            ("linear", "multisine", "loader"),
            ("linear", "chirp", "servo-open"),
            ("rough", "multisine", "servo-open"),
            ("rough", "multisine", "servo-closed"),
            ("rough", "chirp", "loader"),
            ("rough", "chirp", "loader test_signal"),
            ("digital", "multisine", "loader test_signal"),
            ("digital", "chirp", "servo-closed"),
        ],
        2,
    ),
)
def test_every_limit_holds_on_the_nonlinear_loader(name, kind, experiment):
    found = excite(LOADERS[name], FITS[name], experiment, replace(PLAN, signal=kind))
    history = played(found).history
    peaks = {
        "current": np.abs(history["valve_current_a"].values).max(),
        "travel": np.abs(history["column_angle_rad"].values).max(),
        "force": np.abs(history["load_cell_force_n"].values).max(),
        "drive": np.abs(found.signal).max(),
    }
    shares = {use.limit.name: peaks[use.limit.name] / use.limit.value for use in found.uses}
    assert all(share <= 1 + SAMPLED for share in shares.values())
    assert max(shares.values()) >= NEAR - SAMPLED
    assert (
        max(shares, key=shares.__getitem__) == found.binding.limit.name
        or found.binding.share - max(shares.values()) < SAMPLED
    )
    assert {use.limit.name: use.share for use in found.uses} == pytest.approx(shares, rel=SAMPLED)


@pytest.mark.slow
def test_limits_default_to_the_loader_and_can_be_tightened():
    linear = {limit.name: limit.value for limit in limits_of(ff.elevator(), Drive.PILOT_FORCE, {})}
    assert linear == pytest.approx(
        {
            "current": 0.8 * 0.015,
            "travel": np.radians(10),
            "force": 2 / 3 * 1200 * 2.36 * LB,
            "drive": 96 * LB,
        }
    )
    rough = {limit.name: limit.value for limit in limits_of(ROUGH, Drive.TEST_SIGNAL, {})}
    assert rough["current"] == pytest.approx(0.8 * 0.012)
    assert rough["travel"] == pytest.approx(0.8 * np.radians(9))
    assert rough["drive"] == 10.0
    for name, value in {"current": 1e-3, "travel": np.radians(1), "force": 100 * LB, "drive": 0.5}.items():
        assert excite(ff.elevator(), "J", plan=replace(PLAN, limits={name: value})).binding.limit.name == name


@pytest.mark.parametrize("kind", ["multisine", "chirp"])
def test_signal_starts_and_ends_smoothly_at_zero(kind):
    found = excite(ff.elevator(), "k,c,J,C_i", plan=replace(PLAN, signal=kind))
    assert found.signal[0] == found.signal[-1] == 0
    at_rest = np.flatnonzero(np.abs(found.signal) > 0.01 * found.peak)
    ramp = 0.25 * found.period_s if kind == "multisine" else 0.05 * PLAN.time_s
    # (1 - cos)/2 is 1 % at 6 % of the ramp.
    assert found.time_s[at_rest[0]] > 0.03 * ramp
    assert found.time_s[-1] - found.time_s[at_rest[-1]] > 0.03 * ramp
    shape = envelope(1000, 200)
    assert np.abs(np.diff(shape)).max() < 1.01 * np.pi / 2 / 200
    assert np.all(shape[200:800] == 1)


@pytest.fixture(scope="module")
def multisine():
    return excite(ff.elevator(), "k,c,J,C_i", plan=PLAN)


@pytest.mark.slow
def test_signal_repeats_whole_periods(multisine):
    period = round(multisine.period_s * PLAN.rate_hz)
    first = multisine.signal[period : 2 * period]
    assert multisine.period_s == 2.0
    for k in range(2, FEWEST_PERIODS):
        np.testing.assert_allclose(multisine.signal[k * period : (k + 1) * period], first, atol=ROUNDING)
    assert FEWEST_PERIODS * period < len(multisine.signal)


def test_period_has_the_stated_lines(multisine):
    period = round(multisine.period_s * PLAN.rate_hz)
    spectrum = 2 * np.abs(np.fft.rfft(multisine.signal[period : 2 * period]) / period) ** 2
    expected = np.zeros(period // 2 + 1)
    expected[np.rint(multisine.frequency_hz * multisine.period_s).astype(int)] = multisine.power
    np.testing.assert_allclose(spectrum, expected, atol=ROUNDING)
    assert multisine.frequency_hz[0] == 0.5
    assert multisine.frequency_hz[-1] == 40.0


def test_every_line_has_its_uniform_share(multisine):
    even = multisine.power.min() / multisine.power.mean()
    # The even spectrum's power within the limits is less than the best one's; a fifth of it is on every line.
    assert 0.05 < even <= 0.2
    assert np.count_nonzero(multisine.power > 1.01 * multisine.power.min()) <= 4 * 5 / 2 + 4


def test_limited_quantities_have_low_crest_factors(multisine):
    period = round(multisine.period_s * PLAN.rate_hz)
    history = played(multisine).history
    steps = round(1 / PLAN.rate_hz / 1e-3)
    for name in ("valve_current_a", "column_angle_rad", "load_cell_force_n"):
        steady = history[name].values[steps * 2 * period : steps * 3 * period]
        assert np.abs(steady).max() / np.sqrt(np.mean(steady**2)) < 1.1 * CREST


@pytest.mark.slow
def test_open_servo_stays_near_its_position_and_returns():
    # It integrates and keeps what the ramp gathers: 20 to 40 % of the peak for a signal that begins anywhere.
    found = excite(ff.elevator(), "k,c,J,C_i", "servo-open", PLAN)
    angle = played(found).history["column_angle_rad"].values
    period = round(found.period_s / 1e-3)
    assert abs(angle[2 * period : 3 * period].mean()) < 0.05 * np.abs(angle).max()
    assert abs(angle[-1]) < 0.01 * np.abs(angle).max()


@pytest.mark.slow
@pytest.mark.parametrize("experiment", mostly_slow(["servo-open", "servo-closed", "loader"]))
def test_signal_is_more_informative_than_uniform_and_random_spectra(experiment):
    loader = ff.elevator()
    asked = Experiment.read(experiment)
    limits = limits_of(loader, asked.drive, {})
    fit = ("linkage.stiffness", "linkage.damping", "column.inertia", "valve.current_gain")
    found = excite(loader, fit, asked, PLAN)
    lines = lines_of(loader, fit, asked, PLAN.of(loader), spectral_lines(PLAN, timing(PLAN), loader), None, limits)
    problem = lines.problem(0.0)
    own = problem.log_det(problem.filled(found.power))
    assert own > problem.log_det(problem.even())
    rng = np.random.default_rng(3)
    for _ in range(200):
        shape = rng.exponential(1.0, len(lines.frequency_hz)) * (rng.uniform(size=len(lines.frequency_hz)) < 0.2)
        if np.count_nonzero(shape) > 3:
            assert own > problem.log_det(problem.filled(shape))
    assert 0.8 <= found.efficiency <= 1  # 1 - s of the even share s: M >= (1 - s) M*
    assert found.even_efficiency < found.efficiency


@pytest.mark.slow
def test_signal_is_reproducible(multisine):
    np.testing.assert_array_equal(excite(ff.elevator(), "k,c,J,C_i", plan=PLAN).signal, multisine.signal)


# Bad input


@pytest.mark.parametrize(
    ("plan", "message"),
    [
        ({"time_s": 0.0}, "expected time_s to be a number above 0, got 0.0"),
        (
            {"time_s": 13.0, "from_hz": 0.1},
            r"expected 6 whole periods of 10 s at least, 62.5 s for a lowest frequency of 0.1 Hz",
        ),
        (
            {"rate_hz": 100.0},
            r"rate: expected 4 samples in a cycle of the highest frequency at least, 160 Hz for 40 Hz, got 100 Hz",
        ),
        ({"from_hz": 39.0}, r"band: expected 8 lines at least, which are 0.5 Hz apart, got 3 from 39 to 40 Hz"),
        ({"time_s": 0.01}, "time: expected time for 6 periods of some samples, got 5 samples in all"),
        ({"time_s": 1e5}, "time: expected at most 5,000,000 samples, got 100000 s at 500 Hz"),
        ({"signal": "noise"}, "signal: expected multisine or chirp, got 'noise'"),
        ({"noise_share": -0.01}, "expected noise_share to be a number above 0, got -0.01"),
        ({"measured": ()}, "measure: expected each channel once, one at least, got none"),
        ({"measured": ("column",)}, "measure: expected channels out of column_angle, .*, got 'column'"),
        ({"noise": {"load_cell": 0.1}}, "noise: load_cell is not measured; measure it too"),
        ({"limits": {"current": -1e-3}}, "limits: expected current to be a number above 0, got -0.001"),
        ({"limits": {"speed": 1.0}}, "limits: expected current, travel, force, drive, got 'speed'"),
        ({"limits": {"force": 1e6}}, r"expected a force of at most 2832 lb \(supply pressure times piston area\)"),
    ],
)
def test_invalid_plan_raises_input_error(plan, message):
    with pytest.raises(ff.InputError, match=message):
        excite(ff.elevator(), "J", plan=replace(PLAN, **plan))


def test_limits_above_those_of_the_loader_raise_input_error():
    for name, value, own in (("current", 0.013, "12 mA"), ("travel", 0.2, "9 deg")):
        with pytest.raises(ff.InputError, match=f"expected a {name} of at most {own}"):
            excite(ROUGH, "J", plan=replace(PLAN, limits={name: value}))


@pytest.mark.parametrize(
    ("fit", "experiment", "message"),
    [
        ("k,zz", "servo-closed", "fit: unknown parameter 'zz'"),
        ("F_c", "servo-closed", "fit: column.coulomb_friction is 0 lb in the loader"),
        ("J", "servo-closed release", "a release is its own excitation"),
        ("J", "bench", "experiment: expected servo-open, servo-closed, motor-open, loader"),
    ],
)
def test_invalid_arguments_raise_input_error(fit, experiment, message):
    with pytest.raises(ff.InputError, match=message):
        excite(ff.elevator(), fit, experiment, PLAN)


@pytest.mark.slow
def test_whole_loader_experiment_takes_a_law():
    law = ff.laws.GainLaw.original(ff.elevator().si_values)
    with pytest.raises(
        ff.InputError, match="law: is the law of the whole loader, and servo-closed test_signal is of the servo"
    ):
        excite(ff.elevator(), "J", "servo-closed", PLAN, law)
    with_law, without = (excite(ff.elevator(), "J", "loader", PLAN, it) for it in (law, None))
    np.testing.assert_allclose(with_law.signal, without.signal, rtol=0, atol=ROUNDING * without.peak)


def test_loader_that_exceeds_its_limits_alone_is_refused():
    heavy = ff.elevator().replace({"column.gravity_torque": "4000 lb in", "column.gravity_angle": "90 deg"})
    with pytest.raises(ff.InputError, match=r"exceeds the force of .* however small the excitation is"):
        excite(heavy, "J", "servo-closed", replace(PLAN, limits={"force": 50 * LB}))


def test_unstable_loop_is_refused():
    # The published low setting of the feel is unstable on the original loop.
    loader = ff.elevator().scale_feel(0.1)
    with pytest.raises(
        ff.InputError, match="loader test_signal runs away however small the excitation is; its loop is unstable"
    ):
        excite(loader, "J", "loader test_signal", PLAN)


def test_slow_controller_limits_the_band():
    slow = ff.digital_elevator().replace({"controller.period": "8 ms", "controller.delay": "0 ms"})
    plan = replace(PLAN, to_hz=None)
    lines = spectral_lines(plan, timing(plan), slow)
    assert lines[-1] == 31.0  # of 125 Hz a quarter, on a grid of half a hertz
    with pytest.raises(ff.InputError, match=r"expected lines below half the controller's rate, 62.5 Hz, got 80 Hz"):
        excite(slow, "J", "servo-closed", replace(PLAN, to_hz=80.0))


@pytest.mark.slow
def test_default_voltage_leaves_the_noise_at_rest_its_room():
    """The law of the yoke takes 16 of 20.7 V for sensor noise alone, in ten seconds 18.6: the peak of a run without a signal."""
    loader = ff.loader.electric("desktop-yoke")
    plan = ff.bench.ExcitationPlan(time_s=4.0, rate_hz=2000.0)
    found = ff.bench.excite(loader, "J_m,k,J", plan=plan)
    voltage = next(use for use in found.uses if use.limit.name == "voltage")
    scenario = ff.Scenario(duration_s=4.0, step_s=0.5e-3, sample_s=0.5e-3)
    rest = float(np.abs(ff.simulate(loader, scenario, "robust").history["motor_voltage_v"]).max())
    bound = loader["current_loop.voltage_limit"]
    assert 0.7 * bound < rest < bound
    assert voltage.limit.noise == pytest.approx(rest, rel=0.02)  # a step more or less of noise
    assert voltage.limit.value == pytest.approx(voltage.limit.noise + 0.8 * (bound - voltage.limit.noise))
    assert rest < voltage.peak <= voltage.limit.value < bound
    stated = ff.bench.ExcitationPlan(time_s=4.0, rate_hz=2000.0, limits={"voltage": 0.95 * rest})
    with pytest.raises(ff.InputError, match="however small the excitation is"):
        ff.bench.excite(loader, "J_m,k,J", plan=stated)
