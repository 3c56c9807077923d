"""The law under which a live run was recorded is the law of the fit."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.run_law import law_of_runs
from forcefeel.commission import identified
from forcefeel.errors import InputError


class FittedError(Exception):
    """Stops a commissioning once the law of its fit is known."""


@pytest.fixture
def yoke():
    return ff.loader.electric("desktop-yoke")


def record(loader, law="torque-mode", name="run", **about):
    times = np.arange(0.0, 1.0, 1e-3)
    swing = np.sin(2 * np.pi * times)
    channels = {"pilot_force": 10.0 * swing, "column_angle": 0.1 * swing, "load_cell_force": 5.0 * swing}
    run = {"law": law, "loader": loader.name, "loader_hash": loader.fingerprint} | about
    return BenchRecord(name, Experiment.read("loader pilot_force"), times, channels, run=run if law else {})


@pytest.mark.parametrize(
    ("law", "fitted"), [("torque-mode", "torque-mode"), ("load-cell", "load-cell"), ("", "robust")]
)
def test_commission_fits_under_the_law_that_the_record_states(yoke, monkeypatch, law, fitted):
    def fit(loader, data, keys, *, law, starts):
        raise FittedError(law.name)

    monkeypatch.setattr(identified, "identify", fit)
    plan = ff.commission.CommissionPlan(fit=("J",), own_instruments=True)
    with pytest.raises(FittedError, match=fitted):
        identified.identify_loader(yoke, [record(yoke, law)], plan)


@pytest.mark.parametrize(
    ("data", "needed"),
    [
        (
            lambda yoke: [record(yoke), record(yoke, "robust", "other")],
            "records under two laws, torque-mode in run and robust in other",
        ),
        (
            lambda yoke: [record(yoke, "my law")],
            "under the law my law, which is no design of its own name; identify with its file",
        ),
        (lambda yoke: [record(yoke, loader_hash="0")], "was run on a loader desktop-yoke of other values"),
    ],
)
def test_law_that_cannot_be_made_again_is_refused_with_the_remedy(yoke, data, needed):
    with pytest.raises(InputError, match=needed):
        law_of_runs(data(yoke), yoke)
