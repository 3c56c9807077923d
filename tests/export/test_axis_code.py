"""The supervised law in C: the live loop's bits in every state of the supervisor, and all of it run and mapped."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel._core import safety_functions
from forcefeel.export.axis_golden import axis_inputs
from forcefeel.export.firmware_code import board_axis
from forcefeel.export.sections import SECTIONS
from forcefeel.export.trace_map import statements
from forcefeel.loader.parameters import table
from tests.command_line import runs
from tests.export.test_trace_map import LONGEST_NAME, counted, declared
from tests.export.toolchain import (
    BOARDS,
    CONVERTERS,
    GRIP_SENSOR,
    STRICT,
    for_board,
    motor,
    needs,
    on_board,
    run,
    valve,
    written,
)
from tests.parametrization import mostly_slow

ACTED = {
    "emergency stop",
    "drive fault",
    "drive stopped",
    "not a number",
    "out of range",
    "load cell implausible",
    "drive position implausible",
    "column angle implausible",
    "samples late",
    "sensors silent",
    "sensor stuck",
    "sensors disagree",
    "largest force",
    "speed",
    "cycles late",
    "host silent",
    "rate of command",
}
"""Safety functions that act in the golden vectors."""

MISSED = 0.005
"""Share of a period's statements that golden vectors may miss: the rare branches that the map names, and of contact."""

LONGEST_FUNCTION = 1000
"""Lines: two arms that are just not cut, of 400 each, states and inputs that are read, comments."""

RUN_BY_THE_LAW = {"contact"}
"""Sections whose swings the vectors of the law run; under a supervisor a column seldom swings so."""


export = runs("export")


def supervised(exported, out, *, single=False):
    return written(replace(exported, supervised=True), out, single=single)


def plain():
    return ff.export.Exported.of("robust", ff.digital_elevator(), "pitch")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The valve's law in double precision."""
    needs("gcc")
    return supervised(plain(), tmp_path_factory.mktemp("valve"))


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    """A motor's in single precision for two settings, with every nonlinear part of the feel, a spring curve, and cogging."""
    needs("gcc")
    exported = motor()
    feel = exported.settings * [[1.0, 1.0, 1.0], [1.2, 0.8, 1.5]]
    exported = ff.export.Exported.of("robust", exported.loader, exported.name, feel)
    return supervised(exported, tmp_path_factory.mktemp("motor"), single=True)


@pytest.mark.slow
@pytest.mark.parametrize(("compiler", "level"), [("gcc", 2), ("gcc", 0), ("gcc", 3), ("clang", 2)])
def test_valve_matches_the_live_loop_bitwise(folder, compiler, level):
    needs(compiler)
    run(folder, compiler, *STRICT, f"-O{level}", "-o", "program", "pitch_axis.c", "pitch_axis_test.c", "-lm")
    assert run(folder, "./program").endswith(" samples, 0 differ\n")


@pytest.mark.slow
@pytest.mark.parametrize("compiler", mostly_slow(["gcc", "clang"]))
def test_motor_of_two_settings_matches_the_live_loop_bitwise(single, compiler):
    needs(compiler)
    run(single, compiler, *STRICT, "-O1", "-o", "program", "roll_axis.c", "roll_axis_test.c", "-lm")
    assert run(single, "./program").endswith(" samples, 0 differ\n")


