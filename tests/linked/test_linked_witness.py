"""A linked pair against witnesses of its own: two masses in SciPy, and the exact eigenvalues of two feels over a delay."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import forcefeel as ff
from tests.linked.pairs import LB, link_values, project, raw, simulated

SHAFT = STIFFNESS, DAMPING, PLAY, BREAKOUT = 2500.0, 8.0, 0.01, 80.0
"""A shaft, SI."""

ARM = {"pilot.arm_stiffness": 5000.0, "pilot.arm_damping": 60.0, "pilot.arm_mass": 0.0}
SOFT = {"linkage.stiffness": 176.0, "linkage.damping": 0.2}
"""A linkage so soft that the column is a mass on the pilot's arm."""

STEP_S, DURATION_S = 5e-4, 1.5
FORCES = (250.0, -200.0)
RISE_S = 0.3

UNCOUPLING = 0.01
"""Of the largest angle: required of the transient at uncoupling."""

UNCOUPLING_S = 2e-3
"""Of its time, with whole loaders, whose columns follow their feels by some milliseconds."""


LINKED = 1e-4
"""Of the largest angle: what the linkage's damping, which the witness leaves out, does."""

GIVES_WAY = -4
"""Place of that output of the link."""

ORDER = 0.15
"""Of the ratio of errors at two steps."""


def columns():
    """Two columns on arms, the second heavier."""
    first = ff.elevator().replace({**ARM, **SOFT}, si=True)
    return first, first.replace({"column.inertia": 1.6 * first["column.inertia"]}, si=True)


def on_arms(loader):
    """Inertia, damping, stiffness and lever of a column on its arm and linkage."""
    lever, linkage = loader["column.grip_arm"], loader["linkage.ratio"] * loader["column.base_arm"]
    spring = loader["pilot.arm_stiffness"] * lever**2 + loader["linkage.stiffness"] * linkage**2
    return loader["column.inertia"], loader["pilot.arm_damping"] * lever**2, spring, lever


def feel(loader):
    """The same of the programmed control."""
    return *(loader[f"feel.{name}"] for name in ("inertia", "damping", "stiffness")), loader["column.grip_arm"]


def two_masses(masses, link, forces, *, uncouples=True):
    """Angles (2, samples) of two masses on a shaft (k, c, p, M_b) under forces that rise to ``forces``; and when it opened."""
    stiffness, damping, play, breakout = link

    def stretch(y):
        apart = y[0] - y[2]
        return np.sign(apart) * max(abs(apart) - play / 2, 0.0)

    def rates(t, y, coupled):
        torque = coupled * (stiffness * stretch(y) + damping * (y[1] - y[3]))
        slopes = []
        for k, sign in enumerate((-1.0, 1.0)):
            inertia, damper, spring, lever = masses[k]
            angle, rate = y[2 * k : 2 * k + 2]
            pushed = lever * forces[k] * min(t / RISE_S, 1.0) + sign * torque
            slopes += [rate, (pushed - spring * angle - damper * rate) / inertia]
        return slopes

    def gives_way(_, y, __):
        return stiffness * abs(stretch(y)) - breakout

    gives_way.terminal = True
    time = np.arange(round(DURATION_S / STEP_S) + 1) * STEP_S
    exact = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12, "max_step": 5e-3, "dense_output": True}
    events = [gives_way] if uncouples else None
    run = solve_ivp(rates, (0, DURATION_S), np.zeros(4), events=events, args=(1.0,), **exact)
    if not uncouples:
        return run.sol(time)[[0, 2]], np.inf
    opened = run.t[-1]
    after = solve_ivp(rates, (opened, DURATION_S), run.y[:, -1], args=(0.0,), **exact)
    return np.where(time < opened, run.sol(np.minimum(time, opened)), after.sol(np.maximum(time, opened)))[
        [0, 2]
    ], opened


def ramp(force):
    """A force that rises and stays."""
    time = np.linspace(0.0, DURATION_S, 1 + round(DURATION_S / RISE_S))
    return ff.Recorded(time, force * np.minimum(time / RISE_S, 1.0))


