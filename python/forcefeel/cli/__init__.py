"""The command line. Commands are declared in ``app.py``; what they print is in ``show.py``."""

import sys

from forcefeel.errors import InputError


def main() -> None:
    """Runs the command line: exit status 0 fine, 1 the answer is bad, 2 the input is bad."""
    from forcefeel.cli.app import app  # noqa: PLC0415  after the traceback-free way out is set up

    try:
        app()
    except InputError as error:
        print(f"forcefeel: {error}", file=sys.stderr)
        sys.exit(2)
    except OSError as error:  # files are the commands' own matter, so this is the output: a full disk
        print(f"forcefeel: the output cannot be written ({error.strerror})", file=sys.stderr)
        sys.exit(2)