LOADERS = {
    "every part, surface, converters": lambda: replace(valve().loader, name="valve"),
    "sensor at the grip": lambda: ff.loader.electric("elevator-electric").replace(GRIP_SENSOR),
    "travel search": lambda: ff.digital_elevator().replace(
        {"safety.travel_search": True, "column.stop_low": "-0.02 rad", "column.stop_high": "0.02 rad"} | CONVERTERS
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_slow(LOADERS))
def test_other_loaders_match_bitwise(name, tmp_path):
    needs("gcc")
    supervised(ff.export.Exported.of("robust", LOADERS[name](), "pitch"), tmp_path)
    run(tmp_path, "gcc", *STRICT, "-O1", "-o", "program", "pitch_axis.c", "pitch_axis_test.c", "-lm")
    assert run(tmp_path, "./program").endswith(" samples, 0 differ\n")


@pytest.mark.slow
@pytest.mark.parametrize("core", BOARDS)
def test_emulated_board_matches_bitwise(single, core):
    needs("arm-none-eabi-gcc", "qemu-system-arm")
    for_board(single, core, "board.elf", "roll_axis_test.c", "roll_axis.c", flags=STRICT)
    assert on_board(single, core, "board.elf").endswith(" samples, 0 differ\n")


def test_golden_vectors_reach_every_state_and_many_functions():
    exported = plain()
    given, words = axis_inputs(exported)
    _, states = board_axis(exported).answers(given, words.tolist(), single=False)
    assert len(given) > 10_000
    assert set(states[:, 1]) == set(range(6))
    acted = int(np.bitwise_or.reduce(states[:, 2]))
    names = [name for name, *_ in safety_functions(exported.loader.si_values, exported.loader.drive, 5e-4)]
    assert {name for k, name in enumerate(names) if acted >> k & 1} >= ACTED
    # Each start is after an acknowledgment, and ends in a trip or off.
    assert np.count_nonzero(np.diff(states[:, 1].astype(int)) == 1) >= 8


@pytest.mark.slow
def test_golden_vectors_run_the_statements_of_a_period(folder, tmp_path):
    """By gcov; what they miss is in sections whose rare branches the map names."""
    needs("gcc", "gcov")
    for file in ("pitch_axis.c", "pitch_axis.h", "pitch_axis_golden.h", "pitch_axis_test.c"):
        (tmp_path / file).write_bytes((folder / file).read_bytes())
    run(tmp_path, "gcc", *STRICT, "--coverage", "-O0", "-o", "covered", "pitch_axis.c", "pitch_axis_test.c", "-lm")
    run(tmp_path, "./covered")
    run(tmp_path, "gcov", "covered-pitch_axis.gcda")
    lines = (tmp_path / "pitch_axis.c.gcov").read_text(encoding="utf-8").splitlines()
    missed = {int(line.split(":")[1]) for line in lines if line.split(":")[0].strip() in {"#####", "====="}}
    mapped = statements((folder / "pitch_axis.c").read_text(encoding="utf-8"))
    assert len(mapped) > 2000
    rare = [statement for statement in mapped if statement.line in missed and statement.section not in RUN_BY_THE_LAW]
    assert len(rare) < MISSED * len(mapped)
    sections = {statement.section for statement in rare}
    assert all(SECTIONS[section].rare for section in sections), sections


@pytest.mark.parametrize(("name", "made"), mostly_slow([("pitch", "folder"), ("roll", "single")]))
def test_every_statement_is_mapped_to_its_line(request, name, made):
    out = request.getfixturevalue(made)
    code = (out / f"{name}_axis.c").read_text(encoding="utf-8")
    document = json.loads((out / "axis_trace.json").read_text(encoding="utf-8"))
    lines, mapped = code.splitlines(), document["statements"]
    assert len(mapped) == counted(code) > 2000
    rows = {*table(ff.loader.electric("elevator-electric").drive), *table(ff.digital_elevator().drive)}
    for statement in mapped:
        assert statement["code"].split()[0] in lines[statement["line"] - 1]
        assert all(row in rows or row.startswith("law.") for row in statement["rows"])
    assert {"sensors", "plausibility", "grip", "sequence", "command"} <= set(document["sections"])
    safety = {row for statement in mapped for row in statement["rows"] if row.startswith("safety.")}
    assert {"safety.absolute_force", "safety.speed_limit", "safety.stop_time", "safety.command_rate"} <= safety
    assert max(map(len, declared(code))) <= LONGEST_NAME


@pytest.mark.parametrize(("name", "made"), mostly_slow([("pitch", "folder"), ("roll", "single")]))
def test_functions_are_short_and_each_value_that_passes_between_them_is_used(request, name, made):
    code = (request.getfixturevalue(made) / f"{name}_axis.c").read_text(encoding="utf-8")
    of_period = code.split(f"}} {name}_axis_values;")
    passing = declared(of_period[0].rsplit("typedef struct {", 1)[1])
    functions = of_period[1].split("\n}\n")
    assert len(functions) > 8
    assert max(function.count("\n") for function in functions) < LONGEST_FUNCTION
    assert passing
    for value in passing:
        used = [function for function in functions if re.search(rf"between->{value}\b", function)]
        assert len(used) > 1, value


@pytest.mark.slow
def test_limits_are_those_of_the_loader_file(tmp_path):
    """Another speed limit changes the C where the row is named, and nowhere else."""
    codes = []
    for limit in ("60 deg/s", "61 deg/s"):
        loader = ff.digital_elevator().replace({"safety.speed_limit": limit})
        out = tmp_path / limit[:2]
        supervised(ff.export.Exported.of("robust", loader, "pitch"), out)
        codes.append(statements((out / "pitch_axis.c").read_text(encoding="utf-8")))
    differing = [a for a, b in zip(*codes, strict=True) if a.code != b.code and "READY" not in a.code]
    assert differing
    assert all("safety.speed_limit" in statement.rows for statement in differing)


def test_law_files_are_the_same_with_and_without(folder, tmp_path):
    written(plain(), tmp_path)
    for file in tmp_path.iterdir():
        if file.name not in {"Makefile", "README.md"}:
            assert file.read_bytes() == (folder / file.name).read_bytes(), file.name
    assert "pitch_axis" not in (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "| 0 | emergency stop |" in (folder / "README.md").read_text(encoding="utf-8")


def test_make_runs_both_tests(folder):
    assert run(folder, "make", "test", "CC=gcc").count(", 0 differ\n") == 2


def test_tunable_rows_and_other_targets_are_refused(export, tmp_path):
    rows = ff.export.Exported.of("robust", ff.digital_elevator(), "pitch", tunable=["feel.breakout=0..10 lb"])
    with pytest.raises(ff.InputError, match="supervisor: the supervised law has a fixed feel; leave --tunable out"):
        written(replace(rows, supervised=True), tmp_path)
    status, _, told = export("elevator-2khz", "--to", "firmware", "--supervisor", "--out", "out")
    assert status == 2
    assert "--supervisor: is for --to c, and --to is firmware; leave it out" in told
    assert list(tmp_path.iterdir()) == []
