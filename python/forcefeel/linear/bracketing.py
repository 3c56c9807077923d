"""Roots of a function between two points at which it differs in sign.

Source: T. R. Chandrupatla, A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without using
derivatives, Advances in Engineering Software 28 (1997).
"""

import math
from collections.abc import Callable

_ROUNDING = 4 * 2.0**-52
_MOST = 200
"""Steps; bisection alone takes 64 over the whole range of double precision's digits."""


def root_between(function: Callable[[float], float], first: float, second: float, *, tolerance: float = 2e-12) -> float:
    """The root of a function between two points, by inverse quadratic interpolation where that is safe, else by bisection.

    Args:
        function: The function, with a change of sign between the points; its values may be infinite.
        first: One point.
        second: The other.
        tolerance: Error of the root, in its own unit, beside rounding.

    Returns:
        The root.

    Example:
        >>> from forcefeel.linear.bracketing import root_between
        >>> f"{root_between(lambda x: x**2 - 2, 1.0, 2.0):.12f}"
        '1.414213562373'
    """
    near, far = first, second
    at_near, at_far = function(near), function(far)
    share = 0.5
    for _ in range(_MOST):
        between = near + share * (far - near)
        value = function(between)
        if (value > 0) == (at_near > 0):
            last, at_last = near, at_near
        else:
            last, at_last, far, at_far = far, at_far, near, at_near
        near, at_near = between, value
        best, least = (near, at_near) if abs(at_near) < abs(at_far) else (far, at_far)
        width = abs(far - near)
        error = _ROUNDING * abs(best) + tolerance
        if least == 0 or width <= 2 * error:
            return best
        share = min(max(_interpolated((near, far, last), (at_near, at_far, at_last)), error / width), 1 - error / width)
    return best


def _interpolated(x: tuple[float, float, float], y: tuple[float, float, float]) -> float:
    """Where a parabola through three points, ``x`` over ``y``, is zero, as a share of the way from the first to the second."""
    (a, b, c), (at_a, at_b, at_c) = x, y
    if not all(map(math.isfinite, y)) or at_c in (at_a, at_b):
        return 0.5
    along, up = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
    if not (up**2 < along and (1 - up) ** 2 < 1 - along):
        return 0.5
    return at_a / (at_b - at_a) * at_c / (at_b - at_c) + (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
