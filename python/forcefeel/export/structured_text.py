"""A law of one setting as IEC 61131-3 Structured Text, statement by statement from the traced C.

Each statement of the traced period becomes one of Structured Text, in its order, so a controller that rounds LREAL as IEEE 754
double gives the bits of the simulation. Temporaries become variables of a function block; its state is a structure.
"""

import re
from collections.abc import Iterator
from math import prod

from forcefeel._core import LawSource
from forcefeel.errors import InputError
from forcefeel.export.c_code import about, rendered, traced_law
from forcefeel.export.exported import Exported
from forcefeel.export.trace_map import commented

_FILES = {"law.st": "{}_law.st"}
_DECLARED = re.compile(r"^(\s*)(const )?(bool|\w+_real) (\w+)(?: = (.*))?;(.*)$")
_ASSIGNED = re.compile(r"^(\s*)(\S+) = (.*);(.*)$")
_IF = re.compile(r"^(\s*)if \((.*)\) \{(.*)$")
_TABLE = re.compile(r"\bfrom->(m\d+|n)\[(\d+)\](?:\[(\d+)\])?")
_MEMBER = re.compile(r"\w+ (m\d+|n)\[(\d+)\](?:\[(\d+)\])?;")
_NUMBER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)(e-?\d+)?(?![\w.\[\]])")
_CHOICE = re.compile(r"^(\w+) \? (.*) : (.*)$")


def st_names(name: str) -> tuple[str, ...]:
    """File names of :func:`st_files`."""
    return tuple(file.format(name) for file in _FILES.values())


def st_files(exported: Exported) -> dict[str, str | bytes]:
    """The function block, in LREAL.

    Raises:
        InputError: If the law is analog, or has several settings.
    """
    numbers = exported.sampled()
    if numbers.settings > 1:
        raise InputError(f"--to st: expected a law of one setting, got {numbers.settings}; leave --knots out")
    source = traced_law(exported.loader, exported.law, numbers, single=False, linked=exported.linked).source(
        exported.name
    )
    step, declared = _program(commented(source.step), exported.name)
    reset, others = _program(commented(source.reset), exported.name)
    fields = about(exported, numbers, single=False)
    fields |= {
        "states": source.states,
        "inputs": [(name, _number(low), _number(high)) for name, (low, high) in source.inputs],
        "step": step,
        "reset": reset,
        "variables": declared | others,
        "tables": list(_tables(source)),
    }
    return rendered("st", _FILES, fields)


def _tables(source: LawSource) -> Iterator[tuple[str, str, str]]:
    """Name, bounds and numbers of each matrix, row by row."""
    members, values = source.own
    numbers = iter(re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", values[0]))
    for name, rows, columns in _MEMBER.findall(members):
        bounds = [int(size) for size in (rows, columns) if size]
        listed = ", ".join(_number(float(next(numbers))) for _ in range(prod(bounds)))
        yield name, ", ".join(f"0..{size - 1}" for size in bounds), listed


def _program(code: str, name: str) -> tuple[str, dict[str, str]]:
    """The statements, and the type of each variable."""
    lines, variables = [], dict[str, str]()
    for line in code.splitlines():
        if declared := _DECLARED.match(line):
            indent, _, kind, variable, value, remark = declared.groups()
            variables[variable] = "BOOL" if kind == "bool" else "LREAL"
            if value is not None:
                lines.append(f"{indent}{variable} := {_spelled(value, name)};{_remark(remark)}")
        elif begun := _IF.match(line):
            lines.append(f"{begun[1]}IF {_spelled(begun[2], name)} THEN{_remark(begun[3])}")
        elif line.strip() == "} else {":
            lines.append(line.replace("} else {", "ELSE"))
        elif line.strip() == "}":
            lines.append(line.replace("}", "END_IF;"))
        elif assigned := _ASSIGNED.match(line):
            target = assigned[2].replace("state->", "state.").replace("out->", "out_")
            lines.append(f"{assigned[1]}{target} := {_spelled(assigned[3], name)};{_remark(assigned[4])}")
        elif "return" not in line:
            lines.append(_remark(line))
    return "\n".join(lines), variables


def _remark(text: str) -> str:
    return text.replace("/*", "(*").replace("*/", "*)")


def _spelled(value: str, name: str) -> str:
    """An expression of C in Structured Text."""
    if choice := _CHOICE.match(value):
        mask, yes, no = (_spelled(part, name) for part in choice.groups())
        return f"SEL({mask}, {no}, {yes})"
    value = (
        value.replace("state->", "state.")
        .replace("in->", "in_")
        .replace("REAL_SQRT", "SQRT")
        .replace("REAL_ABS", "ABS")
    )
    value = value.replace("&&", "AND").replace("||", "OR").replace("!", "NOT ")
    value = re.sub(r"\b(?:true|false)\b", lambda of: of[0].upper(), value)
    value = value.replace(f"{name}_smaller(", "MIN(").replace(f"{name}_larger(", "MAX(")
    value = _TABLE.sub(lambda of: f"{of[1]}[{', '.join(filter(None, of.groups()[1:]))}]", value)
    return _NUMBER.sub(lambda number: _number(float(number[0])) if "." in number[0] or number[2] else number[0], value)


def _number(value: float) -> str:
    """A literal of LREAL that is read back to the last bit: it needs digits behind a point."""
    digits, _, exponent = repr(value).partition("e")
    return f"{digits if '.' in digits else f'{digits}.0'}{f'E{int(exponent)}' if exponent else ''}"
