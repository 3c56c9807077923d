"""Commands of one loader on a project: each axis in turn, results beside one another."""

import json

import pytest

import forcefeel as ff


@pytest.fixture
def cockpit(tmp_path):
    """A project of two axes in the folder of the command."""
    path = tmp_path / "cockpit.toml"
    path.write_text('[axes]\npitch = "elevator-2khz"\nroll = "aileron-wheel"\n', encoding="utf-8")
    return path


def test_json_has_the_result_of_each_loader(forcefeel, cockpit):
    status, out, _ = forcefeel("analyze", "cockpit.toml", "--json")
    alone = {axis: json.loads(forcefeel("analyze", loader, "--json")[1]) for axis, loader in LOADERS.items()}
    assert (status, json.loads(out)) == (0, {"project": "cockpit", "axes": alone})


LOADERS = {"pitch": "elevator-2khz", "roll": "aileron-wheel"}


@pytest.mark.slow
def test_each_axis_has_its_folder_and_names(forcefeel, cockpit, tmp_path):
    status, out, _ = forcefeel("export", "cockpit.toml", "--to", "c", "--out", "code")
    assert status == 0
    for axis, loader in LOADERS.items():
        assert f"\n{axis}\nrobust for {loader}" in out
        assert (tmp_path / "code" / axis / f"loader_{axis}_law.c").is_file()


@pytest.mark.slow
def test_law_files_are_named_after_the_axes(forcefeel, cockpit, tmp_path):
    status, *_ = forcefeel("law", "cockpit.toml", "--save-law", "law.json")
    assert status == 0
    assert {path.name for path in tmp_path.glob("law-*.json")} == {"law-pitch.json", "law-roll.json"}
    assert (tmp_path / "forcefeel-law" / "roll" / "law.html").is_file()


def test_record_of_the_project_is_the_data_of_each_axis(forcefeel, cockpit, tmp_path):
    with ff.live.start_cockpit(
        ff.loader.read_project(cockpit), "robust", real_time=False, record=tmp_path / "run.mcap"
    ) as running:
        running.on()
        running.wait(6000)
    status, _, error = forcefeel("identify", "cockpit.toml", "--data", "run.mcap", "--fit", "k")
    # Nobody moved a column: the record is read, and said to be of no use.
    assert status == 2
    assert "axes.pitch: run.mcap/pitch: pilot_force never moves" in error


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("identify", "--data", "x.csv", "--fit", "k"),
            "--data: x.csv is of one loader, and cockpit.toml is a project",
        ),
        (("law", "--law", "report"), "cockpit.toml: axes.roll: recursion (22) takes a loader with a hydraulic drive"),
    ],
)
def test_what_one_axis_refuses_is_refused_with_its_name(forcefeel, cockpit, words, message):
    command, *more = words
    status, _, error = forcefeel(command, "cockpit.toml", *more)
    assert status == 2
    assert message in error


def test_law_of_the_report_is_refused_before_any_axis_is_designed(forcefeel, cockpit):
    status, out, error = forcefeel("law", "cockpit.toml", "--law", "report")
    assert (status, out) == (2, "")
    assert "axes.roll:" in error


def test_identification_of_axes_on_a_shaft_says_so(forcefeel, tmp_path):
    """Two columns on a shaft that is closed: twice the inertia moves."""
    axes = "".join(f'{axis} = "elevator-2khz"\n' for axis in ("pitch", "pitch-first-officer"))
    link = '[links.pitch]\nbetween = ["pitch", "pitch-first-officer"]\nstiffness = "4000 lb in/rad"\n'
    (tmp_path / "pair.toml").write_text(f"[axes]\n{axes}{link}", encoding="utf-8")
    with ff.live.start_cockpit(
        ff.loader.read_project(tmp_path / "pair.toml"), "robust", real_time=False, record=tmp_path / "run.mcap"
    ) as running:
        running.on()
        running.wait(4000)
        running["pitch"].hand_force_n = 60.0
        running.wait(2000)
    _, out, _ = forcefeel("identify", "pair.toml", "--data", "run.mcap", "--fit", "J_c")
    assert "pitch and pitch-first-officer are joined by a shaft" in out
