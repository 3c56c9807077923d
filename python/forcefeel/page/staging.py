"""Files of a folder are written so that they appear together or not at all, and those of others stay.

A folder without other files is written anew beside the old one and replaces it in one step of the file system. So even a run that
is killed leaves the old folder or the new one. If the folder has other files, or cannot be exchanged (a mount, or the current
directory), everything is written to a hidden folder within it. From there the files move one by one, the page last.
"""

import contextlib
import ctypes
import os
import re
import secrets
import shutil
import stat
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path, PurePath

from forcefeel.errors import InputError
from forcefeel.files import TOKEN_BYTES, check_output_file, check_output_folder, part_of_name
from forcefeel.page.script import SCRIPT

_ASIDE = ".forcefeel-"
_NAME = re.compile(rf"{re.escape(_ASIDE)}(?P<folder>.+)-[0-9a-f]{{{2 * TOKEN_BYTES}}}", re.DOTALL)
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2
"""Of Linux, ``renameat2(2)``."""


def put(out: Path, contents: Mapping[str, str | bytes], own: Collection[str]) -> None:
    """Writes all files of a folder, or none; arguments as ``OutputFolder.write``.

    Of ``own``, the names of files that are the command's, one that is there and not written goes.

    Raises:
        InputError: If the folder cannot be made or written, or it or a name in it is a link or otherwise no folder or file.
    """
    own = {*own, *contents}
    check_output_folder(out, "a folder for the files of the command")
    for name in own:
        for above in PurePath(name).parents[:-1]:
            check_output_folder(out / above, "a folder of that name")
        check_output_file(out / name)
    with _explained(out), _created_folder(out) as folder:
        for left in _left_by_killed_runs(folder):
            shutil.rmtree(left, ignore_errors=True)
        if not (_is_free(folder, own) and _exchanged(folder, contents)):
            _moved_in(folder, contents, own)


def _left_by_killed_runs(folder: Path) -> list[Path]:
    """What a run that was killed while it wrote to ``folder`` left in it or beside it."""
    name = part_of_name(folder.name)
    within = [path for path in folder.glob(f"{_ASIDE}*") if _whose(path) in {name, None}]
    beside = [path for path in folder.parent.glob(f"{_ASIDE}*") if _whose(path) == name]
    return [path for path in (*within, *beside) if path.is_dir() and not path.is_symlink()]


def _whose(aside: Path) -> str | None:
    """Name of the folder that was to be made of it; ``None`` where its own name does not say."""
    match = _NAME.fullmatch(aside.name)
    return match and match["folder"]


def _is_free(folder: Path, own: set[str]) -> bool:
    """Whether another folder may take the place of ``folder``."""
    own = own | {Path(name).parent.as_posix() for name in own}
    return (
        os.name == "posix"
        and all(path.relative_to(folder).as_posix() in own for path in folder.rglob("*"))
        and os.access(folder.parent, os.W_OK)
        and not folder.is_mount()
        and not Path.cwd().is_relative_to(folder)
    )


def _exchanged(folder: Path, contents: Mapping[str, str | bytes]) -> bool:
    """Writes a new folder beside and exchanges it for ``folder``; nothing, if the system cannot do that in one step."""
    with _aside(folder.parent, folder) as new:
        _write(new, contents, folder)
        shutil.copymode(folder, new)
        if any(folder.iterdir()):
            return _exchange(folder, new)
        new.rename(folder)  # an empty folder gives way
    return True


def _exchange(first: Path, other: Path) -> bool:
    """Exchanges two folders in one step; whether that was possible."""
    rename = getattr(ctypes.CDLL(None), "renameat2", None)
    names = os.fsencode(first), os.fsencode(other)
    return rename is not None and rename(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE) == 0


def _moved_in(folder: Path, contents: Mapping[str, str | bytes], own: set[str]) -> None:
    """Writes the files aside, then moves them in; those of an earlier run that this one does not write go."""
    with _aside(folder, folder) as aside:
        _write(aside, contents, folder)
        for name in own - contents.keys():
            (folder / name).unlink(missing_ok=True)
        for name in contents:
            (folder / name).parent.mkdir(exist_ok=True)
            (aside / name).replace(folder / name)


def _write(aside: Path, contents: Mapping[str, str | bytes], folder: Path) -> None:
    """Writes the files of ``folder`` to ``aside``; the script is on the disk once for all folders beside each other."""
    for name, text in contents.items():
        (aside / name).parent.mkdir(exist_ok=True)
        # The name of a data file need not be made of letters.
        data = text if isinstance(text, bytes) else text.encode(errors="backslashreplace")
        if not (name == SCRIPT and os.name == "posix" and _linked(aside / name, data, folder)):
            (aside / name).write_bytes(data)


def _linked(path: Path, data: bytes, folder: Path) -> bool:
    """Whether ``path`` could become another name of the user's own file with the same contents, in ``folder`` or beside it."""
    for other in (folder / path.name, *folder.parent.glob(f"*/{path.name}")):
        with contextlib.suppress(OSError):  # not there, not to be read, or a file system without links
            about = other.lstat()
            alone = stat.S_ISREG(about.st_mode) and not about.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
            if alone and about.st_uid == os.geteuid() and about.st_size == len(data) and other.read_bytes() == data:
                path.hardlink_to(other)
                return True
    return False


@contextlib.contextmanager
def _aside(where: Path, folder: Path) -> Iterator[Path]:
    """An empty folder in ``where`` for what is to become ``folder``; gone afterwards."""
    aside = where / f"{_ASIDE}{part_of_name(folder.name)}-{secrets.token_hex(TOKEN_BYTES)}"
    aside.mkdir()
    try:
        yield aside
    finally:
        shutil.rmtree(aside, ignore_errors=True)


@contextlib.contextmanager
def _created_folder(out: Path) -> Iterator[Path]:
    """The folder ``out`` itself, whatever links are above it; if what follows fails, none is there that was not before."""
    folder = out.resolve()
    missing = [parent for parent in (*reversed(folder.parents), folder) if not parent.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    try:
        yield folder
    except BaseException:
        for parent in reversed(missing):
            with contextlib.suppress(OSError):  # not empty: something of others is in it
                parent.rmdir()
        raise


@contextlib.contextmanager
def _explained(out: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{out}: cannot be written ({reason}); expected a folder that can be made or written"
        ) from error
