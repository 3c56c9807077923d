"""Records whose features are known in closed form."""

import math

import numpy as np
from scipy.optimize import brentq

from forcefeel.qualification import Record


def second_order(zeta, frequency_hz, t):
    """Way of a column of second order that is let go at t = 0 from 1, at rest: x'' + 2 z w x' + w^2 x = 0."""
    w, t = 2 * math.pi * frequency_hz, np.maximum(np.asarray(t, dtype=float), 0.0)
    if zeta == 1:
        return np.exp(-w * t) * (1 + w * t)
    if zeta > 1:
        root = math.sqrt(zeta**2 - 1)
        slow, fast = w * (zeta - root), w * (zeta + root)
        return (fast * np.exp(-slow * t) - slow * np.exp(-fast * t)) / (fast - slow)
    wd = w * math.sqrt(1 - zeta**2)
    return np.exp(-zeta * w * t) * (np.cos(wd * t) + zeta * w / wd * np.sin(wd * t))


def exact(zeta, frequency_hz):
    """Its features: fall time, P0, P1, and overshoots A1.. as shares of the way."""
    w = 2 * math.pi * frequency_hz
    far = (3 + 20 * max(zeta, 0.1)) / w

    def passes(level, until):
        return brentq(lambda t: float(second_order(zeta, frequency_hz, t)) - level, 0, until, xtol=1e-14)

    if zeta >= 1:
        return passes(0.1, far) - passes(0.9, far), (), ()
    wd = w * math.sqrt(1 - zeta**2)
    first = (math.pi / 2 + math.asin(zeta)) / wd
    high, low = passes(0.9, first), passes(0.1, first)
    sizes = tuple(math.exp(-k * math.pi * zeta / math.sqrt(1 - zeta**2)) for k in range(1, 17))
    return low - high, (first - high, *[2 * math.pi / wd] * 8), sizes


def lasts(zeta, frequency_hz):
    """Long enough to rest at 1e-7 of the way."""
    slow = zeta - math.sqrt(max(zeta**2 - 1, 0)) if zeta > 1 else zeta
    return 18 / (slow * 2 * math.pi * frequency_hz)


def released(  # noqa: PLR0913
    zeta, frequency_hz, rate, *, way=0.2, held_s=0.5037, steady=0.01, noise=0.0, seed=0, name="record", **options
):
    """A record that is held, let go between two samples, and rests."""
    t = np.arange(0, held_s + lasts(zeta, frequency_hz), 1 / rate)
    x = steady + way * second_order(zeta, frequency_hz, t - held_s)
    if noise:
        x = x + noise * abs(way) * np.random.default_rng(seed).standard_normal(len(t))
    return Record(t, x, name=name, **options)


def swept(  # noqa: PLR0913
    *,
    stiffness=400.0,
    breakout=10.0,
    friction=5.0,
    freeplay=0.0,
    damping=0.0,
    duration_s=100.0,
    rate=100.0,
    stop=0.2,
    noise_n=0.0,
    seed=0,
    surface_gain=None,
    name="sweep",
    unit="rad",
):
    """A sweep neutral - stop - opposite stop - neutral: F = B sgn x + k (x less half the freeplay) + c x' + F_c sgn x'.

    It begins with a force that grows until the control moves.
    """
    speed = 4 * stop / duration_s
    t = np.arange(1, round(duration_s * rate)) / rate
    legs = np.interp(t, [0, duration_s / 4, 3 * duration_s / 4, duration_s], [0, stop, -stop, 0])
    way = np.where((t < duration_s / 4) | (t >= 3 * duration_s / 4), 1.0, -1.0)
    taken = np.sign(legs) * np.maximum(np.abs(legs) - freeplay / 2, 0)
    force = breakout * np.sign(taken) + stiffness * taken + (damping * speed + friction) * way
    before = np.linspace(0, breakout + friction, round(0.02 * duration_s * rate), endpoint=False)
    moving = np.concatenate([np.zeros(len(before)), legs])
    pull = np.concatenate([before if not freeplay else np.linspace(0, friction, len(before), endpoint=False), force])
    if noise_n:
        pull = pull + noise_n * np.random.default_rng(seed).standard_normal(len(pull))
    time = np.arange(len(moving)) / rate
    surface = None if surface_gain is None else surface_gain * moving
    return Record(time, moving, pull, surface, position_unit=unit, name=name)
