"""The command line: ``app.py`` lists the commands, each has a file of its name."""

import contextlib
import gc
import os
import sys
import traceback
from typing import NoReturn

from forcefeel.cli.exit_status import BAD_INPUT, FAULT, INTERRUPTED, UNREAD
from forcefeel.errors import InputError, shortened
from forcefeel.printable import visible

TRACEBACK = "FORCEFEEL_TRACEBACK"
"""Environment variable: set to anything, a fault shows where it happened."""

_LONGEST = 300
"""Characters that are shown of what a library says."""

_ALLOCATIONS = 100_000
"""Between searches for cycles, which take a twentieth of a short command's time where the default searches while libraries load."""


def main() -> None:
    """Runs the command line: exit status 0 fine, 1 the answer is bad, 2 the input is bad, else as ``exit_status`` has it."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a stream without the letters of a name shows their numbers
            stream.reconfigure(errors="backslashreplace")
    # The engine has threads of its own; on matrices of ten rows those of BLAS wait for one another, turning.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(_ALLOCATIONS)
    try:
        from forcefeel.cli import app

        try:
            app.run(sys.argv[1:])
        finally:
            sys.stdout.flush()  # while a full disk can still be told
        sys.exit(0)
    except SystemExit:
        raise
    except KeyboardInterrupt:
        _end("interrupted", INTERRUPTED)
    except InputError as error:
        _end(str(error), BAD_INPUT)
    except BrokenPipeError:
        _leave_unread()
        sys.exit(UNREAD)
    except MemoryError:
        _end("this machine's memory does not suffice; ask for less at a time", BAD_INPUT)
    except BaseException as error:  # a panic of the engine is no Exception
        if message := _not_understood(error):
            _end(message, BAD_INPUT)
        if isinstance(error, OSError) and error.filename is None:  # no file, so the output: a full disk
            _end(f"the output cannot be written ({error.strerror})", BAD_INPUT)
        if _has_no_threads(error):
            _end(str(error), BAD_INPUT)
        _end(_fault(error), FAULT)


def _end(message: str, status: int) -> NoReturn:
    print(f"forcefeel: {visible(message)}", file=sys.stderr)
    sys.exit(status)


def _leave_unread() -> None:
    """Drops what is still to be printed, which the interpreter would try once more at its end."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _not_understood(error: BaseException) -> str | None:
    """What is wrong with the command line, where that is the error."""
    from cyclopts import CycloptsError

    from forcefeel.cli.app import command_line_error

    return command_line_error(error) if isinstance(error, CycloptsError) else None


def _has_no_threads(error: BaseException) -> bool:
    from forcefeel._core import ThreadsError

    return isinstance(error, ThreadsError)


def _fault(error: BaseException) -> str:
    """A line that asks to report a fault; with the way to it, where that is asked for."""
    if os.environ.get(TRACEBACK):
        traceback.print_exception(error)
    what = shortened(" ".join(f"{type(error).__name__}: {error}".split()), _LONGEST)
    return f"internal error ({what}); please report it: the command, its files, and the output with {TRACEBACK}=1"
