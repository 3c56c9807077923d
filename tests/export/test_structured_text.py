"""The law as Structured Text, run by an interpreter of these tests: no free compiler of IEC 61131-3 is installed where they run.

It knows what the export writes: assignments, IF, declarations, and the standard functions ABS, LIMIT, MAX, MIN, SEL and SQRT.
"""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.c_code import traced_law
from forcefeel.export.golden import INPUTS, PART, golden_inputs, within_ranges
from forcefeel.export.structured_text import st_files
from tests.export.toolchain import CONVERTERS, NONLINEAR, motor
from tests.parametrization import mostly_slow

KEYWORDS = set(
    re.findall(
        r"\w+",
        "action at by case do end exit for from function if mod not of on or program repeat return step task then to transition "
        "type until var while with xor and true abs sqrt min max limit sel mux trunc left right mid len find time date real",
    )
)
OPERATORS = {"AND": "and", "OR": "or", "NOT": "not", "TRUE": "True", "FALSE": "False", ":=": "=", "=": "=="}
STANDARD = {
    "ABS": abs,
    "LIMIT": lambda low, x, high: min(max(x, low), high),
    "MAX": max,
    "MIN": min,
    "SEL": lambda chosen, no, yes: yes if chosen else no,
    "SQRT": math.sqrt,
}
TOKEN = re.compile(r"\s*(:=|>=|<=|\d+\.\d+(?:E-?\d+)?|\d+|[A-Za-z_][\w.]*|[-+*/<>=(),;\[\]])")
OUTPUTS = "out_command, out_torque, out_feel_angle, out_feel_rate"


def interpreted(text, name):
    """The function block as a function of its memory and inputs, which gives its outputs; its variables and states."""
    bare = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
    functions = dict(STANDARD)
    for block in re.findall(r"\bFUNCTION (\w+ : .*?)END_FUNCTION\b", bare, re.DOTALL):
        of = block.split()[0]
        given = re.search(r"VAR_INPUT\s+(.*?) :", block)[1]
        body = _python(block.rpartition("END_VAR")[2].replace(f"{of} :=", "result :="))
        exec(f"def {of}({given}):\n{body}    return result\n", functions)
    block = bare.partition(f"FUNCTION_BLOCK {name}_law")[2]
    for table, bounds, numbers in re.findall(r"(\w+) : ARRAY\[(.*?)\] OF LREAL := \[(.*?)\];", block):
        sizes = [int(high) + 1 for high in bounds.replace("0..", "").split(", ")]
        values = [float(number) for number in numbers.split(", ")]
        functions[table] = {
            key if len(sizes) > 1 else key[0]: value for key, value in zip(np.ndindex(*sizes), values, strict=True)
        }
    declared = re.findall(r"^ {4}(\w+) : (\w+);", block, re.MULTILINE)
    states = re.findall(r"^ {4}(\w+) : (\w+);", bare.partition("STRUCT")[2].partition("END_STRUCT")[0], re.MULTILINE)
    inputs = ", ".join(of for of, _ in declared if of.startswith("in_"))
    body = _python(block.rpartition("END_VAR")[2].partition("END_FUNCTION_BLOCK")[0])
    exec(f"def law(state, ready, {OUTPUTS}, {inputs}):\n{body}    return ready, out_good, {OUTPUTS}\n", functions)
    return functions["law"], [of for of, _ in declared], [of for of, _ in states]


def _python(body):
    """Statements as lines of Python; what is not of the grammar above raises."""
    lines, indent, held, place = [], 1, [], 0
    while body[place:].strip():
        token = TOKEN.match(body, place)
        assert token, body[place : place + 60]
        place, word = token.end(), token[1]
        if word in {"THEN", "ELSE"}:
            line = f"if {' '.join(held[1:])}:" if word == "THEN" else "else:"
            lines.append("    " * (indent - (word == "ELSE")) + line)
            indent, held = indent + (word == "THEN"), []
        elif word == ";":
            if held != ["END_IF"]:
                lines.append("    " * indent + " ".join(held))
            indent, held = indent - (held == ["END_IF"]), []
        else:
            held.append(OPERATORS.get(word, word))
    assert (indent, held) == (1, [])
    return "".join(f"{line}\n" for line in lines)


@pytest.fixture(scope="module", params=mostly_slow(["valve", "motor"]))
def exported(request):
    """Every nonlinear part of the feel: a motor with a curve and cogging, a valve with converters."""
    valve = ff.digital_elevator().replace(NONLINEAR | CONVERTERS, si=True)
    return motor() if request.param == "motor" else ff.export.Exported.of("robust", valve, "pitch")


@pytest.fixture(scope="module")
def program(exported):
    return interpreted(st_files(exported)[f"{exported.name}_law.st"], exported.name)


def test_block_gives_the_simulated_bits(exported, program):
    block, declared, states = program
    traced = traced_law(exported.loader, exported.law, exported.sampled(), single=False)
    inputs, pairs = golden_inputs(exported)
    inputs = within_ranges(inputs, traced.source(exported.name))
    given = [INPUTS.index(of.removeprefix("in_")) for of in declared if of.startswith("in_") and of != "in_reset"]
    assert len(states) > 20
    for part in range(0, len(inputs), PART):
        rows = inputs[part : part + PART]
        state = SimpleNamespace(**dict.fromkeys(states, 0.0))
        ready, out, answers = False, [0.0] * 4, []
        for k, row in enumerate(rows.tolist()):
            ready, good, *out = block(state, ready, *out, k == 0, *(row[place] for place in given))
            assert good
            answers.append(out)
        assert np.array_equal(answers, traced.answers(rows, pairs[part : part + PART]))


def test_names_are_declared_once_whatever_their_case_and_are_no_keywords(program):
    names = [name.lower() for name in program[1]]
    assert len(names) == len(set(names)) > 500
    assert not KEYWORDS & set(names)
    assert not [name for name in names if "__" in name or name.startswith("_")]


def test_bad_input_gives_no_command(program):
    block, declared, states = program
    state = SimpleNamespace(**dict.fromkeys(states, 0.0))
    given = {of: 0.0 for of in declared if of.startswith("in_") and of != "in_reset"}
    ready, good, *out = block(state, False, 1.0, 1.0, 1.0, 1.0, False, *given.values())
    assert (ready, good, out[0]) == (False, False, 0.0)
    ready, good, *out = block(state, False, *out, True, *given.values())
    assert (ready, good) == (True, True)
    for bad in (math.nan, math.inf, 1e300):
        ready, good, *out = block(state, True, *out, False, *(given | {"in_force": bad}).values())
        assert (ready, good, out[0]) == (True, False, 0.0)


def test_several_settings_are_refused():
    feel = np.array([[6.8, 34.0, 1085.0], [4.0, 25.0, 800.0]])
    with pytest.raises(ff.InputError, match="--to st: expected a law of one setting, got 2"):
        st_files(ff.export.Exported.of("robust", ff.digital_elevator(), "pitch", feel))
