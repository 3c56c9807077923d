"""The synthetic bench of ``examples``: made anew it is the same, and its truth is found."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff

BENCH = Path(__file__).parents[2] / "examples" / "bench"
FIT = "k,c,J,C_i,F_c"

ROUNDING = 1e-12
"""Relative, of times that are made again. Measured: 0."""
FOUND = 2e-3
"""Of a value: what the noise of the sensors leaves in 10 s. Measured: 9e-4."""
ONE_STEP = 1.5
"""Steps of a sensor: where noise puts a value between two steps, another machine's rounding may choose the other one."""


@pytest.fixture(scope="module")
def anew(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    runpy.run_path(str(BENCH / "make.py"))["main"](folder)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("name", ["multisine.parquet", "release.mat", "sweep.csv"])
def test_records_are_reproducible(anew, name):
    kept, made = (ff.read_bench_data(folder / name) for folder in (BENCH, anew))
    assert (kept.experiment, kept.channels.keys()) == (made.experiment, made.channels.keys())
    np.testing.assert_allclose(made.time_s, kept.time_s, rtol=ROUNDING)
    for channel, values in kept.channels.items():
        steps = np.unique(np.round(np.abs(np.diff(values)), 12))
        assert np.abs(made.channels[channel] - values).max() < ONE_STEP * steps[steps > 0].min() + 1e-9  # rounding


@pytest.mark.slow
@pytest.mark.parametrize("name", ["servo-closed.csv", "servo-open.csv"])
def test_responses_are_reproducible(anew, name):
    kept, made = (ff.read_bench_data(folder / name) for folder in (BENCH, anew))
    np.testing.assert_allclose(made.frequency_hz, kept.frequency_hz)
    np.testing.assert_allclose(np.abs(made.value / kept.value), 1, atol=2e-3)  # dB with three decimals, phase with two


@pytest.mark.slow
@pytest.mark.parametrize("name", ["loader.toml", "truth.toml"])
def test_loader_files_are_reproducible(anew, name):
    assert (anew / name).read_text(encoding="utf-8") == (BENCH / name).read_text(encoding="utf-8")


@pytest.mark.slow
def test_true_parameters_are_identified():
    """From the file's values, in a sixth of the record: 10 s are one period of the multisine and its soft beginning."""
    file, truth = ff.load(BENCH / "loader.toml"), ff.load(BENCH / "truth.toml")
    whole = ff.read_bench_data(BENCH / "multisine.parquet")
    early = whole.time_s <= 10.0
    channels = {name: values[early] for name, values in whole.channels.items()}
    record = ff.bench.BenchRecord("early", whole.experiment, whole.time_s[early], channels)
    found = ff.identify(file, [record], FIT, starts=1)
    assert found.loader is not None
    for it in found.estimates:
        assert it.value == pytest.approx(truth[it.unknown.key], rel=FOUND)
    response = ff.read_bench_data(BENCH / "servo-closed.csv")
    misled = ff.identify(file, [response], "k,c,J,C_i")
    # The linear model has no friction: a fit to the response alone is further off than its standard errors say.
    assert abs(misled["k"].value / truth["linkage.stiffness"] - 1) > 0.03
