"""The springs that a host may ask for: a table that is run coarsely first must be the table of all feels."""

import numpy as np
import pytest

from forcefeel.laws.law import Law
from forcefeel.live import rendered
from forcefeel.live.rendered import rendered_feels
from forcefeel.loader.built_in import open_loader


def _all_at_once(outcome, _margin, _never):
    yield np.ones_like(outcome, dtype=bool)


def _off_by(changes):
    """A stick whose rows are off by these factors, and the law of the stick as it should be."""
    loader = open_loader("sidestick-pitch")
    changed = loader.replace({key: loader[key] * factor for key, factor in changes.items()}, si=True)
    return changed, Law.of(Law.of("robust", loader).sampled, changed)


@pytest.mark.parametrize("changes", [{}, pytest.param({"motor.torque_constant": 2}, marks=pytest.mark.slow)])
def test_coarse_first_gives_the_table_of_all_feels(changes, monkeypatch):
    loader, law = _off_by(changes)
    refined = rendered_feels(loader, law)
    monkeypatch.setattr(rendered, "rounds", _all_at_once)
    np.testing.assert_array_equal(refined, rendered_feels(loader, law))
    assert 0 < len(refined) < 28, "a table without an edge shows nothing"


def test_no_spring_is_rendered_where_the_programmed_feel_is_unstable():
    assert len(rendered_feels(*_off_by({"motor.torque_constant": 8}))) == 0
