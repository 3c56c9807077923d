"""Inferred outcomes, held against full runs: of drawn maps and of two loaders."""

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import forcefeel as ff
from forcefeel.cli.envelope import EnvelopeOptions
from forcefeel.envelope.plan import Plan, make_plan
from forcefeel.envelope.refinement import FEWEST, UNKNOWN, rounds
from forcefeel.envelope.result import Envelope
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import Loader

PASSES, UNSTABLE, FAILS = 0, 1, 2
FINE = {"stiffness": "5..100 %:15:log", "frequency": "1.5..4 Hz:9:log", "damping": "0.2, 0.7"}
CHANGES = {"linkage.stiffness": 0.2, "column.inertia": 0.2}


def inferred_map(
    margin: NDArray[np.float64], stable: NDArray[np.bool_]
) -> tuple[NDArray[np.int8], NDArray[np.bool_], NDArray[np.float32]]:
    """Outcome, whether it was run, and margin of a map drawn by its margin, refined as a case of its own."""
    truth = np.where(stable, np.where(margin >= 0, PASSES, FAILS), UNSTABLE)[np.newaxis]
    outcome = np.where(truth == UNSTABLE, UNSTABLE, UNKNOWN).astype(np.int8)
    margins, run = np.full(outcome.shape, np.nan, dtype=np.float32), np.zeros(outcome.shape, dtype=bool)
    for wanted in rounds(outcome, margins, UNSTABLE):
        assert not (wanted & (run | (outcome == UNSTABLE))).any()  # nothing twice, nothing unstable
        outcome[wanted], margins[wanted] = truth[wanted], margin[np.newaxis][wanted]
        run |= wanted
    return outcome[0], run[0], margins[0]


def drawn_map(margin: Callable[..., NDArray[np.float64]]) -> NDArray[np.float64]:
    """Margins over damping, frequency and stiffness, each from 0 to 1."""
    return margin(*np.meshgrid(*(np.linspace(0, 1, size) for size in (6, 16, 25)), indexing="ij"))


MAPS = {
    "edge": lambda d, f, s: 0.9 - f + 0.1 * s + 0.1 * d,
    "sheet at the end": lambda d, f, s: np.where((s > 0.97) & (f + d > 0.5), -0.1, 0.2 - 0.1 * s),
    "corner": lambda d, f, s: 0.3 - np.exp(-8 * (f**2 + (1 - s) ** 2)),
    "ring": lambda d, f, s: np.abs(np.hypot(f - 0.5, s - 0.5) - 0.35) - 0.12,
    "thin line": lambda d, f, s: np.abs(f - s) - 0.05,
}


@pytest.mark.parametrize("name", MAPS)
def test_drawn_map_is_inferred_without_error_from_part_of_its_settings(name: str) -> None:
    margin = drawn_map(MAPS[name])
    stable = np.ones(margin.shape, dtype=bool)
    outcome, run, _ = inferred_map(margin, stable)
    assert ((outcome == PASSES) == (margin >= 0)).all()
    assert run.mean() < 0.8


def test_passing_map_is_run_at_its_coarse_lattice_and_margins_are_bilinear() -> None:
    margin = drawn_map(lambda d, f, s: 0.6 + 0.2 * f + 0.1 * s + 0.05 * f * s)
    outcome, run, margins = inferred_map(margin, np.ones(margin.shape, dtype=bool))
    assert (outcome == PASSES).all()
    assert run.sum() == 6 * 5 * 4  # every fourth of 16 frequencies and the last, every eighth of 25 stiffnesses
    np.testing.assert_allclose(margins, margin, atol=1e-6)  # of single precision


def first_inferred(margin: NDArray[np.float32], code: NDArray[np.int8]) -> int:
    """Settings still to run in the second round if the corners of the coarse cells have these margins and codes."""
    outcome, margins = (
        np.full((1, *margin.shape), UNKNOWN, dtype=np.int8),
        np.full((1, *margin.shape), np.nan, np.float32),
    )
    steps = rounds(outcome, margins, UNSTABLE)
    corners = next(steps)
    outcome[corners], margins[corners] = code[np.newaxis][corners], margin[np.newaxis][corners]
    return int(next(steps).sum())


@pytest.mark.parametrize(
    ("codes", "margins", "refined"),
    [
        ((PASSES, PASSES), (0.5, 0.9), False),
        ((PASSES, PASSES), (0.1, 0.9), True),  # nearer to the limit than half the spread
        ((PASSES, PASSES), (0.5, -np.inf), True),  # a figure is missing at one corner
        ((FAILS, FAILS), (-np.inf, -np.inf), False),
        ((FAILS, FAILS + 1), (-0.5, -0.5), True),
        ((UNSTABLE, UNSTABLE), (np.nan, np.nan), True),
    ],
)
def test_cell_is_inferred_if_its_corners_agree_far_from_the_limit(
    codes: tuple[int, int], margins: tuple[float, float], refined: bool
) -> None:
    shape = (1, 9, 9)
    above = np.arange(9)[:, np.newaxis] * np.ones(shape) > 4
    code = np.where(above, codes[1], codes[0]).astype(np.int8)
    margin = np.where(above, margins[1], margins[0]).astype(np.float32)
    assert bool(first_inferred(margin, code)) is refined