def pair(loaders, step_s=STEP_S, play=PLAY, **joint):
    """The same by the engine, with a shaft that the witness has too."""
    scenarios = [ff.Scenario(ramp(force), DURATION_S, step_s, STEP_S) for force in FORCES]
    breakout = {"breakout": BREAKOUT} if joint else {}
    values = link_values(stiffness=STIFFNESS, damping=DAMPING, play=play, **breakout)
    return raw(loaders, scenarios, values, "open", outputs=(0,), **joint).T


def test_uncoupling_transient_matches_two_masses():
    loaders = columns()
    witness, opened = two_masses([*map(on_arms, loaders)], SHAFT, FORCES)
    rows = pair(loaders, uncouples=True)
    swing = np.abs(witness).max()
    assert 0.05 < opened < RISE_S
    assert abs(np.argmax(rows[GIVES_WAY]) * STEP_S - opened) <= 2 * STEP_S
    # The transient: what the columns do once the shaft has let go.
    assert np.abs(witness[0] - witness[1]).max() > 2 * (BREAKOUT / STIFFNESS + PLAY / 2)
    np.testing.assert_allclose(rows[:2], witness, rtol=0, atol=UNCOUPLING * swing)


def test_uncoupling_transient_of_whole_loaders_matches_two_feels():
    """Noise, limits and the orifice's flow are in play. Let go by the shaft, each column swings far beyond where it was held."""
    force = 110 * LB
    scenario = ff.Scenario(ramp(force), DURATION_S, STEP_S, STEP_S)
    run = simulated("uncoupling", scenario, ramp(-force))
    shaft = [run.link[name] for name in ("stiffness", "damping", "play", "breakout")]
    witness, opened = two_masses([*map(feel, run.loaders)], shaft, (force, -force))
    angles = [run.history[f"{side}_column_angle_rad"].to_numpy() for side in ("first", "second")]
    assert run.measures.gave_way_at_s == pytest.approx(opened, abs=UNCOUPLING_S)
    held = witness[0][round(opened / STEP_S)]
    assert witness[0].max() > 3 * held
    np.testing.assert_allclose(angles, witness, rtol=0, atol=UNCOUPLING * np.abs(witness).max())


def test_linked_columns_match_two_masses():
    loaders = columns()
    witness, _ = two_masses([*map(on_arms, loaders)], SHAFT, FORCES, uncouples=False)
    np.testing.assert_allclose(pair(loaders)[:2], witness, rtol=0, atol=LINKED * np.abs(witness).max())


def test_coupling_is_of_second_order():
    loaders = columns()
    exact, *others = (pair(loaders, STEP_S / parts, play=0.0)[:2] for parts in (32, 1, 2, 4))
    errors = [np.abs(other - exact).max() for other in others]
    assert errors[0] / errors[1] == pytest.approx(4, rel=ORDER)
    assert errors[1] / errors[2] == pytest.approx(4, rel=ORDER)


PERIOD_S = 5e-4
DELAYS = (1, 2, 4, 10, 20, 40)
"""Periods: 0.5 to 20 ms."""

BOUND = 0.01
"""Required of the largest stable stiffness."""


def digital():
    """A linear loader at 2 kHz."""
    return ff.elevator().replace({"controller.period": PERIOD_S, "controller.delay": PERIOD_S}, si=True)


def needed_periods(periods):
    """Injected damping over stiffness and period."""
    return max(periods + 2, 1.064 * (periods + 1))


def radius(loader, stiffness, periods, injected):
    """Largest magnitude of the eigenvalues of both feels under a held torque, each angle carried on over its delay, exact."""
    inertia, damping, spring = (loader[f"feel.{name}"] for name in ("inertia", "damping", "stiffness"))
    damping += min(stiffness * needed_periods(periods) * PERIOD_S, injected)
    held = expm(PERIOD_S * np.array([[0, 1, 0], [-spring / inertia, -damping / inertia, 1 / inertia], [0, 0, 0]]))
    largest = 0.0
    for mode in (1.0, -1.0):  # both apart, both together
        matrix = np.zeros((3 + periods, 3 + periods))
        matrix[:2, :2] = held[:2, :2]
        angles = [0, *range(2, 3 + periods)]  # of now, of one period before, ...
        for sign, back in ((1.0, 0), (mode, periods)):
            ahead = back + 0.5
            matrix[:2, angles[back]] -= sign * (1 + ahead) * stiffness * held[:2, 2]
            matrix[:2, angles[back + 1]] += sign * ahead * stiffness * held[:2, 2]
        matrix[2, 0] = 1.0
        matrix[np.arange(3, 3 + periods), np.arange(2, 2 + periods)] = 1.0
        largest = max(largest, np.abs(np.linalg.eigvals(matrix)).max())
    return largest


