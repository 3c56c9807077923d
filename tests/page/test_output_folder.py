"""A command's folder: all of its files or none, also where the run is killed; what others put there stays."""

import os
import stat
from pathlib import Path

import pytest

from forcefeel.errors import InputError
from forcefeel.page import staging
from forcefeel.page.folder import OutputFolder
from forcefeel.page.script import SCRIPT

FOLDER = OutputFolder("the test", ("page.html", "results.json", "extra.csv"), ("tables",), plots=False)
OLD = {"results.json": "old", "extra.csv": "old", "page.html": "old"}
NEW = {"tables/a.csv": b"new", "results.json": "new", "page.html": "new"}
WRITTEN = dict.fromkeys(NEW, "new")

forking = pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
"""The child of a process with threads writes files and ends."""

KILLED = 9
"""Exit status of a child that ends without another word, as by a signal that nobody can catch."""


def held(folder):
    return {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*") if path.is_file()}


def left(folder):
    return [path.name for path in folder.iterdir() if path.name.startswith(".forcefeel-")]


@pytest.fixture
def out(tmp_path):
    FOLDER.write(tmp_path / "out", OLD)
    return tmp_path / "out"


def test_folder_is_made_with_its_parents(tmp_path):
    out = tmp_path / "a" / "b" / "out"
    FOLDER.write(out, NEW)
    assert held(out) == WRITTEN
    assert stat.S_IMODE(out.stat().st_mode) == stat.S_IMODE((tmp_path / "a").stat().st_mode)
    assert left(out) == left(out.parent) == []


def test_files_of_earlier_run_are_removed(out):
    FOLDER.write(out, NEW)
    assert held(out) == WRITTEN


def test_unrelated_files_are_kept(out):
    (out / "notes.txt").write_text("mine")
    (out / "empty").mkdir()
    inode = out.stat().st_ino
    FOLDER.write(out, NEW)
    assert held(out) == WRITTEN | {"notes.txt": "mine"}
    assert (out / "empty").is_dir()
    assert out.stat().st_ino == inode
    assert left(out) == left(out.parent) == []


@pytest.mark.parametrize("within", [".", "tables"])
def test_working_folder_of_a_process_is_not_exchanged(out, monkeypatch, within):
    (out / within).mkdir(exist_ok=True)
    monkeypatch.chdir(out / within)
    inode = out.stat().st_ino
    FOLDER.write(out, NEW)
    assert out.stat().st_ino == inode
    assert held(out) == WRITTEN


def test_files_are_moved_where_exchange_is_unsupported(out, monkeypatch):
    monkeypatch.setattr(staging, "_exchange", lambda *_: False)
    FOLDER.write(out, NEW)
    assert held(out) == WRITTEN
    assert left(out) == left(out.parent) == []


def test_link_is_followed_only_above_the_folder(out):
    link = out.parent / "link"
    link.symlink_to(out, target_is_directory=True)
    before = held(out)
    with pytest.raises(InputError, match=r"link: is a link to .*out, and links are not followed; expected a folder"):
        FOLDER.write(link, NEW)
    assert held(out) == before
    FOLDER.write(link / "within", NEW)
    assert held(out) == before | {f"within/{name}": text for name, text in WRITTEN.items()}


@pytest.mark.parametrize("name", ["results.json", "tables", "extra.csv", "tables/a.csv"])
@pytest.mark.parametrize("notes", [False, True])
def test_link_in_folder_is_neither_followed_nor_replaced(out, tmp_path, name, notes):
    """Whether files move in one by one, or the whole folder is exchanged."""
    if notes:
        (out / "notes.txt").write_text("mine")
    (out / name).unlink(missing_ok=True)
    (out / name).parent.mkdir(exist_ok=True)
    (tmp_path / "mine").mkdir()
    (out / name).symlink_to(tmp_path / "mine")
    before = held(tmp_path)
    with pytest.raises(InputError, match=f"{name}: is a link to .*mine, and links are not followed"):
        FOLDER.write(out, NEW)
    assert held(tmp_path) == before
    assert (out / name).is_symlink()


@pytest.mark.parametrize("name", ["x" * 255, "é" * 127])
def test_folder_of_any_legal_name_is_written_and_replaced(tmp_path, name):
    for _ in range(2):
        FOLDER.write(tmp_path / name, NEW)
        assert held(tmp_path / name) == WRITTEN
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("notes", [False, True])
def test_full_disk_leaves_folder_unchanged(out, monkeypatch, notes):
    if notes:
        (out / "notes.txt").write_text("mine")
    before, write = held(out), Path.write_bytes

    def full(self, data):
        if self.name == "page.html":
            raise OSError(28, "No space left on device")
        return write(self, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InputError, match=r"out: cannot be written \(No space left on device\)"):
        FOLDER.write(out, NEW)
    with pytest.raises(InputError, match="cannot be written"):
        FOLDER.write(out.parent / "new" / "out", NEW)
    assert held(out) == before
    assert [path.name for path in out.parent.iterdir()] == ["out"]


def _killed(call: int, out: Path) -> int:
    """Exit status of a process that writes ``out`` and ends at its so-manyth change of the file system."""
    child = os.fork()
    if child == 0:
        _killed_at(pytest.MonkeyPatch(), call)
        FOLDER.write(out, NEW)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _killed_at(monkeypatch, call: int) -> None:
    """Ends this process at its so-manyth call that changes the file system."""
    done = 0

    def counted(original):
        def one(*words, **options):
            nonlocal done
            done += 1
            if done > call:
                os._exit(KILLED)
            return original(*words, **options)

        return one

    for owner, name in (
        *((Path, name) for name in ("mkdir", "write_text", "write_bytes", "rename", "replace", "unlink", "rmdir")),
        *((staging, name) for name in ("_exchange",)),
        *((staging.shutil, name) for name in ("rmtree", "copymode")),
    ):
        monkeypatch.setattr(owner, name, counted(getattr(owner, name)))


@forking
def test_killed_run_leaves_old_or_new_folder_and_next_run_cleans_up(tmp_path):
    out, seen = tmp_path / "out", []
    for call in range(100):
        FOLDER.write(out, OLD)
        status = _killed(call, out)
        assert held(out) in (OLD, WRITTEN)
        seen.append((status, held(out) == OLD))
        if status == 0:
            break
        FOLDER.write(out, OLD)
        assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert {(KILLED, True), (KILLED, False)} <= set(seen)
    assert seen[-1] == (0, False)


@pytest.mark.slow
@forking
def test_killed_run_keeps_unrelated_files(tmp_path):
    out = tmp_path / "out"
    for call in range(100):
        FOLDER.write(out, OLD)
        (out / "notes.txt").write_text("mine")
        status = _killed(call, out)
        assert (out / "notes.txt").read_text() == "mine"
        assert set(held(out).values()) <= {"old", "new", "mine"}
        if status == 0:
            break
    assert left(out) == left(tmp_path) == []


def test_leftovers_of_killed_run_are_removed_for_same_folder_only(out):
    mine, others = (out.parent / f".forcefeel-{name}-01234567" for name in ("out", "other"))
    for path in (mine, others, out / ".forcefeel-abcd1234"):
        path.mkdir()
        (path / "page.html").write_text("half")
    (out.parent / ".forcefeel-file").write_text("mine")
    FOLDER.write(out, NEW)
    assert left(out) == []
    assert sorted(left(out.parent)) == [".forcefeel-file", others.name]


def test_text_with_lone_surrogate_is_written(out):
    FOLDER.write(out, {"page.html": "the file a\udcff.csv"})
    assert (out / "page.html").read_text() == r"the file a\udcff.csv"


@pytest.mark.parametrize("name", FOLDER.files)
def test_folder_in_place_of_file_is_refused(tmp_path, name):
    (tmp_path / name).mkdir()
    with pytest.raises(InputError, match=f"{name}: is a folder; expected to write a file of that name"):
        FOLDER.check(tmp_path)


def test_file_in_place_of_folder_is_refused(tmp_path):
    (tmp_path / "tables").write_text("mine")
    with pytest.raises(InputError, match="tables: is a file; expected a folder"):
        FOLDER.check(tmp_path)
    with pytest.raises(InputError, match="tables: is a file; expected a folder for the test"):
        FOLDER.check(tmp_path / "tables")


def test_files_are_replaced_only_on_request(out):
    FOLDER.check(out)
    with pytest.raises(
        InputError, match=r"out: holds page\.html already; name another folder with --out, or --replace"
    ):
        FOLDER.check(out, replace=False)


def test_plot_script_is_written_and_foreign_script_is_refused(tmp_path):
    pages = OutputFolder("the test", ("page.html",))
    pages.write(tmp_path / "out", {"page.html": "old"})
    assert sorted(held(tmp_path / "out")) == ["page.html", SCRIPT]
    (tmp_path / "out" / "page.html").unlink()
    pages.check(tmp_path / "out", replace=False)
    (tmp_path / "out" / SCRIPT).write_text("mine")
    with pytest.raises(InputError, match=rf"out: holds another {SCRIPT}; name another folder with --out, or --replace"):
        pages.check(tmp_path / "out", replace=False)
    pages.check(tmp_path / "out")
    other = tmp_path / "other"
    (other / SCRIPT).mkdir(parents=True)
    with pytest.raises(InputError, match=rf"{SCRIPT}: is a folder; expected to write a file of that name"):
        pages.check(other)


def test_script_is_stored_once_for_neighboring_folders(tmp_path):
    plots = OutputFolder("the test", ("page.html",))
    for name in ("a", "b", "a"):
        plots.write(tmp_path / name, {"page.html": name})
    one, other = (tmp_path / name / SCRIPT for name in ("a", "b"))
    assert one.samefile(other)
    assert one.stat().st_nlink == 2


@pytest.mark.parametrize("change", ["contents", "rights", "link"])
def test_script_of_neighbor_that_others_may_change_is_not_shared(tmp_path, change):
    plots = OutputFolder("the test", ("page.html",))
    plots.write(tmp_path / "a", {"page.html": ""})
    one, other = (tmp_path / name / SCRIPT for name in ("a", "b"))
    match change:
        case "contents":
            one.write_text("another")
        case "rights":
            one.chmod(0o666)
        case "link":
            one.rename(tmp_path / "elsewhere.js")
            one.symlink_to(tmp_path / "elsewhere.js")
    plots.write(tmp_path / "b", {"page.html": ""})
    assert not one.samefile(other)
    assert other.stat().st_size > 1e6
