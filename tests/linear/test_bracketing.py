"""Roots between two points: closed forms, and SciPy's Brent as a second route."""

import math

import pytest
from scipy.optimize import brentq

from forcefeel.linear.bracketing import root_between

ERROR = 4e-12
"""Twice the default tolerance, for a second method with its own."""

CASES = [
    (lambda x: x**2 - 2, 1.0, 2.0, math.sqrt(2)),
    (lambda x: math.cos(x) - x, 1.0, 0.0, 0.7390851332151607),  # the Dottie number
    (lambda x: math.atan(50 * (x - 1)), 0.0, 9.0, 1.0),  # flat on both sides
    (lambda x: math.exp(-300 * x) - 0.5, 0.0, 10.0, math.log(2) / 300),
    (lambda x: -1.0 if x < 0.3 else 1.0, 0.0, 1.0, 0.3),  # a jump
    (lambda x: math.inf if x > 4 else x - 3, 0.0, 8.0, 3.0),
    (lambda x: x, -1.0, 1.0, 0.0),
]


@pytest.mark.parametrize(("function", "first", "second", "root"), CASES)
def test_root_is_that_of_the_closed_form_and_of_brent(function, first, second, root):
    assert root_between(function, first, second) == pytest.approx(root, abs=ERROR)
    assert root_between(function, first, second) == pytest.approx(brentq(function, first, second), abs=ERROR)


def test_root_takes_fewer_evaluations_than_bisection():
    count = 0

    def counted(x):
        nonlocal count
        count += 1
        return math.exp(x) - 5

    assert root_between(counted, 0.0, 100.0) == pytest.approx(math.log(5), abs=ERROR)
    assert count < math.log2(100 / 2e-12)
