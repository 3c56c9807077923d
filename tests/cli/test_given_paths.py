"""Paths that cannot be read or written: refused in words by every command before its work, and nothing is changed on the disk."""

import json
import os
import stat

import pytest

import forcefeel as ff
from forcefeel.cli.app import command_line
from tests.parametrization import mostly_slow

LONG = "x" * 300
"""More than the 255 bytes that a name in a file system has at most."""

NEEDED = {
    "schedule": ("elevator-1974", "--knots", "knots.csv"),
    "identify": ("elevator-1974", "--data", "data.csv", "--fit", "k"),
    "resonance": ("elevator-1974", "--data", "data.csv"),
    "excite": ("elevator-1974", "--fit", "k", "--out", "excite.csv"),
    "commission": ("elevator-1974", "--data", "data.csv"),
    "run": ("elevator-2khz", "--headless", "--duration", "0.1 s"),
    "export": ("elevator-1974", "--to", "table"),
    "law": ("elevator-2khz", "--law", "robust"),
}
"""What a command is given beside the path; the others take a loader alone."""

ENDINGS = {("excite", "--out"): ".csv", ("law", "--save-law"): ".json", ("new", "FILE"): ".toml"}
"""Of options that write a file; the others that write name a folder."""


def _paths():
    """Command and name of every argument and option that takes a path."""
    listed = command_line(listed=False)
    for command in (
        "new",
        "size",
        "design",
        "analyze",
        "simulate",
        "sweep",
        "envelope",
        "frontier",
        "qualify",
        *NEEDED,
    ):
        for argument in listed[command].assemble_argument_collection():
            if "Path" in str(argument.hint):
                yield command, argument.name


PATHS = [*_paths()]
WRITTEN = [pair for pair in PATHS if pair[1] in {"--out", "--save-law", "FILE"}]
READ = [pair for pair in PATHS if pair not in WRITTEN]


@pytest.fixture
def run(forcefeel, tmp_path):
    (tmp_path / "knots.csv").write_text("stiffness (lb in/rad),natural_frequency (Hz),damping_ratio\n9600,2,0.2\n")
    (tmp_path / "data.csv").write_text("time (s),pilot_force (lb),column_angle (deg)\n0,0,0\n1,5,1\n")
    (tmp_path / "folder").mkdir()
    return forcefeel


def tree(folder):
    """What lies in a folder: kind, rights, and where a link leads or what is in a file."""
    found = {}
    for path in sorted(folder.rglob("*")):
        mode = path.lstat().st_mode
        held = path.readlink() if stat.S_ISLNK(mode) else path.read_bytes() if stat.S_ISREG(mode) else None
        found[path.relative_to(folder).as_posix()] = mode, held
    return found


def words_for(command, name, path):
    """A command with a path in the place of its argument or option."""
    words = list(NEEDED.get(command, () if command == "new" else ("elevator-2khz",)))
    if not name.startswith("--"):
        words[:1] = []
        return [str(path), *words]
    if name in words:
        words[words.index(name) + 1] = str(path)
        return words
    return [*words, name, str(path)]


def test_all_commands_with_paths_are_covered():
    assert len(READ) == 30
    assert len(WRITTEN) == 16


@pytest.mark.parametrize("kind", mostly_slow(["long", "loop", "in a loop", "dangling", "pipe", "zero byte"], 2))
@pytest.mark.parametrize(("command", "name"), READ)
def test_unreadable_path_is_named(run, tmp_path, command, name, kind):
    path = bad_path(tmp_path, kind, ".csv" if name in {"--data", "--knots", "--record"} else "")
    before = tree(tmp_path)
    status, out, err = run(command, *words_for(command, name, path))
    assert (status, out) == (2, ""), err
    assert len(err) < 1000
    assert tree(tmp_path) == before


@pytest.mark.parametrize(
    "kind", mostly_slow(["long", "loop", "in a loop", "dangling", "pipe", "zero byte", "link", "in a file"], 2)
)
@pytest.mark.parametrize(("command", "name"), WRITTEN)
def test_unwritable_path_is_named(run, tmp_path, command, name, kind):
    ending = ENDINGS.get((command, name), "")
    path = bad_path(tmp_path, kind, ending, file=bool(ending))
    before = tree(tmp_path)
    status, out, err = run(command, *words_for(command, name, path), "--replace")
    assert (status, out) == (2, ""), err
    assert len(err) < 1000
    assert tree(tmp_path) == before


