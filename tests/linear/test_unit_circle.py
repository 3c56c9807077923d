"""Poles inside the unit circle, told by powers of the matrix: against NumPy's eigenvalues."""

import numpy as np
import pytest

from forcefeel.envelope.machines import full_rows
from forcefeel.envelope.plan import make_plan
from forcefeel.laws.law import Law
from forcefeel.linear.unit_circle import inside_unit_circle
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loops.sampled_loop import sampled_loops
from tests.parametrization import mostly_slow

_NEAR = 1e-9
"""Distances from the circle down to this are told as by eigenvalues, whose own rounding is below it for these matrices."""


@pytest.mark.parametrize("states", [1, 3, 8, 19, 33])
def test_random_matrices_are_told_apart_at_any_distance(states: int) -> None:
    rng = np.random.default_rng(states)
    matrices = rng.normal(size=(200, states, states))
    radius = 1 + rng.choice([-1, 1], 200) * 10 ** rng.uniform(np.log10(_NEAR), -1, 200)
    matrices *= (radius / np.abs(np.linalg.eigvals(matrices)).max(axis=1))[:, None, None]
    units = 10 ** rng.uniform(-5, 5, (200, states))
    matrices *= units[:, :, None] / units[:, None, :]
    assert (inside_unit_circle(matrices, 2) == (radius < 1)).all()


def test_what_is_no_number_is_not_inside() -> None:
    matrices = np.zeros((3, 4, 4))
    matrices[1, 0, 2], matrices[2, 3, 3] = np.nan, np.inf
    assert inside_unit_circle(matrices, 1).tolist() == [True, False, False]


@pytest.mark.parametrize("name", mostly_slow([name for name, make in BUILT_IN.items() if make()["controller.period"]]))
def test_verdicts_on_the_loops_of_a_loader_are_those_of_their_poles(name: str) -> None:
    plan = make_plan(
        BUILT_IN[name](),
        ["robust"],
        {"stiffness": "1..100 %:8:log", "frequency": "0.5..4 Hz:6", "damping": "0.1, 0.7, 1.5"},
    )
    feel = plan.settings.feel(plan.loader)
    law = Law.of("robust", plan.loader, feel)
    cases = [sampled_loops(plan.loader, law, full_rows(plan.loader, case, feel, law)) for case in plan.cases]
    inside = np.array([np.abs(loops.poles).max(axis=1) < 1 for loops in cases])
    assert (np.array([loops.stable for loops in cases]) == inside).all()
    assert 0 < inside.sum() < inside.size
