"""The smallest friction: what sits on the column's side of every sensor is felt whole, by the balance at rest."""

import pytest

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.frontier.friction import smallest_friction
from forcefeel.loader.built_in import BUILT_IN
from tests.parametrization import mostly_slow

GRID = {"stiffness": "50, 100 %", "frequency": "2, 3 Hz", "damping": "0.5, 1"}
STILL_MOVING = 0.05  # relative; the push goes on while the column slips
POUND_N = 4.4482216


DRY = {"column.coulomb_friction": "2 lb"}


@pytest.mark.slow
def test_column_friction_is_fully_felt():
    """R_p F_p = G theta + R_p F_c sgn(theta'): a law that does not know of it cannot take it off."""
    smooth = ff.elevator()
    without, found = (
        smallest_friction(make_plan(each, ("published",), GRID)) for each in (smooth, smooth.replace(DRY))
    )
    assert found.column_n == pytest.approx(2 * POUND_N)
    assert found.felt_n - without.felt_n == pytest.approx(found.column_n, rel=STILL_MOVING)


@pytest.mark.parametrize(("loader", "left"), mostly_slow([("elevator-2khz", 0.05), ("elevator-electric", 0.15)]))
def test_friction_known_to_the_law_is_hardly_felt(loader, left):
    """Measured: 0.026 and 0.114, with a friction that is known to 1 %."""
    loader = BUILT_IN[loader]()
    known = loader.replace(DRY).with_tolerances({"column.coulomb_friction": "1 %"})
    found = smallest_friction(make_plan(known, ("robust",), GRID))
    assert found.felt_n < left * found.column_n


def test_no_friction_leaves_only_rounding():
    found = smallest_friction(make_plan(ff.elevator(), ("published",), GRID))
    assert found.felt_n < 1e-2 * found.force_n
    assert found.noise_n < 1e-4 * found.force_n


@pytest.mark.slow
def test_sensor_noise_is_felt():
    loader = ff.digital_elevator()
    quiet, loud = (
        smallest_friction(make_plan(each, ("robust",), GRID))
        for each in (loader, loader.replace({"load_cell.noise": 10 * loader["load_cell.noise"]}, si=True))
    )
    assert 0 < quiet.noise_n < loud.noise_n
