"""The blocks of code in the documentation run as tests: Python, and what is typed in a terminal."""

import contextlib
import io
import tempfile
from collections.abc import Iterator
from pathlib import Path

from manual.terminal import Answer, Block, Terminal, blocks, missing
from sybil import Document, Example, Region, Sybil
from sybil.parsers.markdown import PythonCodeBlockParser

_TERMINALS: dict[str, Terminal] = {}


def typed(document: Document) -> Iterator[Region]:
    """What the site and its readers run, in the order of the page."""
    for block in blocks(document.text):
        yield Region(block.start, block.end, parsed=block, evaluator=_run)


def _run(example: Example) -> None:
    block: Block = example.parsed
    if block.language == "run-python":
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block.body, example.path, "exec"), example.namespace)
        answers = [Answer("", printed.getvalue(), 0)]
    else:
        if example.path not in _TERMINALS:
            _TERMINALS[example.path] = Terminal(Path(tempfile.mkdtemp(prefix="forcefeel-docs-")))
        answers = _TERMINALS[example.path].run(block.body)
    lost = missing(block.shows, answers)
    assert not lost, f"not printed: {lost}; printed: {''.join(one.output for one in answers)[-2000:]}"


pytest_collect_file = Sybil(
    parsers=[PythonCodeBlockParser(), typed], patterns=["README.md", "docs/*.md", "docs/*/*.md", "examples/*/*.md"]
).pytest()
