"""Batches: the same bits on any number of threads, in any lane, in pieces; members that fail; the measures."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import forcefeel as ff
from forcefeel._core import GainLaw
from forcefeel.linear.models import Linkage, loader_model
from forcefeel.linear.step import equilibrium
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.simulation import Scenario, simulate, simulate_batch
from forcefeel.simulation.inputs import Step
from forcefeel.simulation.outcome import MEASURES, outputs
from tests.side_by_side import LB

ROUNDING_S = 1e-9
"""Of times that are whole steps of a millisecond."""
SUMMED = 1e-12
"""Relative, and of numbers about one: sums in another order, and times k h of one product or another. Measured: 4e-15."""
READ = 1e-4
"""Relative: an equilibrium by secants and another by matrices, a spline and a polynomial through the same samples."""

LOADER = ff.elevator().replace({"valve.orifice": True, "column.coulomb_friction": "2 lb"})
PLAIN = ff.elevator().replace({"column.coulomb_friction": "2 lb"})
NOISY = LOADER.replace({"controller.period": 1e-3, "load_cell.noise": 0.5, "potentiometer.noise": 1e-5}, si=True)
SCENARIO = Scenario(Step(96 * LB, 0.1), 1.0)
KEEP = tuple(outputs("V"))


def draws(loader, count, seed=1):
    rng = np.random.default_rng(seed)
    values = np.repeat(loader.si_values[np.newaxis], count, axis=0)
    for key, tolerance in loader.tolerances.items():
        values[:, INDEX[key]] = tolerance.sample(rng, count)
    return values


def assert_same(one, other, runs=slice(None), others=slice(None)):
    for name in one.data_vars:
        np.testing.assert_array_equal(one[name].values[runs], other[name].values[others], err_msg=name)


@pytest.fixture(scope="module")
def values():
    return draws(LOADER, 21)


@pytest.fixture(scope="module")
def batch(values):
    return simulate_batch(LOADER, SCENARIO, values, keep=KEEP, threads=1)


@pytest.mark.parametrize("threads", [2, 3])
def test_bits_do_not_depend_on_threads(batch, values, threads):
    assert_same(batch, simulate_batch(LOADER, SCENARIO, values, keep=KEEP, threads=threads))


def test_bits_do_not_depend_on_the_lane(batch, values):
    order = np.random.default_rng(2).permutation(21)
    assert_same(batch, simulate_batch(LOADER, SCENARIO, values[order], keep=KEEP), order)
    for run in (0, 3, 8, 20):
        assert_same(batch, simulate_batch(LOADER, SCENARIO, values[[run]], keep=KEEP), [run])
        single = simulate(Loader("one", "here", values[run]), SCENARIO)
        for name in KEEP:
            np.testing.assert_array_equal(batch[name].values[run], single.history[name].values)
        for name in MEASURES:
            np.testing.assert_array_equal(batch[name].values[run], getattr(single.measures, name))


@pytest.mark.parametrize("cut", [3, 8, 11])
def test_noise_belongs_to_the_run(cut):
    values = np.repeat(NOISY.si_values[np.newaxis], 20, axis=0)
    whole = simulate_batch(NOISY, SCENARIO, values, "original", keep=KEEP)
    first = simulate_batch(NOISY, SCENARIO, values[:cut], "original", keep=KEEP)
    rest = simulate_batch(NOISY, SCENARIO, values[cut:], "original", keep=KEEP, first_run=cut)
    assert_same(whole, first, slice(cut))
    assert_same(whole, rest, slice(cut, None))
    assert len({row.tobytes() for row in whole.column_angle_rad.values}) == 20
    np.testing.assert_array_equal(
        whole.column_angle_rad[0], simulate(NOISY, SCENARIO, "original").history.column_angle_rad
    )


def test_runs_without_index_have_noise_of_first_run():
    values = np.repeat(NOISY.si_values[np.newaxis], 20, axis=0)
    first = simulate_batch(NOISY, SCENARIO, values[:1], "original", keep=KEEP)
    alike = simulate_batch(NOISY, SCENARIO, values, "original", keep=KEEP, first_run=None)
    for run in range(20):
        assert_same(first, alike.isel(run=[run]))


def test_diverged_member_does_not_change_other_members(batch, values):
    broken = values.copy()
    broken[5, INDEX["load_cell.gain"]] *= 1000
    broken[5, INDEX["feel.stiffness"]] *= 1e-4
    found = simulate_batch(LOADER, SCENARIO, broken, keep=KEEP)
    others = np.arange(21) != 5
    assert_same(batch, found, others, others)
    assert found.status.values[5] == "diverged"
    at = found.diverged_at_s.values[5]
    angle = found.column_angle_rad.values[5]
    assert np.all(np.isfinite(angle[found.time_s.values < at - ROUNDING_S]))
    assert np.all(np.isnan(angle[found.time_s.values > at + ROUNDING_S]))
    assert np.abs(angle[round(at * 1000) - 1]) < 10


def test_run_of_nan_is_not_settled(batch, values):
    broken = values.copy()
    broken[7, INDEX["linkage.stiffness"]] = np.nan
    found = simulate_batch(LOADER, SCENARIO, broken, keep=KEEP)
    others = np.arange(21) != 7
    assert_same(batch, found, others, others)
    assert found.status.values[7] == "diverged"


def rest_of(values):
    """Column angle at rest under the force, from the linear model's matrices: friction has no part in it."""
    loader = Loader("one", "here", values)
    model = loader_model(loader, GainLaw.original(values), Linkage.COMPLIANT)
    force = SCENARIO.force.force_n * loader["pilot.force"] / PLAIN["pilot.force"]
    return force * float(np.asarray(model.C)[0] @ equilibrium(model))


