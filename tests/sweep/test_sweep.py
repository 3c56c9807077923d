"""Sweeps: what is drawn, that a run of a sweep is the run by itself, and what is said of all of them."""

import math
import pickle

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

import forcefeel as ff
from forcefeel.conclusions import share_text
from forcefeel.errors import InputError
from forcefeel.loader.parameters import INDEX, TABLE
from forcefeel.seeded_numbers import shares
from forcefeel.simulation import FeelChange, Scenario, simulate
from forcefeel.simulation.inputs import Chirp, Doublet, HandsOff, Step
from forcefeel.simulation.outcome import MEASURES, RunStatus
from forcefeel.sweep import Sweep, run_sweep, text
from forcefeel.sweep.chunk import measure
from forcefeel.sweep.findings import main_measures, sweep_conclusions
from forcefeel.sweep.result import IMPOSSIBLE, SweepResult
from forcefeel.sweep.stability import damping_map
from forcefeel.sweep.summary import QUANTILES, summarize
from forcefeel.units import UnitSystem
from tests.sweeps import PUSH, nonlinear, small

ROUNDING = 1e-12
"""Relative; the same sums in another order."""

SIGNIFICANCE = 1e-3
"""Of a test of the random numbers; their seeds are fixed, so that it passes or fails for good."""


def test_random_numbers_are_uniform_and_independent():
    many = np.array([shares(0, key, 0, 20_000) for key in ("linkage.stiffness", "column.inertia", "valve.rated_flow")])
    assert many.min() > 0
    assert many.max() < 1
    for row in many:
        assert scipy.stats.kstest(row, "uniform").pvalue > SIGNIFICANCE
        assert abs(np.corrcoef(row[:-1], row[1:])[0, 1]) < 4 / math.sqrt(len(row))  # four standard deviations
    others = np.corrcoef(many)[np.triu_indices(3, 1)]
    assert np.abs(others).max() < 4 / math.sqrt(many.shape[1])


@pytest.mark.parametrize(("first", "count"), [(0, 1), (1, 6), (4, 8), (777, 223), (999, 1), (3, 0)])
def test_random_numbers_depend_on_index_only(first, count):
    whole = shares(7, "linkage.stiffness", 0, 1000)
    assert np.array_equal(shares(7, "linkage.stiffness", first, count), whole[first : first + count])


def test_random_numbers_differ_by_seed_and_parameter():
    drawn = [shares(seed, key, 0, 8) for seed in (0, 1) for key in ("feel.inertia", "feel.damping")]
    assert len({tuple(row) for row in drawn}) == len(drawn)


def test_parameter_samples_are_independent_of_other_parameters():
    alone, more = small(), small(vary={"column.base_arm": "1 %"})
    runs = range(13, 77)
    assert np.array_equal(alone.drawn(runs)["linkage.stiffness"], more.drawn(runs)["linkage.stiffness"])


def test_samples_follow_bounds_and_distribution():
    sweep = small(20_000, vary={"load_cell.gain": {"normal": "5 %", "low": "-8 %", "high": "10 %"}})
    drawn = sweep.drawn(range(sweep.total))
    assert set(drawn) == set(sweep.varied) == set(nonlinear().tolerances)
    for key, tolerance in sweep.varied.items():
        assert drawn[key].min() >= tolerance.low
        assert drawn[key].max() <= tolerance.high
    gain, nominal = drawn["load_cell.gain"], nonlinear()["load_cell.gain"]
    bounds = scipy.stats.truncnorm(-8 / 5, 10 / 5, loc=nominal, scale=0.05 * nominal)
    assert scipy.stats.kstest(gain, bounds.cdf).pvalue > SIGNIFICANCE


def test_values_of_piece_equal_values_of_whole():
    for sweep in (
        small(300),
        small(7, grids={"feel.stiffness": "5000..9000 lb in/rad:13", "feel.damping": "100..300 lb in s/rad:3"}),
        small(150, grids={"feel.stiffness": "5000..9000 lb in/rad:2"}),
    ):
        whole = sweep.values(range(sweep.total))
        for start, stop in ((0, 1), (5, 100), (149, 151), (sweep.total - 3, sweep.total)):
            assert np.array_equal(sweep.values(range(start, stop)), whole[start:stop])


