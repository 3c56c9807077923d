"""``forcefeel simulate`` on a project with links: what is printed and written, and what is refused."""

import csv
import json
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.errors import InputError

EXAMPLES = Path("examples/cockpit").resolve()
AXES = '[axes]\npitch = "elevator-2khz"\npitch-first-officer = "elevator-2khz"\n'
LINK = '[links.pitch]\nbetween = ["pitch", "pitch-first-officer"]\nstiffness = "4000 lb in/rad"\n'


def document(out):
    return json.loads(out)


@pytest.mark.parametrize("name", ["transport-column", "uncoupling", "linked-sticks"])
def test_ready_projects_run(forcefeel, name):
    status, out, _ = forcefeel("simulate", f"{EXAMPLES}/{name}.toml", "--law", "robust", "--force", "5 lb", "--json")
    result = document(out)
    assert (status, result["status"]) == (0, "done")
    assert result["measures"]["peak_link_force"]["value"] > 0.1
    assert result["measures"]["second_final_angle"]["value"] > 0.1


def test_every_option_reaches_the_run(forcefeel):
    options = ("--force", "60 lb", "--second-force", "-50 lb", "--second-start", "0.2 s", "--second-width", "0.5 s")
    events = ("--second-arm", "firm", "--jam", "0.6 s: pitch-first-officer", "--disconnect", "1 s", "--link", "pitch")
    status, out, _ = forcefeel("simulate", f"{EXAMPLES}/transport-column.toml", *options, *events, "--json")
    result = document(out)
    assert status == 0
    assert result["hands"] == (
        "pitch: a step of 60 lb at 0.1 s; pitch-first-officer: a pulse of -50 lb from 0.2 s on, 0.5 s long; "
        "pitch-first-officer jams at 0.6 s; the link is opened at 1 s"
    )
    assert "arm_stiffness" in json.dumps(result["loaders"]["second"])
    assert "arm_stiffness" not in json.dumps(result["loaders"]["first"])


def test_folder_lays_both_sides_over_one_another(forcefeel, tmp_path):
    options = ("--force", "80 lb", "--second-force", "-80 lb", "--out", "pair", "--units", "si")
    status, out, _ = forcefeel("simulate", f"{EXAMPLES}/transport-column.toml", *options)
    assert status == 0
    assert "force fight of the hands" in out
    assert "356 N" in out.replace("355.9", "356")
    with (tmp_path / "pair" / "history.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2001
    assert float(rows[-1]["first column angle (deg)"]) == pytest.approx(
        -float(rows[-1]["second column angle (deg)"]), abs=0.1
    )  # noise
    assert float(rows[-1]["first link torque (N m)"]) < -100
    page = (tmp_path / "pair" / "simulation.html").read_text(encoding="utf-8")
    assert all(text in page for text in ("link on pitch-first-officer", "Force of hand", "The link gave way"))


@pytest.mark.parametrize(
    ("links", "told"),
    [
        (
            LINK.replace("pitch-first-officer", "roll"),
            "links.pitch.between: expected axes of [axes] (pitch, pitch-first-officer), got 'roll'",
        ),
        (LINK.replace('"pitch-first-officer"', '"pitch"'), "links.pitch.between: expected two axes"),
        (LINK.replace("4000", "-4000"), "links.pitch.stiffness: expected 0.01 to 10000000 lb in/rad"),
        (
            LINK.replace("4000 lb in/rad", "4000 lb"),
            "links.pitch.stiffness: expected a number with its unit such as '2000 lb in/rad'",
        ),
        (LINK.replace("stiffness", "stifness"), "links.pitch.stifness: expected one of between, kind"),
        (
            '[links.pitch]\nbetween = ["pitch", "pitch-first-officer"]\n',
            "links.pitch.stiffness: expected stiffness of the link, such as",
        ),
        (LINK + 'kind = "rope"\n', "links.pitch.kind: expected mechanical or electronic, got 'rope'"),
        (LINK + 'delay = "1 ms"\n', "links.pitch.delay: is of an electronic link, and this one is mechanical"),
        (
            LINK + 'stiffness_after = "1 lb in/rad"\n',
            "links.pitch.stiffness_after: holds after a breakout, and the link has none",
        ),
        (
            LINK + 'breakout = "9 lb in"\nafter_breakout = "uncouple"\nstiffness_after = "1 lb in/rad"\n',
            "links.pitch.stiffness_after: is of an override, and this link uncouples",
        ),
        (LINK + LINK.replace("links.pitch", "links.other"), "links.other.between: pitch is linked by pitch already"),
        ("links = 3\n", "links: expected a table for each link"),
    ],
)
def test_bad_link_is_named(tmp_path, links, told):
    path = tmp_path / "pair.toml"
    path.write_text(links + AXES if links.startswith("links =") else AXES + links, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        ff.loader.read_project(path)
    assert told in str(refused.value)


@pytest.mark.parametrize(
    ("project", "options", "told"),
    [
        (AXES + LINK, ("--law", "torque-mode"), "--law: torque-mode is a law for a motor"),
        (AXES + LINK, ("--link", "roll"), "--link: expected pitch, got 'roll'"),
        (AXES + LINK, ("--jam", "0.5 s: yaw"), "--jam: expected pitch or pitch-first-officer, got 'yaw'"),
        (AXES + LINK, ("--jam", "pitch"), "--jam: expected a time and an axis such as"),
        (AXES + LINK, ("--disconnect", "9 s"), "--disconnect: expected a time within the run of 2 s, got 9 s"),
        (AXES + LINK, ("--second-start", "1 s"), "--second-start: requires a --second-force"),
        (AXES + LINK, ("--change", "1 s: feel.stiffness=9000 lb in/rad"), "--change: is for one loader"),
        (
            AXES + LINK,
            ("--input", "release", "--angle", "5 deg", "--second-force", "1 lb"),
            "--second-force: given with --input release",
        ),
        (
            AXES.replace("elevator-2khz", "elevator-1974") + LINK.replace("4000", "9000000"),
            (),
            "links.pitch.stiffness: both columns swing on the link at",
        ),
        (
            AXES + LINK + 'kind = "electronic"\ndelay = "0.7 ms"\n',
            (),
            "links.pitch.delay: expected 1 to 255 periods of 0.5 ms, got 0.7 ms",
        ),
        (
            AXES.replace("elevator-2khz", "elevator-1974") + LINK + 'kind = "electronic"\n',
            (),
            "links.pitch.kind: an electronic link joins two digital controllers",
        ),
        (
            AXES.replace("elevator-2khz", "elevator-1974", 1) + LINK,
            (),
            "controller.period: expected one period for pitch and pitch-first-officer, got 0 ms and 0.5 ms",
        ),
    ],
)
def test_impossible_run_exits_with_2(forcefeel, tmp_path, project, options, told):
    (tmp_path / "pair.toml").write_text(project, encoding="utf-8")
    status, out, error = forcefeel("simulate", "pair.toml", *options)
    assert (status, out) == (2, "")
    assert told in error


@pytest.mark.slow
def test_commands_that_judge_each_axis_alone_say_so(forcefeel, tmp_path):
    for name, said in (("transport-column", True), ("cockpit", False)):
        _, out, _ = forcefeel("size", f"{EXAMPLES}/{name}.toml", "--out", str(tmp_path / name))
        assert ("judged by itself, without its link" in " ".join(out.split())) is said


def test_link_options_are_refused_for_one_loader(forcefeel):
    status, out, error = forcefeel("simulate", "elevator-2khz", "--jam", "1 s: pitch")
    assert (status, out) == (2, "")
    assert "--jam: is for two linked axes; name a project file" in error
