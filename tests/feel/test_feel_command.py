"""``forcefeel feel`` as a user types it: files, intervals, page; bad input is named, and nothing is written."""

import json
import math

import numpy as np
import pytest

import forcefeel as ff
from tests.command_line import runs
from tests.feel_witness import Control

run = runs("feel")

ROUNDED_N = 0.05
"""The forces have one decimal."""
MOTION = 0.02
"""Relative; of inertia and damping from a release with 0.02 deg of noise."""
ROUNDING = 1e-6
"""Relative; of points without noise."""

TEN = "position (deg),force (N)\n" + "".join(
    f"{x},{6 * x + 14 * math.copysign(1, x):.1f}\n" for x in (-15, 11, -7, 3, -1.5, 1.5, -3, 7, -11, 15)
)
"""Ten points in any order, each on the way out: 6 N/deg, 8 N of breakout and 6 N of friction."""


@pytest.fixture
def ten(tmp_path):
    (tmp_path / "flight.csv").write_text(TEN, encoding="utf-8")
    return ("--from", "flight.csv", "--out", "my.toml")


def write(folder, name, head, rows):
    (folder / name).write_text("\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n", encoding="utf-8")


@pytest.mark.slow
def test_ten_points_become_a_loader_file_with_intervals_and_a_page(run, ten, tmp_path):
    (tmp_path / "my.toml").write_text("there", encoding="utf-8")
    words = ("--friction", "6 N", "--frequency", "2 Hz", "--damping", "0.3", "--units", "si", "--report", "page")
    assert run(*ten, *words)[0] == 2
    status, out, err = run(*ten, *words, "--replace")
    assert (status, err) == (0, "")
    assert "feel.breakout" in out
    assert "±" in out
    assert "each is taken as moving away from neutral" in " ".join(out.split())
    loader = ff.load(tmp_path / "my.toml")
    assert loader["feel.breakout"] == pytest.approx(8.0, abs=ROUNDED_N)
    assert loader["feel.coulomb_friction"] == pytest.approx(6.0)
    assert math.sqrt(loader["feel.stiffness"] / loader["feel.inertia"]) == pytest.approx(4 * math.pi)
    assert {path.name for path in (tmp_path / "page").iterdir()} == {"feel.html", "results.json", "plotly.min.js"}
    text = (tmp_path / "page" / "feel.html").read_text(encoding="utf-8")
    for part in ("Force over position", "points, rising", "points, falling", "feel, rising", "Rows of the feel"):
        assert part in text
    assert "No point beyond 15 deg: up to the throw of 20 deg the feel is extrapolated." in text


@pytest.mark.slow
def test_printed_json_is_that_of_the_folder(run, ten, tmp_path):
    status, out, _ = run(*ten, "--json", "--report", "page")
    printed = json.loads(out)
    stored = json.loads((tmp_path / "page" / "results.json").read_text(encoding="utf-8"))
    assert status == 0
    assert {key: value for key, value in printed.items() if key not in ("loader_file", "knots", "page")} == stored
    assert stored["rows"]["feel.breakout"]["half_interval"]["unit"] == "lb"


