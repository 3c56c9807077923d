"""Dry friction on one of two linked sticks, against two equations that share no code with the engine."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from tests.linked.pairs import LB, project

FIRST_OFFICER = "stick-pitch-first-officer"
FRICTION_LB = 3.0

SAME = 0.03
"""Of a difference of two released sticks: the link's delay, and friction that is smoothed in the witness."""

BREAKOUT = 0.01
"""Of the breakout, whether or not the law of the jammed column compensates its friction."""

COMPENSATED = 1.3
"""Of the difference of released sticks: what a law that compensates the friction makes of it, at most."""


@pytest.fixture(scope="module")
def sticks():
    """Two sticks with a plain feel, the second with friction, and the law of each, made with the friction and without."""
    axes = project("linked-sticks")
    loader = axes.loaders["stick-pitch"]
    plain = loader.replace(dict.fromkeys(row for row in loader.given if row.startswith("feel.")))
    rough = plain.replace({"column.coulomb_friction": f"{FRICTION_LB} lb"})
    axes = replace(axes, loaders={"stick-pitch": plain, FIRST_OFFICER: rough})
    return axes, ff.Law.of("robust", plain), ff.Law.of("robust", rough)


def released(loader, link, friction):
    """Largest difference of two sticks let go at 5 deg: ``I d'' = -B d' - G d -+ T``, friction on the second."""
    inertia, damping, stiffness = (loader[f"feel.{row}"] for row in ("inertia", "damping", "stiffness"))

    def rates(_, state):
        first, rate, second, second_rate = state
        torque = np.clip(link["stiffness"] * (first - second), -link["breakout"], link["breakout"])
        torque += link["damping"] * (rate - second_rate)
        rubs = friction * np.tanh(second_rate / 2e-3)
        return [
            rate,
            (-damping * rate - stiffness * first - torque) / inertia,
            second_rate,
            (-damping * second_rate - stiffness * second + torque - rubs) / inertia,
        ]

    angle = np.radians(5.0)
    far_below = {"rtol": 1e-8, "atol": 1e-10}  # SAME of the difference
    run = solve_ivp(rates, (0, 2), [angle, 0, angle, 0], method="LSODA", max_step=1e-3, **far_below)
    return np.abs(run.y[0] - run.y[2]).max()


@pytest.mark.parametrize(("compensates", "most"), [(False, 1 + SAME), (True, COMPENSATED)])
def test_friction_moves_released_sticks_apart_as_two_equations_say(sticks, compensates, most):
    axes, law, knows = sticks
    link, loader = axes.links["stick-pitch"], axes.loaders["stick-pitch"]
    release = ff.Release("5 deg")
    both = ff.linked.LinkedScenario(ff.Scenario(release, 2.0), release)
    run = ff.linked.simulate_linked(axes, "stick-pitch", both, law, knows if compensates else law)
    expected = released(loader, link, FRICTION_LB * LB * loader["column.grip_arm"])
    assert (1 - SAME) * expected < run.measures.largest_difference_rad < most * expected


def test_friction_of_a_jammed_stick_leaves_the_breakout(sticks):
    """The hand holds the feel and the breakout, whatever friction the jammed column has; at rest all that is one sum."""
    axes, law, knows = sticks
    link, loader = axes.links["stick-pitch"], axes.loaders["stick-pitch"]
    ramp = ff.Recorded([0.0, 8.0], [0.0, 62.0])
    jammed = ff.linked.LinkedScenario(ff.Scenario(ramp, 8.0), jam=ff.linked.Jam(FIRST_OFFICER, 0.01))
    for second in (law, knows):
        run = ff.linked.simulate_linked(axes, "stick-pitch", jammed, law, second)
        at = int(np.argmax(run.history["link_gives_way"].to_numpy() > 0))
        feel = loader["feel.stiffness"] * float(run.history["first_column_angle_rad"][at]) / loader["column.grip_arm"]
        of_link = float(run.history["first_hand_force_n"][at]) - feel
        assert of_link * loader["column.grip_arm"] == pytest.approx(link["breakout"], rel=BREAKOUT)