def test_measures_match_histories():
    values = draws(PLAIN, 21)
    batch = simulate_batch(PLAIN, replace(SCENARIO, duration_s=2.5), values, keep=KEEP)
    time = batch.time_s.values
    for run in range(21):
        angle, rest = batch.column_angle_rad.values[run], rest_of(values[run])
        off = CubicSpline(time, angle - rest)
        crossings = [at for at in off.roots(extrapolate=False) if at > SCENARIO.force.start_s]
        sides = np.sign(rest) * np.array([off(at) for at in off.derivative().roots(extrapolate=False)])
        periods = batch.periods.values[run]
        whole = int(np.nan_to_num(periods))  # none where friction stretches one swing more than the next
        tail = angle[-(len(angle) // 10) :]
        outside = np.flatnonzero(np.abs(angle - rest) > 0.05 * abs(rest))[-1]
        exact = {
            "maximum_angle_rad": angle.max(),
            "time_of_maximum_s": time[angle.argmax()],
            "minimum_angle_rad": angle.min(),
            "time_of_minimum_s": time[angle.argmin()],
            "final_angle_rad": tail.mean(),
            "settling_time_s": np.nan if outside + 1 == len(angle) else time[outside],
            "last_swing_rad": np.ptp(tail),
            "peak_current_a": np.abs(batch.valve_current_a.values[run]).max(),
            "peak_pressure_pa": np.abs(batch.load_pressure_pa.values[run]).max(),
            "peak_flow_m3_per_s": np.abs(batch.actuator_flow_m3_per_s.values[run]).max(),
            "diverged_at_s": np.inf,
        }
        read = {
            "equilibrium_angle_rad": rest,
            "overshoot": sides.max() / abs(rest),
            "period_s": (crossings[2 * whole] - crossings[0]) / whole if whole else np.nan,
            "periods": periods,
        }
        assert {*exact, *read} == set(MEASURES)
        for expected, within in ((exact, SUMMED), (read, READ)):
            for name, value in expected.items():
                np.testing.assert_allclose(batch[name].values[run], value, rtol=within, atol=SUMMED, err_msg=name)
    assert np.isfinite(batch.period_s.values).sum() >= len(values) // 2