@pytest.mark.slow
@pytest.mark.parametrize(("tests", "passed"), [(("static",), 1), pytest.param((), 7, marks=pytest.mark.slow)])
def test_loader_qualifies_against_the_ten_points(run, ten, tmp_path, tests, passed):
    assert run("elevator-2khz", *ten, "--friction", "6 N", "--frequency", "2 Hz", "--damping", "0.4")[0] == 0
    setup = ff.qualification.QualificationSetup(laws=("robust",), tests=tests, references=("flight.csv",))
    qualification = ff.qualify_loader(ff.load("my.toml"), setup)
    assert [str(result.outcome) for result in qualification.sections[0].results] == ["passed"] * passed
    assert qualification.reference.startswith("10 points of flight.csv at rest; in motion the programmed feel alone")
    ff.qualification.write_qualification(qualification, tmp_path / "tests")
    assert '"mode":"markers"' in (tmp_path / "tests" / "qualification.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_release_gives_frequency_and_damping(run, ten, tmp_path):
    record = Control(damping=14.0).released(8.0, noise_deg=0.02)
    write(tmp_path, "release.csv", "time (s),position (rad)", zip(record.time_s, record.position, strict=True))
    status, out, err = run(*ten, "--friction", "6 N", "--release", "release.csv", "--json", "--units", "si")
    rows = json.loads(out)["rows"]
    assert (status, err) == (0, "")
    assert rows["feel.inertia"]["value"]["value"] == pytest.approx(1.6, rel=MOTION)
    assert rows["feel.damping"]["value"]["value"] == pytest.approx(14.0, rel=MOTION)
    assert 0 < rows["feel.natural_frequency"]["half_interval"]["value"] < 0.02
    assert rows["feel.damping_ratio"]["source"] == "release"


def test_condition_selects_its_points_and_is_named(run, tmp_path):
    points = [(x, q, (0.05 * q) * x + math.copysign(8, x)) for q in (60, 120) for x in (-9, -6, -3, 3, 6, 9)]
    write(tmp_path, "flight.csv", "position (deg),q (lb/ft^2),force (lb)", points)
    status, out, err = run("--from", "flight.csv", "--out", "my.toml")
    assert (status, out) == (2, "")
    assert "has 2 flight conditions: dynamic pressure=60 lb/ft^2; dynamic pressure=120 lb/ft^2; expected one" in err
    for q in (60, 120):
        name = f"{q}.toml"
        assert run("--from", "flight.csv", "--condition", f"q={q} lb/ft^2", "--out", name)[0] == 0
        loader = ff.load(tmp_path / name)
        slope = loader["feel.stiffness"] / loader["column.grip_arm"] / 4.4482216152605 * math.pi / 180
        assert slope == pytest.approx(0.05 * q, rel=ROUNDING)
        assert f"dynamic pressure={q} lb/ft^2" in loader.source


def test_conditions_become_knots_of_a_schedule(run, tmp_path):
    """Inertia and damping are those of the selected condition; the spring rates are proportional to the dynamic pressure."""
    points = [(x, q, (0.05 * q) * x + math.copysign(2, x)) for q in (60, 120) for x in (-9, -6, -3, 3, 6, 9)]
    write(tmp_path, "flight.csv", "position (deg),q (lb/ft^2),force (lb)", points)
    words = ("--from", "flight.csv", "--condition", "q=120 lb/ft^2", "--frequency", "2 Hz", "--out", "my.toml")
    assert run(*words, "--knots", "knots.csv")[0] == 0
    knots = ff.flight_schedule.read_knots(tmp_path / "knots.csv")
    loader = ff.load(tmp_path / "my.toml")
    assert [(axis.name, axis.unit) for axis in knots.axes] == [("dynamic pressure", "lb/ft^2")]
    assert knots.axes[0].values == pytest.approx((60, 120))
    inertia, damping, stiffness = knots.feel.T
    shown = 1e-5  # relative; knots have six digits
    assert inertia == pytest.approx([loader["feel.inertia"]] * 2, rel=shown)
    assert damping == pytest.approx([loader["feel.damping"]] * 2, rel=shown)
    assert stiffness == pytest.approx([loader["feel.stiffness"] / 2, loader["feel.stiffness"]], rel=shown)


@pytest.mark.slow
def test_data_sheet_gives_the_drive(run, ten, tmp_path):
    (tmp_path / "motor.toml").write_text(
        '[winding]\nresistance_phase = "0.5 ohm"\ninductance_phase = "1 mH"\n', encoding="utf-8"
    )
    assert run("elevator-electric", *ten, "--data-sheet", "motor.toml")[0] == 0
    assert ff.load(tmp_path / "my.toml")["winding.resistance"] == pytest.approx(0.5)
    status, _, err = run("elevator-2khz", *ten, "--data-sheet", "motor.toml", "--replace")
    assert status == 2
    assert "a data sheet takes a loader with an electric drive" in err


def test_knots_need_several_conditions(run, ten, tmp_path):
    status, _, err = run(*ten, "--knots", "knots.csv")
    assert status == 2
    assert "flight.csv: expected two flight conditions for knots, got one" in err
    assert [path.name for path in tmp_path.iterdir()] == ["flight.csv"]


BAD = {
    "turns back": (
        "position (deg),force (N),direction",
        [(-9, -60, 1), (-3, -25, 1), (0, 5, 1), (3, 25, 1), (6, 60, 1), (9, 40, 1)],
        ("turns back: 60 N at 6 deg, and 40 N at 9 deg", "flight conditions"),
    ),
    "turns back without directions": (
        "position (deg),force (N)",
        [(-9, -60), (-3, -25), (3, 25), (6, 60), (7, 40), (8, 25), (9, 5)],
        ("turns back: 60 N at 6 deg, and 5 N at 9 deg", "flight conditions"),
    ),
    "no unit": ("position,force (N)", [(-1, -1), (1, 1)], ("position: has no unit", "add it to the header")),
    "unknown unit": ("position (flurb),force (N)", [(-1, -1), (1, 1)], ("unknown unit 'flurb'",)),
    "too few": (
        "position (deg),force (N)",
        [(-3, -20), (3, 20), (6, 40)],
        ("expected 5 points at least, at 3 or more positions, got 3 at 3",),
    ),
    "negative friction": (
        "position (deg),force (N),direction",
        [(x, 6 * x - 5 * d, d) for d in (1, -1) for x in (-9, -6, -3, 0, 3, 6, 9)],
        ("negative friction: the force on the way up lies 10 N below",),
    ),
    "reversed sign": (
        "position (deg),force (N)",
        [(x, -6 * x) for x in (-9, -6, -3, 3, 6, 9)],
        ("the force falls as the position rises", "change the sign of one column"),
    ),
    "two conditions without a column": (
        "position (deg),force (N)",
        [(x, k * x) for k in (5, 11) for x in (-9, -6, -3, 3, 6, 9)],
        ("scatter by", "'dynamic pressure (Pa)'"),
    ),
    "direction": (
        "position (deg),force (N),direction",
        [(x, 6 * x, 2) for x in (-9, -6, -3, 3, 6, 9)],
        ("direction: expected 1 where the position rises, -1 where it falls, or 0, got 2",),
    ),
    "no force": ("position (deg),time (s)", [(-1, -1), (1, 1)], ("has no column 'force'",)),
    "not a number": ("position (deg),force (N)", [(-1, "x"), (1, 1)], ("line 2: force: expected a number",)),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_points_are_named_and_nothing_is_written(run, tmp_path, case):
    head, rows, needed = BAD[case]
    write(tmp_path, "flight.csv", head, rows)
    status, out, err = run("--from", "flight.csv", "--out", "my.toml", "--report", "page")
    assert (status, out) == (2, "")
    assert err.startswith("forcefeel: flight.csv")
    for text in needed:
        assert text in err
    assert [path.name for path in tmp_path.iterdir()] == ["flight.csv"]


@pytest.mark.parametrize(
    ("words", "needed"),
    [
        (("--friction", "-3 N"), "--friction: expected a number of at least 0, got -3.0"),
        (("--breakout", "-3 N"), "--breakout: expected a number of at least 0"),
        (("--damping", "-0.3"), "--damping: expected a number of at least 0"),
        (("--frequency", "0 Hz"), "--frequency: expected a frequency above 0"),
        (("--frequency", "2"), "--frequency: expected a number with its unit"),
        (("--condition", "q=60 lb/ft^2"), "condition: expected NAME=VALUE with a condition of flight.csv (none)"),
        (("--neutral", "1 N"), "--neutral"),
        (("--out", "flight.csv", "--replace"), "flight.csv is what the feel is made from"),
        (("--release", "none.csv"), "none.csv"),
    ],
)
def test_bad_options_are_named_and_nothing_is_written(run, ten, tmp_path, words, needed):
    given = ten[:2] if "--out" in words else ten
    status, out, err = run(*given, *words)
    assert (status, out) == (2, "")
    assert needed in err
    assert [path.name for path in tmp_path.iterdir()] == ["flight.csv"]
    assert (tmp_path / "flight.csv").read_text(encoding="utf-8") == TEN


@pytest.mark.slow
def test_release_that_does_not_oscillate_gives_a_bound(run, tmp_path):
    write(tmp_path, "flight.csv", "position (deg),force (N)", [(x, 6 * x) for x in (-9, -6, -3, 3, 6, 9)])
    time = np.arange(0, 3, 0.02)
    angle = 8 * np.exp(-4 * np.maximum(time - 0.5, 0))
    write(tmp_path, "release.csv", "time (s),position (deg)", zip(time, angle, strict=True))
    status, _, err = run("--from", "flight.csv", "--out", "my.toml", "--release", "release.csv")
    assert status == 2
    assert "release.csv: does not oscillate; it only bounds the damping ratio, at least" in err
    assert "state --frequency" in err
    assert not (tmp_path / "my.toml").exists()


def test_points_without_direction_at_one_position_are_refused_as_a_reference(tmp_path):
    points = Control().points(np.repeat([-8.0, 8.0, 4.0], 2), [1, -1] * 3, stated=False)
    setup = ff.qualification.QualificationSetup(laws=("robust",), references={"static": points}, tests=("static",))
    with pytest.raises(ff.InputError, match="expected the direction of each point; add a column 'direction'"):
        ff.qualify_loader(ff.digital_elevator(), setup)


def test_points_are_no_reference_of_a_motion():
    points = Control().points([-8.0, 8.0, 4.0], [-1, 1, 1])
    setup = ff.qualification.QualificationSetup(laws=("robust",), references={"medium": points})
    with pytest.raises(ff.InputError, match="has no column 'time', and medium is a motion"):
        ff.qualify_loader(ff.digital_elevator(), setup)
