"""Fits to records of an independent simulation: the nonlinear loader by hand, solved to tight tolerance, with other constants."""

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.identification.confidence import confidence_of
from forcefeel.bench.identification.fit import identify, unseen_from_afar
from forcefeel.bench.identification.friction_jumps import surroundings
from forcefeel.bench.identification.problem import Problem
from forcefeel.bench.identification.record_observation import RecordObservation
from forcefeel.bench.identification.record_run import RecordRun
from forcefeel.bench.identification.result import Status
from forcefeel.bench.identification.unknowns import parameter_keys, unknowns_of
from forcefeel.bench.records import BenchRecord
from forcefeel.errors import InputError
from tests import nonlinear_witness, witness
from tests.bench_witness import TRUTH_SI

FRICTION_LB = 1.3
TRUTH = nonlinear_witness.Machine(
    link_stiffness=5230.0,
    link_damping=19.4,
    column_inertia=40.6,
    current_gain=4.87,
    coulomb_friction=FRICTION_LB,
    static_friction=FRICTION_LB,
)
SERVO = replace(TRUTH, gains=(-witness.K3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
"""The position loop closed, the feel computer without effect."""

KEYS = {**TRUTH_SI, "column.coulomb_friction": FRICTION_LB * witness.LBF}

UNITS = {
    "column_angle": ("theta", 1.0),
    "piston_position": ("x_p", witness.INCH),
    "load_pressure": ("p", witness.LBF / witness.INCH**2),
}

NOISY, NOISY_FRICTION = 0.02, 0.05
"""Of a value: what 1 or 2 % of noise leaves of link, column and valve, and of a friction, which tells where the column turns.
Measured: 2e-3, 6e-3."""
NOISY_FEEL = 2e-3
"""The same of a stiffness, which all of a sweep tells. Measured: 2e-4."""
RELEASED = 1e-3
"""What 0.2 % of noise leaves of the link of a release, all else being known. Measured: 8e-5."""
QUIET_FRICTION, QUIET_BREAKAWAY = 2e-3, 0.01
"""What 0.3 % of noise leaves of a friction and of a breakaway force, which tells by single jumps. Measured: 2e-4, 6e-4."""
SPARSE = 0.05
"""Of a value where every third sample is missing."""
SOFTER = 5e-4
"""What 0.2 % of noise leaves of a stiffness alone. Measured: 3e-5."""
STEPS = 1e-3
"""Of a stiffness without noise: what runs leave whose steps are not those of the record. Measured: 9e-5."""
SEARCHED = 1e-7
"""Relative: two searches, each with a precision of 1e-10 of its cost. Measured: 7e-16."""
ROUNDING = 1e-14
"""Relative: a root. Measured: 0."""
ENGINE = 5e-3
"""Of a channel's largest value: 2e-5 of the column's full travel, see docs/how-to/simulate.md, in motions of a fortieth of it."""


@pytest.fixture
def loader():
    """The file: the report's machine and a guess of its friction."""
    loader = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    return loader.replace({"column.coulomb_friction": "2 lb", "column.static_friction": "2 lb"})


def push(t):
    """A force at the grip in lb that goes through many frequencies and both directions, from zero."""
    return 14.0 * math.sin(2 * math.pi * 0.7 * t) + 10.0 * math.sin(2 * math.pi * (2.0 + 2.0 * t) * t)


@cache
def pushed(machine, duration=4.0, rate=500.0):
    time_s = np.arange(round(duration * rate) + 1) / rate
    solver = nonlinear_witness.Solver("LSODA", 1e-9)
    run = nonlinear_witness.simulate(machine, (push, []), duration, time_s, solver=solver)
    return time_s, run, np.array([push(t) for t in time_s]) * witness.LBF


@cache
def let_go(machine, angle=0.07, held=0.25, duration=2.5, rate=1000.0):
    time_s = np.arange(round(duration * rate) + 1) / rate
    initial = nonlinear_witness.release(machine, angle)
    solver = nonlinear_witness.Solver("LSODA", 1e-9)
    return time_s, nonlinear_witness.simulate(machine, (), duration, time_s, initial, solver=solver), angle, held


def record(name, experiment, time_s, run, drive=None, noise=0.0, seed=0):
    random = np.random.default_rng(seed)
    channels = {}
    for channel, (column, scale) in UNITS.items():
        values = run[column] * scale
        channels[channel] = values + noise * values.std() * random.standard_normal(len(values))
    return BenchRecord(name, Experiment.read(experiment), time_s, {**channels, **(drive or {})})


def push_record(noise=0.0, machine=SERVO, experiment="servo-closed pilot_force"):
    time_s, run, force = pushed(machine)
    return record("push", experiment, time_s, run, {"pilot_force": force}, noise, 1)


def release_record(noise=0.0):
    """The grip held for a while, then let go between two samples of the recorder."""
    time_s, run, angle, held = let_go(SERVO)
    before = np.arange(round(held * 1000)) / 1000
    later = 0.0004
    joined = np.concatenate([before, held + later + time_s])
    at_rest = {
        column: np.concatenate([np.full(len(before), run[column][0]), run[column]]) for column, _ in UNITS.values()
    }
    at_rest["theta"][: len(before)] = angle
    return record("release", "servo-closed release", joined, at_rest, noise=noise, seed=2)


def errors(found):
    return {it.unknown.symbol: abs(it.value / KEYS[it.unknown.key] - 1) for it in found.estimates}


def true_loader(loader):
    friction = dict.fromkeys(("column.coulomb_friction", "column.static_friction"), FRICTION_LB * witness.LBF)
    return loader.replace({**TRUTH_SI, **friction}, si=True)


@pytest.mark.slow
def test_runs_match_the_reference(loader):
    """With the true values the simulated channels lie on the witness's, so what is left in a fit is noise."""
    data = push_record()
    run = RecordRun(data, true_loader(loader), None)
    found = run.at(true_loader(loader).si_values, ())
    for name, values in zip(run.channels, found.value, strict=True):
        assert np.abs(values - data.channels[name]).max() < ENGINE * np.abs(data.channels[name]).max()


def test_run_without_sensitivities_matches_run_with_them():
    loader = ff.digital_elevator().replace({"column.coulomb_friction": "1 lb"})
    experiment = Experiment.read("servo-closed")
    time_s = np.arange(1001) / 1000
    channels = {"test_signal": 0.3 * np.sin(5 * time_s), **dict.fromkeys((*UNITS, "load_cell_force"), 0 * time_s)}
    run = RecordRun(BenchRecord("one", experiment, time_s, channels), loader, None)
    sloped, alone = (run.at(loader.si_values, keys).value for keys in (["column.inertia"], ()))
    assert np.ptp(alone, axis=1).min() > 0
    np.testing.assert_allclose(alone, sloped, rtol=1e-12)  # rounding: the same operations, with and without slopes


@pytest.mark.slow
def test_push_record_identifies_link_column_valve_and_friction(loader):
    found = identify(loader, [push_record(noise=0.01)], "k,c,J,C_i,F_c", starts=2)
    assert found.determined
    assert max(error for symbol, error in errors(found).items() if symbol != "F_c") < NOISY
    assert errors(found)["F_c"] < NOISY_FRICTION
    assert found["k"].low < TRUTH_SI["linkage.stiffness"] < found["k"].high


@pytest.mark.slow
def test_release_record_identifies_link_without_release_time(loader):
    held = loader.replace(
        {key: KEYS[key] for key in ("column.inertia", "valve.current_gain", "column.coulomb_friction")}, si=True
    )
    held = held.replace({"column.static_friction": KEYS["column.coulomb_friction"]}, si=True)
    found = identify(held, [release_record(noise=0.002)], "k,c", starts=2)
    assert found.determined
    assert errors(found)["k"] < RELEASED
    assert errors(found)["c"] < RELEASED


@pytest.mark.slow
def test_records_and_responses_are_fitted_together(loader):
    from tests.bench_witness import servo_response  # noqa: PLC0415  only here

    response = servo_response("column_angle", noise=0.01, random=np.random.default_rng(3))
    found = identify(loader, [push_record(noise=0.02), response], "k,c,J,C_i,F_c", starts=1)
    assert found.determined
    assert max(error for symbol, error in errors(found).items() if symbol != "F_c") < NOISY
    assert len(found.fitted) == 4
    assert found.rigid is not None


@pytest.mark.slow
def test_whole_loader_sweep_identifies_feel_and_friction(loader):
    """Under the original law at rest the angle per force is the feel's, and the loop of force over angle the friction's."""
    time_s, run, force = pushed(TRUTH)
    data = record("sweep", "sweep", time_s, run, {"pilot_force": force}, 0.01, 4)
    guessed = {"column.coulomb_friction": "2 lb", "column.static_friction": "2 lb"}
    start = true_loader(loader).replace({"feel.stiffness": "8000 lb in", **guessed}, si=True)
    found = identify(start, [data], "G,F_c", starts=2)
    assert found["G"].value == pytest.approx(ff.elevator()["feel.stiffness"], rel=NOISY_FEEL)
    assert found["F_c"].value == pytest.approx(FRICTION_LB * witness.LBF, rel=NOISY_FRICTION)


@pytest.mark.slow
def test_constant_sensor_offset_is_estimated(loader):
    data = push_record(noise=0.01)
    moved = {**data.channels, "column_angle": data.channels["column_angle"] + 0.01}
    off = replace(data, channels=moved)
    with_offset, without = (identify(loader, [it], "k,c,J,C_i", starts=1) for it in (off, data))
    for one, other in zip(with_offset.estimates, without.estimates, strict=True):
        assert one.value == pytest.approx(other.value, rel=SEARCHED)


@pytest.mark.slow
def test_unevenly_sampled_record_is_compared_at_its_own_times(loader):
    data = push_record(noise=0.01)
    kept = np.arange(len(data.time_s)) % 3 != 1
    sparse = replace(data, time_s=data.time_s[kept], channels={k: v[kept] for k, v in data.channels.items()})
    # Where a sample is missing the force is taken as straight, which it is to some 1 % at 10 Hz. Measured: 5e-3.
    found = identify(loader, [sparse], "k,c,J,C_i,F_c", starts=1)
    assert max(error for symbol, error in errors(found).items() if symbol != "F_c") < SPARSE


def test_unexcited_parameter_is_not_reported(loader):
    time_s, run, force = pushed(SERVO)
    quiet = slice(0, 200)
    data = record(
        "short",
        "servo-closed pilot_force",
        time_s[quiet],
        {k: v[quiet] for k, v in run.items()},
        {"pilot_force": force[quiet]},
        2.0,
    )
    found = identify(loader, [data], "c,w_n", starts=1)
    assert found["w_n"].status is Status.UNDETERMINED
    assert found.loader is None


def slow(t):
    """A force at the grip in lb, up and down once in 8 s."""
    return 16.0 * math.sin(2 * math.pi * t / 8.0)


@cache
def swept():
    """The whole loader under its original law, with a breakaway force above its dry friction: it sticks, then slips."""
    time_s = np.arange(4001) / 500.0
    machine = replace(TRUTH, static_friction=1.9)
    run = nonlinear_witness.simulate(machine, (slow, []), 8.0, time_s, solver=nonlinear_witness.Solver("LSODA", 1e-9))
    return record(
        "slow", "sweep", time_s, run, {"pilot_force": np.array([slow(t) for t in time_s]) * witness.LBF}, 0.003, 6
    )


def test_breakaway_force_is_identified_despite_cost_jumps(loader):
    """From a file that has none: at the dry friction and below it the slopes see nothing of it."""
    start = true_loader(loader).replace({"column.coulomb_friction": "2 lb", "column.static_friction": "2 lb"})
    found = identify(start, [swept()], "F_c,F_s", starts=2)
    assert found.determined
    assert found["F_c"].value == pytest.approx(1.3 * witness.LBF, rel=QUIET_FRICTION)
    assert found["F_s"].value == pytest.approx(1.9 * witness.LBF, rel=QUIET_BREAKAWAY)
    assert found["F_s"].low < 1.9 * witness.LBF < found["F_s"].high


@pytest.mark.parametrize("jag", [0.0, 0.3, 4.0])
def test_cost_jags_widen_standard_errors(jag):
    """A parabola ``(x / s)^2 / 2`` of two unknowns, to whose second a jag is added a standard error away: ``sqrt(1 + 2 jag)``."""
    deviation = np.array([1e-3, 2e-3])

    def cost(x, noise):
        away = np.abs(x / deviation)
        return 0.5 * away @ away + jag * (0.5 < away[1] < 2.0)

    problem = SimpleNamespace(
        unknowns=[0, 1],
        cost=cost,
        costs=lambda places, noise: [cost(x, noise) for x in places],
        bounds=lambda count: (np.full(count, -1.0), np.full(count, 1.0)),
    )
    place = SimpleNamespace(x=np.zeros(2), noise=None)
    independent = SimpleNamespace(
        deviation=deviation, sizes=np.ones(2), covariance=np.diag(deviation**2), inflation=np.ones(2)
    )
    found = surroundings(problem, place, independent)
    np.testing.assert_allclose(found.growth, [1.0, np.sqrt(1 + 2 * jag)], rtol=ROUNDING)
    assert found.drop == 0


def test_smooth_record_keeps_standard_errors(loader):
    start, keys = true_loader(loader), parameter_keys("k,c,J,C_i")
    run = RecordRun(push_record(noise=0.01), start, None)
    problem = Problem(unknowns_of(start, keys), [RecordObservation(run, keys)])
    place = problem.search(problem.start(np.array([start[key] for key in keys])))
    assert np.all(surroundings(problem, place, confidence_of(problem, place)).growth < 1.01)
    many = [place.x + 0.01 * k for k in (1, 2, 3)]  # runs side by side have the numbers of each alone
    assert problem.costs(many, place.noise) == [problem.cost(x, place.noise) for x in many]


def test_distant_start_reveals_unobservable_parameters(loader):
    """A valve without its orifice gives the same flow at every supply pressure."""
    keys = ("linkage.stiffness", "column.inertia", "valve.supply_pressure")
    record_of_push = push_record(noise=0.01)
    assert unseen_from_afar(true_loader(loader), [record_of_push], keys) == ("valve.supply_pressure",)


def test_record_of_another_experiment_gives_no_loader_file(loader):
    data = replace(push_record(noise=0.01), experiment=Experiment.read("loader"))
    found = identify(loader, [data], "k,c", starts=1)
    assert found.loader is None


def test_channel_with_wrong_sign_is_named(loader):
    time_s = np.arange(4001) / 500.0
    signal = 2.0 * np.sin(2 * np.pi * (0.3 + 1.2 * time_s) * time_s) * np.clip(time_s, 0, 1)
    schedule = ff.simulation.Schedule(tuple(time_s.tolist()), tuple(signal.tolist()))
    law = ff.laws.GainLaw.position_loop(loader.si_values)
    scenario = ff.Scenario(test_signal_v=schedule, duration_s=8.0, sample_s=2e-3)
    angle = ff.simulate(loader, scenario, law).history["column_angle_rad"].values
    given = {"test_signal": signal, "column_angle": -angle}
    data = BenchRecord("turned", Experiment.read("servo-closed"), time_s, given)
    with pytest.raises(InputError, match="polarity seems reversed"):
        identify(loader, [data], "k,c", starts=1)


def test_operating_point_gains_are_refused_with_an_orifice(loader):
    with pytest.raises(InputError, match=r"follows the orifice, eq\. \(1\).*fit valve\.rated_flow"):
        identify(loader.replace({"valve.orifice": True}), [push_record()], "k,C_i", starts=1)


def multisine_record(loader, duration_s=6.0, jitter=0.0):
    """A chirp on the closed servo of a machine that is 10 % softer than its file."""
    random = np.random.default_rng(3)
    time_s = np.arange(round(duration_s * 500) + 1) / 500
    if jitter:
        time_s = time_s + np.append(0.0, jitter / 500 * random.uniform(-1, 1, len(time_s) - 1))
    signal = 2.0 * np.sin(2 * np.pi * (0.3 + 1.2 * time_s) * time_s) * np.clip(time_s, 0, 1)
    fine = np.arange(round(duration_s * 1000) + 3) / 1000
    schedule = ff.simulation.Schedule(tuple(time_s.tolist()), tuple(signal.tolist()))
    scenario = ff.Scenario(test_signal_v=schedule, duration_s=float(fine[-1]))
    machine = loader.replace({"linkage.stiffness": 0.9 * loader["linkage.stiffness"]}, si=True)
    run = ff.simulate(machine, scenario, ff.laws.GainLaw.position_loop(loader.si_values))
    angle = CubicSpline(fine, run.history["column_angle_rad"].values)(time_s)
    noisy = angle + 0.002 * angle.std() * random.standard_normal(len(angle))
    return BenchRecord("chirp", Experiment.read("servo-closed"), time_s, {"test_signal": signal, "column_angle": noisy})


@pytest.mark.slow
def test_record_without_frequency_response_is_fitted(loader):
    """Samples at uneven times have none; the link's test is then left out, and said to be."""
    found = identify(loader, [multisine_record(loader, jitter=0.15)], "k", starts=1)
    assert found["k"].value == pytest.approx(0.9 * loader["linkage.stiffness"], rel=SOFTER)
    assert found.rigid is None
    assert "not judged" in found.notes[0]


def test_record_sampled_above_the_controller_rate_is_fitted():
    """Noise at 1 kHz into a controller of 500 Hz: only the lines below 250 Hz can be looked at."""
    loader = ff.digital_elevator().replace(
        {"controller.period": "2 ms", "controller.delay": "0.5 ms", "valve.orifice": False}
    )
    loader = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    random = np.random.default_rng(1)
    time_s = np.arange(3001) / 1000
    signal = random.standard_normal(3001) * np.clip(5 * time_s, 0, 1)
    scenario = ff.Scenario(
        test_signal_v=ff.simulation.Schedule(tuple(time_s.tolist()), tuple(signal.tolist())), duration_s=3.0
    )
    run = ff.simulate(loader, scenario, ff.laws.GainLaw.position_loop(loader.si_values))
    channels = {"test_signal": signal, "column_angle": run.history["column_angle_rad"].values}
    data = BenchRecord("noise", Experiment.read("servo-closed"), time_s, channels)
    found = identify(loader, [data], "k", starts=1)
    assert found["k"].value == pytest.approx(loader["linkage.stiffness"], rel=STEPS)
    with_responses = identify(loader, [data], "k", starts=1, as_responses=True)
    assert with_responses.fitted[0].at.max() < 250


def test_zero_friction_is_identified_as_zero(loader):
    """An estimate near zero is no share of itself: the file's guess is the measure."""
    start = true_loader(loader).replace({"column.viscous_friction": "5 lb in s/rad"})
    found = identify(start, [release_record(noise=0.002)], "B_c,k", starts=1)
    assert found["B_c"].status is not Status.UNDETERMINED
    assert abs(found["B_c"].value) < 0.1 * start["column.viscous_friction"]