def test_every_grid_point_has_same_machines():
    sweep = small(5, grids={"feel.stiffness": [800.0, 900.0, 1000.0], "feel.damping": [20.0, 30.0]})
    drawn = sweep.drawn(range(sweep.total))
    assert sweep.total == 30
    for key in sweep.varied:
        assert np.array_equal(drawn[key].reshape(6, 5), np.tile(drawn[key][:5], (6, 1)))
    points = drawn["feel.stiffness"].reshape(3, 2, 5), drawn["feel.damping"].reshape(3, 2, 5)
    assert (points[0][1] == 900.0).all()
    assert (points[1][:, 1] == 30.0).all()


def test_a_grid_alone_draws_no_machines():
    sweep = Sweep(nonlinear(), PUSH, grids={"feel.stiffness": "288..28800 lb in/rad:5:log"})
    assert (sweep.total, sweep.varied) == (5, {})
    values = sweep.values(range(5))
    ratios = values[1:, INDEX["feel.stiffness"]] / values[:-1, INDEX["feel.stiffness"]]
    assert ratios == pytest.approx([10**0.5] * 4)
    values[:, INDEX["feel.stiffness"]] = nonlinear()["feel.stiffness"]
    assert (values == nonlinear().si_values).all()


def test_grid_without_runs_ignores_tolerances():
    loader = nonlinear().with_tolerances({"controller.period": "5 %"})
    assert Sweep(loader, PUSH, grids={"feel.damping": [20.0, 30.0]}).total == 2
    with pytest.raises(InputError, match=r"vary: controller\.period: all runs of a sweep share it; .* \(none\)"):
        Sweep(loader, PUSH)
    assert "controller.period" not in Sweep(loader, PUSH, vary={"controller.period": "none"}).varied


def test_tolerance_of_grid_parameter_is_ignored():
    sweep = small(5, grids={"linkage.stiffness": "5000..7000 lb/in:3"})
    assert "linkage.stiffness" not in sweep.varied
    assert "linkage.damping" in sweep.varied


def test_sweep_run_equals_single_run():
    """By the second route: the loader of that run, simulated alone."""
    sweep = Sweep(nonlinear().replace({"load_cell.noise": None}), PUSH, law="original", runs=40)
    found = run_sweep(sweep).runs
    for run in (0, 7, 39):
        loader = sweep.loader.with_tolerances(dict.fromkeys(sweep.varied))
        loader = loader.replace({key: float(found[key][run]) for key in sweep.varied}, si=True)
        alone = simulate(loader, PUSH, "original")
        assert str(found["status"].values[run]) == alone.status
        for name in MEASURES:
            want = getattr(alone.measures, name)
            assert float(found[name][run]) == pytest.approx(
                want, rel=1e-9, abs=1e-15, nan_ok=True
            )  # lanes fuse other sums


def test_the_numbers_do_not_depend_on_threads_or_pieces():
    sweep = small(203)
    one, two = (run_sweep(sweep, threads=threads).runs for threads in (1, 2))
    assert one.identical(two)
    whole = measure(sweep, range(203))
    pieces = [measure(sweep, range(a, b)) for a, b in ((0, 8), (8, 120), (120, 203))]
    assert np.array_equal(np.concatenate(pieces), whole, equal_nan=True)
    assert np.array_equal(whole[:, 0], one["maximum_angle_rad"].values)


def test_chunks_cover_every_run_once_and_depend_only_on_sweep():
    for runs in (1, 9, 400, 100_003):
        chunks = small(runs).chunks
        assert [run for chunk in chunks for run in chunk] == list(range(runs))
        assert all(len(chunk) % 16 == 0 for chunk in chunks[:-1])
    assert len(small(400).chunks) > 8


def test_sweep_can_be_pickled():
    sweep = small(30, vary={"feel.damping": "5 %"}, law=ff.laws.GainLaw.original(nonlinear().si_values), seed=3)
    sent = pickle.loads(pickle.dumps(sweep))
    assert np.array_equal(sent.values(range(30)), sweep.values(range(30)))
    assert np.array_equal(measure(sent, range(30)), measure(sweep, range(30)), equal_nan=True)


def test_results_are_labeled():
    found = run_sweep(small(20)).runs
    assert found.sizes == {"run": 20}
    assert found["linkage.stiffness"].attrs["units"] == "N/m"
    assert found["linkage.stiffness"].dims == ("run",)
    assert found["final_angle_rad"].attrs["units"] == "rad"
    assert set(map(str, found.coords)) == {*nonlinear().tolerances}


