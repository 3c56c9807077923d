"""Makes the flight test of a light aircraft: force over position at two dynamic pressures, and a release; by formulas of its own.

``F = q (k_1 x + k_3 x^3) + F_b sgn x + F_f sgn x'`` at the grip, ``x`` position in deg, ``q`` dynamic pressure in lb/ft^2.
"""

import math
import sys
from pathlib import Path

import numpy as np

GRADIENT, CUBIC = 0.04, 2e-5
"""``k_1``, ``k_3``: lb per lb/ft^2 and deg, deg^3."""
BREAKOUT, FRICTION = 1.8, 1.35
"""``F_b``, ``F_f``: 8 N and 6 N, in lb."""
ARM_IN, INERTIA, DAMPING = 31.375, 25.0, 260.0
"""Arm of the grip, inertia in lb in s^2/rad and damping in lb in s/rad of elevator and control run."""
SLOW, FAST = 25.0, 60.0
"""Dynamic pressures in lb/ft^2: 86 and 133 knots at sea level."""
STEP_S, RATE = 1e-4, 100


def elastic(x, q):
    """Force without friction, lb; breakout builds up over 0.1 deg."""
    return q * (GRADIENT * x + CUBIC * x**3) + BREAKOUT * np.clip(x / 0.1, -1, 1)


def points(rng):
    """Rows of the points: a loop at each dynamic pressure."""
    loop = [(-12, -1), (-8, -1), (-5, -1), (-2, -1), (-7, 1), (2, 1), (5, 1), (8, 1), (12, 1), (6, -1)]
    for q in (SLOW, FAST):
        for x, direction in loop:
            force = elastic(x, q) + FRICTION * direction + 0.1 * rng.standard_normal()
            yield f"{x},{q:g},{direction},{force:.2f}"


def release(rng, held_s=0.5, lasts_s=5.0):
    """Rows of a release from 8 deg at the higher dynamic pressure."""
    x, speed = math.radians(8.0), 0.0
    drag = STEP_S * FRICTION * ARM_IN / INERTIA
    for k in range(round((held_s + lasts_s) * RATE)):
        yield f"{k / RATE:.2f},{math.degrees(x) + 0.02 * rng.standard_normal():.3f}"
        for _ in range(round(1 / RATE / STEP_S) if k >= held_s * RATE else 0):
            speed -= STEP_S * (ARM_IN * float(elastic(math.degrees(x), FAST)) + DAMPING * speed) / INERTIA
            speed = math.copysign(max(abs(speed) - drag, 0.0), speed)
            x += STEP_S * speed


def main(folder: Path) -> None:
    """Writes ``flight.csv`` and ``release.csv``."""
    rng = np.random.default_rng(1)
    head = "position (deg),dynamic pressure (lb/ft^2),direction,force (lb)"
    (folder / "flight.csv").write_text("\n".join([head, *points(rng)]) + "\n", encoding="utf-8")
    (folder / "release.csv").write_text("\n".join(["time (s),position (deg)", *release(rng)]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
