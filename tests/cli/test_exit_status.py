"""What the program ends with: 1 is an answer, 2 the user's input, 70 a fault of its own, 130 Ctrl-C."""

import os
import signal
import subprocess
import sys

import pytest

from forcefeel.cli import BAD_INPUT, FAULT, INTERRUPTED, TRACEBACK, main
from forcefeel.design import workflow
from forcefeel.errors import InputError

UNSTABLE = ("analyze", "--set", "feel.inertia=0.6 lb in s^2/rad", "--set", "feel.stiffness=96 lb in/rad")


class PanicException(BaseException):
    """As PyO3 makes it: no ``Exception``."""


@pytest.fixture
def ended(monkeypatch, capsys):
    """Status and error output of a command in which ``error`` is raised."""

    def call(error):
        def raises(*_, **__):
            raise error

        monkeypatch.setattr(workflow, "analyze", raises)
        monkeypatch.setattr(sys, "argv", ["forcefeel", "analyze"])
        with pytest.raises(SystemExit) as end:
            main()
        return end.value.code, capsys.readouterr().err

    return call


@pytest.mark.parametrize(
    "error",
    [
        KeyError("x"),
        ValueError("two\nlines"),
        PanicException("index"),
        FileNotFoundError(2, "No such file", "a template"),
    ],
)
def test_internal_error_has_its_own_status_and_asks_for_a_report(ended, error):
    status, said = ended(error)
    assert status == FAULT == 70
    assert said.startswith(f"forcefeel: internal error ({type(error).__name__}: ")
    assert f"please report it: the command, its files, and the output with {TRACEBACK}=1" in said
    assert said.count("\n") == 1


def test_traceback_is_shown_on_request(ended, monkeypatch):
    monkeypatch.setenv(TRACEBACK, "1")
    status, said = ended(KeyError("x"))
    assert status == FAULT
    assert said.startswith("Traceback (most recent call last)")
    assert said.splitlines()[-1].startswith("forcefeel: internal error (KeyError: 'x')")


def test_long_library_message_is_truncated(ended):
    assert len(ended(ValueError("x" * 100_000))[1]) < 500


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (InputError("my.toml: name: missing value"), BAD_INPUT, "forcefeel: my.toml: name: missing value\n"),
        (OSError(28, "No space left on device"), BAD_INPUT, "the output cannot be written (No space left on device)\n"),
        (MemoryError(), BAD_INPUT, "memory does not suffice"),
        (KeyboardInterrupt(), INTERRUPTED, ""),
    ],
)
def test_expected_error_is_not_reported_as_internal(ended, error, status, said):
    found = ended(error)
    assert found[0] == status
    assert said in found[1]
    assert "fault" not in found[1]


def test_help_lists_the_exit_statuses(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["forcefeel", "--help"])
    with pytest.raises(SystemExit):
        main()
    told = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "2 the input is bad, 70 internal error" in told
    assert TRACEBACK in told


def test_message_length_is_bounded_and_truncation_is_stated():
    lines = str(InputError("\n".join(f"line {k}" for k in range(5000)))).split("\n")
    assert lines[:2] == ["line 0", "line 1"]
    assert lines[-1] == "... and 4,980 more"
    assert len(lines) == 21
    assert len(str(InputError("x" * 10**6))) == 4000
    assert str(InputError(str(InputError("x\n" * 5000)))) == str(InputError("x\n" * 5000))


@pytest.mark.skipif(os.name != "posix", reason="of pipes as POSIX has them")
@pytest.mark.parametrize(
    "words",
    [
        ("--version",),
        ("analyze",),
        *(
            pytest.param(words, marks=pytest.mark.slow)
            for words in (("--help",), ("analyze", "--help"), ("analyze", "--json"), ("new", "my.toml"), UNSTABLE)
        ),
    ],
    ids=" ".join,
)
def test_closed_output_pipe_exits_like_sigpipe(tmp_path, words):
    """``forcefeel ... | head -1``: 128 and the number of SIGPIPE, as shells report programs that it ends; no word beside it."""
    program = "from forcefeel.cli import main; main()"
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-c", program, *words], stdout=writing, stderr=subprocess.PIPE, cwd=tmp_path, check=False
    )
    os.close(writing)
    assert done.stderr == b""
    assert done.returncode == 128 + signal.SIGPIPE == 141
