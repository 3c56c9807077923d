"""Exponential, balancing, zeros and peaks of the linear models, beside SciPy's, which the package does not need for them."""

import control
import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

import forcefeel as ff
from forcefeel import _core
from forcefeel.linear.frequency import resonance, response, zeros
from forcefeel.linear.models import Linkage, open_loop_model, servo_model
from forcefeel.linear.riccati import stationary_continuous

ROUNDING = 1e-12
DEFECTIVE = 1e-6
"""Relative error of a double zero: the root of rounding, and some."""
SOLVED = 1e-10


@pytest.fixture(scope="module")
def matrices():
    models = (ff.compliant_model(ff.elevator()), ff.compliant_model(ff.loader.electric("sidestick-roll")))
    return [np.asarray(model.A) for model in models]


def test_exponential_is_scipys_and_inverts(matrices):
    for a in matrices:
        like, _ = _core.balanced(a)
        like = like * (1.0 / np.abs(like).sum(axis=0).max())
        np.testing.assert_allclose(_core.exponential(like), scipy.linalg.expm(like), atol=ROUNDING)
        np.testing.assert_allclose(_core.exponential(like) @ _core.exponential(-like), np.eye(len(a)), atol=ROUNDING)


def test_exponential_keeps_the_digits_of_what_is_slow_beside_what_is_fast():
    """Closed form of a slow and a fast pole that drives it, over a thousand steps."""
    slow, fast, step, steps = -2.0, -1e9, 1e-3, 1000
    over_step = _core.exponential(np.array([[slow, 1.0], [0.0, fast]]) * step)
    over_all = np.linalg.matrix_power(over_step, steps)
    np.testing.assert_allclose(over_all[0, 0], np.exp(slow * step * steps), rtol=ROUNDING)
    np.testing.assert_allclose(over_step[0, 1], np.exp(slow * step) / (slow - fast), rtol=ROUNDING)


def test_balancing_is_exact_and_as_small_as_scipys(matrices):
    for a in matrices:
        like, scale = _core.balanced(a)
        assert np.array_equal(np.frexp(scale)[0], np.full(len(a), 0.5))  # powers of two
        assert np.array_equal(like * scale[:, None] / scale, a)
        theirs = scipy.linalg.matrix_balance(a, permute=False)[0]
        assert np.linalg.norm(like) <= 2 * np.linalg.norm(theirs)  # a power of two more or less in a row


def test_matrix_that_is_no_number_is_not_balanced():
    a = np.array([[1.0, np.inf], [0.0, 1.0]])
    like, scale = _core.balanced(a)
    assert np.array_equal(like, a)
    assert np.array_equal(scale, np.ones(2))


def test_zeros_of_closed_forms():
    """(s + 1)(s + 2) / ((s + 3)(s + 4)(s + 5)), and with a feedthrough; a chain of integrators has none."""
    for zero in ([-1.0, -2.0], [-1 + 4j, -1 - 4j], [-1.0, -2.0, -7.0], []):
        system = control.ss(control.zpk(zero, [-3.0, -4.0, -5.0], 2.5))
        np.testing.assert_allclose(
            np.sort_complex(zeros(system)), np.sort_complex(np.array(zero, complex)), atol=ROUNDING * 1e3
        )
    chain = control.ss(np.diag(np.ones(3), 1), np.eye(4)[:, -1:], np.eye(4)[:1], 0)
    assert len(zeros(chain)) == 0


def test_zeros_of_a_loader_are_those_of_the_pencil():
    """The finite eigenvalues of SciPy's QZ are among them, and each one makes the response nothing."""
    for linkage in Linkage:
        for model in (
            servo_model(ff.elevator(), linkage, closed=False).to_output(0),
            open_loop_model(ff.elevator(), linkage),
        ):
            a, scale = _core.balanced(np.asarray(model.A))
            whole = np.block(
                [[a, np.asarray(model.B) / scale[:, None]], [np.asarray(model.C) * scale, np.asarray(model.D)]]
            )
            theirs = scipy.linalg.eigvals(whole, np.diag([*np.ones(len(a)), 0.0]))
            ours = zeros(model)
            largest = 10 * np.abs(np.linalg.eigvals(a)).max()
            theirs = theirs[np.isfinite(theirs) & (np.abs(theirs) < largest)]
            assert len(ours) == len(theirs)
            for zero in ours:
                assert np.abs(theirs - zero).min() <= DEFECTIVE * max(abs(zero), 1.0)


def test_resonance_is_the_greatest_gain_around_it():
    model = servo_model(ff.elevator(), Linkage.COMPLIANT, closed=True).to_output(1)
    peak = resonance(model, 30.0, 200.0)
    best = scipy.optimize.minimize_scalar(
        lambda w: -abs(response(model, np.array([1j * w]))[0]),
        bounds=(30.0, 200.0),
        method="bounded",
        options={"xatol": 1e-9},
    )
    assert peak.gain == pytest.approx(-best.fun, rel=ROUNDING)
    assert peak.frequency_rad_per_s == pytest.approx(best.x, rel=1e-6)  # flat at its top: the root of rounding


def test_continuous_riccati_equation_is_solved():
    """Its residual, then SciPy's solution; a double integrator has the closed form P = [[sqrt 3, 1], [1, sqrt 3]]."""
    a, g = np.array([[0.0, 1.0], [0.0, 0.0]]), np.diag([0.0, 1.0])
    np.testing.assert_allclose(stationary_continuous(a, g, np.eye(2)), [[3**0.5, 1], [1, 3**0.5]], rtol=ROUNDING)
    rng = np.random.default_rng(1974)
    for _ in range(20):
        a, b, c = rng.normal(size=(6, 6)), rng.normal(size=(6, 1)), rng.normal(size=(6, 6))
        q = c @ c.T
        cost = stationary_continuous(a, b @ b.T, q)
        left = a.T @ cost + cost @ a - cost @ b @ b.T @ cost + q
        assert np.abs(left).max() <= SOLVED * np.abs(cost).max() ** 2
        np.testing.assert_allclose(
            cost, scipy.linalg.solve_continuous_are(a, b, q, np.eye(1)), rtol=0, atol=SOLVED * np.abs(cost).max()
        )