def test_fixed_law_is_used_for_all_machines():
    loader = ff.elevator()
    law = ff.laws.GainLaw.original(loader.si_values)
    own, fixed = (run_sweep(Sweep(loader, PUSH, given, runs=16)).runs for given in (None, law))
    assert not np.array_equal(own["final_angle_rad"], fixed["final_angle_rad"])


# What can go wrong with a member.


def test_diverged_run_has_status_and_other_runs_are_kept():
    sweep = Sweep(ff.elevator(), Scenario(Step(427.0, 0.1)), grids={"feel.inertia": "2..200 lb in s^2/rad:9:log"})
    found = run_sweep(sweep)
    status = found.runs["status"].values
    assert {"diverged", "settled"} <= set(status)
    assert np.isfinite(found.runs["final_angle_rad"].values[status == "settled"]).all()
    assert np.isfinite(found.runs["diverged_at_s"].values[status == "diverged"]).all()
    assert np.isnan(found.map("overshoot").values[status == "diverged"]).all()
    # The linear model agrees on which.
    damping = damping_map(sweep)
    assert ((damping.values < 0) >= (status == "diverged")).all()


def test_impossible_machine_has_status_and_other_runs_are_kept():
    vary = {"column.coulomb_friction": "1 lb..3 lb", "column.static_friction": "2..4 lb"}
    sweep = small(300, vary=vary)
    found = run_sweep(sweep)
    cannot = found.runs["column.static_friction"] < found.runs["column.coulomb_friction"]
    assert 0 < cannot.sum() < 100
    assert np.array_equal(found.runs["status"].values == IMPOSSIBLE, cannot)
    assert np.isnan(found.runs["final_angle_rad"].values[cannot]).all()
    assert np.isfinite(found.runs["final_angle_rad"].values[~cannot]).all()
    assert found.reasons == {"column.static_friction is below column.coulomb_friction": int(cannot.sum())}
    summary = summarize(found)
    assert summary.spreads["final_angle_rad"].runs == int((~cannot).sum())
    assert "are impossible and were not run" in " ".join(sweep_conclusions(found, summary, UnitSystem.US).findings)
    # The same machine alone is refused for the same reason.
    bad = int(np.argmax(cannot.values))
    with pytest.raises(InputError, match=r"column\.static_friction: expected at least column\.coulomb_friction"):
        sweep.loader.replace({key: float(found.runs[key][bad]) for key in vary}, si=True)


# What is said of all runs.


@pytest.fixture(scope="module")
def result():
    return run_sweep(Sweep(ff.elevator(), Scenario(Step(427.0, 0.1), duration_s=1.0), runs=1500))


def test_quantiles_and_correlations_match_scipy(result):
    summary, runs = summarize(result), result.runs
    for name in ("overshoot", "final_angle_rad", "peak_flow_m3_per_s"):
        spread = summary.spreads[name]
        assert spread.quantiles == pytest.approx(np.quantile(runs[name].values, QUANTILES), rel=ROUNDING)
        for key in ("load_cell.gain", "linkage.stiffness", "column.inertia"):
            want = scipy.stats.spearmanr(runs[name].values, runs[key].values).statistic
            assert float(summary.correlations.sel(measure=name, parameter=key)) == pytest.approx(want, abs=ROUNDING)
    noise = scipy.stats.norm.ppf(0.975) / math.sqrt(1499)
    assert summary.chance == pytest.approx(noise, rel=ROUNDING)


def test_large_sweep_is_correlated_over_evenly_spread_runs(result, monkeypatch):
    monkeypatch.setattr("forcefeel.sweep.result.SAMPLE_RUNS", 499)
    few = result.runs.isel(run=slice(None, None, 4))
    correlated = summarize(SweepResult(result.sweep, result.runs))
    want = scipy.stats.spearmanr(few["overshoot"].values, few["column.inertia"].values).statistic
    assert few.sizes["run"] == 375
    assert float(correlated.correlations.sel(measure="overshoot", parameter="column.inertia")) == pytest.approx(
        want, abs=ROUNDING
    )
    assert correlated.chance == pytest.approx(scipy.stats.norm.ppf(0.975) / math.sqrt(374), rel=ROUNDING)


