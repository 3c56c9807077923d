"""Traceability of an exported C file: each statement with its equation, loader rows, requirement and golden test.

The map is read from the finished C, so it states nothing that is not there: the head of a section names it, and a comment behind a
statement names the rows from which its known numbers follow.
"""

import json
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass

from forcefeel.export.sections import SECTIONS, VECTORS, Section
from forcefeel.page.render import render

_MARK = re.compile(r"^( *)/\* section: (\w+)(, continued)? \*/$")
_HEAD = re.compile(r"^ */\* \[(\w+)\]")
_ROWS = re.compile(r" /\* ([a-z_]+\.[a-z_0-9, .]+) \*/$")
_FUNCTION = re.compile(r"^(?!typedef|#|/\*|\s).*?\b(\w+)\(.*\)(?: \{ (.*) \})?$")
_SETTINGS = re.compile(r"\b(?:from|to|s\d)->")
_STATUS = (
    "_is_good",
    "_is_between",
    "_is_tuned",
    "_reset",
    "_tune",
    "_step",
    "_hinge_moment",
    "_period",
    "_rest",
    "_surface",
    "_sample",
    "_init",
)
_COMMENT = re.compile(r" /\*.*?\*/")
_WIDTH = 150


@dataclass(frozen=True)
class Statement:
    """A statement of the C.

    Attributes:
        line: Its first line in the file, from 1.
        function: The function that it stands in.
        section: Key of ``SECTIONS``.
        code: The statement.
        rows: Rows of the loader file, or parts of the law's numbers, that its known numbers follow from.
        setting: Whether it uses numbers of the feel's setting.
    """

    line: int
    function: str
    section: str
    code: str
    rows: tuple[str, ...]
    setting: bool


def commented(code: str, *, settings: int = 1) -> str:
    """The lines of a function with the head of each section: equation, source, rows of the loader file, setting."""
    lines = code.splitlines()
    rows: dict[str, dict[str, None]] = {}
    changing, section = set(), ""
    for line in lines:
        if mark := _MARK.match(line):
            section = mark[2]
        if listed := _ROWS.search(line):
            rows.setdefault(section, {}).update(dict.fromkeys(listed[1].split(", ")))
        if _SETTINGS.search(line):
            changing.add(section)
    heads = (
        _section_head(mark, list(rows.get(mark[2], ())), changing=mark[2] in changing, settings=settings)
        if (mark := _MARK.match(line))
        else line
        for line in lines
    )
    return "".join(f"{line}\n" for line in heads)


def _section_head(mark: re.Match[str], rows: list[str], *, changing: bool, settings: int) -> str:
    indent, key, again = mark.groups()
    section = SECTIONS[key]
    if again:
        return f"{indent}/* [{key}], continued */"
    rows = list(dict.fromkeys((*rows, *section.rows)))
    setting = "numbers of the setting" if changing else "the one that is exported" if settings == 1 else "any"
    parts = [f"[{key}] {section.title}: {section.equation}", f"Source: {section.source}"]
    parts += [f"Rows: {', '.join(rows)}"] if rows else []
    parts += [f"Setting: {setting}"]
    words = [word for part in parts for word in (*part.split(), "\n")][:-1]
    text, line = [], ""
    for word in words:
        if word == "\n" or len(line) + len(word) > _WIDTH:
            text.append(line.rstrip())
            line = ""
        line += "" if word == "\n" else f"{word} "
    return f"{indent}/* " + f"\n{indent} * ".join((*text, line.rstrip())) + " */"


def statements(code: str) -> tuple[Statement, ...]:
    """All statements of a C file, in their order."""
    return tuple(_statements(code.splitlines()))


def _statements(lines: list[str]) -> Iterator[Statement]:
    function, section, within_comment, inside = "", "", False, False
    begin, held = 0, ""
    for number, line in enumerate(lines, start=1):
        if within_comment:
            within_comment = "*/" not in line
            continue
        if head := _HEAD.match(line):
            section = head[1]
        if line.lstrip().startswith("/*"):
            within_comment = "*/" not in line
            continue
        if not inside:
            if (head := _FUNCTION.match(line)) and not line.endswith(";"):
                function, section = head[1], "status" if head[1].endswith(_STATUS) else "numbers"
                if head[2]:
                    yield _statement(number, function, section, head[2])
            inside = line == "{" and bool(function)
            continue
        if line == "}":
            inside, function = False, ""
            continue
        begin = number if not held else begin
        held = f"{held} {line.strip()}".strip()
        bare = _bare(held)
        if bare in {"}", "} else {"}:
            held = ""
        elif bare.endswith(";") or (bare.endswith("{") and "= {" not in bare):
            yield _statement(begin, function, section, held)
            held = ""


def _statement(line: int, function: str, section: str, code: str) -> Statement:
    listed = _ROWS.search(f" {code}")
    rows = tuple(listed[1].split(", ")) if listed else ()
    bare = _bare(code)
    return Statement(line, function, section, bare, rows, _SETTINGS.search(bare) is not None)


def _bare(code: str) -> str:
    return _COMMENT.sub("", code)


def trace_json(file: str, code: str, name: str, vectors: str = VECTORS) -> str:
    """The map as JSON: sections with equation, source, requirement and test; statements with line and rows.

    ``vectors`` is the test of the sections that the golden vectors of a law would run.
    """
    mapped = statements(code)
    used = {statement.section for statement in mapped}
    sections = {
        key: asdict(section) | {"source": _paths(section.source), "test": _test(section, name, vectors)}
        for key, section in SECTIONS.items()
        if key in used
    }
    document = {"file": file, "sections": sections, "statements": [asdict(statement) for statement in mapped]}
    return json.dumps(document, indent=1) + "\n"


def _test(section: Section, name: str, vectors: str) -> str:
    return (vectors if section.test == VECTORS else section.test).format(name=name)


def _paths(files: str) -> list[str]:
    return [f"crates/model/src/{file}" for file in files.split(", ")]


def trace_html(file: str, code: str, name: str, vectors: str = VECTORS) -> str:
    """The map as a page: a table of sections, then each function's statements; ``vectors`` as of ``trace_json``."""
    mapped = statements(code)
    functions = {
        function: [statement for statement in mapped if statement.function == function]
        for function in dict.fromkeys(statement.function for statement in mapped)
    }
    used = dict.fromkeys(statement.section for statement in mapped)
    sections = [
        (
            key,
            SECTIONS[key],
            _test(SECTIONS[key], name, vectors),
            sum(statement.section == key for statement in mapped),
        )
        for key in used
    ]
    return render(
        "export/c/trace.html.j2",
        command="",
        name=name,
        file=file,
        count=len(mapped),
        sections=sections,
        rare={key: SECTIONS[key].rare for key in used if SECTIONS[key].rare},
        functions=functions,
    )
