"""Paths that a user names, and their files: read if they are regular files of a stated size, written whole or not at all.

Reading follows links. Writing does not: what is replaced is a regular file, and what is written into is a folder, never a link, a
pipe or a device.
"""

import hashlib
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path

from forcefeel.errors import InputError

MOST_TEXT_BYTES = 2**20
"""Largest file that a person writes: a loader file, a weighting matrix, the knots of a schedule."""

TOKEN_BYTES = 4
"""Of a random name that nothing else has."""

_LONGEST_PART = 200
"""Bytes: of the 255 that most file systems allow for a name, what leaves room for a token and a mark."""


class Kind(StrEnum):
    """Kind of a path."""

    FILE = "a file"
    FOLDER = "a folder"
    LINK = "a link"
    OTHER = "a pipe or a device"

    @classmethod
    def of(cls, status: os.stat_result) -> "Kind":
        """The kind that the file system says."""
        kinds = {stat.S_IFREG: cls.FILE, stat.S_IFDIR: cls.FOLDER, stat.S_IFLNK: cls.LINK}
        return kinds.get(stat.S_IFMT(status.st_mode), cls.OTHER)


def input_kind(path: Path) -> Kind | None:
    """What a path leads to, links followed; ``None`` where that is nothing: an attempt to read it says why."""
    try:
        return Kind.of(path.stat())
    except (OSError, ValueError):  # too long a name, a loop of links; a zero byte
        return None


def input_files(folder: Path) -> list[Path]:
    """The entries of a folder, by name.

    Raises:
        InputError: If it cannot be read.
    """
    try:
        return sorted(folder.iterdir())
    except OSError as error:
        raise InputError(f"{folder}: cannot be read ({error.strerror}); expected a folder of files") from error


def output_kind(path: Path) -> Kind | None:
    """Kind of a path, of a link the link itself; ``None`` if it does not exist.

    Raises:
        InputError: If nothing can be written there.
    """
    try:
        return Kind.of(path.lstat())
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be written ({_reason(error)}); name another path") from error


def check_output_file(path: Path, *, replace: bool = True) -> None:
    """Refuses to write a file where something else lies.

    Raises:
        InputError: If a link, a folder, a pipe or a device is there, a file that is not to be replaced, or none can be.
    """
    kind = output_kind(path)
    if kind not in {None, Kind.FILE}:
        raise InputError(f"{path}: {_kind_text(path, kind)}; expected to write a file of that name; {_REMEDY}")
    if kind and not replace:
        raise InputError(f"{path}: is there already; give another name, or --replace to replace it")


def check_output_folder(path: Path, expected: str) -> None:
    """Refuses to write into what is no folder.

    Args:
        path: The folder.
        expected: What it should be, for the message: ``a folder for the report``.

    Raises:
        InputError: If a link, a file, a pipe or a device is there, or no folder can be.
    """
    kind = output_kind(path)
    if kind not in {None, Kind.FOLDER}:
        raise InputError(f"{path}: {_kind_text(path, kind)}; expected {expected}; {_REMEDY}")


def _kind_text(path: Path, kind: Kind | None) -> str:
    if kind is not Kind.LINK:
        return f"is {kind}"
    return f"is a link to {path.readlink()}, and links are not followed"


_REMEDY = "name another one, or move it away"


def make_folder(path: Path, expected: str = "a folder that can be written") -> None:
    """Makes a folder and those above it, where they are not there.

    Args:
        path: The folder.
        expected: What it should be, for the message.

    Raises:
        InputError: If it cannot be made, or something else is there.
    """
    check_output_folder(path, expected)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be made ({error.strerror}); expected {expected}; name another one") from error


def is_same(first: Path, other: Path) -> bool:
    """Whether two paths lead to the same; not where one of them leads nowhere."""
    try:
        return first.samefile(other)
    except (OSError, ValueError):
        return False


def part_of_name(name: str) -> str:
    """A file's name as part of another: itself, or its hash where the other would be too long for a file system."""
    data = os.fsencode(name)
    return name if len(data) <= _LONGEST_PART else hashlib.sha256(data).hexdigest()


def _reason(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or str(error)


def read_input(path: Path, most_bytes: int, expected: str) -> bytes:
    """What is in a file that a user names. A pipe or a device, which may have no end, is refused.

    Args:
        path: The file.
        most_bytes: Largest size of it.
        expected: What it should be, for the message: ``a loader file``.

    Raises:
        InputError: If it cannot be read, is no regular file, is too large, or grows meanwhile.
    """
    try:
        status = path.stat()
        if (kind := Kind.of(status)) is not Kind.FILE:
            remedy = "name a file in it" if kind is Kind.FOLDER else "write it to a file first"
            raise InputError(f"{path}: is {kind}; expected {expected}; {remedy}")
        if status.st_size > most_bytes:
            most, remedy = _size(most_bytes), "leave out what is not needed"
            raise InputError(f"{path}: has {_size(status.st_size)}; expected {expected} of {most} at most; {remedy}")
        with path.open("rb") as file:
            data = file.read(status.st_size + 1)
    except InputError:
        raise
    except (OSError, ValueError) as error:  # a name with a zero byte is a ValueError
        raise InputError(f"{path}: cannot be read ({_reason(error)}); expected {expected}") from error
    if len(data) > status.st_size:
        raise InputError(
            f"{path}: grows while it is read; expected {expected} that is complete; wait until it is written"
        )
    return data


def _size(size: int) -> str:
    """A number of bytes as people read it."""
    return f"{size / 2**20:.4g} MB" if size >= 2**20 else f"{size} bytes"


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """A path beside ``path`` to write to, which takes its place at the end, and is removed on an error.

    Raises:
        InputError: As ``check_output_file``, or if the folder is not there or cannot be written.
    """
    check_output_file(path)
    aside = path.with_name(f".{part_of_name(path.name)}.{secrets.token_hex(TOKEN_BYTES)}")
    try:
        yield aside
        aside.replace(path)
    except OSError as error:
        aside.unlink(missing_ok=True)
        raise InputError(
            f"{path}: cannot be written ({_reason(error)}); expected a writable folder {path.parent}"
        ) from error
    except BaseException:
        aside.unlink(missing_ok=True)
        raise


def write_whole(path: Path, contents: str | bytes) -> None:
    """Writes ``contents``, text in UTF-8, to ``path``, never half of it, with the rights that the umask leaves.

    Raises:
        InputError: As ``written_whole``.
    """
    with written_whole(path) as aside, aside.open("xb") as file:
        file.write(contents.encode() if isinstance(contents, str) else contents)
