"""Many pairs at once: as one by one, whatever the threads; and the feels alone against an independent integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.links import LINK_TABLE
from forcefeel.loader.parameters import INDEX
from tests.linked.pairs import DEG, LB, link_values, project

WITNESS = {False: 1e-4, True: 1e-3}
"""Of the release angle: a second-order step of a tenth of the fastest rate, at whose end a link opens."""


def settings(loader, count):
    """Rows of a loader whose feel is stiffer from run to run."""
    rows = np.tile(loader.si_values, (count, 1))
    rows[:, INDEX["feel.stiffness"]] *= np.linspace(0.5, 1.5, count)
    return rows


def test_batch_is_what_each_pair_is_alone():
    axes = project("transport-column")
    rows = [settings(axes.loaders[axis], 3) for axis in axes.links["pitch"].between]
    links = np.tile(axes.links["pitch"].values, (3, 1))
    links[:, 0] *= [0.1, 1.0, 2.0]
    scenario = ff.linked.LinkedScenario(ff.Scenario(ff.Step(40 * LB), 0.5), second_force=ff.Step(-9 * LB))
    laws = [ff.Law.of("robust", axes.loaders[axis]) for axis in axes.links["pitch"].between]
    both = [
        ff.linked.simulate_linked_batch(
            axes, "pitch", scenario, ff.linked.PairValues(*rows, links), (laws[0], laws[1]), threads=threads
        )
        for threads in (1, 2)
    ]
    assert both[0].identical(both[1])
    alone = ff.linked.simulate_linked(axes, "pitch", scenario, "robust")
    middle = both[0].isel(run=1)
    for name in both[0].data_vars:
        np.testing.assert_array_equal(middle[name], alone.history[name])
    assert np.ptp(both[0]["first_column_angle_rad"].to_numpy()[:, -1]) > 0.5 * DEG


def test_bad_batch_is_refused():
    axes = project("transport-column")
    rows = np.tile(axes.loaders["pitch"].si_values, (2, 1))
    scenario = ff.linked.LinkedScenario(ff.Scenario(ff.Step(1.0), 0.5))
    pairs = ff.linked.PairValues(rows, rows)
    with pytest.raises(InputError, match=r"second: expected shape \(2, "):
        ff.linked.PairValues(rows, rows[:1])
    with pytest.raises(InputError, match=rf"link: expected shape \(2, {len(LINK_TABLE)}\)"):
        ff.linked.PairValues(rows, rows, np.ones((2, 3)))
    with pytest.raises(InputError, match="keep: expected names of outputs"):
        ff.linked.simulate_linked_batch(axes, "pitch", scenario, pairs, keep=["angle"])
    with pytest.raises(InputError, match="link: expected one of pitch, got 'pich'"):
        ff.linked.simulate_linked_batch(axes, "pich", scenario, pairs)


@pytest.mark.parametrize("uncouples", [False, True])
def test_two_feels_on_a_link_match_an_independent_integrator(uncouples):
    """Play, breakout and damping in play; the second feel carries an arm's mass and spring."""
    feels = np.array([[0.9, 4.0, 90.0], [2.2, 9.0, 700.0]])
    stiffness, damping, play, breakout, after = 2500.0, 8.0, 0.004, 15.0, 300.0
    angle, step_s, samples = 0.2, 2e-3, 800

    def torque(apart, rate, open_):
        stretched = stiffness * np.sign(apart) * max(abs(apart) - play / 2, 0.0)
        beyond = max(abs(stretched) - breakout, 0.0)
        spring = np.sign(stretched) * (min(abs(stretched), breakout) + beyond * after / stiffness)
        return 0.0 if open_ else spring + damping * rate

    def rates(_, y, open_):
        of_link = torque(y[0] - y[2], y[1] - y[3], open_)
        return [
            value
            for k, sign in ((0, -1.0), (1, 1.0))
            for value in (
                y[2 * k + 1],
                (sign * of_link - feels[k, 1] * y[2 * k + 1] - feels[k, 2] * y[2 * k]) / feels[k, 0],
            )
        ]

    def gives_way(_, y, __):
        return abs(y[0] - y[2]) - play / 2 - breakout / stiffness

    gives_way.terminal = uncouples
    time = np.arange(samples) * step_s
    exact = {"rtol": 1e-10, "atol": 1e-12, "max_step": 1e-3, "dense_output": True}
    first = solve_ivp(rates, (0, time[-1]), [angle, 0, angle, 0], events=[gives_way], args=(False,), **exact)
    assert len(first.t_events[0])
    witness = first.sol(time)
    if uncouples:
        after_it = solve_ivp(rates, (first.t[-1], time[-1]), first.y[:, -1], args=(True,), **exact)
        witness = np.where(time < first.t[-1], witness, after_it.sol(np.maximum(time, first.t[-1])))
    values = link_values(stiffness=stiffness, damping=damping, play=play, breakout=breakout, stiffness_after=after)
    angles = _core.linked_feels(feels[:1], feels[1:], values, (angle, step_s), samples, uncouples=uncouples)
    np.testing.assert_allclose(angles[0], witness[[0, 2]], rtol=0, atol=WITNESS[uncouples] * angle)
