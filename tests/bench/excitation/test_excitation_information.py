"""The information of a signal, by the model differenced in time and by Monte Carlo."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.stats import chi2

import forcefeel as ff
from forcefeel.bench.channels import OUTPUTS
from forcefeel.bench.excitation import ExcitationPlan, NotSeparableError, excite
from forcefeel.bench.excitation.information import line_information, relative_errors
from forcefeel.bench.experiments import Loop
from forcefeel.bench.identification.linear import channel_responses
from forcefeel.simulation.scenario import Scenario

FIT = ("linkage.stiffness", "linkage.damping", "column.inertia", "valve.current_gain")
MEASURED = ("column_angle", "piston_position", "load_pressure")
HISTORY = {
    "column_angle": "column_angle_rad",
    "piston_position": "piston_position_m",
    "load_pressure": "load_pressure_pa",
}
SHORT = ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0)
SIGMAS = 4.0
"""Of a Monte Carlo mean: one chance in 16 000 each."""
STRAIGHT = 0.02
"""Relative: the engine draws the signal straight between samples: at 40 Hz and 500 Hz that is sinc^2, 2 % off at the highest line.
Measured: 4e-3."""
NEIGHBOURHOOD = 0.015
"""Relative: lines of a chirp stand for their neighborhood; what is before and behind the band is left out. Measured: 1.4e-3."""
ENOUGH = 1e-6
"""Relative: the search for the spectrum ends so close to the greatest ln det, whatever the noise is told in. Measured: 0."""
DIFFERENCED = 1e-6
"""Of the trace: central differences with h = 1e-4 leave h^2 / 6 of a third derivative. Measured: 1.4e-7."""


def in_time(loader, found):
    """The measured channels over the samples, (channels, samples), by runs of the loader; nothing of the frequency domain."""
    step = 1 / found.plan.rate_hz
    steps = len(found.time_s) - 1
    drive = ff.simulation.Schedule(tuple(found.time_s), tuple(found.signal))
    run = ff.simulate(
        loader,
        Scenario(test_signal_v=drive, duration_s=steps * step, step_s=step, sample_s=step),
        ff.laws.GainLaw.position_loop(loader.si_values),
    )
    return np.array([run.history[HISTORY[name]].values for name in found.plan.measured])


def differenced(found):
    """theta dy/dtheta of every measured channel by runs of loaders that are 0.1 % off, (parameters, channels, samples)."""
    h = 1e-3  # the error is h^2 / 6 of a third derivative, some 1e-5 of the slope
    slopes = []
    for key in found.fit:
        above, below = (
            in_time(found.loader.replace({key: found.loader[key] * (1 + s)}, si=True), found) for s in (h, -h)
        )
        slopes.append((above - below) / (2 * h))
    return np.array(slopes)


@pytest.fixture(scope="module")
def short():
    return excite(ff.elevator(), FIT, plan=SHORT)


def of_samples(slopes, found):
    """Fisher information of samples with white noise: sum over channels and samples."""
    sigma = np.array([found.noise[name] for name in found.plan.measured])
    weighted = (slopes / sigma[:, None]).reshape(len(slopes), -1)
    return weighted @ weighted.T


@pytest.mark.slow
def test_multisine_information_matches_its_samples(short):
    # Parseval: the sum over the samples of whole periods is that over the lines, once the first period's transient is gone.
    period = round(short.period_s * SHORT.rate_hz)
    periods = int((len(short.time_s) - 0.25 * period) // period)
    steady = differenced(short)[:, :, period : periods * period]
    summed = of_samples(steady, short)
    size = np.sqrt(np.diag(summed))
    np.testing.assert_allclose(short.information / np.outer(size, size), summed / np.outer(size, size), atol=STRAIGHT)
    np.testing.assert_allclose(relative_errors(short.information), relative_errors(summed), rtol=STRAIGHT)


def test_chirp_information_matches_its_samples():
    found = excite(ff.elevator(), FIT, plan=ExcitationPlan("chirp", 13.0, 500.0, to_hz=40.0))
    summed = of_samples(differenced(found), found)
    np.testing.assert_allclose(relative_errors(found.information), relative_errors(summed), rtol=NEIGHBOURHOOD)


def test_line_sensitivities_match_the_servo_of_the_report():
    # The column angle of the closed servo by python-control, differenced: a route without duals and without channels.
    loader, line = ff.elevator(), np.array([0.5, 5.0, 12.0, 30.0])

    def angle(of):
        servo = ff.linear.servo(of, ff.linear.Linkage.COMPLIANT, closed=True)
        return servo(2j * np.pi * line)[1, 0]

    h = 1e-4
    slopes = np.array(
        [
            (
                angle(loader.replace({k: loader[k] * (1 + h)}, si=True))
                - angle(loader.replace({k: loader[k] * (1 - h)}, si=True))
            )
            / (2 * h)
            for k in FIT
        ]
    )
    expected = line_information(slopes[:, None], np.array([0.01]))
    responses = channel_responses(loader, Loop.SERVO_CLOSED, FIT, line)
    theta = np.array([loader[key] for key in FIT])[:, None, None]
    found = line_information(theta * responses.slopes[:, :1, 0], np.array([0.01]))
    for i in range(len(line)):
        np.testing.assert_allclose(found[i], expected[i], rtol=0, atol=DIFFERENCED * np.trace(expected[i]))


@pytest.mark.slow
def test_least_squares_scatter_matches_the_prediction(short):
    # 200 records of the steady periods with white noise; the parameters fitted to their lines by nonlinear least squares.
    runs, rng = 200, np.random.default_rng(41)
    loader, lines = short.loader, short.frequency_hz
    count = (int((len(short.time_s) / SHORT.rate_hz - 0.25 * short.period_s) // short.period_s) - 1) * round(
        short.period_s * SHORT.rate_hz
    )
    bins = np.rint(lines * count / SHORT.rate_hz).astype(int)
    amplitude = np.sqrt(2 * short.power)
    rows = [list(OUTPUTS).index(name) for name in MEASURED]
    sigma = np.array([short.noise[name] for name in MEASURED])
    per_line = sigma[:, None] * np.sqrt(2 / count)  # of the real and of the imaginary part of 2/N sum y exp(-jwt)
    theta = np.array([loader[key] for key in FIT])

    def clean(relative):
        changed = loader.replace(dict(zip(FIT, (theta * (1 + relative)).tolist(), strict=True)), si=True)
        found = channel_responses(changed, Loop.SERVO_CLOSED, FIT, lines)
        return amplitude * found.value[rows, 0] / per_line, theta[:, None, None] * amplitude * found.slopes[
            :, rows, 0
        ] / per_line

    def split(it):
        return np.concatenate([it.real.reshape(*it.shape[:-2], -1), it.imag.reshape(*it.shape[:-2], -1)], axis=-1)

    true = clean(np.zeros(4))[0]
    estimates = []
    for _ in range(runs):
        spectrum = 2 / count * np.fft.rfft(sigma[:, None] * rng.normal(size=(len(MEASURED), count)))[:, bins]
        measured = true + spectrum / per_line
        found = least_squares(
            lambda x, y=measured: split(clean(x)[0] - y),
            np.zeros(4),
            lambda x: split(clean(x)[1]).T,
            method="lm",
            xtol=1e-12,
        )
        estimates.append(found.x)
    estimates = np.array(estimates)
    errors = np.array(list(short.standard_errors.values()))
    np.testing.assert_array_less(np.abs(estimates.mean(axis=0)), SIGMAS * errors / np.sqrt(runs))
    low, high = chi2.ppf([1e-4, 1 - 1e-4], runs - 1) / (runs - 1)
    ratio = estimates.var(axis=0, ddof=1) / errors**2
    assert np.all((low < ratio) & (ratio < high))
    # The whole covariance, correlations and all: the squared distances add up to chi^2.
    distance = np.einsum("ij,jk,ik->", estimates, short.information, estimates)
    assert chi2.ppf(1e-4, 4 * runs) < distance < chi2.ppf(1 - 1e-4, 4 * runs)


@pytest.mark.slow
def test_doubled_noise_doubles_the_error(short):
    noisy = excite(ff.elevator(), FIT, plan=ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0, noise_share=0.02))
    assert noisy.standard_errors == pytest.approx(
        {key: 2 * it for key, it in short.standard_errors.items()}, rel=ENOUGH
    )


@pytest.mark.slow
def test_channel_noise_can_be_specified(short):
    named = ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0, noise=dict(short.noise))
    assert excite(ff.elevator(), FIT, plan=named).standard_errors == pytest.approx(short.standard_errors, rel=ENOUGH)


# What cannot be determined


@pytest.mark.slow
def test_inseparable_parameters_are_named():
    # e -> K_2 e -> C_i K_2 e: neither the column nor the oil knows them apart. The current does.
    fit = ("amplifier.admittance", "valve.current_gain", "column.inertia")
    with pytest.raises(
        NotSeparableError, match=r"cannot tell K_2 \(amplifier.admittance\) and C_i \(valve.current_gain\) apart"
    ):
        excite(ff.elevator(), fit, plan=SHORT)
    apart = ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0, measured=("column_angle", "valve_current"))
    assert not excite(ff.elevator(), fit, plan=apart).vague


@pytest.mark.parametrize("key", ["feel.damping", "load_cell.gain"])
def test_parameters_without_effect_are_named(key):
    with pytest.raises(
        ff.InputError, match=rf"{key}\) changes nothing that is measured in servo-closed test_signal; leave it out"
    ):
        excite(ff.elevator(), ("column.inertia", key), plan=SHORT)


def test_valve_with_orifice_is_identified_by_its_rated_flow():
    with pytest.raises(
        ff.InputError, match=r"follows its orifice, where q_r \(valve.rated_flow\) stands for its gains"
    ):
        excite(ff.digital_elevator(), "C_i,J", plan=SHORT)


@pytest.mark.slow
def test_poorly_determined_parameter_is_reported():
    found = excite(ff.elevator(), FIT, plan=ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0, noise_share=100.0))
    assert set(found.vague) == {key for key, error in found.standard_errors.items() if error >= 0.5 / 1.96}
    assert found.vague
    assert "Not determined" in found.verdict
