"""The bound of friction known to a share: its theorem on the engine, its releases by another route, its shares."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.frontier.friction_bound import friction_bound, rubbed_releases
from forcefeel.laws.law import Law
from forcefeel.simulation.inputs import Recorded

GRID = {"stiffness": "5, 30 %", "frequency": "1, 2 Hz", "damping": "0.3, 0.7"}
DRY = {"column.coulomb_friction": "1 lb"}
INTEGRATED = 1e-7
"""Of the deflection, by an integrator at 1e-10."""


def swings(feel, friction, angle, time):
    """I theta'' + B theta' + G theta = -f sgn(theta'), integrated from turn to turn."""
    inertia, damping, stiffness = feel
    at, start, found = angle, 0.0, np.full(len(time), np.nan)
    while start < time[-1]:
        if stiffness * abs(at) <= friction:
            found[np.isnan(found)] = at
            return found
        way = -np.sign(at)

        def slope(_, x, way=way):
            return [x[1], -(stiffness * x[0] + damping * x[1] + friction * way) / inertia]

        def turns(_, x):
            return x[1]

        turns.terminal, turns.direction = True, -way
        run = solve_ivp(
            slope,
            (start, time[-1]),
            [at, way * 1e-12],
            events=turns,
            rtol=1e-10,
            atol=1e-13,
            dense_output=True,  # far below INTEGRATED
        )
        here = (time >= start) & (time <= run.t[-1])
        found[here] = run.sol(time[here])[0]
        at, start = run.y[0, -1], run.t[-1]
    return found


@pytest.mark.parametrize("friction", [0.0, 2.0, -1.0])
@pytest.mark.parametrize("feel", [(2.0, 1.5, 100.0), (2.0, 40.0, 100.0)])
def test_release_with_residual_friction_matches_independent_method(feel, friction):
    time = np.arange(0.0, 4.0, 4e-3)
    found = rubbed_releases(np.array([feel]), friction, 0.17, time)[0]
    np.testing.assert_allclose(
        found, swings(feel, friction, 0.17, time), atol=0.17 * INTEGRATED
    )  # a share of the release


def test_friction_and_dragging_hand_are_indistinguishable():
    """(1 + e) F hands off, and (1 - e) F with a hand that drags with 2 e F: one motion, whatever the law."""
    quiet = {f"{part}.{row}": None for part in ("load_cell", "column_sensor") for row in ("noise", "resolution")}
    loader = ff.digital_elevator().replace({**quiet, **DRY}, si=True)
    law = Law.of("robust", loader)
    force, off = loader["column.coulomb_friction"], 0.3
    more, less = (loader.replace({"column.coulomb_friction": share * force}, si=True) for share in (1 + off, 1 - off))
    step = 5e-4
    time = np.arange(0.0, 0.6 + step / 2, step)
    push = np.where(time < 0.2, 40.0, -40.0)
    alone = ff.simulate(more, ff.Scenario(Recorded(time, push), 0.6, step, step), law).history
    drag = -2 * off * force * np.sign(alone.column_velocity_rad_per_s.values)
    held = ff.simulate(less, ff.Scenario(Recorded(time, push + drag), 0.6, step, step), law).history
    apart = alone.column_angle_rad.values - held.column_angle_rad.values
    # The recorded drag turns over a step, not at a point.
    assert np.abs(apart).max() < 2e-3 * np.ptp(alone.column_angle_rad.values)
    unheld = ff.simulate(less, ff.Scenario(Recorded(time, push), 0.6, step, step), law).history
    assert np.abs(alone.column_angle_rad.values - unheld.column_angle_rad.values).max() > 20 * np.abs(apart).max()


def test_larger_friction_error_leaves_fewer_settings():
    plan = make_plan(ff.digital_elevator().replace(DRY), ["robust"], GRID, arms=())
    found = friction_bound(plan, (0.01, 0.1))
    assert found.tolerance == pytest.approx(0.2)
    assert found.errors == (0.01, 0.1, 0.2)
    assert np.all(np.diff(found.possible.astype(int), axis=0) <= 0)
    assert found.shares[0] > found.share
    assert found.off_n == pytest.approx(0.2 * plan.loader["column.coulomb_friction"])


def test_loader_without_friction_has_no_friction_bound():
    assert friction_bound(make_plan(ff.digital_elevator(), ["robust"], GRID)) is None
