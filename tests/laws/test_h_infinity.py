"""H-infinity filter of the pilot's torque: its equation, the peak gain over frequency, SLICOT's own least gamma, whole laws."""

from dataclasses import replace

import ctrlsys
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.laws.sampled import OBSERVER, RECOVERED, Power
from forcefeel.laws.sampled.feedforward import feel_moves
from forcefeel.laws.sampled.h_infinity import ABOVE_LEAST, FOUND, H_INFINITY, Filtering, design, filter_torque
from forcefeel.laws.sampled.observer import observe, observed, readings
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.regulator import regulate
from tests.laws.test_designs_gains import RATIOS, RICCATI, assert_close, noises
from tests.laws.test_designs_laws import DOUBLE, FEELS, NOMINAL, POLES, REST, Loop, apart, ideal
from tests.laws.test_designs_plant import PERIOD, sampled

UNTOLD = replace(RECOVERED, piston_noise=None, torque_walk=Power(-1.94, 0.3))
"""Strong noise at the input, the potentiometer left out, another filter for each inertia."""
TUNINGS = {"h-infinity": H_INFINITY, "all sensors": OBSERVER, "two sensors": UNTOLD}
KALMAN = 1e-6
"""Share of the largest number by which the filter of a gamma of a million of the least differs from Kalman's. Measured: 1e-9."""
TORQUE = np.eye(1, 8, 6)
"""M."""

every_tuning = pytest.mark.parametrize("tuning", TUNINGS.values(), ids=TUNINGS)
every_ratio = pytest.mark.parametrize("ratio", RATIOS)


@pytest.fixture(scope="module", params=[0.4, 1.0], ids=["fraction", "period"])
def plant(request):
    return SampledPlant.of(sampled(request.param * PERIOD))


def root(w):
    """A square root of a matrix that may be singular."""
    u, s, _ = np.linalg.svd(w)
    return u * np.sqrt(s)


def peak(plant, tuning, ratio, gains):
    """Largest gain from unit disturbances to the error of the torque's estimate, over frequency, of a filter with these gains."""
    a, c, w, r = noises(plant, tuning, ratio)
    kept = np.eye(8) - gains @ c
    by = np.hstack([root(w), -a @ gains @ np.sqrt(r)])
    angle = np.concatenate([[0.0], np.geomspace(1e-5, np.pi, 600)])
    state = np.linalg.solve(np.exp(1j * angle)[:, None, None] * np.eye(8) - a @ kept, by)
    straight = np.hstack([np.zeros((1, 8)), -TORQUE @ gains @ np.sqrt(r)])
    return np.linalg.norm(TORQUE @ kept @ state + straight, axis=(1, 2)).max()


def trusted(found):
    return found.gains[:8][:, found.gains.any(axis=0)]


@every_tuning
@every_ratio
def test_filter_solves_its_equation(plant, tuning, ratio):
    """In the form without inverses of P: ``P = A (1 + P S)^-1 P A' + W`` with ``S = C' R^-1 C - gamma^-2 M' M``."""
    found = filter_torque(plant, tuning, ratio)
    a, c, w, r = noises(plant, tuning, ratio)
    p = found.matrix
    s = c.T @ np.linalg.inv(r) @ c - TORQUE.T @ TORQUE / found.level**2
    assert_close(a @ np.linalg.solve(np.eye(8) + p @ s, p) @ a.T + w, p, RICCATI)
    assert found.riccati_residual < RICCATI
    assert np.linalg.eigvalsh(p).min() > -1e-12 * np.abs(p).max()  # rounding
    kept = np.linalg.inv(np.linalg.inv(p) + c.T @ np.linalg.inv(r) @ c)
    assert 0 < kept[6, 6] < found.level**2
    # Inverses of P, whose numbers span ten decades; 0.4e-6 to 1.1e-6 by whose linear algebra it is.
    assert_close(kept @ c.T @ np.linalg.inv(r), trusted(found), 5e-6)


@every_tuning
@every_ratio
def test_gain_stays_below_gamma_and_least_gamma_is_minimal(plant, tuning, ratio):
    found = filter_torque(plant, tuning, ratio)
    assert found.level == ABOVE_LEAST * found.least
    gain = peak(plant, tuning, ratio, trusted(found))
    assert found.least / (1 + FOUND) < gain < found.level
    assert peak(plant, tuning, ratio, trusted(observe(plant, tuning, ratio))) > found.least / (1 + FOUND)


def test_kalman_filter_has_a_larger_peak_gain(plant):
    found = filter_torque(plant, H_INFINITY, 1.0)
    kalman = trusted(observe(plant, H_INFINITY, 1.0))
    assert peak(plant, H_INFINITY, 1.0, kalman) > 1.1 * found.level  # measured: 1.14


