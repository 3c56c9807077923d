"""Regulator, observer and feed-forward: residuals of their equations first, then what the gains cost and python-control's."""

import control
import numpy as np
import pytest

from forcefeel import _core
from forcefeel.laws.sampled import OBSERVER, RECOVERED, robust_tuning
from forcefeel.laws.sampled.feedforward import feed_forward, feel_moves
from forcefeel.laws.sampled.observer import REMEMBERED, observe
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.regulator import regulate
from tests.laws.test_designs_plant import PERIOD, sampled

TUNINGS = {"observer": OBSERVER, "recovered": RECOVERED, "robust": robust_tuning(sampled())}
RATIOS = (0.01, 1.0, 80.0)
"""Programmed inertias over the column's, those of 0.5-4 Hz at 1-100 % of G_max."""
RICCATI = 1e-11
"""Share of the largest number that a solution leaves of its equation. Measured: 7e-13."""
SECOND = 1e-8
"""Share of the largest gain by which a second route differs. Measured: 2e-10."""
EXPONENTIAL = 1e-13
"""Relative: two exponentials of one matrix. Measured: 4e-16."""
FOLLOWED_RAD = 1e-9
"""Rounding of a thousand periods."""
REGULATOR_EQUATIONS = 1e-12
"""Share of the largest number that a solution leaves of 24 equations. Measured: 3e-15."""

every_tuning = pytest.mark.parametrize("tuning", TUNINGS.values(), ids=TUNINGS)
every_ratio = pytest.mark.parametrize("ratio", RATIOS)


@pytest.fixture(scope="module", params=[0.0, 0.4, 1.0], ids=["no delay", "fraction", "period"])
def plant(request):
    return SampledPlant.of(sampled(request.param * PERIOD))


def assert_close(found, expected, share):
    np.testing.assert_allclose(found, expected, rtol=0, atol=share * np.abs(expected).max())


def for_ever(a, q):
    """The sum of ``a^k q a'^k``, twice as many terms at each step: the fixed point of ``p = a p a' + q``."""
    for _ in range(40):  # 2^40 periods
        q, a = q + a @ q @ a.T, a @ a
    return q


def weights(tuning, ratio):
    """Q and R of the regulator on [x; e_h], from what the tuning says."""
    q = np.zeros((7, 7))
    q[4, 4] = 1.0
    q[5, 5] = tuning.rate_weight.at(ratio) if tuning.rate_weight else 0.0
    return q, np.array([[tuning.command_weight.at(ratio)]])


def noises(plant, tuning, ratio):
    """Phi, C, W and R of the observer on [x; T_p; d], from what the tuning says."""
    h = plant.periods_per_time
    phi = np.zeros((8, 8))
    both = plant.by_held + plant.by_command
    phi[:6, :6], phi[:6, 6], phi[:6, 7] = plant.phi, plant.by_torque, both
    phi[6, 6], phi[7, 7] = 1.0, REMEMBERED
    w = np.diag(
        [0, 0, tuning.flow_walk.at(ratio), 0, 0, 0, tuning.torque_walk.at(ratio), tuning.disturbance_walk.at(ratio)]
    )
    w = w**2 * h
    w[:6, :6] += tuning.input_noise.at(ratio) ** 2 / h * np.outer(both, both)
    sensors = {1: tuning.pressure_noise, 0: tuning.piston_noise, 4: tuning.angle_noise}
    trusted = {place: noise.at(ratio) ** 2 / h for place, noise in sensors.items() if noise}
    return phi, np.eye(8)[list(trusted)], w, np.diag(list(trusted.values()))


@every_tuning
@every_ratio
def test_regulator_solves_its_riccati_equation(plant, tuning, ratio):
    found = regulate(plant, tuning, ratio)
    a, b, (q, r) = plant.transition, plant.input[:, None], weights(tuning, ratio)
    k, p = found.gains[None], found.cost
    assert_close(a.T @ p @ (a - b @ k) + q, p, RICCATI)
    assert found.riccati_residual < RICCATI
    # What the gains cost when they are kept for ever is what the equation says, and no other gains cost less.
    closed = a - b @ k
    assert np.abs(np.linalg.eigvals(closed)).max() < 1
    cost = for_ever(closed.T, q + k.T @ r @ k)
    assert_close(np.linalg.solve(r + b.T @ cost @ b, b.T @ cost @ a), k, SECOND)
    assert_close(control.dlqr(a, b, q, r)[0], k, SECOND)


