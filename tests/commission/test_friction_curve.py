"""Friction by speed, direction and place, as a record determines it."""

import math
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

import forcefeel as ff
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.result import Status
from forcefeel.commission import fits
from forcefeel.commission.fits import _curved, without
from forcefeel.commission.observability import ASYMMETRY, BREAKAWAY, DRY, FRICTION_CURVE, SEALS, STRIBECK, with_friction
from forcefeel.commission.sensor_lag import without_lag
from forcefeel.commission.simulated_bench import BenchTime, simulated_records

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import commission as independent

FEW = ["column.inertia", DRY]
ENCODER = dict.fromkeys(("column_sensor.noise", "column_sensor.resolution"), math.tau / 2**20)
NEAR = 0.1  # relative; of a record of 3 s


def fitted(friction):
    """Fits of a machine of this friction with and without its curve, and the machine."""
    loader = ff.digital_elevator().replace(ENCODER, si=True)
    loader = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    truth = loader.replace(friction)
    data = simulated_records(loader, truth, BenchTime(3.0, 500.0))
    start = with_friction(loader)
    even = identify(without(start, FRICTION_CURVE), data, FEW, starts=1)
    return even, _curved(even, start, FRICTION_CURVE, data, None), truth


@pytest.mark.slow
def test_seals_are_identified_and_a_fall_is_never_read_as_a_jump():
    _, curved, truth = fitted({DRY: "1.4 lb", BREAKAWAY: "1.4 lb", SEALS: "10 lb"})
    found = {estimate.unknown.key: estimate for estimate in curved.estimates}
    assert SEALS in found
    assert (BREAKAWAY in found) == (STRIBECK in found)
    for key in (DRY, SEALS):
        assert found[key].value == pytest.approx(truth[key], rel=NEAR)


@pytest.mark.slow
def test_even_friction_gets_no_curve():
    even, curved, truth = fitted({DRY: "1.4 lb", BREAKAWAY: "1.4 lb"})
    found = {estimate.unknown.key: estimate.value for estimate in curved.estimates}
    assert not {BREAKAWAY, STRIBECK, ASYMMETRY, SEALS} & set(found)
    assert found[DRY] == pytest.approx(truth[DRY], rel=NEAR)
    assert even.loader is not None


MEASURED = {DRY: 0.01, BREAKAWAY: 0.05, STRIBECK: 0.15, SEALS: 0.01, ASYMMETRY: 0.025}
"""Bounds, relative; 0.2, 2, 6, 0.6 and 0.6 %, with an offset, which does not fall over a velocity, 2 % of the asymmetry."""


@pytest.mark.slow
@pytest.mark.parametrize("offset_n", [0.0, 2.0])
def test_friction_as_it_is_is_identified_from_a_record_of_an_independent_integrator(offset_n):
    """An offset of the load cell reads as friction that differs by direction; nothing else moves."""
    loader = independent.on_file()
    loader = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    truth = loader.replace({DRY: "2 lb", BREAKAWAY: "2.6 lb", SEALS: "10 lb"})
    truth = truth.replace({STRIBECK: 0.08, ASYMMETRY: 0.2}, si=True)
    [[data]] = independent.witnessed(loader, [truth], [0], BenchTime(8.0, 500.0, seed=3))
    shifted = data.channels | {"load_cell_force": data.channels["load_cell_force"] + offset_n}
    data = without_lag(replace(data, channels=shifted), loader)
    start = with_friction(loader)
    even = identify(without(start, FRICTION_CURVE), [data], FEW, starts=1)
    found = {
        estimate.unknown.key: estimate.value
        for estimate in _curved(even, start, FRICTION_CURVE, [data], None).estimates
    }
    per_load_cell = truth["linkage.ratio"] * truth["column.base_arm"] / truth["column.grip_arm"]
    expected = {key: truth[key] for key in (DRY, BREAKAWAY, STRIBECK, SEALS)}
    expected[ASYMMETRY] = truth[ASYMMETRY] + offset_n * per_load_cell / truth[DRY]
    for key, near in MEASURED.items():
        assert found[key] == pytest.approx(expected[key], rel=near), key


def test_a_fall_beyond_what_a_loader_may_have_leaves_asymmetry_and_seals(monkeypatch):
    def identified(loader, data, keys, **_):
        if BREAKAWAY in keys:
            raise ff.InputError("column.static_friction: expected at least column.coulomb_friction")
        shown = [
            SimpleNamespace(unknown=SimpleNamespace(key=key), status=Status.DETERMINED, value=1.0, low=0.9, high=1.1)
            for key in keys
        ]
        return SimpleNamespace(estimates=shown, loader=loader, keys=tuple(keys))

    monkeypatch.setattr(fits, "identify", identified)
    start = with_friction(ff.digital_elevator())
    curved = _curved(identified(start, (), [DRY]), start, FRICTION_CURVE, (), None)
    assert [estimate.unknown.key for estimate in curved.estimates] == [DRY, ASYMMETRY, SEALS]
    assert curved.loader[BREAKAWAY] == 0
    monkeypatch.setattr(fits, "identify", lambda *_, **__: identified(start, (), [BREAKAWAY]))
    even = identified(start, (), [DRY])
    assert _curved(even, start, [ASYMMETRY], (), None) is even
