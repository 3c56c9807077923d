"""Limit cycles of an electric loader's position loop, with backlash and with cogging, against harmonic balance.

`x` end of the drive, `M = J_m / r^2` its mass · `y = alpha R_b theta` the column's place there, `M_b = J / (alpha R_b)^2` its
mass · `f = K_t i / r` force of the motor · `k`, `c` link, `b` its play · `T_1 sin(N phi)` cogging, `phi = x / r` · `A`, `w`
amplitude and frequency of the cycle

    f = -K_p p - K_i integral p - K_v x'        p = y with backlash, p = x with cogging; sampled each T, held, lagged by the current

The nonlinear part is replaced by what it makes of a sine's first harmonic (A. Gelb, W. E. Vander Velde, Multiple-Input Describing
Functions and Nonlinear System Design, McGraw-Hill 1968, app. B). Between two masses backlash is a spring with a dead zone, of the
stretch `x - y`; the play that a load without mass keeps by its friction has another.

    dead zone    N(A) = k (1 - (2 / pi) (asin(b / 2A) + (b / 2A) sqrt(1 - (b / 2A)^2)))
    harmonic     N(A) = 2 T_1 J_1(N A / r) / (r A)
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import root
from scipy.special import j1

from forcefeel.laws import SampledLaw
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded
from tests.optional_rows import bare

CLOSE = 0.05
"""What is asked for, of amplitude and frequency. Measured: 0.027 and 0.020 with backlash, 0.030 and 0.009 with cogging."""
PERIOD_S = 5e-4
LEAK = 1e-3
"""rad/s: the integral forgets, since a law that integrates without end has no state at rest."""
RUN_S, PUSH_S, CYCLES = 20.0, 0.1, 10
PLAY_M, COGGING_N_M = 1e-3, 0.5


@dataclass(frozen=True)
class Loop:
    """`K_p`, `K_i`, `K_v`, and what `p` is of `F_c, x, theta`."""

    place: float
    integral: float
    speed: float
    senses: tuple[float, float, float]

    def law(self, newton_per_ampere):
        """The loop as a sampled law: its states are `x` of the sample before and the integral."""
        transition, inputs, command, torque = (np.zeros(shape) for shape in ((1, 2, 2), (1, 2, 4), (1, 7), (1, 7)))
        transition[0, 1, 1] = 1 - LEAK * PERIOD_S
        inputs[0, 0, 1], inputs[0, 1, :3] = 1.0, PERIOD_S * np.array(self.senses)
        command[0, :2] = self.speed / PERIOD_S, -self.integral
        command[0, 2:5] = -self.place * np.array(self.senses)
        command[0, 3] -= self.speed / PERIOD_S
        torque[0, 2] = -0.1  # the feel computer runs beside, and is not listened to
        return SampledLaw(PERIOD_S, 0.0, transition, inputs, command / newton_per_ampere, torque)

    def answers(self, w, lag):
        """Force per `-p` and per `-x` at the frequency ``w``."""
        z = cmath.exp(1j * w * PERIOD_S)
        held = (1 - 1 / z) / (1j * w * PERIOD_S) / (1 + 1j * w / lag)
        return held * (self.place + self.integral * PERIOD_S / (z - 1 + LEAK * PERIOD_S)), held * self.speed * (
            1 - 1 / z
        ) / PERIOD_S


class Masses:
    """What of a loader the balance needs."""

    def __init__(self, loader):
        row = loader.__getitem__
        self.r, self.k, self.c = row("transmission.travel"), row("linkage.stiffness"), row("linkage.damping")
        self.lever = row("linkage.ratio") * row("column.base_arm")
        self.m, self.base = row("motor.inertia") / self.r**2, row("column.inertia") / self.lever**2
        self.newton_per_ampere, self.lag = row("motor.torque_constant") / self.r, row("current_loop.bandwidth")


def dead_zone(share):
    """N / k at ``share`` = b / 2A."""
    return 1 - 2 / math.pi * (math.asin(share) + share * math.sqrt(1 - share**2))


def balanced(residual, start):
    """The amplitude and frequency at which the first harmonics balance."""
    found = root(lambda at: [(e := residual(*at)).real, e.imag], start)
    assert found.success
    return found.x


def cycle(loader, loop, signal):
    """Amplitude of the first harmonic and frequency of the last cycles, after a push."""
    time = np.arange(round(RUN_S / PERIOD_S) + 1) * PERIOD_S
    push = np.where(time < PUSH_S, 50.0, 0.0)
    law = loop.law(Masses(loader).newton_per_ampere)
    history = simulate(loader, Scenario(Recorded(time, push), RUN_S, PERIOD_S, PERIOD_S), law).history
    x = signal(history)
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    crossings = (time[up] - x[up] * PERIOD_S / (x[up + 1] - x[up]))[-CYCLES - 1 :]
    w = 2 * math.pi * CYCLES / (crossings[-1] - crossings[0])
    even = np.linspace(crossings[0], crossings[-1], 4000, endpoint=False)
    first = 2 * abs(np.mean(np.interp(even, time, x) * np.exp(-1j * w * even)))
    assert np.ptp(np.diff(crossings)) < CLOSE * np.diff(crossings).mean()  # it has settled
    return first, w


@pytest.mark.parametrize(("spring", "play_m"), [(1.3, PLAY_M), (1.6, PLAY_M), (1.9, PLAY_M), (1.6, PLAY_M / 4)])
def test_backlash_limit_cycle_matches_describing_function(spring, play_m):
    """A loop that is stable on the stiff link and not on a soft one settles at the stretch whose mean stiffness is between."""
    soft = bare(ELECTRIC).replace(
        {"motor.inertia": 0.03, "linkage.damping": 1.0, "transmission.backlash": play_m}, si=True
    )
    w_0, speed = 20.0, 2000.0
    place = Masses(soft).base * w_0**2
    loader = soft.replace({"linkage.stiffness": spring * place}, si=True)
    of = Masses(loader)
    loop = Loop(place, 0.1 * speed * w_0**2, speed, (0.0, 0.0, of.lever))

    def residual(share, w):
        # F = N (x - y) = M_b y'',  M x'' = f - F; per y
        s, (p, v) = 1j * w, loop.answers(w, of.lag)
        inertia = of.base * s**2
        return ((of.m * s**2 + v) * (1 + inertia / (of.k * dead_zone(share))) + inertia + p) / place

    share, w = balanced(residual, (0.2, w_0))
    found = cycle(loader, loop, lambda h: h.drive_position_m.values - of.lever * h.column_angle_rad.values)
    assert found[0] == pytest.approx(play_m / 2 / share, rel=CLOSE)
    assert found[1] == pytest.approx(w, rel=CLOSE)


@pytest.mark.parametrize("share", [0.9, 0.7, 0.5])
def test_cogging_limit_cycle_matches_describing_function(share):
    """A loop that is softer at the slot's edge than the cogging is stiff swings until J_1 has taken it back."""
    changes = {"motor.inertia": 0.01, "motor.cogging_torque": COGGING_N_M, "linkage.damping": 2000.0}
    loader = bare(ELECTRIC).replace(changes, si=True)
    of, periods = Masses(loader), loader["motor.cogging_periods"]
    stiffest = COGGING_N_M * periods / of.r**2
    w_0 = 0.6 * math.sqrt(stiffest / of.base)
    place = share * stiffest + of.base * w_0**2
    speed = 0.6 * math.sqrt(of.base * place)
    loop = Loop(place, speed * w_0**2, speed, (0.0, 1.0, 0.0))

    def residual(turned, w):
        s, (p, v) = 1j * w, loop.answers(w, of.lag)
        link = of.k + of.c * s
        load = of.base * s**2 * link / (of.base * s**2 + link)
        return (of.m * s**2 + load + p + v - stiffest * 2 * j1(turned) / turned) / place

    turned, w = balanced(residual, (1.5, w_0))
    found = cycle(loader, loop, lambda h: h.drive_position_m.values)
    assert found[0] == pytest.approx(turned * of.r / periods, rel=CLOSE)
    assert found[1] == pytest.approx(w, rel=CLOSE)