@every_tuning
@every_ratio
def test_observer_solves_its_riccati_equation(plant, tuning, ratio):
    found = observe(plant, tuning, ratio)
    a, c, w, r = noises(plant, tuning, ratio)
    trusted = np.flatnonzero(found.gains.any(axis=0))
    assert list(trusted) == ([0, 2] if tuning.piston_noise is None else [0, 1, 2])
    assert not found.gains[8].any()
    gains, p = found.gains[:8][:, trusted], found.covariance
    assert_close(a @ (p - gains @ c @ p) @ a.T + w, p, RICCATI)
    assert found.riccati_residual < RICCATI
    # The covariance that the gains lead to when they are kept for ever has them as its best.
    kept = np.eye(8) - gains @ c
    assert np.abs(np.linalg.eigvals(a @ kept)).max() < 1
    covariance = for_ever(a @ kept, a @ gains @ r @ gains.T @ a.T + w)
    units = np.sqrt(np.diag(p))[:, None] / np.sqrt(np.diag(r))
    best = np.linalg.solve(r + c @ covariance @ c.T, c @ covariance).T
    assert_close(best / units, gains / units, SECOND)
    # python-control's gains are those of the predictor.
    assert_close(control.dlqe(a, np.eye(8), c, w, r)[0] / units, a @ gains / units, SECOND)


def feels():
    """I, B, G: random ones over the envelope and the report's."""
    rng = np.random.default_rng(1974)
    stiffness = 3254 * rng.uniform(0.01, 1.0, 20)
    w = 2 * np.pi * rng.uniform(0.5, 4.0, 20)
    inertia = stiffness / w**2
    rows = np.column_stack([inertia, 2 * rng.uniform(0.1, 1.5, 20) * w * inertia, stiffness])
    return np.vstack([rows, [6.779089741657, 34.347388024395, 1084.65435866512]])


def test_feed_forward_solves_the_regulator_equations(plant):
    found = feed_forward(plant, feels())
    phi, gamma = plant.transition, plant.input[:, None]
    enters = np.zeros((7, 4))
    enters[:6, 2], enters[:6, 3] = plant.by_torque, plant.by_held + plant.by_command
    for pi, command, moves in zip(found.states, found.command, found.moves, strict=True):
        assert_close(phi @ pi + gamma @ command[None] + enters, pi @ moves, REGULATOR_EQUATIONS)
        np.testing.assert_allclose(pi[4], [1, 0, 0, 0], rtol=0, atol=REGULATOR_EQUATIONS)


@pytest.mark.slow
def test_feed_forward_moves_the_column_like_the_feel(plant):
    """Plant and feel run side by side, open loop: the column's angle stays the feel's."""
    rows = feels()
    found = feed_forward(plant, rows)
    for (inertia, damping, stiffness), pi, command in zip(rows, found.states, found.command, strict=True):
        a = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
        b = np.array([[0.0], [plant.scale.torque_n_m / inertia]])
        free, pushed = _core.discretize(a, b, PERIOD)
        feel, torque, disturbance = np.array([0.2, -0.5]), 0.03, 0.1
        state = pi @ [*feel, torque, disturbance]
        for _ in range(1000):
            e = command @ [*feel, torque, disturbance]
            state = plant.transition @ state + plant.input * e
            state[:6] += plant.by_torque * torque + (plant.by_held + plant.by_command) * disturbance
            feel = free @ feel + pushed[:, 0] * torque
            disturbance *= REMEMBERED
        assert abs(state[4] - feel[0]) < FOLLOWED_RAD


def test_feel_step_matches_one_period():
    rows = feels()
    for (inertia, damping, stiffness), moves in zip(rows, feel_moves(rows, PERIOD, 100.0), strict=True):
        a = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
        free, pushed = _core.discretize(a, np.array([[0.0], [100.0 / inertia]]), PERIOD)
        np.testing.assert_allclose(
            moves,
            np.block([[free, pushed], [np.zeros((1, 2)), np.eye(1)]]),
            rtol=EXPONENTIAL,
            atol=1e-15,  # of a zero beside ones
        )
