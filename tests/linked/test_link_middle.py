"""A body at the middle of a link, against three masses in SciPy."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.links import LINK_TABLE
from tests.linked.pairs import EXAMPLES, LB, link_values, project, raw
from tests.linked.test_linked_witness import DURATION_S, FORCES, RISE_S, STEP_S, columns, feel, on_arms, ramp

BODY = {"middle_inertia": 4.0, "middle_damping": 15.0, "middle_stiffness": 900.0}
EXACT = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12, "max_step": 5e-3}
"""Far below what is compared."""

UNITS = {"middle_inertia": "N m s^2/rad", "middle_stiffness": "N m/rad"}
STIFFNESS, DAMPING, PLAY = 2500.0, 8.0, 0.01

SHAFT = 1e-4
"""Of the largest angle, as without a body: what the linkage's damping does."""

HELD = 0.01
"""Of the largest angle: a sample and its hold, 1 ms at the fastest."""

STATIC = 0.01
"""Of a force at rest, with the sensors' noise."""


def three_masses(masses, angles, forces, play=PLAY):
    """Angles of two masses and of a body between them, (3, samples), from rest at ``angles``, under forces that rise."""

    def torque(apart, rate):
        return 2 * STIFFNESS * np.sign(apart) * max(abs(apart) - play / 4, 0.0) + 2 * DAMPING * rate

    def rates(t, y):
        first, second = torque(y[0] - y[4], y[1] - y[5]), torque(y[4] - y[2], y[5] - y[3])
        slopes = []
        for k, linked in enumerate((-first, second)):
            inertia, damper, spring, lever = masses[k]
            pushed = lever * forces[k] * min(t / RISE_S, 1.0) + linked
            slopes += [y[2 * k + 1], (pushed - spring * y[2 * k] - damper * y[2 * k + 1]) / inertia]
        own = BODY["middle_damping"] * y[5] + BODY["middle_stiffness"] * y[4]
        return [*slopes, y[5], (first - second - own) / BODY["middle_inertia"]]

    time = np.arange(round(DURATION_S / STEP_S) + 1) * STEP_S
    start = [angles[0], 0.0, angles[1], 0.0, angles[2], 0.0]
    run = solve_ivp(rates, (0, DURATION_S), start, t_eval=time, **EXACT)
    return run.y[[0, 2, 4]]


def with_body(kind):
    """Two columns with a body at the middle of a link without play."""
    axes = project("transport-column")
    link = axes.links["pitch"]
    values = link_values(**{row: link[row] for row in LINK_TABLE} | {"play": 0.0} | BODY)
    return replace(axes, links={"pitch": replace(link, kind=kind, values=values)})


def test_columns_on_a_shaft_with_a_body_match_three_masses():
    loaders = columns()
    witness = three_masses([*map(on_arms, loaders)], (0.0, 0.0, 0.0), FORCES)
    values = link_values(stiffness=STIFFNESS, damping=DAMPING, play=PLAY, **BODY)
    scenarios = [ff.Scenario(ramp(force), DURATION_S, STEP_S, STEP_S) for force in FORCES]
    rows = raw(loaders, scenarios, values, "open", outputs=(0,)).T
    np.testing.assert_allclose(rows[:2], witness[:2], rtol=0, atol=SHAFT * np.abs(witness).max())


def test_feels_on_an_electronic_link_with_a_body_match_three_masses():
    loader = ff.elevator().replace({"controller.period": STEP_S, "controller.delay": STEP_S}, si=True)
    values = link_values(stiffness=STIFFNESS, damping=DAMPING, **BODY)
    scenarios = [ff.Scenario(ramp(force), DURATION_S, STEP_S, STEP_S) for force in FORCES]
    # The programmed control: what the link acts on.
    rows = raw((loader, loader), scenarios, values, "robust", outputs=(2,), delay=1).T
    witness = three_masses([feel(loader)] * 2, (0.0, 0.0, 0.0), FORCES, play=0.0)
    np.testing.assert_allclose(rows[:2], witness[:2], rtol=0, atol=HELD * np.abs(witness).max())


@pytest.mark.parametrize("kind", ["mechanical", "electronic"])
def test_hands_share_the_stiffness_of_the_body(kind):
    """Together each has half of it; one hand alone nearly all, and the other column follows."""
    axes = with_body(ff.linked.LinkKind(kind))
    link, loader = axes.links["pitch"], axes.loaders["pitch"]
    own, arm, body, half = (
        loader["feel.stiffness"],
        loader["column.grip_arm"],
        link["middle_stiffness"],
        2 * link["stiffness"],
    )
    push = ff.Recorded(np.array([0.0, 3.0, 6.0]), np.array([0.0, 20.0, 20.0]) * LB)
    for second, expected in (
        (push, own + half * body / (2 * half + body)),
        (ff.simulation.HandsOff(), own + 1 / (1 / half + 1 / (body + 1 / (1 / half + 1 / own)))),
    ):
        scenario = ff.linked.LinkedScenario(ff.Scenario(push, 6.0), second_force=second)
        run = ff.linked.simulate_linked(axes, "pitch", scenario, "robust")
        assert 20 * LB * arm / run.measures.first_final_angle_rad == pytest.approx(expected, rel=STATIC)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ({"middle_stiffness": 900.0}, "middle_stiffness: is of a body at the middle, which needs inertia"),
        ({"middle_inertia": 1e-4}, "the middle swings on the link at .* more middle_inertia"),
    ],
)
def test_body_without_inertia_or_too_light_is_refused(tmp_path, rows, message):
    text = (Path(EXAMPLES) / "transport-column.toml").read_text(encoding="utf-8").replace("mechanical", "electronic")
    path = tmp_path / "cockpit.toml"
    path.write_text(
        text + "".join(f'{row} = "{value} {UNITS[row]}"\n' for row, value in rows.items()), encoding="utf-8"
    )
    scenario = ff.linked.LinkedScenario(ff.Scenario(ff.Step(1.0), 0.1))
    with pytest.raises(InputError, match=message):
        ff.linked.simulate_linked(ff.loader.read_project(path), "pitch", scenario, "robust")


def test_frontier_of_a_link_with_a_body_is_refused():
    axes = with_body(ff.linked.LinkKind.ELECTRONIC)
    with pytest.raises(InputError, match=r"middle_inertia: .* leave the middle out"):
        ff.frontier.link_frontier(axes, "robust", delays=[1])
