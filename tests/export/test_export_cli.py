"""``forcefeel export`` on the command line: what is written, and what is refused before anything is."""

import json
from pathlib import Path

import pytest

import forcefeel as ff
from tests.command_line import runs

KNOTS = Path(__file__).parents[2] / "examples" / "schedule" / "knots.csv"


export = runs("export")


def test_each_setting_has_a_table(export, tmp_path):
    status, out, _ = export(
        "elevator-2khz", "--law", "robust", "--to", "table", "--knots", KNOTS, "--name", "pitch", "--out", "sheet"
    )
    assert status == 0
    assert "settings of the feel: 4" in out
    assert {path.name for path in (tmp_path / "sheet").iterdir()} == {
        "pitch_drive.csv",
        "pitch_drive.html",
        "pitch_parameters.csv",
        "pitch_observer.csv",
    }


def test_json_names_files_law_and_loader(export):
    status, out, _ = export("elevator-electric", "--to", "table", "--json")
    found = json.loads(out)
    assert (status, found["files"], found["law"]) == (
        0,
        ["loader_drive.csv", "loader_drive.html", "loader_parameters.csv", "loader_observer.csv"],
        "robust",
    )
    assert found["loader_sha256"] == ff.loader.electric("elevator-electric").fingerprint


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--to", "table", "--name", "9x"), "--name: expected a C identifier"),
        (("--to", "table", "--name", "a-b"), "--name: expected a C identifier"),
        (("--to", "plc"), "--to: expected c, firmware, fmu, matlab, openffboard, st or table"),
        (
            ("--to", "matlab", "--law", "original"),
            "is gains of an analog law, and elevator-2khz has a digital controller",
        ),
        (("--to", "table", "--law", "converged"), "--law: converged is gains of an analog law"),
        (("--to", "table", "--law", "torque-mode"), "--law: torque-mode is a law for a motor"),
        (("--to", "matlab", "--law", "robust", "--knots", "none.csv"), "none.csv: cannot be read"),
        (("--to", "c", "--target", "avr"), "--target: is for --to firmware, and --to is c; leave it out"),
        (("--to", "c", "--board", "stm32f405"), "--board: is for --to firmware, and --to is c; leave it out"),
        (("--to", "firmware", "--board", "uno"), "--board: expected stm32f405, got 'uno'"),
        (
            ("--to", "firmware", "--board", "stm32f405", "--target", "avr"),
            "--board: has its own target, and --target is avr",
        ),
        (("--to", "fmu", "--law", "original"), "is gains of an analog law, and elevator-2khz has a digital controller"),
        (("--to", "fmu", "--name", "a-b"), "--name: expected a C identifier"),
        (("--to", "fmu", "--single"), "--single: is for --to c and firmware, and --to is fmu"),
        (("--to", "openffboard", "--law", "torque-mode"), "--to openffboard takes a loader with an electric drive"),
        (("--to", "table", "--units", "si"), "--units"),
        ((), "--to: required"),
    ],
)
def test_invalid_input_is_named_and_nothing_is_written(export, tmp_path, words, expected):
    status, out, error = export("elevator-2khz", *words)
    assert (status, out) == (2, "")
    assert expected in error
    assert list(tmp_path.iterdir()) == []


def test_law_of_another_loader_or_rate_is_refused(export, tmp_path):
    loader = ff.digital_elevator()
    ff.Law.of("robust", loader).save(tmp_path / "law.json")
    ff.Law.of("robust", loader.replace({"controller.period": "1 ms"})).save(tmp_path / "slow.json")
    given = ("elevator-2khz", "--to", "matlab", "--law")
    status, _, error = export(*given, "law.json", "--set", "column.inertia=50 lb in s^2/rad")
    assert status == 2
    assert "was made for elevator-2khz" in error
    status, _, error = export(*given, "slow.json")
    assert status == 2
    assert "made for a controller.period of 1 ms, the loader has 0.5 ms" in error
    assert export(*given, "law.json")[0] == 0


@pytest.mark.slow
def test_fmus_of_loader_law_and_machine_are_written(export, tmp_path):
    status, out, _ = export("elevator-2khz", "--law", "robust", "--to", "fmu", "--name", "pitch", "--out", "fmus")
    assert status == 0
    names = {f"pitch_{kind}_fmi{version}.fmu" for kind in ("loader", "law", "machine") for version in (2, 3)}
    assert {path.name for path in (tmp_path / "fmus").iterdir()} == names
    assert all(name in out for name in names)


def test_analog_loader_has_no_fmu(export, tmp_path):
    status, _, error = export("elevator-1974", "--law", "converged", "--to", "fmu")
    assert status == 2
    assert "--law: converged is an analog law, and the target is digital; give the loader a controller.period" in error
    assert list(tmp_path.iterdir()) == []


def test_existing_files_are_replaced_only_with_replace(export):
    given = ("elevator-2khz", "--law", "robust", "--to", "table", "--out", "sheet")
    assert export(*given)[0] == 0
    status, _, error = export(*given)
    assert status == 2
    assert "--replace" in error
    assert export(*given, "--replace")[0] == 0


@pytest.mark.parametrize(
    ("target", "name"),
    [
        ("c", "loader_law.c"),
        ("firmware", "libforcefeel.a"),
        ("fmu", "loader_law_fmi3.fmu"),
        ("matlab", "loader.mat"),
        ("table", "loader_parameters.csv"),
    ],
)
def test_existing_output_folder_is_refused_before_reading_input(export, tmp_path, target, name):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_text("mine", encoding="utf-8")
    status, _, error = export("elevator-2khz", "--to", target, "--knots", "none.csv", "--out", "out")
    assert status == 2
    assert f"out: holds {name} already" in error
    assert (tmp_path / "out" / name).read_text(encoding="utf-8") == "mine"
