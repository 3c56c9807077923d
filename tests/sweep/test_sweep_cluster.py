"""The same sweep on a real Dask cluster: worker processes, one of them killed half-way."""

import os
import signal
from importlib.metadata import PackageNotFoundError

import numpy as np
import pytest
from distributed import LocalCluster

from forcefeel.errors import InputError
from forcefeel.laws.analog.recursion import published_settings
from forcefeel.sweep import Sweep, cluster, run_sweep
from tests.sweeps import PUSH, nonlinear, small

RUNS = 8_000
"""So many that a worker can be killed half-way."""


@pytest.fixture(scope="module")
def workers():
    with LocalCluster(n_workers=1, processes=True, threads_per_worker=1, dashboard_address=":0") as found:
        yield found


@pytest.fixture(scope="module")
def here():
    return run_sweep(small(RUNS)).runs


@pytest.mark.slow
def test_killed_worker_does_not_change_result(workers, here, tmp_path):
    """Nothing is counted twice and nothing lost: the result is the embedded one, bit for bit."""
    workers.scale(2)
    workers.wait_for_workers(2)
    victim = next(iter(workers.workers.values())).pid
    told, killed = [], []

    def kill_half_way(done, total):
        told.append(done)
        if done >= total / 2 and not killed:
            os.kill(victim, signal.SIGKILL)
            killed.append(done)

    found = run_sweep(small(RUNS), tmp_path, scheduler=workers.scheduler_address, progress=kill_half_way)
    assert killed
    assert killed[0] < RUNS
    assert found.runs.identical(here)
    assert len(told) == 1 + len(small(RUNS).chunks)
    assert sorted(np.diff(told)) == sorted(map(len, small(RUNS).chunks))


def test_local_sweep_resumes_on_cluster(workers, tmp_path):
    def stop(done, total):
        if done > total / 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(small(), tmp_path, progress=stop)
    found = run_sweep(small(), tmp_path, resume=True, scheduler=workers.scheduler_address)
    assert found.runs.identical(run_sweep(small()).runs)


@pytest.mark.slow
def test_cluster_laws_equal_local_laws(workers):
    loader = nonlinear()
    vary = {"feel.damping": "30 %"}
    sweep = Sweep(loader, PUSH, published_settings(loader), runs=200, vary=vary)
    assert run_sweep(sweep, scheduler=workers.scheduler_address).runs.identical(run_sweep(sweep).runs)


@pytest.mark.slow
def test_interrupted_cluster_sweep_keeps_finished_chunks(workers, here, tmp_path):
    def stop(done, total):
        if done > total / 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(small(RUNS), tmp_path, scheduler=workers.scheduler_address, progress=stop)
    kept = len(list((tmp_path / "chunks").iterdir()))
    assert 0 < kept < len(small(RUNS).chunks)
    assert run_sweep(small(RUNS), tmp_path, resume=True).runs.identical(here)


def test_another_engine_on_a_worker_is_named(workers, monkeypatch):
    right = cluster.nominal(small(64))
    monkeypatch.setattr(cluster, "nominal", lambda sweep: np.nextafter(right, np.inf))
    with pytest.raises(InputError, match="a worker's engine gives other numbers than the one here"):
        run_sweep(small(64), scheduler=workers.scheduler_address)


@pytest.mark.parametrize(
    ("found", "said"),
    [("0.0.1", "has forcefeel 0.0.1, expected"), (PackageNotFoundError("forcefeel"), "has no forcefeel; install")],
)
def test_worker_with_other_or_missing_forcefeel_is_named(workers, monkeypatch, found, said):
    monkeypatch.setattr("distributed.Client.run", lambda self, *args, **options: {"tcp://far:1": found})
    with pytest.raises(InputError, match=said):
        run_sweep(small(64), scheduler=workers.scheduler_address)


def test_a_scheduler_without_workers_is_named(monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_S", 0.5)
    with (
        LocalCluster(n_workers=0, processes=False, protocol="tcp", dashboard_address=":0") as empty,
        pytest.raises(InputError, match="has no workers; start some"),
    ):
        run_sweep(small(64), scheduler=empty.scheduler_address)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nowhere", "http://127.0.0.1:8786", ""])
def test_an_unreachable_scheduler_is_named_and_nothing_is_lost(monkeypatch, tmp_path, address):
    monkeypatch.setattr(cluster, "CONNECT_S", 0.5)

    def stop(done, total):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(small(64), tmp_path, progress=stop)
    with pytest.raises(InputError, match=r"cannot be reached .*expected the address of a running Dask scheduler"):
        run_sweep(small(64), tmp_path, resume=True, scheduler=address)
    assert len(list((tmp_path / "chunks").iterdir())) == 1


def test_missing_dask_error_gives_install_command(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(
        InputError, match=r"distributed: expected an installed package.*pip install 'forcefeel\[cluster\]'"
    ):
        run_sweep(small(64), scheduler="tcp://127.0.0.1:8786")
