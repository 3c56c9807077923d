"""Plain engineering English: words and identifiers that public text and code must not use."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

LONGEST_SENTENCE = 35
"""Words of a sentence in public text, at most."""

PHRASES = (
    r"\b[Ww]ho(ever)? (has|wants|looks|sends|trusts|designs|reaches|opens)\b",
    r"[Nn]obody",
    r"\bfor ever\b",
    r"nothing else is said",
    r"held against",
    r"as one likes",
    r"\bbe had\b",
    r"hang together",
    r"\b(hears|heard)\b",
    r"handed over",
    r"What (would|asks|lies)\b(?!.*\?)",
    r"\bis none\b",
    r"may be given again",
    r"called so",
    r"Beside this page",
    r"(?i:\b(colour|neighbour|modelled|labelled|initialis)|\bcent(re|red|res)\b|\bmetres?\b)",
)
ANY_PHRASE = re.compile("|".join(PHRASES))

VARIABLES = {
    *("found", "said", "told", "heard", "recalled", "afresh", "given_back"),
    *("looking_on", "left_over", "mine", "theirs", "wish"),
}
TYPES = {"Seen", "Told", "Now", "Made", "Kept", "Before", "Begun", "Wish", "Course"}
PYTHON_NAMES = VARIABLES | TYPES | {"one"}


def sentences(text: str) -> Iterator[str]:
    """Sentences of prose without examples, code spans, links' targets and Jinja tags; a row of a table, or a symbol, is one."""
    text = re.sub(r"^ *(>>>|\.\.\.) .*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"```.*?```|(`+)[^`]+\1|\{%.*?%\}|\{\{.*?\}\}|<[^>]*>|\]\([^)]*\)", " ", text, flags=re.DOTALL)
    text = re.sub(r"^ *=+ +=+ *\n(.+\n?)*", lambda table: table[0].replace("\n", "\n\n"), text, flags=re.MULTILINE)
    for block in re.split(r"\n\s*\n|\n[#*|-]|\|| · ", text):
        yield from (" ".join(sentence.split()) for sentence in re.split(r"(?<=[.;:?!])\s", block))


def hits_in_text(text: str) -> Iterator[str]:
    """The rules that a public text breaks, each as often as it does."""
    if not re.search(r"\s", text) and not ANY_PHRASE.search(text):  # most texts of a module are a key or a unit
        return
    for sentence in sentences(text):
        for phrase in PHRASES if ANY_PHRASE.search(sentence) else ():
            yield from (phrase for _ in re.finditer(phrase, sentence))
        if len(re.findall(r"[A-Za-z]{2,}", sentence)) > LONGEST_SENTENCE:
            yield "long sentence"


def texts_of_python(nodes: list[ast.AST]) -> Iterator[str]:
    """Docstrings and all other texts of a module, an f-string as one."""
    within = {id(part) for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in nodes:
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else "x" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in within:
            yield node.value


def names_of_python(nodes: list[ast.AST]) -> Iterator[str]:
    """Names that a module gives to variables, parameters and types."""
    for node in nodes:
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.ClassDef):
            yield node.name


def hits_in_python(source: str) -> Iterator[str]:
    """The rules that a module breaks."""
    nodes = [*ast.walk(ast.parse(source))]
    for text in texts_of_python(nodes):
        yield from hits_in_text(text)
    yield from (f"name {name}" for name in names_of_python(nodes) if name in PYTHON_NAMES)


def hits_in_code_template(source: str) -> Iterator[str]:
    """The rules that docstrings, comments and texts of a template of code break."""
    for text in re.findall(r'""".*?"""|"[^"\n]*"|#[^\n]*', source, re.DOTALL):
        yield from hits_in_text(text)


def hits_in_rust(source: str) -> Iterator[str]:
    """The rules that the declarations of a file break."""
    bare = re.sub(r"//[^\n]*", "", source)
    names = [
        *re.findall(r"\b(?:let(?: mut)?|ref|mut|for) (\w+)\b", bare),
        *re.findall(r"[(,|]\s*(?:mut )?(\w+)\s*:(?!:)", bare),
    ]
    yield from (f"name {name}" for name in names if name in VARIABLES)
    yield from (f"name {name}" for name in re.findall(r"\b(?:struct|enum|trait|type) (\w+)", bare) if name in TYPES)