def bad_path(folder, kind, ending="", *, file=False):
    """A path of a kind that is neither read nor written, from ``folder``."""
    name = f"path{ending}"
    place = folder / name
    match kind:
        case "long":
            return f"{LONG}{ending}"
        case "zero byte":
            return f"a\0b{ending}"
        case "loop":
            place.symlink_to(name)
        case "in a loop":
            (folder / "loop").symlink_to("loop")
            return f"loop/{name}"
        case "in a file":
            return f"data.csv/{name}"
        case "dangling":
            place.symlink_to("nowhere")
        case "pipe":
            os.mkfifo(place)
        case "link":
            place.symlink_to("data.csv" if file else "folder")
    return name


@pytest.mark.parametrize(
    ("command", "file"),
    [
        (("simulate", "elevator-1974", "--duration", "0.5"), "simulation.html"),
        (("size", "elevator-1974"), "results.json"),
        (("export", "elevator-1974", "--to", "table"), "loader_parameters.csv"),
        (("run", "elevator-2khz", "--headless", "--duration", "0.1 s"), "record.mcap"),
        (("sweep", "elevator-1974", "--runs", "4", "--duration", "0.5"), "runs.nc"),
    ],
    ids=lambda it: it if isinstance(it, str) else it[0],
)
@pytest.mark.parametrize("kind", ["link", "dangling", "pipe"])
def test_replace_overwrites_only_files_in_the_folder(run, tmp_path, command, file, kind):
    (tmp_path / "out").mkdir()
    made = bad_path(tmp_path, kind, file=True)
    (tmp_path / made).rename(tmp_path / "out" / file)
    before = tree(tmp_path)
    status, out, err = run(*command, "--out", "out", "--replace")
    assert (status, out) == (2, ""), err
    assert f"out/{file}: is a {'pipe' if kind == 'pipe' else 'link'}" in err
    assert tree(tmp_path) == before


def test_error_states_the_target_of_a_link(run, tmp_path):
    (tmp_path / "out").symlink_to("folder")
    _, _, err = run("size", "elevator-1974", "--out", "out", "--replace")
    assert err == (
        "forcefeel: out: is a link to folder, and links are not followed; expected a folder for the sizing; name another one, or "
        "move it away"
    )


@pytest.mark.parametrize("option", ["--record", "--reference"])
def test_record_with_any_legal_file_name_is_read(run, tmp_path, option):
    """NAME=FILE is longer than a name can be; FILE alone is not."""
    name = "r" * 240 + ".csv"
    rows = "".join(f"{k / 100},{8 * 2.718 ** (-k / 30) if k > 20 else 8}\n" for k in range(400))
    (tmp_path / name).write_text("time (s),position (deg)\n" + rows)
    status, _, err = run(
        "qualify", "elevator-1974", option, f"release-25-positive={name}", "--test", "release-25-positive"
    )
    assert status in {0, 1}, err
    status, _, err = run("qualify", "elevator-1974", option, f"wheel={name}", "--replace")
    assert (status, "unknown test 'wheel'" in err) == (2, True)


@pytest.mark.parametrize("option", ["--record", "--reference"])
@pytest.mark.parametrize("prefix", ["", "release-25-positive="])
@pytest.mark.parametrize("kind", ["long", "loop", "in a loop", "dangling", "pipe"])
def test_unreadable_record_is_refused(run, tmp_path, option, prefix, kind):
    path = bad_path(tmp_path, kind, ".csv")
    status, out, err = run("qualify", "elevator-1974", option, f"{prefix}{path}")
    assert (status, out) == (2, ""), err


@pytest.mark.parametrize("key", ["period", "delay", "load_cell_arm"])
@pytest.mark.parametrize("sign", ["", "-"])
def test_law_file_number_out_of_float_range_is_refused(run, tmp_path, key, sign):
    law, loader = (ff.Law.of("published", ff.elevator()), "elevator-1974")
    if key != "load_cell_arm":
        law, loader = ff.Law.of("robust", ff.digital_elevator()), "elevator-2khz"
    law.save(tmp_path / "law.json")
    document = json.loads((tmp_path / "law.json").read_text())
    name, place = (f"time.{key}", document["time"]) if key in {"period", "delay"} else (key, document)
    assert key in place
    place[key] = int(f"{sign}1{'0' * 400}")
    (tmp_path / "law.json").write_text(json.dumps(document))
    status, out, err = run("simulate", loader, "--duration", "0.5", "--law", "law.json")
    assert (status, out) == (2, "")
    assert f"law.json: {name}: expected a finite number, got a huge number" in err


@pytest.mark.parametrize("command", ["size", "qualify", "envelope"])
def test_project_with_invalid_loader_path_is_refused(run, tmp_path, command):
    (tmp_path / "cockpit.toml").write_text(f'[axes]\npitch = "{LONG}"\n')
    status, out, err = run(command, "cockpit.toml")
    assert (status, out) == (2, "")
    assert "axes.pitch" in err
