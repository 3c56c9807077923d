"""The stationary Riccati equation by doubling: against the equation solved in extended precision, by code of its own."""

import numpy as np
import pytest

from forcefeel import _core
from forcefeel.laws.sampled import observer, regulator
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.linear import riccati
from forcefeel.loader.built_in import BUILT_IN

EXTENDED = np.longdouble
GAINS = 1e-9
"""Of the largest gain. Measured: 2.3e-10 at most; SciPy's are off by up to 3.2e-7."""
LAWS = ("observer", "recovered", "robust", "agile")

pytestmark = pytest.mark.skipif(np.finfo(EXTENDED).eps > 1e-18, reason="this machine has no extended precision")


def solved(a, b):
    """``a^-1 b`` by Gaussian elimination in extended precision."""
    a, b = a.astype(EXTENDED), b.astype(EXTENDED)
    for k in range(len(a)):
        pivot = k + int(np.argmax(np.abs(a[k:, k])))
        a[[k, pivot]], b[[k, pivot]] = a[[pivot, k]], b[[pivot, k]]
        share = a[k + 1 :, k] / a[k, k]
        a[k + 1 :] -= np.outer(share, a[k])
        b[k + 1 :] -= np.outer(share, b[k])
    for k in reversed(range(len(a))):
        b[k] = (b[k] - a[k, k + 1 :] @ b[k + 1 :]) / a[k, k]
    return b


def gains(a, b, r, p):
    return solved(r + b.T @ p @ b, b.T @ p @ a)


def witness(a, b, q, r):
    """P in extended precision: recursion (22) by Newton's steps, each a Lyapunov equation by doubling."""
    a, b, p = a.astype(EXTENDED), b.astype(EXTENDED), riccati.stationary(a, b, q, r)[0].astype(EXTENDED)
    for _ in range(4):
        k = gains(a, b, r, p)
        closed, p = a - b @ k, q + k.T @ r @ k
        for _ in range(40):
            p, closed = p + closed.T @ p @ closed, closed @ closed
            if np.abs(closed).max() < 1e-30:
                break
    return p


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", ["elevator-2khz", "elevator-electric", "desktop-yoke", "rudder-pedals"])
def test_gains_are_those_of_extended_precision(name, law, monkeypatch):
    checked = []

    def compared(a, b, q, r):
        result = riccati.stationary(a, b, q, r)
        exact = gains(a, b, r, witness(a, b, q, r))
        assert np.abs(gains(a, b, r, result[0].astype(EXTENDED)) - exact).max() < GAINS * np.abs(exact).max()
        checked.append(len(a))
        return result

    monkeypatch.setattr(observer, "stationary", compared)
    monkeypatch.setattr(regulator, "stationary", compared)
    loader = BUILT_IN[name]()
    stiffness = loader["feel.maximum_stiffness"] * np.array([0.02, 0.2, 1.0])
    frequency = 2 * np.pi * np.array([0.5, 1.4, 4.0])
    feel = [[g / w**2, 2 * 0.7 * g / w, g] for g in stiffness for w in frequency]
    LAW_DESIGNS[law].design(loader, np.array(feel))
    assert len(set(checked)) == 2, "regulators and observers"


@pytest.mark.parametrize(
    ("a", "q"), [([[1.0, 0.0], [0.0, 0.5]], [[0.0, 0.0], [0.0, 1.0]]), ([[2.0, 0.0], [0.0, 0.5]], np.eye(2))]
)
def test_state_that_does_not_decay_has_no_solution(a, q):
    a, b, q, r = np.array(a), np.array([[0.0], [1.0]]), np.array(q), np.eye(1)
    assert _core.stationary(a, b, q, r) is None
    with pytest.raises(np.linalg.LinAlgError):
        riccati.stationary(a, b, q, r)
