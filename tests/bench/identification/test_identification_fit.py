"""Fits to frequency responses that an independent model gives: the report's equations by hand, with other constants."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Experiment, Loop
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.linear import LinearModel
from forcefeel.bench.identification.result import Status
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.linear.models import Linkage
from forcefeel.loader.tolerances import Distribution
from tests.bench_witness import FREQUENCY_HZ, TRUTH_SI, servo_response

FIT = "k,c,J,C_i"

LEFT = 0.02
"""Of each value: what 1 % of noise on 60 lines leaves at most. Measured: 5e-3."""
SPREAD = 0.2
"""Relative: 60 lines of two parts tell a noise to 1 / sqrt(240), 6.5 %; three of them. Measured: 0.13."""
OF_A_GAIN = 4 * 0.01 / 60**0.5
"""Relative: four of what 1 % of noise on 60 lines leaves of their common gain. Measured: 1e-3."""
TEN_DIGITS = 1e-9
"""Relative: a loader file has ten significant digits. Measured: 3e-10."""
ROUNDING = 1e-12
"""Relative: some products, and a root and its square. Measured: 3e-16."""
EXACT = 1e-6
"""Relative; the report's SI factors are exact here, so only the search's end and the conditioning of k, c, J together remain."""


@pytest.fixture
def loader():
    """The file: the report's machine, free of tolerances."""
    return ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))


def errors(found):
    return np.array([it.value / TRUTH_SI[it.unknown.key] - 1 for it in found.estimates])


def test_noise_free_data_recover_the_true_values(loader):
    found = identify(loader, [servo_response("column_angle"), servo_response("load_pressure")], FIT)
    assert np.abs(errors(found)).max() < EXACT
    assert found.determined
    assert all(end.same for end in found.ends)


def test_one_percent_noise_gives_at_most_two_percent_error(loader):
    random = np.random.default_rng(11)
    data = [servo_response(it, noise=0.01, random=random) for it in ("column_angle", "load_pressure")]
    found = identify(loader, data, FIT)
    assert np.abs(errors(found)).max() < LEFT
    assert all(it.status is Status.DETERMINED for it in found.estimates)
    for fitted in found.fitted:
        assert fitted.noise == pytest.approx(0.01, rel=SPREAD)


@pytest.mark.slow
def test_confidence_interval_has_nominal_coverage(loader):
    """In 95 of 100; the binomial deviation over 40 repetitions is 3.4 points. ``benchmarks/identification.py`` makes 200."""
    random = np.random.default_rng(2)
    repetitions = 40
    inside = np.zeros(4)
    for _ in range(repetitions):
        data = [servo_response(it, noise=0.01, random=random) for it in ("column_angle", "load_pressure")]
        found = identify(loader, data, FIT, starts=1)
        inside += [it.low <= TRUTH_SI[it.unknown.key] <= it.high for it in found.estimates]
    assert np.all(np.abs(inside / repetitions - 0.95) < 4 * 0.0345)


def test_experiments_are_fitted_together(loader):
    random = np.random.default_rng(4)
    closed = servo_response("column_angle", noise=0.01, random=random)
    opened = servo_response("load_pressure", "servo-open", noise=0.01, random=random)
    alone, both = identify(loader, [closed], FIT), identify(loader, [closed, opened], FIT)
    assert np.abs(errors(both)).max() < LEFT
    for one, together in zip(alone.estimates, both.estimates, strict=True):
        assert together.deviation < one.deviation


def test_parameters_known_only_as_a_product_are_not_reported(loader):
    random = np.random.default_rng(6)
    data = [servo_response(it, noise=0.01, random=random) for it in ("column_angle", "load_pressure")]
    found = identify(loader, data, "k,C_i,K_2,J,c")
    status = {it.unknown.symbol: it.status for it in found.estimates}
    assert {s for s, it in status.items() if it is Status.UNDETERMINED} == {"C_i", "K_2"}
    assert not found.determined
    assert found.loader is None
    (confusion,) = found.inseparable
    assert "only their product" in confusion.sentence
    assert set(confusion.keys) == {"valve.current_gain", "amplifier.admittance"}
    # What would tell them apart is the current between them.
    assert found.advice
    assert all("valve_current" in it.sentence for it in found.advice)
    assert all(share < 0.5 for it in found.advice for share in it.shares.values())


