"""Sweeps in which each setting of the feel has a law designed for itself: beside single designs and runs, one by one."""

import json

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.laws.analog.recursion import published_settings
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.outcome import MEASURES
from forcefeel.sweep import Sweep, identity, run_sweep
from forcefeel.sweep.chunk import measure
from tests.parametrization import mostly_slow
from tests.sweeps import PUSH, nonlinear

STIFFNESS = (500.0, 1000.0, 2000.0)
INERTIA = (4.0, 7.0, 12.0)
GRID = {"feel.stiffness": STIFFNESS, "feel.inertia": INERTIA}

DESIGNS = {"published": published_settings, "converged": lambda _: ff.laws.DesignSettings()}

SOLVED = 1e-11
"""Relative: one recursion of hundreds of steps, alone and side by side with others. Measured: 7e-14."""
# A column's angle to 1e-9 of a radian: the gains of a fixed point and of a recursion stopped at 1e-10 of the largest, and lanes
# fuse other sums.
CLOSE = {"rel": 2e-6, "abs": 1e-9}


# Steps of 1 ms beside a linear run that is exact.
STEPPED = {"rel": 1e-4, "abs": 1e-6}


def analog():
    """Without noise, of which each run of a sweep has its own."""
    return nonlinear().replace({"load_cell.noise": None, "controller.period": None})


def alone(loader, design, at):
    """The run of one setting: its law designed for ``loader`` at this feel, the machine with all of ``at``."""
    feel = {key: at[key] for key in FEEL_SETTING if key in at}
    designed = loader.replace(feel, si=True)
    law = ff.design_gains(designed, design).law(designed)
    bare = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    return simulate(bare.replace(at, si=True), PUSH, law)


def assert_same(runs, k, run):
    assert str(runs["status"].values[k]) == run.status
    close = CLOSE if run.method == "stepped" else STEPPED
    for name in MEASURES:
        assert float(runs[name][k]) == pytest.approx(getattr(run.measures, name), **close, nan_ok=True), name


@pytest.mark.parametrize("name", mostly_slow(DESIGNS))
@pytest.mark.parametrize("machine", [ff.elevator, analog], ids=["linear", "nonlinear"])
def test_each_grid_point_uses_law_of_its_setting(name, machine):
    loader = machine()
    design = DESIGNS[name](loader)
    runs = run_sweep(Sweep(loader, PUSH, design, grids=GRID)).runs
    assert runs.sizes == {"run": 9}
    for k in range(9):
        at = {key: float(runs[key][k]) for key in GRID}
        assert_same(runs, k, alone(loader, design, at))


def test_laws_per_setting_differ_from_fixed_law():
    loader = analog()
    one = run_sweep(Sweep(loader, PUSH, ff.design_gains(loader).law(loader), grids=GRID)).runs
    own = run_sweep(Sweep(loader, PUSH, published_settings(loader), grids=GRID)).runs
    apart = np.abs(one["maximum_angle_rad"] - own["maximum_angle_rad"]).values
    assert apart.max() > 1e-3


def test_varied_machine_uses_law_of_its_feel():
    """A varied feel is designed anew; a varied plant meets what was designed for the nominal one at that feel."""
    loader = analog()
    design = published_settings(loader)
    sweep = Sweep(loader, PUSH, design, runs=24, vary={"feel.damping": "30 %", "feel.stiffness": "20 %"})
    runs = run_sweep(sweep).runs
    for k in (0, 5, 23):
        at = {key: float(runs[key][k]) for key in sweep.varied}
        assert "linkage.stiffness" in at
        assert_same(runs, k, alone(loader, design, at))


def test_grid_of_feel_and_plant_parameters_uses_setting_laws():
    loader = analog()
    sweep = Sweep(
        loader, PUSH, published_settings(loader), grids={"feel.stiffness": STIFFNESS, "column.inertia": [2.0, 3.0]}
    )
    law = sweep.law_of(sweep.values(range(6))).numbers.gains
    assert law.shape == (6, 7)
    assert np.array_equal(law[0::2], law[1::2])  # the inertia varies fastest, and the law does not see it
    assert len(np.unique(law, axis=0)) == 3
    assert not law[:, 6].any()
    for k in (1, 4):
        at = {key: float(values[k]) for key, values in sweep.drawn(range(6)).items()}
        assert_same(run_sweep(sweep).runs, k, alone(loader, published_settings(loader), at))


def test_the_numbers_do_not_depend_on_threads_or_pieces():
    loader = nonlinear()
    sweep = Sweep(loader, PUSH, published_settings(loader), runs=100, vary={"feel.damping": "30 %"})
    whole = measure(sweep, range(100))
    pieces = [measure(sweep, range(a, b), threads=1) for a, b in ((0, 8), (8, 57), (57, 100))]
    assert np.array_equal(np.concatenate(pieces), whole, equal_nan=True)


def test_nominal_law_matches_design_for_nominal_loader():
    loader = nonlinear()
    sweep = Sweep(loader, PUSH, published_settings(loader), grids=GRID)
    want = ff.design_gains(loader).law(loader)
    assert np.allclose(sweep.nominal_law.numbers.law.gains, want.gains, rtol=SOLVED, atol=0)
    assert sweep.nominal_law.numbers.law.load_cell_arm == want.load_cell_arm


@pytest.mark.slow
def test_sweep_resumes_only_with_same_design(tmp_path):
    loader = nonlinear()
    sweep = Sweep(loader, PUSH, published_settings(loader), grids={"feel.stiffness": "2000..20000 lb in/rad:64"})

    def stop(done, total):
        if done > total / 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(sweep, tmp_path, progress=stop)
    plan = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert plan["law"]["kind"] == "DesignSettings"
    assert plan["law"]["horizon_s"] == 0.05
    other = Sweep(loader, PUSH, ff.laws.DesignSettings(), grids=dict(sweep.grids))
    with pytest.raises(InputError, match=r"law\.horizon_s: 0\.05 there, null here"):
        run_sweep(other, tmp_path, resume=True)
    one = Sweep(loader, PUSH, ff.design_gains(loader).law(loader), grids=dict(sweep.grids))
    assert identity.digest(identity.identity(one)) != plan["sweep"]
    assert run_sweep(sweep, tmp_path, resume=True).runs.identical(run_sweep(sweep).runs)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            {"runs": 20},
            "none of feel.inertia, feel.damping, feel.stiffness varies; give one law, or leave --redesign out",
        ),
        ({"grids": {"linkage.stiffness": [1e6, 2e6]}}, "none of feel.inertia, feel.damping, feel.stiffness varies"),
        (
            {"grids": {"feel.stiffness": STIFFNESS, "linkage.ratio": [0.8, 0.9]}},
            "keep that as it is, such as --vary linkage.ratio=none",
        ),
    ],
)
def test_unsupported_redesign_is_refused(options, said):
    with pytest.raises(InputError) as refused:
        Sweep(nonlinear(), PUSH, ff.laws.DesignSettings(), **options)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_impossible_design_is_refused_before_sweep():
    whole = ff.laws.DesignSettings(q=tuple(map(tuple, np.eye(7).tolist())))
    with pytest.raises(InputError, match="leave out q"):
        Sweep(nonlinear(), Scenario(PUSH.force), whole, grids=GRID)