def test_shares_have_wilson_interval(result):
    for share in summarize(result).shares:
        want = scipy.stats.binomtest(share.runs, 1500).proportion_ci(method="wilson")
        assert (share.low, share.high) == pytest.approx((want.low, want.high), abs=ROUNDING)
        assert share.share == share.runs / 1500


def test_a_force_that_varies_scales_a_linear_loader(result):
    """What is known without a simulation: the angle goes with the force, so that its correlation is one."""
    loader = ff.elevator().with_tolerances({**dict.fromkeys(ff.elevator().tolerances), "pilot.force": "10 %"})
    found = run_sweep(Sweep(loader, PUSH, runs=50))
    per_force = found.runs["final_angle_rad"] / found.runs["pilot.force"]
    assert per_force.values == pytest.approx([found.nominal.final_angle_rad / loader["pilot.force"]] * 50, rel=ROUNDING)
    assert summarize(found).ranking("final_angle_rad") == [("pilot.force", pytest.approx(1.0))]


def test_a_map_is_the_median_of_the_machines_at_each_point():
    sweep = small(9, grids={"feel.stiffness": [800.0, 1000.0, 1200.0], "feel.damping": [20.0, 35.0]})
    found = run_sweep(sweep)
    over = found.map("overshoot")
    assert over.dims == ("feel.stiffness", "feel.damping")
    assert over["feel.damping"].attrs["units"] == "N m s/rad"
    here = (found.runs["feel.stiffness"] == 1000.0) & (found.runs["feel.damping"] == 35.0)
    want = np.median(found.runs["overshoot"].values[here.values])
    assert float(over.sel({"feel.stiffness": 1000.0, "feel.damping": 35.0})) == pytest.approx(want, rel=ROUNDING)
    total = sum(found.share_map(status) for status in ("settled", "moving", "diverged", "impossible"))
    assert np.allclose(total.values, 1.0)


def test_the_damping_map_changes_sign_where_the_loader_becomes_unstable():
    loader = ff.elevator()
    edge = ff.linear.smallest_stable_stiffness(loader).stiffness_n_m_per_rad
    scale = edge / loader["feel.stiffness"]
    at_edge = loader.scale_feel(scale)
    grids = {
        "feel.stiffness": [0.98 * edge, 1.02 * edge],
        "feel.inertia": [at_edge["feel.inertia"] * k for k in (0.98, 1.02)],
    }
    base = loader.replace({"feel.damping": at_edge["feel.damping"]}, si=True)
    damping = damping_map(Sweep(base, PUSH, grids=grids)).values
    assert damping[0, 0] < 0 < damping[1, 1]


def test_envelope_contains_the_runs(result):
    envelope = result.envelope["column_angle_rad"]
    assert (np.diff(envelope.values, axis=0) >= 0).all()
    first = result.runs["maximum_angle_rad"].values[:400]
    assert float(envelope.sel(edge="highest").max()) == pytest.approx(first.max(), rel=ROUNDING)


def test_conclusions_name_largest_effect(result):
    summary = summarize(result)
    found = sweep_conclusions(result, summary, UnitSystem.US)
    assert "of 1,500 loaders" in found.verdict or "All 1,500 loaders" in found.verdict
    assert "overshoot" in found.verdict
    assert "has the largest effect on it" in found.verdict
    assert not any(len(word) > 40 for word in " ".join(found.findings).split())


@pytest.mark.parametrize(
    ("share", "said"), [(1.0, "100 %"), (0.99996, "99.996 %"), (0.9712, "97.1 %"), (0.0, "0 %"), (2e-5, "0.002 %")]
)
def test_incomplete_share_is_not_formatted_as_all(share, said):
    assert share_text(share) == said


@pytest.mark.parametrize(
    ("force", "first"), [(Step(400.0, 0.1), "overshoot"), (Chirp(100.0, 0.5, 5.0, 1.0), "maximum_angle_rad")]
)
def test_the_headline_measure_fits_the_input(force, first):
    found = run_sweep(Sweep(ff.elevator(), Scenario(force, duration_s=1.0), runs=24))
    assert main_measures(found, summarize(found))[0] == first


def test_returning_inputs_use_settling_time_not_overshoot():
    found = run_sweep(Sweep(ff.elevator(), Scenario(Doublet(100.0, 0.1, 0.2), duration_s=3.0), runs=24))
    assert np.isnan(found.runs["overshoot"].values).all()
    measures = main_measures(found, summarize(found))
    assert "settling_time_s" in measures
    assert "overshoot" not in measures


