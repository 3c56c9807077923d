"""A command as a user types it, for the tests of every command."""

import sys
from collections.abc import Callable

import pytest

from forcefeel.cli import main

Run = Callable[..., tuple[int, str, str]]


def runner(monkeypatch, capsys, folder, command: str, columns: int = 120) -> Run:
    """Runs ``forcefeel COMMAND ...`` in a folder; gives exit status, output and error output."""
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", str(columns))

    def call(*words):
        monkeypatch.setattr(sys, "argv", ["forcefeel", command, *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capsys.readouterr()
        return ended.value.code or 0, printed.out, " ".join(printed.err.split())

    return call
