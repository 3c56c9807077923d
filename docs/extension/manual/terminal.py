"""Blocks of the documentation that a reader types: run as they stand, by the site and by the tests."""

import io
import os
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

PROJECT = Path(__file__).parents[3]
EXAMPLES = "examples"
"""What the folder of a page has of the project, as a copy, where its commands name it."""

COLUMNS = 80
BAD_ANSWER = "exit status 1"
"""In the comment behind a command: its answer is bad, and the page says so. All other commands end with 0."""

INSTALLS = ("git", "make", "python", "pip", "source", "dask")
"""What installs or serves; the build itself and the test of the wheel try it."""

_FENCE = re.compile(
    r"(?P<slow><!-- slow -->\n)?"
    r"(?P<small><!-- small: (?P<swaps>[^\n]+) -->\n)?"
    r"^(?P<fence>`{3,})(?P<language>console|\{terminal\}|\{run-python\})(?P<rest>[^\n]*)\n"
    r"(?P<options>(?::[\w-]+:[^\n]*\n)*)(?P<body>.*?)^(?P=fence)$",
    re.MULTILINE | re.DOTALL,
)
_HIDDEN = re.compile(r"<!-- (?P<language>console)\n(?P<body>.*?)-->", re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A block of a page: what is typed, and what its output has to show."""

    start: int
    end: int
    language: str
    body: str
    shows: tuple[str, ...] = ()
    slow: bool = False
    hidden: bool = False


@dataclass(frozen=True)
class Answer:
    """A command with what it printed."""

    command: str
    output: str
    status: int


def blocks(text: str) -> Iterator[Block]:
    """The blocks of a page that are run, in its order: those that readers type, and those that only prepare them.

    A comment ``<!-- small: --runs 100000 => --runs 200 -->`` over a block says what is changed where it is tried.
    ``;`` parts several. A block below ``<!-- slow -->`` is tried by ``make validate``; so is each block that needs its files.
    """
    matches = [*_FENCE.finditer(text), *_HIDDEN.finditer(text)]
    for match in sorted(matches, key=lambda match: match.start()):
        parts = match.groupdict()
        body = parts["body"]
        for swap in filter(None, (parts.get("swaps") or "").split(";")):
            long, short = (words.strip() for words in swap.split("=>"))
            if long not in body:
                raise ValueError(f"the block below 'small:' does not hold {long!r}")
            body = body.replace(long, short)
        stated = re.search(r"^:shows:(.*)$", parts.get("options") or "", re.MULTILINE)
        shows = tuple(text.strip() for text in stated[1].split("|")) if stated else ()
        slow, hidden = bool(parts.get("slow")), "fence" not in parts
        yield Block(match.start(), match.end(), parts["language"].strip("{}"), body, shows, slow, hidden)


def prepared(text: str) -> list[str]:
    """The blocks of a page that only prepare the others."""
    return [match["body"] for match in _HIDDEN.finditer(text)]


def missing(shows: tuple[str, ...], answers: list[Answer]) -> list[str]:
    """What should have been printed and was not; lines may break anywhere."""
    printed = _flat("".join(answer.output for answer in answers))
    return [show for show in shows if _flat(show) not in printed]


def _flat(text: str) -> str:
    return "".join(re.sub(r"[│┃]", " ", text).split())


class Terminal:
    """A folder in which the commands of a page are run, one after another."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def run(self, body: str, *, fresh: bool = False) -> list[Answer]:
        """Types the lines of a block, each where the folders without a name of those before are gone if it is ``fresh``.

        Raises:
            ValueError: If a command is not of a kind that is known here, or ends with another exit status than its line states.
        """
        answers = []
        for line in commands(body):
            if fresh:
                self._tidy()
            answers.append(self._typed(line))
        return answers

    def _tidy(self) -> None:
        for folder in self.folder.glob("forcefeel-*"):
            shutil.rmtree(folder)

    def _typed(self, line: str) -> Answer:
        program, *words = shlex.split(line.replace("\\\n", " "), comments=True)
        if any(word.startswith(f"{EXAMPLES}/") for word in words) and not (self.folder / EXAMPLES).exists():
            shutil.copytree(PROJECT / EXAMPLES, self.folder / EXAMPLES)
        if program in INSTALLS:
            return Answer(line, "", 0)
        if program in self._own:
            self._own[program](self, *words)
            return Answer(line, "", 0)
        if program != "forcefeel":
            raise ValueError(f"{program}: no command that is known here")
        status, output = answered(words, self.folder)
        stated = int(BAD_ANSWER in line.partition(" # ")[2])
        if status != stated:
            raise ValueError(f"{line}: expected exit status {stated}, got {status}: {output[-1500:]}")
        return Answer(line, output, status)

    def _cd(self, folder: str) -> None:
        self.folder = (self.folder / folder).resolve(strict=True)

    def _cp(self, source: str, target: str) -> None:
        shutil.copy(self.folder / source, self.folder / target)

    def _mkdir(self, folder: str) -> None:
        (self.folder / folder).mkdir(parents=True)

    _own: Mapping[str, Callable[..., None]] = {"cd": _cd, "cp": _cp, "mkdir": _mkdir}


def commands(body: str) -> Iterator[str]:
    """The commands of a block as they are typed: without lines that are empty or a comment, each with its continuations."""
    for line in re.findall(r"(?:[^\n]*\\\n)*[^\n]+", body):
        if not line.lstrip().startswith("#"):
            yield line.strip()


def answered(words: list[str], folder: Path) -> tuple[int, str]:
    """Exit status of ``forcefeel WORDS`` in a folder, and what it printed to a terminal of 80 columns."""
    from forcefeel.cli import main  # noqa: PLC0415

    with _window(["forcefeel", *words], folder) as printed:
        try:
            main()
            status = 0
        except SystemExit as ended:
            status = int(ended.code or 0)
    return status, printed.getvalue()


@contextmanager
def _window(typed: list[str], folder: Path) -> Iterator[io.StringIO]:
    """The process as a command finds it that was typed in a folder; afterwards as it was."""
    previous, argv, environment = Path.cwd(), sys.argv, dict(os.environ)
    started = sys.modules["__main__"]
    package, started.__package__ = started.__package__, None  # by which a program knows that "python -m" started it
    printed = io.StringIO()
    os.chdir(folder)
    sys.argv = typed
    os.environ.update(COLUMNS=str(COLUMNS), NO_COLOR="1", TERM="dumb")
    try:
        with redirect_stdout(printed), redirect_stderr(printed):
            yield printed
    finally:
        os.chdir(previous)
        sys.argv = argv
        started.__package__ = package
        os.environ.clear()
        os.environ.update(environment)
