"""Traceability of an exported C file: each statement with its equation, loader rows, requirement and golden test.

The map is read from the finished C, so it states nothing that is not there: the head of a section names it and the files of the
model that ask for its operations, and a comment behind a statement names the rows from which its known numbers follow.
"""

import json
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field

from forcefeel.export.sections import SECTIONS, Section
from forcefeel.page.render import render

_MARK = re.compile(r"^( *)/\* section: (\w+)(, continued)? \*/$")
_HEAD = re.compile(r"^ */\* \[(\w+)\]")
_FILE = re.compile(r" /\* file: (\S+) \*/$")
_HEADS = re.compile(r"/\* \[(\w+)\] (.*?)\*/", re.DOTALL)
_MODEL_FILE = re.compile(r"[a-z_/]+\.rs")
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


@dataclass
class _Noted:
    """What the tracer notes behind the statements of a section: rows, files of the model, and whether a number is the setting's."""

    rows: dict[str, None] = field(default_factory=dict)
    files: Counter[str] = field(default_factory=Counter)
    of_setting: bool = False


def commented(code: str, sections: Mapping[str, Section] = SECTIONS, *, settings: int = 1) -> str:
    """The lines of a function with the head of each of its ``sections``: equation, sources, rows of the loader file, setting.

    The sources are the file that derives the equation and those that the tracer has noted behind statements, most often first.
    """
    noted: defaultdict[str, _Noted] = defaultdict(_Noted)
    section = ""
    lines = code.splitlines()
    for line in lines:
        if mark := _MARK.match(line):
            section = mark[2]
        if file := _FILE.search(line):
            noted[section].files[file[1].replace("\\", "/")] += 1
        if listed := _ROWS.search(_FILE.sub("", line)):
            noted[section].rows |= dict.fromkeys(listed[1].split(", "))
        noted[section].of_setting |= _SETTINGS.search(line) is not None
    heads = (
        _section_head(mark, sections[mark[2]], noted[mark[2]], settings)
        if (mark := _MARK.match(line))
        else _FILE.sub("", line)
        for line in lines
    )
    return "".join(f"{line}\n" for line in heads)


def _section_head(mark: re.Match[str], section: Section, noted: _Noted, settings: int) -> str:
    indent, key, again = mark.groups()
    if again:
        return f"{indent}/* [{key}], continued */"
    files = dict.fromkeys((section.source, *(file for file, _ in noted.files.most_common())))
    rows = dict.fromkeys((*noted.rows, *section.rows))
    setting = "numbers of the setting" if noted.of_setting else "the one that is exported" if settings == 1 else "any"
    parts = [f"[{key}] {section.title}: {section.equation}", f"Source: {', '.join(files)}"]
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


def sources(code: str, sections: Mapping[str, Section] = SECTIONS) -> dict[str, list[str]]:
    """Files of the model that the heads of each section of a C file name; of a section without a head, the file of the table."""
    named: defaultdict[str, dict[str, None]] = defaultdict(dict)
    for key, head in _HEADS.findall(code):
        named[key] |= dict.fromkeys(_MODEL_FILE.findall(head))
    return {key: list(named.get(key, {section.source: None})) for key, section in sections.items()}


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
                function, section = head[1], _first_section(head[1])
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


def _first_section(function: str) -> str:
    """The section of a function before it names one."""
    return "off" if function.endswith("_init") else "status" if function.endswith(_STATUS) else "numbers"


def _statement(line: int, function: str, section: str, code: str) -> Statement:
    listed = _ROWS.search(f" {code}")
    rows = tuple(listed[1].split(", ")) if listed else ()
    bare = _bare(code)
    return Statement(line, function, section, bare, rows, _SETTINGS.search(bare) is not None)


def _bare(code: str) -> str:
    return _COMMENT.sub("", code)


def trace_json(file: str, code: str, name: str, sections: Mapping[str, Section] = SECTIONS) -> str:
    """The map as JSON: sections with equation, source, requirement and test; statements with line and rows."""
    mapped = statements(code)
    used, files = {statement.section for statement in mapped}, sources(code, sections)
    spelled = {
        key: asdict(section)
        | {"source": [f"crates/model/src/{file}" for file in files[key]], "test": section.test.format(name=name)}
        for key, section in sections.items()
        if key in used
    }
    document = {"file": file, "sections": spelled, "statements": [asdict(statement) for statement in mapped]}
    return json.dumps(document, indent=1) + "\n"


def trace_html(
    file: str, code: str, name: str, sections: Mapping[str, Section] = SECTIONS, *, document: str = "trace.json"
) -> str:
    """The map as a page: a table of sections, then each function's statements; the JSON file is ``document``."""
    mapped = statements(code)
    functions = {
        function: [statement for statement in mapped if statement.function == function]
        for function in dict.fromkeys(statement.function for statement in mapped)
    }
    used, files = dict.fromkeys(statement.section for statement in mapped), sources(code, sections)
    counted = [
        (
            key,
            sections[key],
            ", ".join(files[key]),
            sections[key].test.format(name=name),
            sum(of.section == key for of in mapped),
        )
        for key in used
    ]
    return render(
        "export/c/trace.html.j2",
        command="",
        name=name,
        file=file,
        count=len(mapped),
        document=document,
        sections=counted,
        rare={key: sections[key].rare for key in used if sections[key].rare},
        functions=functions,
    )
