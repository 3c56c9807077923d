"""Files of a folder, put in place together: everything is written aside first, the page moves last."""

import contextlib
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from forcefeel.errors import InputError


def write_together(out: Path, contents: Mapping[str, str | bytes]) -> None:
    """Writes files so that what was there stays until all that is new is complete; other files are left alone.

    Args:
        out: The folder; made if it is not there.
        contents: Each file's text or bytes by its name within the folder, in the order in which they move into place.

    Raises:
        InputError: If the folder cannot be made or written.
    """
    with _explained(out), _staging(out) as aside:
        for name, text in contents.items():
            (aside / name).parent.mkdir(exist_ok=True)
            if isinstance(text, bytes):
                (aside / name).write_bytes(text)
            else:
                (aside / name).write_text(text, encoding="utf-8", newline="\n")
        for name in contents:
            (out / name).parent.mkdir(exist_ok=True)
            (aside / name).replace(out / name)


@contextlib.contextmanager
def _staging(out: Path) -> Iterator[Path]:
    """A folder within ``out``, so that a file moves into place in one step; gone afterwards."""
    made = _make(out)
    aside = Path(tempfile.mkdtemp(prefix=".forcefeel-", dir=out))
    try:
        yield aside
    except BaseException:
        shutil.rmtree(aside, ignore_errors=True)
        for folder in reversed(made):
            with contextlib.suppress(OSError):  # not empty: something of the report, or of others, is in it
                folder.rmdir()
        raise
    shutil.rmtree(aside, ignore_errors=True)


def _make(out: Path) -> list[Path]:
    """Makes ``out``; the folders that were not there before."""
    missing = [folder for folder in (*reversed(out.parents), out) if not folder.exists()]
    out.mkdir(parents=True, exist_ok=True)
    return missing


@contextlib.contextmanager
def _explained(out: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{out}: cannot be written ({reason}); expected a folder that can be made or written"
        ) from error
