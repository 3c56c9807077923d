"""A file is written whole, as the user's rights are, over a file or where none is; anything else stays."""

import os
import stat

import pytest

from forcefeel.errors import InputError
from forcefeel.files import write_whole


@pytest.fixture
def umask():
    """Sets the umask for a test."""
    before = os.umask(0o022)
    yield os.umask
    os.umask(before)


@pytest.mark.parametrize(("mask", "mode"), [(0o077, 0o600), (0o022, 0o644), (0o002, 0o664), (0o027, 0o640)])
def test_written_file_has_umask_permissions(tmp_path, umask, mask, mode):
    umask(mask)
    write_whole(tmp_path / "a", "text")
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == mode


def test_written_file_replaces_old_file_without_leftovers(tmp_path):
    write_whole(tmp_path / "a", "old")
    write_whole(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_text() == "new"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


@pytest.mark.parametrize("name", ["x" * 255, "é" * 127, "x" * 250])
def test_a_file_of_any_legal_name_is_written(tmp_path, name):
    write_whole(tmp_path / name, "text")
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_link_is_neither_followed_nor_replaced(tmp_path):
    (tmp_path / "other").write_text("mine")
    (tmp_path / "a").symlink_to("other")
    with pytest.raises(InputError, match="a: is a link to other, and links are not followed; expected to write a file"):
        write_whole(tmp_path / "a", "text")
    assert str((tmp_path / "a").readlink()) == "other"
    assert (tmp_path / "other").read_text() == "mine"


def test_a_pipe_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "a")
    with pytest.raises(InputError, match="a: is a pipe or a device; expected to write a file"):
        write_whole(tmp_path / "a", "text")
    assert (tmp_path / "a").is_fifo()


def test_failed_write_leaves_file_unchanged(tmp_path, monkeypatch):
    write_whole(tmp_path / "a", "old")
    monkeypatch.setattr(os, "replace", _full)
    monkeypatch.setattr("pathlib.Path.replace", _full)
    with pytest.raises(InputError, match=r"a: cannot be written \(No space left on device\)"):
        write_whole(tmp_path / "a", "new")
    assert (tmp_path / "a").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def _full(*_):
    raise OSError(28, "No space left on device")
