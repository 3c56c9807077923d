"""The search for a tuning: what it starts from, that it keeps what is better, and that its score is the envelope's."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute_few
from forcefeel.errors import InputError
from forcefeel.laws.sampled import Power, robust_tuning
from forcefeel.laws.sampled.methods import tuned

GRID = {"stiffness": "3, 30 %", "frequency": "2, 3.5 Hz", "damping": "0.2, 1"}
OPTIONS = {"grid": GRID, "changes": {"valve.rated_flow": 0.3}, "arms": ()}
SLOW = replace(robust_tuning(ff.digital_elevator()), torque_walk=Power(0.0, 0.5), command_weight=Power(-2.5, -0.7))
"""A tuning that hears the pilot late: there is room for better."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.digital_elevator()


@pytest.fixture(scope="module")
def found(loader: ff.Loader) -> ff.envelope.Tuned:
    return ff.envelope.tune(loader, SLOW, 12, seed=3, **OPTIONS)


def test_it_finds_a_better_one(found: ff.envelope.Tuned) -> None:
    assert found.score > found.first
    assert found.evaluations == 12
    assert found.tuning != SLOW


def test_score_is_the_envelopes(loader: ff.Loader, found: ff.envelope.Tuned) -> None:
    own = compute_few(make_plan(loader, {"it": tuned("it", "", found.tuning)}, **OPTIONS))
    passes, stable = own.passes("it"), own.stable("it")
    margins = np.array(own.data["margin"].values[0].reshape(passes.shape), dtype=float)
    margins = np.where(stable & np.isfinite(margins), margins, -1.0).clip(-1.0, 0.2)
    score = (
        passes.all(axis=0).mean()
        + 0.3 * passes[0].mean()
        + 0.15 * margins.min(axis=0).mean()
        + 0.1 * stable.all(axis=0).mean()
    )
    assert found.score == pytest.approx(score, abs=1e-6)  # margins are held in single precision
    assert found.shares.passes_worst == passes.all(axis=0).mean()


def test_same_seed_same_tuning(loader: ff.Loader) -> None:
    once, again = (ff.envelope.tune(loader, SLOW, 3, seed=5, **OPTIONS) for _ in range(2))
    assert (once.tuning, once.score) == (again.tuning, again.score)


def test_progress_and_one_evaluation(loader: ff.Loader) -> None:
    seen: list[tuple[int, int, float]] = []
    found = ff.envelope.tune(loader, SLOW, 1, progress=lambda *args: seen.append(args), **OPTIONS)
    assert found.tuning is SLOW
    assert found.score == found.first
    assert seen == [(1, 1, found.score)]


def test_it_begins_with_the_rules(loader: ff.Loader) -> None:
    assert ff.envelope.tune(loader, evaluations=1, **OPTIONS).tuning == robust_tuning(loader)


def test_bad_arguments(loader: ff.Loader) -> None:
    with pytest.raises(InputError, match="evaluations: expected at least 1, got 0"):
        ff.envelope.tune(loader, evaluations=0)
    with pytest.raises(InputError, match=r"controller\.period: expected a sample period"):
        ff.envelope.tune(ff.elevator(), evaluations=1, **OPTIONS)