def largest_stable(loader, periods, injected):
    """By bisection, N m/rad."""
    low, high = 1.0, 1e7
    for _ in range(40):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if radius(loader, middle, periods, injected) < 1 else (low, middle)
    return low


def grows(loader, stiffness, periods, injected):
    """Whether the pair swings up by itself after a push."""
    values = link_values(stiffness=stiffness, injected_damping=injected)
    duration = {"duration_s": 6.0, "step_s": PERIOD_S, "sample_s": PERIOD_S}
    scenarios = [
        ff.Scenario(ff.simulation.Pulse(0.1, 0.01, 0.02), **duration),
        ff.Scenario(ff.simulation.HandsOff(), **duration),
    ]
    rows = raw((loader, loader), scenarios, values, "robust", outputs=(2,), delay=periods)
    apart = rows[:, 0] - rows[:, 1]
    quarter = len(apart) // 4
    return np.linalg.norm(apart[-quarter:]) > np.linalg.norm(apart[quarter : 2 * quarter])


@pytest.mark.parametrize("injected", [0.0, 20.0])
@pytest.mark.parametrize("periods", DELAYS)
def test_largest_stable_stiffness_of_an_electronic_link_is_that_of_the_eigenvalues(periods, injected):
    loader = digital()
    stiffness = largest_stable(loader, periods, injected)
    assert not grows(loader, (1 - BOUND) * stiffness, periods, injected)
    assert grows(loader, (1 + BOUND) * stiffness, periods, injected)


@pytest.mark.parametrize("periods", [1, 2, 4, 10, 15, 16, 20, 40, 100, 255])
def test_injected_damping_takes_what_delay_and_hold_give_at_each_frequency(periods):
    """Held torques do the work ``Re conj(z - 1) H`` on both controls, together and apart; no smaller damping takes all of it."""
    z = np.exp(1j * np.concatenate([np.geomspace(1e-3, 0.1, 500), np.linspace(0.1, np.pi, 100_000)]))
    own = 1 + 0.5 * (1 - 1 / z)
    other = z**-periods * (1 + (periods + 0.5) * (1 - 1 / z))
    given = [-np.real(np.conj(z - 1) * (own + sign * other)) / np.abs(z - 1) ** 2 for sign in (1, -1)]
    share = np.max(given) / needed_periods(periods)
    assert 0.99 < share <= 1


@pytest.mark.parametrize("periods", [1, 4, 20])
def test_injected_damping_is_that_of_delay_and_period(periods):
    """Beyond the largest stable stiffness without it: just stable with it, by the eigenvalues, and unstable with less of it."""
    loader = digital()
    stiffness = 4 * largest_stable(loader, periods, 0.0)
    injected = stiffness * needed_periods(periods) * PERIOD_S
    needed = brentq(lambda damping: radius(loader, stiffness, periods, damping) - 1, 0.0, injected)
    assert not grows(loader, stiffness, periods, np.inf)
    assert not grows(loader, stiffness, periods, (1 + BOUND) * needed)
    assert grows(loader, stiffness, periods, (1 - BOUND) * needed)


@pytest.mark.slow
def test_frontier_of_a_link_is_that_of_the_eigenvalues():
    axes = project("transport-column")
    loader = digital()
    link = replace(axes.links["pitch"], kind=ff.linked.LinkKind.ELECTRONIC, values=link_values(stiffness=1e4))
    bare = replace(axes, loaders=dict.fromkeys(axes.loaders, loader), links={"pitch": link})
    frontier = ff.frontier.link_frontier(bare, "robust", delays=[1, 4, 40]).links["pitch"]
    assert len(frontier.limits) == 9
    for limit in (*frontier.limits, frontier.own):
        periods = round(limit.delay_s / PERIOD_S)
        exact = largest_stable(loader, periods, limit.injected_damping_n_m_s_per_rad)
        assert limit.stiffness_n_m_per_rad == pytest.approx(exact, rel=BOUND)
    assert frontier.used == pytest.approx(1e4 / largest_stable(loader, 1, 0.0), rel=BOUND)
