"""A machine that is recorded on the bus of its drive, and commissioned."""

from dataclasses import replace

import pytest

import forcefeel as ff
from forcefeel.bus import bench_record
from forcefeel.commission.findings import glance
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.simulated_bench import BenchTime, bench_signal
from forcefeel.commission.steps import BENCH
from tests.live.test_bus import yoke

NEAR = 2e-3
"""Of a record of 8 s in virtual time with the sensors' noise. Measured: 2e-4."""

GUESS = {"column.coulomb_friction": "0.5 N"}


def test_machine_on_its_bus_is_recorded_once_and_identified(tmp_path, monkeypatch):
    hidden = {"column.inertia": "0.0115 kg m^2", "linkage.stiffness": "170 N/mm", "column.coulomb_friction": "0.2 N"}
    played = []

    as_played = bench_record.play

    def play(excitation):
        played.append(excitation)
        return as_played(excitation, real_time=False)

    monkeypatch.setattr(bench_record, "play", play)
    machine = yoke().replace(hidden)
    with ff.live.BusEmulator([machine], real_time=False) as emulator:
        loader = replace(yoke(), bus=replace(yoke().bus, port=emulator.port)).replace(GUESS)
        grid = {"stiffness": "30, 100 %", "frequency": "1, 2 Hz", "damping": "0.3, 1"}
        plan = CommissionPlan(fit=("K_t", "J_m", "k", "J", "F_c"), grid=grid, draws=1)
        for _ in range(2):
            found = ff.commission.commission_loader(
                loader, [], tmp_path, plan, record=lambda: ff.bus.record(loader, 8.0), bench_time=BenchTime(8.0)
            )
    assert len(played) == 1  # the second time its record is there
    assert played[0].law.name == "torque-mode"
    assert (tmp_path / BENCH / "bench.csv").is_file()
    assert found.identified.ok, found.identified
    assert glance(found)[0].result == "record of the machine"
    for key in hidden:
        assert found.loader[key] == pytest.approx(machine[key], rel=NEAR), key


def test_simulated_machine_of_a_loader_with_a_bus_has_the_signal_of_its_law():
    """The record is simulated under ``robust``; a signal for the bus would be one for ``torque-mode``."""
    assert bench_signal(yoke(), BenchTime(4.0, 500.0)).law.name == "robust"