def test_recommended_experiment_determines_the_parameters(loader):
    random = np.random.default_rng(6)
    data = [servo_response(it, noise=0.01, random=random) for it in ("column_angle", "load_pressure")]
    model = LinearModel(loader.replace(TRUTH_SI, si=True), Loop.SERVO_CLOSED).responses(
        loader.replace(TRUTH_SI, si=True).si_values, (), FREQUENCY_HZ
    )
    experiment = Experiment.read("servo-closed")
    current, _ = model.between("test_signal", "valve_current", experiment.drive)
    noisy = current * np.exp(0.01 * (random.standard_normal(60) + 1j * random.standard_normal(60)))
    more = Response("current", experiment, "test_signal", "valve_current", FREQUENCY_HZ, noisy)
    found = identify(loader, [*data, more], "k,C_i,K_2,J,c")
    assert found.determined
    assert found["K_2"].value == pytest.approx(loader["amplifier.admittance"], rel=OF_A_GAIN)


def test_parameter_absent_from_linear_model_is_named(loader):
    loader = loader.replace({"column.coulomb_friction": "2 lb", "column.static_friction": "2 lb"})
    data = [servo_response("column_angle", noise=0.01, random=np.random.default_rng(1))]
    found = identify(loader, data, "C_i,F_c")
    assert found["F_c"].status is Status.UNDETERMINED
    assert "do not see F_c" in found.inseparable[0].sentence
    assert "Record the loader in time" in found.advice[0].sentence


def test_compliant_link_is_required_where_present(loader):
    random = np.random.default_rng(8)
    found = identify(loader, [servo_response("column_angle", noise=0.01, random=random)], FIT)
    assert found.rigid.needed
    assert found.rigid.compliant_rms == pytest.approx(0.01, rel=SPREAD)
    assert found.rigid.rigid_rms > 10 * found.rigid.compliant_rms
    assert found.rigid.bic_difference > 10


@pytest.mark.slow
def test_compliant_link_is_not_required_where_rigid(loader):
    """Responses of eq. (15): no stiffness is then told from a stiffer one, and the test says that none is needed."""
    random = np.random.default_rng(9)
    truth = loader.replace({key: TRUTH_SI[key] for key in ("column.inertia", "valve.current_gain")}, si=True)
    refused = 0
    for _ in range(8):
        model = LinearModel(truth, Loop.SERVO_CLOSED, None, Linkage.RIGID)
        value = model.responses(truth.si_values, (), FREQUENCY_HZ).value[0, 0]
        noisy = value * np.exp(0.01 * (random.standard_normal(60) + 1j * random.standard_normal(60)))
        data = Response("rigid", Experiment.read("servo-closed"), "test_signal", "column_angle", FREQUENCY_HZ, noisy)
        stiff = loader.replace({"linkage.stiffness": "1e6 lb/in"})
        found = identify(stiff, [data], "k,c,J,C_i", starts=1)
        refused += found.rigid.needed
    assert refused == 0  # the test's level is 0.001


def test_new_loader_file_states_standard_errors(loader, tmp_path):
    data = [servo_response(it, noise=0.01, random=np.random.default_rng(3)) for it in ("column_angle", "load_pressure")]
    found = identify(loader, data, FIT)
    for it in found.estimates:
        tolerance = found.loader.tolerances[it.unknown.key]
        assert tolerance.distribution is Distribution.NORMAL
        assert tolerance.deviation == pytest.approx(it.deviation)
        assert found.loader[it.unknown.key] == it.value
    assert "k, c, J, C_i identified from column_angle; load_pressure" in found.loader.source
    (tmp_path / "new.toml").write_text(found.loader.to_toml())
    again = ff.load(tmp_path / "new.toml")
    for it in found.estimates:
        assert again[it.unknown.key] == pytest.approx(it.value, rel=TEN_DIGITS)
        assert again.tolerances[it.unknown.key].deviation == pytest.approx(it.deviation, rel=TEN_DIGITS)
    # What was found is knowledge for the next identification, and the data alone must still determine it.
    second = identify(found.loader, data[:1], FIT)
    assert second["k"].deviation < found["k"].deviation