def test_runs_without_an_overshoot_are_counted_and_the_reason_is_given():
    loader = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    vary = {"column.coulomb_friction": "2 lb..60 lb"}  # of which most hold 50 N fast
    found = run_sweep(Sweep(loader, Scenario(Step(50.0, 0.1), duration_s=1.0), runs=40, vary=vary))
    none = int(np.isnan(found.runs["overshoot"].values).sum())
    assert 0 < none < 40
    said = " ".join(sweep_conclusions(found, summarize(found), UnitSystem.US).findings)
    assert f"{none} have none: the column ends where it began, meets a stop," in said


def test_sweep_without_motion_reports_all_settled():
    found = run_sweep(Sweep(ff.elevator(), Scenario(HandsOff(), duration_s=0.2), runs=8))
    assert "All 8 loaders settle" in sweep_conclusions(found, summarize(found), UnitSystem.SI).verdict


# Bad input.


def bad(**options):
    loader = options.pop("loader", nonlinear())
    scenario = options.pop("scenario", PUSH)
    return Sweep(loader, scenario, **options)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"runs": 0}, "runs: expected a whole number from 1 to 10,000,000, got 0"),
        ({"runs": 2.5}, "runs: expected a whole number"),
        ({"seed": None}, "seed: expected a whole number"),
        ({"seed": -1}, "seed: expected a whole number from 0"),
        (
            {"vary": {"linkage.stifness": "20 %"}},
            "unknown parameter 'linkage.stifness'; did you mean linkage.stiffness?",
        ),
        ({"vary": {"valve.orifice": "20 %"}}, "valve.orifice: all runs of a sweep share it"),
        ({"vary": {"controller.period": "20 %"}}, "controller.period: all runs of a sweep share it"),
        ({"grids": {"controller.delay": "0..1 ms:4"}}, "grid: controller.delay: all runs of a sweep share it"),
        (
            {"vary": {"linkage.ratio": "0.5..1.5"}},
            "vary: linkage.ratio: out of range: expected bounds within 0.01 to 1",
        ),
        ({"vary": {"linkage.ratio": "{ low = }"}}, "vary: linkage.ratio: expected a table as a loader file has it"),
        ({"vary": {"linkage.stiffness": "lots"}}, "vary: linkage.stiffness: expected a tolerance such as"),
        (
            {"vary": {"linkage.stiffness": "1 lb..5 lb"}},
            "vary: linkage.stiffness: uniform: expected a number with its unit",
        ),
        ({"vary": {"feel.breakout": "20 %"}}, "a share of feel.breakout, which is off, says nothing"),
        (
            {"grids": {"feel.stiffness": "fine"}},
            "grid: feel.stiffness: expected from..to:how many, or from..to:how many:log",
        ),
        (
            {"grids": {"feel.stiffness": "1..2 lb in/rad:1"}},
            "grid: feel.stiffness: expected 2 to 10,000 values, got '1'",
        ),
        (
            {"grids": {"feel.stiffness": "9..2 lb in/rad:5"}},
            "expected a first value below the last, got '9..2 lb in/rad'",
        ),
        ({"grids": {"feel.damping": "0..2 lb in s/rad:5:log"}}, "expected a first value above 0 (log)"),
        ({"grids": {"feel.stiffness": "1..2 furlong:5"}}, "unknown unit 'furlong'"),
        ({"grids": {"feel.stiffness": "0..2 lb in/rad:5"}}, "grid: feel.stiffness: out of range"),
        ({"grids": {"feel.stiffness": [3.0, 2.0]}}, "expected 2 to 10,000 rising values"),
        ({"grids": {"feel.stiffness": 3.0}}, "expected text or numbers, got 3.0"),
        (
            {"grids": {key: [1.0, 2.0] for key in ("feel.stiffness", "feel.damping", "feel.inertia")}},
            "one or two parameters",
        ),
        ({"grids": {"feel.damping": [1.0, 2.0]}, "vary": {"feel.damping": "2 %"}}, "given as a grid and to vary"),
        ({"grids": {"feel.damping": [1.0, 2.0]}, "vary": {"feel.inertia": "2 %"}}, "at a grid say how many machines"),
        (
            {"runs": 9_000_000, "grids": {"feel.damping": [1.0, 2.0]}},
            "expected at most 10,000,000 in all, got 18,000,000",
        ),
    ],
)
def test_bad_sweeps_are_refused_with_a_remedy(options, said):
    with pytest.raises(InputError) as refused:
        bad(**options)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_loader_without_tolerances_raises_error_with_remedy():
    loader = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    with pytest.raises(
        InputError, match=r"nothing varies: elevator-1974 has no tolerances; add a section \[tolerances\]"
    ):
        Sweep(loader, PUSH)
    with pytest.raises(InputError, match="all machines at a point are the same; leave --runs out"):
        Sweep(loader, PUSH, runs=4, grids={"feel.damping": [1.0, 2.0]})


