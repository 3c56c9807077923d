"""A command as a user types it, for the tests of every command."""

import subprocess
import sys
from collections.abc import Callable

import pytest

from forcefeel.cli import main

Run = Callable[..., tuple[int, str, str]]


REPORT_LOADER = "elevator-1974"
"""The loader of the report, whose numbers many tests know."""


def on_the_report_loader(words) -> list[str]:
    """The words after a command, with the report's loader where they name none."""
    named = bool(words) and not str(words[0]).startswith("-")
    return [*map(str, words)] if named or "--help" in words else [REPORT_LOADER, *map(str, words)]


def runner(monkeypatch, capsys, folder, *command: str, columns=120, report=False, lines=False) -> Run:
    """Runs ``forcefeel COMMAND ...`` in a folder; gives exit status, output and error output.

    Without a command the first word is one. With ``report`` the default loader is that of the report. Error output is joined to one
    line, or keeps its ``lines``.
    """
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", str(columns))

    def call(*words):
        name, *words = (*command, *map(str, words))
        monkeypatch.setattr(sys, "argv", ["forcefeel", name, *(on_the_report_loader(words) if report else words)])
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capsys.readouterr()
        return ended.value.code or 0, printed.out, printed.err if lines else " ".join(printed.err.split())

    return call


def imported(*words: str, libraries: set[str]) -> set[str]:
    """Those of some libraries that ``forcefeel WORDS`` imports."""
    probe = (
        f"import sys; sys.argv = ['forcefeel', *{words}]\n"
        "from forcefeel.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "print(*sys.modules)"
    )
    out = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True).stdout
    return libraries & {*out.splitlines()[-1].split()}


def runs(*command: str, **options):
    """The fixture ``run``: ``runner`` in the empty folder of a test."""

    @pytest.fixture
    def run(monkeypatch, capsys, tmp_path) -> Run:
        return runner(monkeypatch, capsys, tmp_path, *command, **options)

    return run
