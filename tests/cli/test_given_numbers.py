"""Numbers that are legal and mean nothing: answered or refused in words; no library's warning, no "nan", no empty table."""

import re

import numpy as np
import pytest

from tests.command_line import runs

run = runs()


ROWS, AT = 4000, 2000


def record(path, experiment, header, column, cell):
    """A record of noise that drives and moves a loader, with one cell of another value."""
    drive = np.concatenate([np.zeros(50), np.cumsum(np.random.default_rng(1974).normal(size=ROWS - 50))])
    rows = [[f"{k / 1000:.3f}", f"{value:.5f}", f"{-value / 9:.5f}"] for k, value in enumerate(drive.tolist())]
    rows[AT][column] = cell
    lines = [f"# experiment: {experiment}", f"time (s),{header},column angle (deg)", *map(",".join, rows)]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("cell", ["1e300", "-1e300", "1e154", "1e20"])
@pytest.mark.parametrize("column", [1, 2])
@pytest.mark.parametrize(
    ("experiment", "header"),
    [("servo-closed test_signal", "test_signal (V)"), ("loader pilot_force", "pilot_force (lb)")],
)
def test_implausibly_large_cell_is_named(run, tmp_path, experiment, header, column, cell):
    record(tmp_path / "data.csv", experiment, header, column, cell)
    status, out, err = run("identify", "elevator-1974", "--data", "data.csv", "--fit", "k,c")
    assert (status, out) == (2, "")
    name = "column_angle" if column == 2 else header.split()[0]
    assert re.search(rf"data\.csv: line {AT + 3}: {name} is -?[\d.]+e\+\d+ \w+; expected at most 1e\+15", err), err


@pytest.mark.parametrize("command", [("resonance", "--data"), ("simulate", "--record"), ("qualify", "--record")])
def test_every_reader_refuses_an_implausible_cell(run, tmp_path, command):
    header = "test_signal (V)" if command[0] == "resonance" else "force (lb)"
    record(tmp_path / "data.csv", "servo-closed test_signal", header, 1, "1e300")
    status, out, err = run(command[0], "elevator-1974", command[1], "data.csv")
    assert (status, out) == (2, "")
    assert f"data.csv: line {AT + 3}: " in err


KNOTS = "mach,stiffness (lb in/rad),frequency (Hz),damping ratio\n1,9600,2,0.3\n2,9600,1e-9,0.2\n"
"""The second has an inertia of 2.4e20 lb in s^2/rad."""


@pytest.mark.parametrize("target", ["c", "firmware", "fmu", "matlab", "st", "table"])
def test_feel_out_of_range_is_not_exported(run, tmp_path, target):
    (tmp_path / "knots.csv").write_text(KNOTS)
    words = ("elevator-2khz", "--law", "robust", "--knots", "knots.csv")
    status, out, err = run("export", *words, "--to", target, "--out", "out")
    assert (status, out) == (2, "")
    assert "feel.inertia: expected 1e-6 to 10000000 lb in s^2/rad" in err
    assert "got 2.431708407e+20 lb in s^2/rad in setting 2" in err
    assert not (tmp_path / "out").exists()


def test_gains_with_undamped_state_have_no_residual(run, tmp_path):
    np.savetxt(tmp_path / "q.csv", np.eye(7), delimiter=",")
    status, out, _ = run("law", "elevator-1974", "--q", "q.csv")
    assert status == 1
    assert "nan" not in out
    assert "residual of eqs. (22): none, because a state does not decay under these gains" in " ".join(out.split())


@pytest.mark.slow
def test_deviation_accepts_the_example_of_its_help(run):
    text = " ".join(run("envelope", "--help")[1].replace("│", " ").split())
    said = re.search(r"'([\w.]+=none)' for", text)
    small = ("--grid", "stiffness=20, 50 %", "--grid", "frequency=1, 2 Hz", "--grid", "damping=0.3, 1", "--draws", "0")
    assert run("envelope", "elevator-1974", *small, "--deviation", said[1])[0] == 0
    status, _, err = run("envelope", "elevator-1974", *small, "--deviation", "none")
    assert (status, "expected part.name=value such as" in err) == (2, True)
