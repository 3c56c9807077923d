"""Releases measured and judged the slow way, from a spline through their samples: the tests' independent witness."""

from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq


def features(time, angle):
    """Fall time, P0 and the later cycles, overshoots beyond 5 %: from a spline through the samples, each root by bisection."""
    spline = CubicSpline(time, angle / angle[0])

    def first(level, start):
        after = np.flatnonzero((time[:-1] >= start) & ((angle / angle[0] - level)[1:] < 0))
        k = int(after[0])
        return brentq(lambda t: spline(t) - level, time[k], time[k + 1])

    high, low = first(0.9, 0.0), first(0.1, 0.0)
    crossings = [root for root in spline.roots(extrapolate=False) if 0 < root < time[-1]]
    tops = [t for t in spline.derivative().roots(extrapolate=False) if crossings and t > crossings[0]]
    sizes = []
    for begin, end in pairwise([*crossings, time[-1]]):
        within = [abs(float(spline(t))) for t in tops if begin < t < end]
        sizes.append(max(within, default=0.0))
    count = 0
    while count < len(sizes) and sizes[count] > 0.05:
        count += 1
    cycles = [crossings[0] - high] if crossings else []
    cycles += [crossings[2 * n] - crossings[2 * n - 2] for n in range(1, (len(crossings) + 1) // 2)]
    return low - high, cycles, sizes, count


def least_margin(mine, wanted_features):
    """Least margin as a share of its tolerance in the words of Part 60: 10 (n + 1) % of Pn, 10 % of A1, the count within one."""
    fall, cycles, sizes, count = mine
    wanted_fall, wanted_cycles, wanted_sizes, wanted = wanted_features
    if wanted == 0:
        # What ought not to swing may do so once; twice is one overshoot too many.
        return min(1 - abs(fall - wanted_fall) / (0.1 * wanted_fall), 1.0 if count <= 1 else -1.0)
    if count == 0 or abs(count - wanted) > 1:
        return -np.inf
    shares = []
    for n in range((wanted // 2) + 1):
        if n >= len(cycles):
            return -np.inf
        shares.append(abs(cycles[n] - wanted_cycles[n]) / (0.1 * (n + 1) * wanted_cycles[n]))
    shares += [
        abs((sizes[k] if k < len(sizes) else 0.0) - wanted_sizes[k]) / (0.1 * wanted_sizes[0]) for k in range(wanted)
    ]
    return 1 - max(shares)


def ideal(feel, angle, time):
    """The free response of ``I x'' + B x' + G x = 0`` from rest at ``angle``, from its two roots."""
    fast, slow = np.roots(feel).astype(complex)
    return (angle * (slow * np.exp(fast * time) - fast * np.exp(slow * time)) / (slow - fast)).real