def test_stable_settings_beside_unstable_ones_are_run() -> None:
    margin = drawn_map(lambda d, f, s: np.where(f < 0.95, 0.5, -0.5))
    stable = drawn_map(lambda d, f, s: f + s) < 1.5
    outcome, run, _ = inferred_map(margin, stable)
    assert ((outcome == UNSTABLE) == ~stable).all()
    assert run[:, 1:][stable[:, 1:] & ~stable[:, :-1]].all()
    assert run[:, :-1][stable[:, :-1] & ~stable[:, 1:]].all()


@pytest.fixture(
    scope="module", params=[pytest.param(name, marks=pytest.mark.slow) for name in ("elevator-2khz", "desktop-yoke")]
)
def maps(request: pytest.FixtureRequest) -> tuple[Envelope, Envelope]:
    """Inferred and full map of a loader without noise, whose runs do not depend on their index in a batch."""
    loader = BUILT_IN[request.param]()
    noise = {key: 0.0 for key in loader.given if key.endswith("noise")}
    loader = loader.replace(noise, si=True)
    inferred, full = (
        ff.find_envelope(loader, ["robust"], FINE, changes=CHANGES, arms=(), draws=ff.envelope.Draws(2), full=full)
        for full in (False, True)
    )
    return inferred, full


def test_inferred_map_agrees_with_the_full_one(maps: tuple[Envelope, Envelope]) -> None:
    inferred, full = maps
    differing = [(inferred.data[name] != full.data[name]).to_numpy() for name in ("outcome", "drawn_outcome")]
    marked = [inferred.data[name].to_numpy() for name in ("inferred", "drawn_inferred")]
    settings = inferred.plan.settings.count
    assert sum(int(part.sum()) for part in marked) == inferred.inferred > settings
    assert not any((differs & ~inferred_there).any() for differs, inferred_there in zip(differing, marked, strict=True))
    assert sum(int(part.sum()) for part in differing) <= 0.005 * 7 * settings  # islands smaller than a cell
    assert full.inferred == 0
    assert full.case_shares("robust")[1].passes == pytest.approx(
        inferred.case_shares("robust")[1].passes, abs=0.01
    )  # islands


def test_nominal_case_and_smaller_angles_are_run_whole(maps: tuple[Envelope, Envelope]) -> None:
    by_case = [row.inferred for row in maps[0].case_shares("robust")]
    assert by_case[0] == 0
    assert max(by_case[1:]) > 0


def test_page_json_and_netcdf_say_what_is_inferred(maps: tuple[Envelope, Envelope], tmp_path: Path) -> None:
    for envelope, folder in zip(maps, (tmp_path / "inferred", tmp_path / "full"), strict=True):
        page = ff.envelope.write_envelope(envelope, folder, ff.UnitSystem.SI).read_text(encoding="utf-8")
        results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
        written = xr.load_dataset(folder / "envelope.nc", engine="scipy")
        points = results["releases"] + results["inferred"]
        drawn = int(written["drawn_inferred"].sum())
        by_case = [case["inferred"] for case in results["laws"]["robust"]["cases"]]
        assert points == 7 * envelope.plan.settings.count
        assert results["inferred"] == envelope.inferred == sum(by_case) + drawn
        assert by_case == written["inferred"].sum(["law", "damping", "frequency", "stiffness"]).to_numpy().tolist()
        stated = f"Of the outcomes, {envelope.inferred:,} of {points:,} are inferred from neighbors"
        assert (stated in page.replace("\n", " ")) is bool(envelope.inferred)


@pytest.mark.parametrize("full", [True, False])
def test_option_full_runs_every_setting(full: bool) -> None:
    options = EnvelopeOptions(law=("robust",), full=full)
    assert options.plan(ff.digital_elevator()).inferring is not full


def planned(loader: Loader, **grid: str) -> Plan:
    return make_plan(loader, ["converged" if not loader["controller.period"] else "robust"], {**FINE, **grid})


def test_coarse_grids_and_linear_loaders_are_run_whole() -> None:
    assert planned(ff.digital_elevator()).inferring
    assert not planned(ff.elevator()).inferring
    assert not planned(ff.digital_elevator(), stiffness="1..100 %:15:log").inferring
    assert not planned(ff.digital_elevator(), frequency=f"1..1.1 Hz:{FEWEST - 1}").inferring


def test_full_of_another_type_raises_input_error() -> None:
    with pytest.raises(ff.InputError, match="full: expected true or false"):
        make_plan(ff.digital_elevator(), ["robust"], full=1)  # type: ignore[arg-type]


def test_progress_ends_at_its_constant_total() -> None:
    reports: list[tuple[int, int]] = []
    ff.find_envelope(
        ff.digital_elevator(),
        ["robust"],
        FINE,
        changes=CHANGES,
        arms=(),
        progress=lambda done, total: reports.append((done, total)),
    )
    assert len({total for _, total in reports}) == 1
    assert all(later[0] >= earlier[0] for earlier, later in pairwise(reports))
    assert reports[-1][0] == reports[-1][1]


def test_progress_counts_contacts_and_inferred_cases_by_their_time(maps: tuple[Envelope, Envelope]) -> None:
    plan, full = maps[0].plan, maps[1].plan
    count = plan.settings.count
    nominal, plant, drawn = (plan.usual_releases(case) for case in (plan.cases[0], plan.cases[1], plan.machines[0]))
    assert full.releases == 7 * nominal  # nominal, four plants off their values, two drawn machines
    assert 1.2 * count > nominal > count > drawn > plant > 0  # each with its stability
    assert plan.releases == nominal + 4 * plant + 2 * drawn
    contacts = plan.with_contacts()
    assert contacts.releases - plan.releases == len(contacts.contacts) * plan.contact_releases
    assert 0 < plan.contact_releases < count / 2
