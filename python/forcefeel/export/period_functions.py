"""The period of an exported axis in functions: 3,400 lines in a row are more than a reader, or a checker of rules, can follow.

A function holds consecutive statements; long arms of branches are cut alike. A value that several functions use is a member
of a structure, and each reads states and inputs by itself. The operations and their order stay those of the trace.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import count

_LONGEST = 400
"""Lines of an arm or a period that is not cut, and of most functions."""
_ENOUGH = 250
"""Lines after which a function ends where its section does."""
_INDENT = "    "

_MARK = re.compile(r"/\* section: (\w+)(?:, continued)? \*/")
_DECLARED = re.compile(r"(?:const )?(\w+) (\w+)(\[\d+\])?(?= =|;)")
_READ = re.compile(r"const \w+ (\w+) = (state|in)->\w+;")
_COMMENT = re.compile(r" /\*.*?\*/")
_WORD = re.compile(r"/\*.*?\*/|(?<![\w.>])[A-Za-z_]\w*")
_POINTERS = {
    "state": "{0}_state *state",
    "in": "{0}_input *in",
    "out": "{0}_output *out",
    "between": "{0}_values *between",
}


@dataclass(frozen=True)
class Period:
    """A period in functions.

    Attributes:
        members: Type and name of each value that passes between functions.
        code: The functions, each before its callers; the last is the period itself.
    """

    members: tuple[tuple[str, str], ...]
    code: str


@dataclass(frozen=True)
class _Statement:
    """A statement, or a branch with a head for each arm; ``calls`` is the function that was cut out in its place."""

    section: str
    lines: tuple[str, ...]
    arms: tuple[tuple["_Statement", ...], ...] = ()
    calls: str = ""

    def size(self) -> int:
        return len(self.lines) + sum(map(_size, self.arms))

    def simple(self) -> Iterator["_Statement"]:
        """The statements and heads in it, without arms."""
        yield replace(self, arms=())
        for arm in self.arms:
            for inner in arm:
                yield from inner.simple()

    def declared(self) -> tuple[str, str, str] | None:
        """Type, name and size of an array, where it declares a value."""
        match = _DECLARED.match(self.lines[0])
        return (match[1], match[2], match[3] or "") if match else None

    def assigns(self) -> bool:
        return "=" in self.lines[0]

    def words(self) -> list[str]:
        return [word for line in self.lines for word in _WORD.findall(line) if not word.startswith("/*")]


_Block = tuple[_Statement, ...]


def _size(block: _Block) -> int:
    return sum(statement.size() for statement in block)


def in_functions(step: str, name: str, first: int) -> Period:
    """The lines of a period in functions; ``name`` begins their names, ``first`` is the number of the first."""
    block, _ = _Parser(map(str.strip, step.splitlines())).block()
    reads = {match[1]: statement for statement in block if (match := _READ.fullmatch(statement.lines[0]))}
    cut = _Cut(name, count(first))
    body = cut.shortened(tuple(statement for statement in block if not _READ.fullmatch(statement.lines[0])))
    functions = cut.functions | {f"{name}_period": body}
    writer = _Writer(name, reads, _members(functions))
    for function, statements in cut.functions.items():
        writer.write(function, statements, writer.pointers(statements))
    writer.write(f"{name}_period", body, {"state": True, "in": False, "out": True})
    return Period(tuple(writer.members.values()), "".join(f"{line}\n" for line in writer.lines))


@dataclass
class _Parser:
    """Statements of the lines of a period; the section of each is that of the last mark."""

    lines: Iterator[str]
    section: str = ""

    def block(self) -> tuple[_Block, str]:
        """The statements up to the end of an arm, and the line that ends it."""
        block: list[_Statement] = []
        begun: list[str] = []
        for line in self.lines:
            if line.startswith("}"):
                return tuple(block), line
            if mark := _MARK.fullmatch(line):
                self.section = mark[1]
                continue
            begun.append(line)
            bare = _COMMENT.sub("", line)
            if bare.endswith("{"):
                block.append(self._branch(line))
            elif bare.endswith(";"):
                block.append(_Statement(self.section, tuple(begun)))
            if bare.endswith(("{", ";")):
                begun = []
        return tuple(block), ""

    def _branch(self, head: str) -> _Statement:
        section, heads, arms = self.section, [head], []
        while heads[-1] != "}":
            arm, end = self.block()
            arms.append(arm)
            heads.append(end)
        return _Statement(section, tuple(heads), tuple(arms))


@dataclass
class _Cut:
    """Functions that were cut out, each before its callers."""

    name: str
    numbers: Iterator[int]
    functions: dict[str, _Block] = field(default_factory=dict)

    def shortened(self, block: _Block) -> _Block:
        """The block, with calls where it or an arm in it is long."""
        block = tuple(replace(statement, arms=tuple(map(self.shortened, statement.arms))) for statement in block)
        return block if _size(block) <= _LONGEST else tuple(map(self._function, _groups(block)))

    def _function(self, group: _Block) -> _Statement:
        section = group[0].section
        called = f"{self.name}_{section}_{next(self.numbers)}"
        self.functions[called] = group
        return _Statement(section, (f"{called}();",), calls=called)


def _groups(block: _Block) -> Iterator[_Block]:
    """Consecutive statements that become a function each; the outputs and states are written in the last."""
    group: list[_Statement] = []
    for statement in block:
        if group:
            size, last = _size(tuple(group)), group[-1]
            is_result = statement.section == "result"
            ends = statement.section != last.section and (size >= _ENOUGH or is_result)
            full = not is_result and size + statement.size() > _LONGEST
            awaits_branch = last.declared() is not None and not last.assigns()
            if (ends or full) and not awaits_branch:
                yield tuple(group)
                group = []
        group.append(statement)
    yield tuple(group)


def _members(functions: Mapping[str, _Block]) -> dict[str, tuple[str, str]]:
    """Type and name, with an array's size, of each value that a function declares and another uses."""
    simple = [(function, inner) for function, block in functions.items() for outer in block for inner in outer.simple()]
    declared = {of[1]: (function, (of[0], of[1] + of[2])) for function, inner in simple if (of := inner.declared())}
    crossing = {
        word for function, inner in simple for word in inner.words() if declared.get(word, (function,))[0] != function
    }
    return {word: member for word, (_, member) in declared.items() if word in crossing}