def test_shares_beyond_parameter_range_are_refused():
    """A loader may hold them, because they follow a value that moves; no machine may have them."""
    loader = nonlinear().with_tolerances({"linkage.ratio": "20 %"}).replace({"linkage.ratio": 0.95}, si=True)
    with pytest.raises(InputError, match=r"tolerances\.linkage\.ratio: out of range: .* narrow it"):
        Sweep(loader, PUSH)
    assert Sweep(loader, PUSH, vary={"linkage.ratio": "5 %"}).total == 10_000


def test_grid_of_ineffective_parameter_is_refused():
    angles = {"column.gravity_angle": "0..90 deg:3"}
    with pytest.raises(InputError, match=r"grid: column\.gravity_angle: has no effect without column\.gravity_torque"):
        Sweep(nonlinear(), PUSH, grids=angles)
    assert Sweep(nonlinear(), PUSH, grids={**angles, "column.gravity_torque": "0..90 lb in:3"}).total == 9


PIECES = st.sampled_from(
    ["1", "5 lb", "..", "20 %", ":", "3", "log", "lb in/rad", "-", "none", "{", "}", "uniform", " ", "1e999", "é"]
)


@given(st.sampled_from(list(TABLE)), st.lists(PIECES, max_size=6).map("".join))
def test_random_text_is_sweep_or_one_line_error(key, stated):
    assert good_or_refused(key, vary={key: stated})
    assert good_or_refused(key, grids={key: stated})


def good_or_refused(key, **options):
    """Whether a sweep is taken, or refused in a line that names the parameter; any other error passes through."""
    try:
        return bad(**options).total >= 1
    except InputError as error:
        return key in str(error) and "\n" not in str(error)


def test_a_feel_that_varies_and_changes_is_refused():
    scenario = Scenario(Step(400.0, 0.1), feel_changes=(FeelChange(0.5, {"feel.damping": 20.0}),))
    with pytest.raises(InputError, match="feel_changes: give every machine the nominal feel"):
        bad(scenario=scenario, vary={"feel.damping": "5 %"})
    assert bad(scenario=scenario).total == 10_000


def test_tolerance_can_be_removed():
    sweep = bad(vary={"linkage.stiffness": "none", "linkage.damping": None})
    assert not {"linkage.stiffness", "linkage.damping"} & set(sweep.varied)


@pytest.mark.parametrize(
    ("stated", "low", "high"),
    [("20 %", 0.8, 1.2), ("-10 %..20 %", 0.9, 1.2), ('{ uniform = ["-5 %", "5 %"] }', 0.95, 1.05)],
)
def test_tolerance_text_is_read(stated, low, high):
    tolerance = bad(vary={"feel.damping": stated}).varied["feel.damping"]
    nominal = nonlinear()["feel.damping"]
    assert (tolerance.low, tolerance.high) == pytest.approx((low * nominal, high * nominal))


def test_first_bound_takes_unit_of_last_bound():
    per_lb = TABLE["column.coulomb_friction"].default_si / TABLE["column.coulomb_friction"].default_us
    for stated in ("1 lb..5 lb", "1..5 lb", "1.0e0 .. 5 lb"):
        tolerance = bad(vary={"column.coulomb_friction": stated}).varied["column.coulomb_friction"]
        assert (tolerance.low, tolerance.high) == pytest.approx((per_lb, 5 * per_lb))


@pytest.mark.parametrize("given", ["linkage.stiffness", "=3", "linkage.stiffness="])
def test_an_assignment_needs_both_sides(given):
    with pytest.raises(InputError, match=r"expected part\.name=value such as 'a=b'"):
        text.assignment(given, "a=b")


def test_statuses_match_run_statuses():
    assert {str(status) for status in RunStatus} | {IMPOSSIBLE} == {"settled", "moving", "diverged", "impossible"}
