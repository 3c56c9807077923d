"""Motor, link and column of an electric loader from records of the tests' independent witness; what is refused of a motor."""

import re

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.channels import inputs, outputs
from forcefeel.bench.experiments import Experiment, Loop
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.linear import channel_responses
from forcefeel.bench.identification.unknowns import parameter_keys, unknowns_of
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import electric
from tests import electric_bench as bench

OF_A_VALVE = re.compile(r"\b(valve|piston|oil|hydraulic|servo)\b", re.IGNORECASE)


@pytest.fixture(scope="module")
def yoke():
    return bench.file_of(electric("desktop-yoke"))


@pytest.fixture(scope="module")
def law(yoke):
    return Law.of("robust", yoke)


@pytest.fixture(scope="module")
def truth(yoke):
    return bench.truth_of(yoke, bench.SMOOTH, np.random.default_rng(5))


@pytest.fixture(scope="module")
def under_its_law(yoke, truth, law):
    random = np.random.default_rng(6)
    signal = bench.multisine(0.06, yoke, 2.0, random)
    return bench.record(truth, law, "loader command_current", signal, 2.0, random=random)


@pytest.fixture(scope="module")
def by_current_alone(yoke, truth):
    random = np.random.default_rng(7)
    quick = bench.multisine(0.06, yoke, 2.5, random, bench.LINES_HZ[5:])  # slower ones drift farther than they swing
    return bench.record(truth, None, "motor-open test_current", quick, 2.5, random=random)


@pytest.fixture(scope="module")
def short():
    """The channels of a motor alone, of no machine: what is refused is so before it is fitted."""
    experiment, time = Experiment.read("motor-open test_current"), np.arange(1601) * 5e-4
    names = ("column_angle", "drive_position", "load_cell_force", "motor_current", "motor_angle", "test_current")
    return BenchRecord(
        "bench", experiment, time, {name: 3 * np.sin(40 * time + k) for k, name in enumerate(names)}, "straight"
    )


@pytest.mark.slow
def test_motor_link_and_column_are_within_their_standard_errors(yoke, truth, law, under_its_law, tmp_path):
    channels = ("column_angle", "drive_position", "load_cell_force", "motor_current")
    found = identify(yoke, [bench.measured(under_its_law, *channels)], "K_t,J_m,k,c,J", law=law, starts=1)
    for one in found.estimates:
        assert abs(one.value - truth[one.unknown.key]) < 4 * one.deviation
        assert one.deviation < 0.01 * one.value
    assert max(abs(it.unknown.nominal / truth[it.unknown.key] - 1) for it in found.estimates) > 0.1  # the file is wrong
    assert found.loader is not None
    page = ff.bench.write_identification(found, tmp_path / "out", ff.UnitSystem.SI)
    assert ff.load(page.parent / "loader.toml")["motor.inertia"] == pytest.approx(found["J_m"].value)
    assert not OF_A_VALVE.findall(re.sub(r"<(script|style|details).*?</\1>", "", page.read_text(), flags=re.DOTALL))


@pytest.mark.slow
def test_position_and_current_leave_the_scale_undetermined(yoke, by_current_alone):
    seen = bench.measured(by_current_alone, "motor_angle", "column_angle", "motor_current")
    found = identify(yoke, [seen], "K_t,J_m,k,c,J", starts=1)
    assert found.loader is None
    assert any("only their mutual ratios" in one.sentence for one in found.inseparable)


@pytest.mark.slow
def test_load_cell_determines_the_scale(yoke, truth, by_current_alone):
    seen = bench.measured(by_current_alone, "motor_angle", "column_angle", "load_cell_force")
    found = identify(yoke, [seen], "K_t,J_m,k,c,J", starts=1)
    assert found.determined
    assert all(abs(one.value - truth[one.unknown.key]) < 4 * one.deviation for one in found.estimates)


@pytest.mark.slow
def test_motor_frequency_responses_are_fitted(yoke, truth, law):
    experiment, lines = Experiment.read("loader test_current"), np.geomspace(0.5, 200, 60)
    noise = 0.003 * np.random.default_rng(8).standard_normal((2, 3, 60))
    modeled = channel_responses(truth, Loop.LOADER, (), lines, law)
    data = [
        Response(name, experiment, "test_current", name, lines, value * np.exp(noise[0, k] + 1j * noise[1, k]))
        for k, name in enumerate(("column_angle", "load_cell_force", "motor_angle"))
        for value in [modeled.between("test_current", name, experiment.drive)[0]]
    ]
    found = identify(yoke, data, "K_t,J_m,k,c,J", law=law, starts=1)
    assert all(abs(one.value - truth[one.unknown.key]) < 4 * one.deviation for one in found.estimates)


def test_sampled_motor_sensitivities_match_differences(yoke, law):
    keys, lines = ("motor.torque_constant", "motor.inertia", "column.inertia"), np.geomspace(1, 100, 12)
    slopes = channel_responses(yoke, Loop.LOADER, keys, lines, law).slopes
    for k, key in enumerate(keys):
        step = 1e-5 * yoke[key]
        high, low = (
            channel_responses(yoke.replace({key: yoke[key] + it}, si=True), Loop.LOADER, (), lines, law).value
            for it in (step, -step)
        )
        apart = (high - low) / (2 * step)
        largest = np.abs(apart).max(axis=2, keepdims=True)
        # 1e-5: the differences' rounding, 1e-16 over a step of 1e-5 and what cancels
        assert np.all(np.abs(slopes[k] - apart) <= 1e-5 * largest + 1e-12)


