"""Every tolerance of a test has a name or a reason: a bare number for a keyword such as ``rtol`` needs a comment."""

import ast
import io
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
KEYWORDS = {"rtol", "atol", "rel", "abs", "rel_tol", "abs_tol"}


def is_bare(value: ast.expr) -> bool:
    """Whether a tolerance is a number, or has one below 1 in it; zero is none, and a few times what has a name is named."""
    numbers = [it.value for it in ast.walk(value) if isinstance(it, ast.Constant) and isinstance(it.value, int | float)]
    alone = not any(isinstance(it, ast.Name | ast.Attribute | ast.Call) for it in ast.walk(value))
    return any(number and (alone or number < 1) for number in numbers)


def lines_of(statement: ast.stmt) -> range:
    """A statement's lines; of one with a body, those of its head."""
    decorators = getattr(statement, "decorator_list", [])
    first = min([statement.lineno, *(it.lineno for it in decorators)])
    body = getattr(statement, "body", None)
    return range(first, body[0].lineno if body else statement.end_lineno + 1)


def unnamed(source: str) -> Iterator[int]:
    """Lines of tolerances that are bare numbers and have no comment in their statement, nor one on the line above it."""
    if not any(f"{keyword}=" in source for keyword in KEYWORDS):  # spared the parser
        return
    nodes = [*ast.walk(ast.parse(source))]
    bare = [node for node in nodes if isinstance(node, ast.keyword) and node.arg in KEYWORDS and is_bare(node.value)]
    if not bare:
        return
    statements = [lines_of(node) for node in nodes if isinstance(node, ast.stmt)]
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    comments = {token.start: token.line for token in tokens if token.type == tokenize.COMMENT}
    beside = {line for line, _ in comments}
    alone = {line for (line, column), text in comments.items() if not text[:column].strip()}
    for node in bare:
        around = min((lines for lines in statements if node.lineno in lines), key=len)
        if beside.isdisjoint(around) and around[0] - 1 not in alone:
            yield node.value.lineno


def test_tolerances_have_a_name_or_a_reason() -> None:
    found = [
        f"{path.relative_to(TESTS.parent)}:{line}"
        for path in sorted(TESTS.rglob("*.py"))
        for line in unnamed(path.read_text(encoding="utf-8"))
    ]
    assert not found, "give these tolerances a name that says why they are so large, or a comment:\n" + "\n".join(found)


@pytest.mark.parametrize(
    ("source", "lines"),
    [
        ("f(rtol=1e-9)", [1]),
        ("f(1,\n  abs=-0.5)", [2]),
        ("f(abs=1)", [1]),
        ("f(abs=1e-3 * size)", [1]),
        ("f(abs=2 * uncertainty + 1e-3)", [1]),
        ("# Of another statement.\nx = 1\nf(rel=1e-9)", [3]),
        ("x = 1  # of another\nf(rel=1e-9)", [2]),
        ("@f(rel=1e-9)\ndef g():\n    return 1  # of the body", [1]),
        ("if f(rel=1e-9):\n    x = 1  # of the body", [1]),
        ("f(rtol=0, atol=ROUNDING)", []),
        ("f(rel=2 * np.finfo(float).eps)", []),
        ("f(rel=SHARE / 10)", []),
        ("f(rel=1e-9)  # nine digits", []),
        ("# Nine digits.\nf(rel=1e-9)", []),
        ("f(\n  rel=1e-9,\n  abs=0,  # nine digits\n)", []),
        ("f(tolerance=1e-9)", []),
        ("assert '#' in f(rel=1e-9)", [1]),
    ],
)
def test_unnamed_tolerances_are_detected(source: str, lines: list[int]) -> None:
    assert list(unnamed(source)) == lines
