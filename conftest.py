"""The blocks of code in the documentation run as tests: Python, and what is typed in a terminal.

What the tutorials and the site type runs as it stands. Lists of commands elsewhere run with fewer machines and settings.
"""

import contextlib
import gc
import io
import os
import re
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from manual.terminal import Answer, Block, Terminal, blocks, commands, missing
from sybil import Document, Example, Region, Sybil
from sybil.integration.pytest import SybilItem
from sybil.parsers.markdown import PythonCodeBlockParser

# The workers already share the cores: BLAS threads would wait for one another, turning. On two cores that took twice to seven times
# the time, also where a test starts commands of its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def pytest_xdist_auto_num_workers() -> int:
    """One worker more than cores: some tests wait for a browser, a cluster or a command of their own."""
    return len(os.sched_getaffinity(0)) + 1 if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Imports and cases stay until the end: to look through them for what can go, each time, costs a fifth of the collection."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


_TERMINALS: dict[str, Terminal] = {}
_PREPARED: dict[str, int] = {}
"""How far down each page what only prepares its blocks was run: a block may be tried without those above it."""

_GRID = '--grid "stiffness=30,100 %" --grid "frequency=1,2 Hz" --grid "damping=0.4,1"'
_FEW = {
    "law": _GRID,
    "envelope": f"{_GRID} --draws 0",
    "frontier": _GRID,
}
"""What is added to a command that asks for settings, unless it is given."""


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
        terminal = _TERMINALS.get(example.path) or Terminal(Path(tempfile.mkdtemp(prefix="forcefeel-docs-")))
        _TERMINALS[example.path] = terminal
        for above in blocks(example.document.text):
            if above.hidden and _PREPARED.get(example.path, -1) < above.start <= block.start:
                terminal.run(small(above.body), fresh=True)
                _PREPARED[example.path] = above.start
        if block.hidden:
            return
        body = block.body if block.language == "terminal" else small(block.body)
        answers = terminal.run(body, fresh=block.language == "console")
    lost = missing(block.shows, answers)
    assert not lost, f"not printed: {lost}; printed: {''.join(one.output for one in answers)[-2000:]}"


def small(body: str) -> str:
    """The same commands for fewer machines and settings."""
    body = re.sub(r"--runs \d+", "--runs 8", body)
    body = body.replace("--law auto", "--law original --envelope")
    body = body.replace("--compare", "--law original").replace("frontier elevator-2khz", "frontier elevator-1974")
    body = re.sub(r":\d+(:log)?([\"'])", r":2\1\2", body)  # the values along an axis
    return "\n".join(_few(line) for line in commands(body))


def _few(line: str) -> str:
    command, *comment = re.split(r"(?<=\S)\s+(?=# )", line, maxsplit=1)
    name = command.split()[1]
    takes_settings = name in _FEW and command.startswith("forcefeel")
    if not takes_settings or (name == "law" and "--envelope" not in command) or "frontier linked" in command:
        return line
    axes = re.findall(r"--grid [\"'](\w+)=", command)
    options = re.findall(r'--\w+ (?:"[^"]*"|\S+)', _FEW[name])
    added = [
        option for option in options if not (option.startswith("--grid") and re.search(r'"(\w+)=', option)[1] in axes)
    ]
    return " ".join([command, *added, *comment])


def elsewhere(namespace: dict[str, object]) -> None:
    """What a page's Python writes, it writes into a folder of its own, beside the examples."""
    namespace["_from"] = Path.cwd()
    os.chdir(tempfile.mkdtemp(prefix="forcefeel-docs-"))
    Path("examples").symlink_to(Path(__file__).parent / "examples")


def back(namespace: dict[str, object]) -> None:
    """Where the other tests are."""
    os.chdir(str(namespace["_from"]))


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with few cases first: theirs are the long ones, and the many short ones fill up what is left to each worker."""
    cases = Counter(item.path for item in items)
    items.sort(key=lambda item: (cases[item.path], str(item.path)))


def pytest_itemcollected(item: pytest.Item) -> None:
    """Marks the examples of the documentation that are slow."""
    if isinstance(item, SybilItem) and getattr(item.example.parsed, "slow", False):
        item.add_marker(pytest.mark.slow)


pytest_collect_file = Sybil(
    parsers=[PythonCodeBlockParser(), typed],
    patterns=["README.md", "docs/*.md", "docs/*/*.md", "examples/*/*.md"],
    setup=elsewhere,
    teardown=back,
).pytest()