def test_cogging_phase_search_covers_full_circle_in_radians(yoke):
    file = yoke.replace({"motor.cogging_torque": 0.1}, si=True)
    (phase,) = unknowns_of(file, parameter_keys("phi_1", "electric"))
    assert phase.nominal == 0
    assert (phase.scale, phase.low, phase.high) == (1.0, -np.pi, np.pi)


def test_symbols_match_the_drive_of_the_loader():
    assert parameter_keys("i_max", "electric") == ("current_loop.current_limit",)
    assert parameter_keys("i_max", "hydraulic") == ("amplifier.current_limit",)


def changed(found, experiment=None, **channels):
    return BenchRecord(
        "bench", Experiment.read(experiment or str(found.experiment)), found.time_s, {**found.channels, **channels}
    )


def test_data_of_another_bench_raises_input_error(yoke, short):
    zeros = np.zeros_like(short.time_s)
    limit = yoke["current_loop.current_limit"]
    noise = 1e-6 * np.random.default_rng(9).standard_normal(len(zeros))
    cases = {
        "load_pressure is no channel of an electric drive": changed(short, load_pressure=zeros),
        "servo-open test_signal is made for a hydraulic drive": changed(short, "servo-open", test_signal=zeros),
        "motor_current is at current_loop.current_limit": changed(
            short, motor_current=np.clip(20 * short.channels["motor_current"], -limit, limit)
        ),
        "motor_angle moves by no more than its noise": changed(short, motor_angle=noise),
    }
    for message, record in cases.items():
        with pytest.raises(ff.InputError, match=message):
            identify(yoke, [record], "K_t")
    with pytest.raises(ff.InputError, match=r"valve\.current_gain is of a hydraulic drive"):
        identify(yoke, [short], "K_t,valve.current_gain")


def test_motor_record_is_refused_for_a_valve(short):
    with pytest.raises(ff.InputError, match="motor-open test_current is made for an electric drive"):
        identify(ff.elevator(), [short], "k")
    pushed = changed(short, "sweep", pilot_force=np.zeros_like(short.time_s))
    with pytest.raises(ff.InputError, match="is no channel of a hydraulic drive"):
        identify(ff.elevator(), [pushed], "k")


def test_experiments_of_both_drives_cannot_be_mixed():
    with pytest.raises(ff.InputError, match="servo-closed and test_current do not go together"):
        Experiment.read("servo-closed test_current")
    with pytest.raises(ff.InputError, match="a release of the open motor has no rest"):
        Experiment.read("motor-open release")
    assert str(Experiment.read("motor-open")) == "motor-open test_current"
    assert set(inputs("electric")) & set(inputs("hydraulic")) == {"pilot_force"}
    assert "motor_angle" in outputs("electric")


PLAN = ff.bench.ExcitationPlan(time_s=8.0, rate_hz=500.0, to_hz=80.0)


def test_motor_signal_keeps_limits_and_predicts_errors(yoke):
    law = Law.of("observer", yoke)  # the noise of the others' commands takes most of this motor's voltage
    found = ff.bench.excite(yoke, "K_t,J_m,k,c,J", plan=PLAN, law=law)
    assert [use.limit.name for use in found.uses] == ["current", "voltage", "speed", "travel", "force", "drive"]
    assert all(use.share <= 1 for use in found.uses)
    assert not found.vague
    assert not OF_A_VALVE.findall(" ".join((*found.findings(ff.UnitSystem.SI), found.verdict)))
    # Back-EMF alone: n u_max / K_t.
    speed = 1.5 * yoke["current_loop.voltage_limit"] / yoke["motor.torque_constant"]
    assert found.uses[2].limit.value == pytest.approx(0.8 * speed)
    force = yoke["motor.torque_constant"] * yoke["current_loop.current_limit"] / yoke["transmission.travel"]
    assert found.uses[4].limit.value == pytest.approx(0.8 * force)


@pytest.mark.slow
def test_open_loop_motor_stays_within_its_travel(yoke):
    found = ff.bench.excite(yoke, "K_t,J_m,k", "motor-open", PLAN)
    assert found.frequency_hz[0] >= 4
    assert all(use.share <= 1 for use in found.uses)


@pytest.mark.parametrize(
    ("fit", "experiment", "limits", "message"),
    [
        ("K_t", "servo-closed", {}, "made for a hydraulic drive"),
        ("K_t", None, {"voltage": 30.0}, r"at most 20\.7 V"),
        ("K_t", None, {"pressure": 1.0}, "expected current, voltage, speed, travel, force, drive"),
        ("K_t,C_i", None, {}, "valve.current_gain is of a hydraulic drive"),
    ],
)
def test_invalid_motor_plan_raises_input_error(yoke, fit, experiment, limits, message):
    with pytest.raises(ff.InputError, match=message):
        ff.bench.excite(yoke, fit, experiment, ff.bench.ExcitationPlan(time_s=4.0, limits=limits))


def test_motor_without_current_limit_raises_input_error(yoke):
    boundless = yoke.replace(dict.fromkeys(("current_loop.current_limit", "current_loop.voltage_limit")))
    with pytest.raises(ff.InputError, match=r"gives no current_loop\.current_limit; give a current"):
        ff.bench.excite(boundless, "K_t", plan=PLAN)