@pytest.mark.slow
def test_tolerances_bound_the_search(loader):
    tight = loader.with_tolerances({"linkage.stiffness": "5 %"})
    data = [servo_response(it, noise=0.01, random=np.random.default_rng(3)) for it in ("column_angle", "load_pressure")]
    found = identify(tight, data, FIT)
    assert found["k"].status is Status.AT_BOUND
    assert found.loader is None
    assert found["k"].value == pytest.approx(0.95 * loader["linkage.stiffness"])


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["test_signal", "command_signal"])
def test_sampled_model_is_fitted_under_a_digital_controller(drive):
    """The same bench under the 2 kHz controller: a signal on the command has its hold and its delay in it, and the fit knows."""
    loader = ff.digital_elevator()
    loader = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    truth = loader.replace({**TRUTH_SI, "valve.orifice": False}, si=True)
    start = loader.replace({"valve.orifice": False})
    random = np.random.default_rng(5)
    data = []
    for channel in ("column_angle", "load_pressure"):
        experiment = Experiment.read(f"servo-closed {drive}")
        found = LinearModel(truth, experiment.loop).responses(truth.si_values, (), FREQUENCY_HZ)
        value, _ = found.between(drive, channel, experiment.drive)
        noise = 0.01 * (random.standard_normal(60) + 1j * random.standard_normal(60))
        data.append(Response(channel, experiment, drive, channel, FREQUENCY_HZ, value * np.exp(noise)))
    found = identify(start, data, FIT)
    assert np.abs(errors(found)).max() < LEFT
    # Taken for the other place the same data lead astray.
    other = {"test_signal": "command_signal", "command_signal": "test_signal"}[drive]
    taken = [replace(it, experiment=Experiment.read(f"servo-closed {other}"), input=other) for it in data]
    assert np.abs(errors(identify(start, taken, FIT))).max() > 0.05
    assert found.rigid is None
    assert "digital controller" in found.notes[0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"data": []}, "got none"),
        ({"fit": "x"}, "unknown parameter"),
        ({"starts": 0}, "expected 1 to"),
        ({"loss": "square"}, "loss: expected"),
    ],
)
def test_invalid_input_is_named(loader, change, said):
    given = {"data": [servo_response("column_angle")], "fit": FIT, **change}
    data, fit = given.pop("data"), given.pop("fit")
    with pytest.raises(InputError, match=said):
        identify(loader, data, fit, **given)


def test_channel_without_excitation_is_named(loader):
    """The open servo's amplifier has no input but the test signal: a force at the grip brings no current."""
    force = Response(
        "dead",
        Experiment.read("servo-open pilot_force"),
        "pilot_force",
        "valve_current",
        FREQUENCY_HZ,
        np.ones(60) + 0j,
    )
    with pytest.raises(InputError, match="nothing of pilot_force reaches valve_current"):
        identify(loader, [force], "k,c")


def test_too_few_points_for_the_parameters_raises_input_error(loader):
    whole = servo_response("column_angle")
    few = Response("few", whole.experiment, whole.input, whole.output, whole.frequency_hz[::20], whole.value[::20])
    with pytest.raises(InputError, match="expected 8 points at least for 4 parameters, got 6"):
        identify(loader, [few], FIT)


def test_uncertain_lines_do_not_reject_a_correct_fit(loader):
    """Nine lines of poor coherence beside good ones, the number of averages not told."""
    random = np.random.default_rng(12)
    clean = servo_response("column_angle")
    coherence = np.where(np.arange(60) % 7 == 3, 0.5, 0.999)
    sigma = np.sqrt((1 - coherence) / (2 * coherence)) * 0.5
    noisy = clean.value * np.exp(sigma * (random.standard_normal(60) + 1j * random.standard_normal(60)))
    found = identify(loader, [replace(clean, value=noisy, coherence=coherence)], "k,c,J,C_i", starts=2)
    assert found.loader is not None


def test_single_uncertain_line_does_not_hide_a_wrong_model(loader):
    clean = servo_response("column_angle")
    bent = clean.value * 10 ** (0.3 * np.sin(3 * np.log(FREQUENCY_HZ)))
    deviation = np.where(np.arange(60) == 59, 3.0, 0.001)
    found = identify(loader, [replace(clean, value=bent, deviation=deviation)], "k,c,J", starts=1)
    assert found.loader is None


def test_rigid_link_is_rejected_by_the_f_test(loader):
    """Both sums of squares in the same units: those of the noise that the compliant fit finds, so that S_c is n of them."""
    random = np.random.default_rng(8)
    data = [servo_response(it, noise=0.01, random=random) for it in ("column_angle", "load_pressure")]
    rigid = identify(loader, data, FIT, starts=1).rigid
    fewer, left = rigid.degrees
    share = (rigid.rigid_rms / rigid.compliant_rms) ** 2
    assert rigid.f_statistic == pytest.approx((share - 1) / fewer * left, rel=ROUNDING)