def public_types_twice() -> Iterator[str]:
    """Public types of a crate whose name stands twice in it."""
    for crate in sorted((ROOT / "crates").iterdir()):
        names = Counter(
            name
            for path in sorted((crate / "src").rglob("*.rs"))
            for name in re.findall(
                r"^pub (?:struct|enum|trait|type) (\w+)", path.read_text(encoding="utf-8"), re.MULTILINE
            )
        )
        yield from (f"{crate.name}: {name}" for name, count in names.items() if count > 1)


KINDS = {
    ".md": hits_in_text,
    ".rst": hits_in_text,
    ".j2": hits_in_text,
    ".py": hits_in_python,
    ".rs": hits_in_rust,
}
CODE_TEMPLATES = (".py.j2", "Makefile.j2")
PLACES = ("README.md", "docs", "examples", "python", "crates")


def files() -> Iterator[Path]:
    """The files that the rules hold for."""
    for place in PLACES:
        path = ROOT / place
        for file in [path] if path.is_file() else sorted(path.rglob("*")):
            if file.suffix in KINDS and "_pictures" not in file.parts and "tests" not in file.parts:
                yield file


def hits(file: Path) -> Iterator[str]:
    """The rules that a file breaks."""
    rules = hits_in_code_template if file.name.endswith(CODE_TEMPLATES) else KINDS[file.suffix]
    return rules(file.read_text(encoding="utf-8"))


def test_words_and_names_follow_the_rules() -> None:
    broken = [f"{file.relative_to(ROOT)}: {rule}" for file in files() for rule in hits(file)]
    assert not broken, "rewrite in plain engineering English, or with the field's term:\n" + "\n".join(broken)


def test_public_type_names_are_unique_in_their_crate() -> None:
    assert list(public_types_twice()) == []


@pytest.mark.parametrize(
    ("text", "broken"),
    [
        ("Who has a wheel needs none of this.", 1),
        ("If you have a wheel, skip this step.", 0),
        ("`is none` is code, and {% if page is none %} too.", 0),
        ("Its table: nobody has held against the document.", 2),
        (" ".join(["word"] * 36) + ".", 1),
        (" ".join(["word"] * 35) + ".", 0),
        ("What would this cost?", 0),
        ("What lies below a curve can be had.", 2),
        ("The same for every drive.", 0),
        ("It runs for ever.", 1),
        ("``nobody`` and ``is none`` are code.", 0),
        (" · ".join(["``x`` the position of one end"] * 10), 0),
        ("====  ====\n" + "x     word word word word\n" * 10 + "====  ====\n\nNobody.", 1),
    ],
)
def test_phrases_of_a_text_are_counted(text: str, broken: int) -> None:
    assert len(list(hits_in_text(text))) == broken


@pytest.mark.parametrize(
    ("source", "broken"),
    [
        ("found = 1", ["name found"]),
        ("def f(one): return one", ["name one"]),
        ("for one in rows: pass", ["name one"]),
        ("class Seen: pass", ["name Seen"]),
        ("row = result.found", []),
        ("raise InputError(f'{x}: nobody')", ["[Nn]obody"]),
    ],
)
def test_names_of_a_module_are_counted(source: str, broken: list[str]) -> None:
    assert list(hits_in_python(source)) == broken


@pytest.mark.parametrize(
    ("source", "broken"),
    [
        ("run: {{ name }}  # nobody\n", 1),
        ('"""It runs\nfor ever."""\nx = nobody', 1),
        (" ".join(["word"] * 36) + ".", 0),
    ],
)
def test_texts_of_a_code_template_are_counted(source: str, broken: int) -> None:
    assert len(list(hits_in_code_template(source))) == broken


@pytest.mark.parametrize(
    ("source", "broken"),
    [
        ("let found = 1;", ["name found"]),
        ("fn f(told: f64) {}", ["name told"]),
        ("pub struct Seen {", ["name Seen"]),
        ("// let found = 1;", []),
        ("let it = found::new();", []),
    ],
)
def test_names_of_rust_are_counted(source: str, broken: list[str]) -> None:
    assert list(hits_in_rust(source)) == broken
