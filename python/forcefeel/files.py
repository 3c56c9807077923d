"""Files: read if they are whole files of a stated size, and written so that they appear whole or not at all."""

import os
import stat
import tempfile
from pathlib import Path

from forcefeel.errors import InputError

MOST_TEXT_BYTES = 2**20
"""Largest file that a person writes: a loader file, a weighting matrix, the knots of a schedule."""


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
        if not stat.S_ISREG(status.st_mode):
            kind = "a folder" if stat.S_ISDIR(status.st_mode) else "a pipe or a device"
            remedy = "name a file in it" if kind == "a folder" else "write it to a file first"
            raise InputError(f"{path}: is {kind}; expected {expected}; {remedy}")
        if status.st_size > most_bytes:
            most, remedy = _size(most_bytes), "leave out what is not needed"
            raise InputError(f"{path}: has {_size(status.st_size)}; expected {expected} of {most} at most; {remedy}")
        with path.open("rb") as file:
            data = file.read(status.st_size + 1)
    except InputError:
        raise
    except (OSError, ValueError) as error:  # a name with a zero byte is a ValueError
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({reason}); expected {expected}") from error
    if len(data) > status.st_size:
        raise InputError(
            f"{path}: grows while it is read; expected {expected} that is complete; wait until it is written"
        )
    return data


def _size(size: int) -> str:
    """A number of bytes as people read it."""
    return f"{size / 2**20:.4g} MB" if size >= 2**20 else f"{size} bytes"


def write_whole(path: Path, contents: str | bytes) -> None:
    """Writes ``contents``, text in UTF-8, to ``path``, so that nobody ever sees half of it.

    Raises:
        InputError: If the folder is not there or cannot be written.
    """
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror}); expected a writable folder {path.parent}"
        ) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(contents.encode() if isinstance(contents, str) else contents)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except OSError as error:
        Path(name).unlink(missing_ok=True)
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