@dataclass
class _Writer:
    """The lines of the functions, each given the pointers that it or those that it calls need."""

    name: str
    reads: Mapping[str, _Statement]
    members: Mapping[str, tuple[str, str]]
    lines: list[str] = field(default_factory=list)
    given: dict[str, dict[str, bool]] = field(default_factory=dict)
    """The pointers of each function, and whether it writes through them."""
    section: str = ""
    begun: set[str] = field(default_factory=set)

    def pointers(self, block: _Block) -> dict[str, bool]:
        """The pointers that a function needs, and whether it writes through them."""
        needed: dict[str, bool] = {}
        for statement in (inner for outer in block for inner in outer.simple()):
            of_statement = self.given[statement.calls] if statement.calls else self._used(statement)
            for key, writes in of_statement.items():
                needed[key] = needed.get(key, False) or writes
        return needed

    def _used(self, statement: _Statement) -> dict[str, bool]:
        words, declared = statement.words(), statement.declared()
        written = declared[1] if declared else words[0]
        used: dict[str, bool] = {}
        for word in words:
            if word in self.reads:
                used["in" if "= in->" in self.reads[word].lines[0] else "state"] = False
            elif word in self.members:
                # A function that is given an array writes there.
                used["between"] = used.get("between", False) or word == written or self.members[word][1].endswith("]")
            elif word in {"state", "out"}:
                used[word] = True
        return used

    def write(self, function: str, block: _Block, pointers: dict[str, bool]) -> None:
        """A function, after those that it calls."""
        self.given[function] = pointers
        owns = "between" not in pointers and self.members
        kinds = {key: text.format(self.name) for key, text in _POINTERS.items() if key in pointers}
        parameters = ", ".join(text if pointers[key] else f"const {text}" for key, text in kinds.items())
        kind = "static" if owns else f"{self.name}_INLINE"
        self.lines += [f"{kind} void {function}({parameters})", "{"]
        if owns:
            self.lines.append(f"{_INDENT}{self.name}_values between;")
        words = dict.fromkeys(word for outer in block for inner in outer.simple() for word in inner.words())
        self.section = ""
        for statement in (*(self.reads[word] for word in words if word in self.reads), *block):
            self._write(statement, _INDENT, "&between" if owns else "between")
        self.lines += ["}", ""]

    def _write(self, statement: _Statement, indent: str, between: str) -> None:
        if statement.calls:
            given = (between if key == "between" else key for key in _POINTERS if key in self.given[statement.calls])
            self.lines.append(f"{indent}{statement.calls}({', '.join(given)});")
            return
        declared = statement.declared()
        if declared and declared[1] in self.members and not statement.assigns():
            return
        if statement.section != self.section:
            again = ", continued" if statement.section in self.begun else ""
            self.lines.append(f"{indent}/* section: {statement.section}{again} */")
            self.section = statement.section
            self.begun.add(statement.section)
        if not statement.arms:
            first, *more = map(self._spelled, statement.lines)
            self.lines += [indent + first, *(2 * _INDENT + line for line in more)]
            return
        for head, arm in zip(statement.lines, statement.arms, strict=False):
            self.lines.append(indent + self._spelled(head))
            for inner in arm:
                self._write(inner, indent + _INDENT, between)
        self.lines.append(f"{indent}}}")

    def _spelled(self, line: str) -> str:
        """The line, with members by the structure that holds them."""
        if (declared := _DECLARED.match(line)) and declared[2] in self.members:
            line = line[declared.start(2) :]
        return _WORD.sub(lambda word: f"between->{word[0]}" if word[0] in self.members else word[0], line)
