"""What a terminal of 80 columns shows: help and tables that break no word, cut nothing off and are no wider."""

import io
import re
import time

import pytest
from rich.progress import Progress
from rich.table import Table

from forcefeel.cli.app import command_line
from forcefeel.cli.options import EDITION, HELP_ALL
from forcefeel.cli.progress import Bar, _Left, all_or_nothing
from forcefeel.cli.terminal import Terminal
from forcefeel.qualification import DEFAULT_EDITION
from tests.command_line import runner

COMMANDS = [name for name in command_line(listed=False) if not name.startswith("-")]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_fits_the_terminal_and_names_choices(command, monkeypatch, capsys, tmp_path):
    status, out, _ = runner(monkeypatch, capsys, tmp_path, command, columns=80)("--help")
    assert status == 0
    assert max(map(len, out.splitlines())) <= 80
    assert len(out.splitlines()) < 130
    assert "…" not in out
    assert "<bool>" not in out
    assert out.count("CHOICE") == out.count("[choices")
    assert f"Example: forcefeel {command}" in out


def test_rare_options_are_named_and_shown_on_request(monkeypatch, capsys, tmp_path):
    run = runner(monkeypatch, capsys, tmp_path, "sweep", columns=80)
    short, full = run("--help")[1], run(HELP_ALL)[1]
    assert re.search(r"shown by --help-all: --width, --input-duration", short)
    assert "Seed of all random numbers." not in short
    assert "Seed of all random numbers." in full


def test_option_has_the_same_meaning_in_every_command():
    helps = {}
    for command in COMMANDS:
        for option in command_line(listed=False)[command].assemble_argument_collection():
            if option.name in {"--units", "--json", "--set", "--threads"}:
                helps.setdefault(option.name, set()).add(option.parameter.help)
    assert set(helps) == {"--units", "--json", "--set", "--threads"}
    assert all(len(said) == 1 for said in helps.values())


def test_rule_named_in_help_is_the_default():
    assert EDITION == DEFAULT_EDITION


@pytest.fixture
def shown(monkeypatch, capsys):
    """The lines that a table becomes on a terminal of so many columns."""

    def show(columns, **options):
        monkeypatch.setenv("COLUMNS", str(columns))
        table = Table("parameter", title="Found", title_justify="left")
        for name in ("estimate", "interval"):
            table.add_column(name, justify="right")
        table.add_row("stiffness of the linkage", "6108 lb/in", "6100 to 6116 lb/in")
        Terminal().show(table, **options)
        return capsys.readouterr().out.splitlines()

    return show


@pytest.mark.parametrize(
    ("columns", "lines"),
    [
        (80, ["│ stiffness of the linkage │ 6108 lb/in │ 6100 to 6116 lb/in │"]),
        (
            56,
            [
                "│ stiffness of the │ 6108 lb/in │ 6100 to 6116 lb/in │",
                "│ linkage │ │ │",
            ],
        ),
        (44, ["stiffness of the linkage", " estimate 6108 lb/in", " interval 6100 to 6116 lb/in"]),
    ],
)
def test_table_does_not_split_words_and_units(shown, columns, lines):
    assert max(map(len, shown(columns))) <= columns
    found = [re.sub(" +", " ", line).rstrip() for line in shown(columns)]
    assert [line for line in lines if line not in found] == []


def test_narrow_table_drops_columns_of_the_page_first(shown):
    found = shown(44, on_the_page=("interval",))
    assert "│ stiffness of the linkage │ 6108 lb/in │" in [line.rstrip() for line in found]
    assert "too narrow for interval; the page has them" in " ".join(found)


@pytest.mark.parametrize(
    ("elapsed", "done", "said"), [(0.3, 10, "a few seconds left"), (2.0, 10, "18 s left"), (60, 25, "3 min 0 s left")]
)
def test_short_remaining_time_is_not_shown_in_seconds(elapsed, done, said):
    now = [0.0]
    bar = Progress(_Left(), get_time=lambda: now[0], disable=True)
    task = bar.add_task("sweep", total=100)
    now[0] = elapsed
    bar.update(task, completed=done)
    assert str(_Left().render(bar.tasks[0])) == said


class _TerminalText(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def error_terminal(monkeypatch):
    """Makes the error stream a terminal; called in the test, since pytest sets its own stream before it."""

    def begin():
        stream = _TerminalText()
        monkeypatch.setenv("TERM", "xterm")
        monkeypatch.setattr("sys.stderr", stream)
        return stream

    return begin


@pytest.mark.parametrize(("waited_s", "expected"), [(0.3, False), (1.3, True)])
def test_progress_line_appears_after_one_second(error_terminal, waited_s, expected):
    stream = error_terminal()
    with all_or_nothing("simulate", silent=False):
        time.sleep(waited_s)
    assert ("simulate" in stream.getvalue()) is expected


def test_progress_line_counts_and_keeps_standard_output(error_terminal, capsys):
    stream = error_terminal()
    with Bar("qualify", "tests", silent=False, even=False) as bar:
        bar.describe("robust, static")
        bar.show(2, 7)
        time.sleep(1.3)
        print("result")
    assert "qualify: robust, static" in stream.getvalue()
    assert "2 of 7 tests" in stream.getvalue()
    assert capsys.readouterr().out == "result\n"


def test_json_output_has_no_progress_line(error_terminal):
    stream = error_terminal()
    with Bar("qualify", "tests", silent=True) as bar:
        bar.show(2, 7)
        time.sleep(1.3)
    assert stream.getvalue() == ""
