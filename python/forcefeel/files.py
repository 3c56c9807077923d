"""Files that appear whole or not at all: written beside, then renamed."""

import os
import tempfile
from pathlib import Path

from forcefeel.errors import InputError


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
