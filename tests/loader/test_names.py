"""A loader's name is text: with a dot, with what looks like mark-up, in any script; what steers a terminal is refused."""

import ast
from dataclasses import replace
from pathlib import Path

import pytest
from rich.table import Table

import forcefeel as ff
from forcefeel import cli
from forcefeel.cli.terminal import Terminal
from forcefeel.errors import InputError
from forcefeel.printable import visible
from tests.command_line import runs
from tests.parametrization import mostly_slow

NAMES = ["elevator v1.2", "rig [/2]", "[bold]rig[/] :smile:", "Höhenruder 昇降 😀", "a$b[0].c", "%s {0}"]
KNOTS = "flaps (deg),stiffness (lb in/rad),frequency (Hz),damping ratio\n0,9600,2,0.2\n1,9000,2,0.2\n"
COMMANDS = {
    "analyze": (),
    "law": ("--law", "report", "--horizon", "0.05"),
    "simulate": ("--duration", "0.5", "--out", "out"),
    "sweep": ("--runs", "4", "--duration", "0.5", "--replace"),
    "excite": ("--fit", "k,c", "--time", "5", "--replace"),
    "schedule": ("--knots", "knots.csv", "--refine", "2", "--replace"),
}
"""Each in a short form; what they share with ``design``, ``envelope`` and the others are the models, the pages and the terminal."""


command_line = runs(columns=200)


@pytest.fixture
def run(command_line, tmp_path):
    """Status, output and error output of a command on a loader of some name."""
    (tmp_path / "knots.csv").write_text(KNOTS, encoding="utf-8")

    def call(name, command, *words):
        loader = replace(ff.digital_elevator(), name=name)
        (tmp_path / "my.toml").write_text(loader.to_toml(), encoding="utf-8")
        return command_line(command, "my.toml", *words)

    return call


@pytest.mark.parametrize("command", mostly_slow(COMMANDS, 2))
def test_every_command_accepts_name_with_dot_and_markup(run, command):
    status, out, err = run("rig [/2] v1.2", command, *COMMANDS[command])
    assert (status, err) == (0, "")
    if command in {"analyze", "simulate"}:  # those that print it
        assert out.startswith("rig [/2] v1.2")


@pytest.mark.parametrize("name", NAMES)
def test_name_with_markup_is_printed_literally(capsys, name):
    Terminal().print(f"{name}: programmed feel", highlight=False)
    table = Table("test", title=name)
    table.add_row(name)
    Terminal().print(table)
    printed = capsys.readouterr().out
    assert printed.startswith(f"{name}: programmed feel")
    assert printed.count(name) == 3


@pytest.mark.parametrize("name", NAMES)
def test_linear_model_of_any_loader_name_is_made(name):
    assert ff.compliant_model(replace(ff.elevator(), name=name)).nstates == 8


@pytest.mark.parametrize("c", ["\x1b", "\x07", "\n", "\r", "\x85", "\u2028", "\u202e", "\u2066", "\x00"])
def test_a_control_character_is_refused_when_the_file_is_read(run, tmp_path, c):
    text = ff.elevator().to_toml().replace('name = "elevator-1974"', f'name = "a\\u{ord(c):04x}[31mb"')
    (tmp_path / "bad.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=f"bad.toml: name: has the control character U\\+{ord(c):04X}; expected"):
        ff.load(tmp_path / "bad.toml")
    with pytest.raises(InputError, match="source: has the control character"):
        replace(ff.elevator(), source=f"a\x1b{c}")


def test_multiline_source_is_accepted():
    assert replace(ff.elevator(), source="one\n\ttwo").source == "one\n\ttwo"


def test_messages_contain_no_terminal_control_characters(command_line):
    assert command_line("analyze", "a\x1b[31m\udcff.toml")[2].startswith(
        r"forcefeel: a\x1b[31m\udcff.toml: cannot be read"
    )
    assert visible("one\ntwo\t\x9b") == "one\ntwo\t\\x9b"


def test_tables_are_printed_by_terminal_module_only():
    """A console of Rich by itself would read names as mark-up; the bars, which print no names, go to the error output."""
    for path in Path(cli.__file__).parent.glob("*.py"):
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "Console":
                assert [word.arg for word in call.keywords] == ["stderr"], path.name
