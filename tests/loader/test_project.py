"""A project file: what it may say, and which commands take it."""

import pytest

import forcefeel as ff
from forcefeel.cli.app import _COMMANDS
from forcefeel.errors import InputError
from forcefeel.loader.axes import AXIS_OF
from forcefeel.loader.built_in import BUILT_IN

TAKE_A_PROJECT = ("qualify", "envelope", "size", "simulate", "run", "emulate", "frontier", "bus")
ON_EACH_AXIS = ("analyze", "law", "sweep", "identify", "excite", "commission", "export")
TAKE_A_LOADER = {
    "design": (),
    "feel": ("--from", "x.csv", "--out", "x.toml"),
    "fly": (),
    "resonance": ("--data", "x.csv"),
    "schedule": ("--knots", "x.csv"),
}


@pytest.fixture
def cockpit(tmp_path):
    """A project of two axes, one of them by its file."""
    (tmp_path / "own.toml").write_text(ff.digital_elevator().to_toml(), encoding="utf-8")
    path = tmp_path / "cockpit.toml"
    path.write_text('[axes]\npitch = "own.toml"\nyaw = "rudder-pedals"\n', encoding="utf-8")
    return path


def test_project_paths_are_relative_to_its_folder(cockpit):
    found = ff.loader.read_project(cockpit)
    assert {axis: loader.name for axis, loader in found.loaders.items()} == {
        "pitch": "elevator-2khz",
        "yaw": "rudder-pedals",
    }
    assert found.name == "cockpit"


def test_every_built_in_loader_has_an_axis():
    assert [*AXIS_OF] == [*BUILT_IN]


def test_byte_order_mark_of_project_is_ignored(cockpit):
    cockpit.write_bytes(b"\xef\xbb\xbf" + cockpit.read_bytes())
    assert [*ff.loader.read_project(cockpit).loaders] == ["pitch", "yaw"]


@pytest.mark.parametrize(
    ("project", "told"),
    [
        ("[axes]\n", "axes: expected a table with a loader for at least one axis"),
        ("axes = 3\n", "axes: expected a table with a loader for at least one axis"),
        ('[axes]\ntail = "elevator-1974"\n', "axes.tail: is no axis; expected some of pitch, roll, yaw, stick-pitch"),
        ("[axes]\npitch = 3\n", "axes.pitch: expected a loader"),
        ('[axes]\npitch = "gone.toml"\n', "axes.pitch: {folder}/gone.toml: cannot be read"),
        ('[axes]\npitch = "cockpit.toml"\n', "axes.pitch: {folder}/cockpit.toml: is a project"),
        (
            '[axes]\npitch = "sidestick-pitch"\n',
            "axes.pitch: sidestick-pitch is the name of a built-in loader of stick-pitch; expected one of pitch, such as "
            "elevator-2khz",
        ),
        ('[axes]\nroll = "own.toml"\n', "axes.roll: elevator-2khz is the name of a built-in loader of pitch"),
        (
            '[axes]\npitch = "own.toml"\nroll = "./own.toml"\n',
            "axes.roll: ./own.toml is the loader of pitch already; expected a file of its own for each axis",
        ),
        (
            'name = "x"\n[axes]\npitch = "elevator-1974"\n',
            "name: a project file has tables [axes], [links], [trips] and [flap_trim] and nothing else",
        ),
        (
            '[axes]\npitch = "elevator-2khz"\n[flap_trim]\nroll = 0.1\n',
            "flap_trim.roll: expected an axis of [axes] (pitch)",
        ),
        (
            '[axes]\npitch = "elevator-2khz"\n[flap_trim]\npitch = "much"\n',
            "flap_trim.pitch: expected the angle of its neutral for an angle of the flaps, at most 10 either way",
        ),
        (
            '[axes]\npitch = "elevator-2khz"\n[flap_trim]\npitch = nan\n',
            "flap_trim.pitch: expected the angle of its neutral",
        ),
        (
            '[axes]\npitch = "elevator-1974"\n[flap_trim]\npitch = 0.1\n',
            "flap_trim.pitch: the flaps move the neutral of a digital",
        ),
    ],
)
def test_a_bad_project_is_named(cockpit, project, told):
    cockpit.write_text(project, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        ff.loader.read_project(cockpit)
    assert told.format(folder=cockpit.parent) in str(refused.value)


def test_renamed_built_in_loader_may_have_another_axis(cockpit):
    text = (cockpit.parent / "own.toml").read_text(encoding="utf-8")
    (cockpit.parent / "own.toml").write_text(text.replace('"elevator-2khz"', '"wheel"', 1), encoding="utf-8")
    cockpit.write_text('[axes]\nroll = "own.toml"\n', encoding="utf-8")
    assert ff.loader.read_project(cockpit).loaders["roll"].name == "wheel"


@pytest.mark.parametrize("command", TAKE_A_LOADER)
def test_single_loader_command_names_project_commands(forcefeel, cockpit, command):
    status, out, error = forcefeel(command, "cockpit.toml", *TAKE_A_LOADER[command])
    assert (status, out) == (2, "")
    assert "cockpit.toml: is a project, which names the loader of each axis; expected one of those loaders" in error
    assert "commission, run, emulate, bus and export take a project" in error


def test_every_loader_command_is_tested():
    on_loaders = {name for name, takes in _COMMANDS.items() if "LOADER" in takes}
    assert on_loaders == {*TAKE_A_LOADER, *TAKE_A_PROJECT, *ON_EACH_AXIS}


@pytest.mark.parametrize(
    ("command", "more", "told"),
    [
        ("size", ("--axis", "roll"), "--axis: is for one loader"),
        ("qualify", ("--axis", "roll"), "--axis: is for one loader"),
        ("qualify", ("--record", "static=x.csv"), "--record: is for one loader"),
        ("qualify", ("--reference", "static=x.csv"), "--reference: is for one loader"),
        ("qualify", ("--law", "published"), "cockpit.toml: axes.yaw: "),
        ("envelope", ("--law", "published"), "cockpit.toml: axes.yaw: "),
        (
            "envelope",
            ("--set", "motor.inertia=1 kg m^2"),
            "cockpit.toml: axes.pitch: motor.inertia: is of a loader with",
        ),
    ],
)
def test_option_incompatible_with_project_is_refused(forcefeel, cockpit, command, more, told):
    status, out, error = forcefeel(command, "cockpit.toml", *more)
    assert (status, out) == (2, "")
    assert told in error
    assert not list(cockpit.parent.glob("forcefeel-*"))