@every_tuning
def test_least_gamma_matches_slicot(plant, tuning):
    """SB10DD, a general H-infinity solver, finds an estimator a little above it and none below."""
    found = filter_torque(plant, tuning, 1.0)
    a, c, w, r = noises(plant, tuning, 1.0)
    # It wants a plant that its input stabilizes, and an estimate moves nothing: the error of another observer is the plant.
    other = observe(plant, replace(OBSERVER, piston_noise=tuning.piston_noise), 1.0)
    unit, gains, sensor = np.sqrt(np.diag(found.matrix)), a @ trusted(other), np.sqrt(r)
    sensors, n = len(r), 8
    b = np.hstack([root(w), -gains @ sensor, np.zeros((n, 1))]) / unit[:, None]
    of = np.vstack([TORQUE / found.least, np.linalg.inv(sensor) @ c]) * unit
    d = np.zeros((1 + sensors, n + sensors + 1))
    d[0, -1], d[1:, n:-1] = -1.0, np.eye(sensors)
    matrices = [np.asfortranarray(m) for m in ((a - gains @ c) * unit / unit[:, None], b, of, d)]

    def outcome(gamma):
        return ctrlsys.sb10dd(n, b.shape[1], len(of), 1, sensors, gamma, *matrices, tol=1e-15)[-1]

    assert outcome(1 + FOUND) == 0
    assert outcome(1 - 2 * FOUND) != 0


@every_tuning
@every_ratio
def test_infinite_gamma_gives_the_kalman_filter(plant, tuning, ratio):
    made_for, kalman = Filtering.of(plant, tuning, ratio), observe(plant, tuning, ratio)
    for level in (np.inf, 1e6 * made_for.least()):
        found = made_for.matrix(level)
        assert_close(found, kalman.covariance, KALMAN)
        assert_close(made_for.gains(found), trusted(kalman), KALMAN)


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0])
def test_poles_are_those_of_regulator_filter_and_feel(delay):
    loader = sampled(delay * PERIOD)
    laws, plant = design(loader, FEELS), SampledPlant.of(loader)
    for k, feel in enumerate(FEELS):
        ratio = feel[0] / loader["column.inertia"]
        error = observed(plant) @ (np.eye(9) - filter_torque(plant, H_INFINITY, ratio).gains @ readings(plant))
        apart_each = (
            plant.transition - np.outer(plant.input, regulate(plant, H_INFINITY, ratio).gains),
            error[:8, :8],
            feel_moves(feel[None], PERIOD, 1.0)[0, :2, :2],
        )
        expected = np.concatenate([np.linalg.eigvals(matrix) for matrix in apart_each])
        poles = Loop(loader, laws.some(k), feel).poles()
        assert np.abs(poles).max() < 1
        assert apart(poles, np.append(expected, 0.0)) < DOUBLE
        assert apart(poles[np.abs(poles) > 1e-3], expected[np.abs(expected) > 1e-3]) < POLES


def test_release_matches_the_feel():
    loader = sampled()
    loop = Loop(loader, design(loader, [NOMINAL]), NOMINAL)
    start = loop.at_rest(loop.by_torque)
    start *= 0.1 / (loop.y[2] @ start)
    error = np.abs(loop.angles(start, 4000) - ideal(NOMINAL, 0.1, 4000)).max()
    assert error < 0.05 * 0.1  # what passing the torque on takes


def test_held_column_is_at_the_feel_position():
    loader = sampled()
    laws = design(loader, FEELS)
    for k, feel in enumerate(FEELS):
        loop = Loop(loader, laws.some(k), feel)
        rest = loop.at_rest(loop.by_torque * 50.0)
        force, _, angle = loop.y @ rest
        heard = -loader["linkage.ratio"] * loader["column.base_arm"] * force
        assert (loop.torque @ rest, heard, angle) == pytest.approx((50.0, 50.0, 50.0 / feel[2]), rel=REST)


@pytest.mark.parametrize("share", [0.8, 1.2])
@pytest.mark.parametrize("key", ["linkage.stiffness", "valve.current_gain", "actuator.area"])
def test_law_is_stable_where_a_trusted_potentiometer_is_unstable(key, share):
    loader = sampled()
    other = loader.replace({key: share * loader[key]}, si=True)

    def stable(tuning):
        laws = design(loader, FEELS, tuning)
        return [np.abs(Loop(other, laws.some(k), feel).poles()).max() < 1 for k, feel in enumerate(FEELS)]

    assert all(stable(H_INFINITY))
    if key == "linkage.stiffness":
        assert not any(stable(RECOVERED))


def test_engine_follows_the_ideal_on_the_digital_elevator():
    """Orifice, limits and noise of the sensors included."""
    loader = ff.digital_elevator()
    own = np.array([[loader["feel.inertia"], loader["feel.damping"], loader["feel.stiffness"]]])
    run = ff.simulate(loader, ff.Scenario(ff.Release(0.1), 2.0), design(loader, own))
    angle = run.history.column_angle_rad
    expected = np.interp(angle.time_s.values, np.arange(4001) * PERIOD, ideal(own[0], 0.1, 4001))
    assert np.abs(angle.values - expected).max() < 0.05 * 0.1  # what passing the torque on takes; measured: 0.005 * 0.1


def test_law_of_a_setting_does_not_depend_on_the_batch():
    loader = sampled()
    for tuning in (H_INFINITY, UNTOLD):  # one filter for all, and one for each inertia
        together = design(loader, FEELS, tuning).rows()
        for k, feel in enumerate(FEELS):
            assert_close(design(loader, [feel], tuning).rows()[0], together[k], 1e-12)


def test_infeasible_tuning_raises_input_error():
    with pytest.raises(InputError, match="tuning: no law in double precision"):
        design(sampled(), FEELS, replace(H_INFINITY, torque_walk=Power(15.0)))


def test_analog_loader_is_refused():
    with pytest.raises(InputError, match=r"controller\.period: .* for example 0\.5 ms"):
        design(ff.elevator(), FEELS)
