"""``forcefeel sweep`` as a user types it."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

import forcefeel as ff
from forcefeel.errors import InputError
from tests.command_line import runs
from tests.sweeps import PUSH_WORDS, nonlinear

PATIENCE_S = 60
PIECES = 16  # of a sweep that is not long
LISTENING = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # a shell's background job does not
)
PROGRAM = (sys.executable, "-c", f"{LISTENING}; from forcefeel.cli import main; main()")


command = runs("sweep", columns=100, report=True)


@pytest.fixture
def run(command, tmp_path):
    """Runs ``forcefeel sweep ...`` beside a loader file."""
    (tmp_path / "my.toml").write_text(nonlinear().to_toml(), encoding="utf-8")
    return command


def small(*words: str) -> tuple[str, ...]:
    runs = () if "--runs" in words else ("--runs", "64")
    return ("my.toml", *runs, *PUSH_WORDS, *words)


def test_help_has_an_example_and_every_option(run):
    status, out, _ = run("--help")
    assert status == 0
    assert "Example:" in out
    for option in (
        "--runs",
        "--vary",
        "--grid",
        "--out",
        "--resume",
        "--replace",
        "--scheduler",
        "--threads",
        "--units",
        "--json",
    ):
        assert option in out


@pytest.mark.slow
def test_monte_carlo_sweep_prints_results(run, tmp_path):
    status, out, err = run(
        *small("--vary", "column.coulomb_friction=1 lb..3 lb", "--vary", "column.static_friction=none")
    )
    assert (status, err) == (0, "")
    assert "of 64 loaders" in out or "All 64 loaders" in out
    assert "overshoot, %" in out
    assert out.endswith("page: forcefeel-sweep/sweep.html\n")
    there = {path.name for path in (tmp_path / "forcefeel-sweep").iterdir()}
    assert there == {"plan.json", "runs.nc", "summary.json", "envelope.csv", "sweep.html", "plotly.min.js"}


@pytest.mark.slow
def test_json_option_prints_json_only_in_requested_units_beside_runs_in_si(run, tmp_path):
    answers = [run(*small("--json", "--units", units, "--out", units)) for units in ("us", "si")]
    assert [(status, err) for status, _, err in answers] == [(0, "")] * 2
    us, si = (json.loads(out) for _, out, _ in answers)
    assert si["runs"] == sum(one["runs"] for one in si["statuses"]) == 64
    assert si["measures"]["peak_flow_m3_per_s"]["unit"] == "cm^3/s"
    stored = json.loads((tmp_path / "si" / "summary.json").read_text(encoding="utf-8"))
    assert si == {"page": "si/sweep.html", **stored}
    flow = [found["measures"]["peak_flow_m3_per_s"]["quantiles"]["0.5"] for found in (us, si)]
    assert flow[1] / flow[0] == pytest.approx(2.54**3)
    assert (tmp_path / "us" / "runs.nc").read_bytes() == (tmp_path / "si" / "runs.nc").read_bytes()


def test_a_grid_makes_a_map(run, tmp_path):
    grid = ("--grid", "feel.stiffness=2000..20000 lb in/rad:5:log", "--grid", "feel.damping=100..400 lb in s/rad:4")
    status, out, _ = run("my.toml", *PUSH_WORDS, *grid, "--out", "map")
    assert status == 0
    assert "of 20 settings" in out or "All 20 settings" in out
    assert "lb in/rad and feel.damping" in out
    page = (tmp_path / "map" / "sweep.html").read_text(encoding="utf-8")
    assert 'id="map-stability"' in page
    assert not (tmp_path / "map" / "envelope.csv").exists()
    assert xr.load_dataset(tmp_path / "map" / "runs.nc", engine="h5netcdf").sizes == {"run": 20}


@pytest.mark.slow
def test_law_is_designed_for_each_setting(run, tmp_path):
    words = ["--set", "load_cell.noise=off", "--grid", "feel.stiffness=5000..15000 lb in/rad:4", *PUSH_WORDS]
    found = {}
    for name, more in (("one", []), ("own", ["--redesign"])):
        status, out, err = run("my.toml", *words, "--law", "published", *more, "--out", name)
        assert (status, err) == (0, "")
        assert "page:" in out
        found[name] = xr.load_dataset(tmp_path / name / "runs.nc", engine="h5netcdf")["maximum_angle_rad"].values
    assert np.abs(found["one"] / found["own"] - 1).max() > 0.01
    page = (tmp_path / "own" / "sweep.html").read_text(encoding="utf-8")
    assert "designed anew for each setting of the feel" in page
    summary = json.loads((tmp_path / "own" / "summary.json").read_text(encoding="utf-8"))
    assert summary["law"] == "designed anew for each setting of the feel"
    assert json.loads((tmp_path / "one" / "summary.json").read_text(encoding="utf-8"))["law"] == "one for all machines"
    assert run("my.toml", *words, "--law", "published", "--redesign", "--out", "own", "--resume")[0] == 0
    assert "law" in run("my.toml", *words, "--law", "published", "--out", "own", "--resume")[2]


def test_runs_are_repeated_at_each_grid_point(run):
    status, out, _ = run(*small("--runs", "16", "--grid", "feel.stiffness=8000..12000 lb in/rad:3", "--json"))
    assert status == 0
    assert json.loads(out)["runs"] == 48


@pytest.mark.slow
def test_diverging_loader_exits_with_status_1(run):
    words = ("--set", "feel.inertia=2 lb in s^2/rad", "--runs", "16")
    status, out, _ = run(*words)  # the built-in loader, which is linear
    assert status == 1
    assert "diverge" in out
    assert "page:" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--runs", "0"], "runs: expected a whole number from 1 to 10,000,000, got 0"),
        (["--vary", "linkage.stifness=20 %"], "did you mean linkage.stiffness?"),
        (["--vary", "linkage.stiffness"], "--vary: expected part.name=value such as 'linkage.stiffness=20 %'"),
        (["--vary", "feel.damping=5 %", "--vary", "feel.damping=6 %"], "--vary: feel.damping is given twice"),
        (["--vary", "valve.orifice=20 %"], "valve.orifice: all runs of a sweep share it"),
        (["--vary", "linkage.ratio=0.5..3"], "linkage.ratio: out of range"),
        (["--grid", "feel.stiffness=1..2"], "grid: feel.stiffness: expected from..to:how many"),
        (["--grid", "feel.stiffness"], "--grid: expected part.name=value"),
        (["--scheduler", "nowhere"], "--scheduler: nowhere cannot be reached"),
        (["--threads", "0"], "threads: expected 1 to 1024"),
        (["--threads", "99999999999999"], "threads: expected 1 to 1024"),
        (["--seed", "-1"], "seed: expected a whole number from 0 to 9,223,372,036,854,775,807, got -1"),
        (["--redesign"], "--redesign: is about designed gains; add --law published or converged"),
        (["--redesign", "--law", "published"], "none of feel.inertia, feel.damping, feel.stiffness varies"),
        (["--out", "my.toml"], "my.toml: is a file; expected a folder for the sweep"),
    ],
)
def test_bad_options_are_named(run, words, said):
    status, out, err = run(*small(*words))
    assert (status, out) == (2, "")
    assert said in err
    assert "Traceback" not in err


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes everywhere")
def test_a_folder_that_cannot_be_written_is_named(run, tmp_path):
    (tmp_path / "locked").mkdir(mode=0o500)
    status, _, err = run(*small("--out", "locked/sweep"))
    assert status == 2
    assert "locked/sweep: cannot be made (Permission denied)" in err


def test_loader_file_without_tolerances_gives_remedy(run, tmp_path):
    bare = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    (tmp_path / "bare.toml").write_text(bare.to_toml(), encoding="utf-8")
    status, _, err = run("bare.toml")
    assert status == 2
    assert "add a section [tolerances] to the loader file, or say what varies, such as --vary" in err
    assert not (tmp_path / "forcefeel-sweep").exists()


@pytest.mark.slow
def test_a_folder_with_a_sweep_is_refused_and_kept(run, tmp_path):
    assert run(*small())[0] == 0
    before = (tmp_path / "forcefeel-sweep" / "runs.nc").read_bytes()
    assert "holds all 64 runs of this very sweep; --resume" in run(*small())[2]
    assert "seed: 0 there, 5 here" in run(*small("--seed", "5"))[2]
    assert (tmp_path / "forcefeel-sweep" / "runs.nc").read_bytes() == before
    assert run(*small("--resume", "--units", "si"))[0] == 0
    assert run(*small("--seed", "5", "--replace"))[0] == 0
    assert (tmp_path / "forcefeel-sweep" / "runs.nc").read_bytes() != before


def test_a_page_that_cannot_be_written_loses_no_run(run, tmp_path, monkeypatch):
    def fail(*_):
        raise InputError("out: cannot be written (No space left on device)")

    with monkeypatch.context() as patched:
        patched.setattr("forcefeel.page.folder.OutputFolder.write", fail)
        status, _, err = run(*small("--replace"))
    assert status == 2
    assert "64 of 64 runs are kept in forcefeel-sweep; go on with: forcefeel sweep my.toml" in err
    assert "--replace" not in err
    assert run(*small("--resume"))[0] == 0


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals as on Unix")
def test_interrupted_or_killed_sweep_keeps_finished_pieces(run, tmp_path):
    """Real processes, interrupted or killed once some pieces are there; then they go on to the same end."""
    words = ("my.toml", "--runs", "1600", *PUSH_WORDS)
    assert run(*words, "--out", "whole")[0] == 0
    for number, status in ((signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL)):
        place = tmp_path / number.name
        process = subprocess.Popen(
            [*PROGRAM, "sweep", *words, "--out", number.name, "--threads", "1"],
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        end = time.monotonic() + PATIENCE_S
        while len(list((place / "chunks").glob("0*.npy"))) < 2 and time.monotonic() < end:
            time.sleep(0.005)
        process.send_signal(number)
        _, err = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == status
        assert 2 <= len(list((place / "chunks").glob("0*.npy"))) < PIECES
        assert not (place / "runs.nc").exists()
        if number is signal.SIGINT:
            assert "forcefeel: interrupted;" in err
            assert f"of 1,600 runs are kept in SIGINT; go on with: forcefeel sweep {' '.join(words[:3])}" in err
            assert err.rstrip().endswith("--resume")
            assert "Traceback" not in err
        assert run(*words, "--out", number.name, "--resume")[0] == 0
        assert (place / "runs.nc").read_bytes() == (tmp_path / "whole" / "runs.nc").read_bytes()
