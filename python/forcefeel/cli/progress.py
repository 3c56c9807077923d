"""The line of a command that works for a while, and what an interruption of it means."""

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console, RenderableType
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from forcefeel.cli.exit_status import INTERRUPTED


class Bar:
    """A line on the terminal's error stream: the command, the step, the count, the time. It appears after one second.

    There is no line if the error stream is no terminal.

    Args:
        command: The command.
        what: The unit of the count, such as runs; a step without a count shows the time so far.
        silent: Whether to print nothing, as with ``--json``.
        even: Whether each counted thing takes the same time, so that the remaining time can be estimated.
    """

    def __init__(self, command: str, what: str = "", *, silent: bool, even: bool = True) -> None:
        console = Console(stderr=True)
        columns = (
            TextColumn("{task.description}"),
            BarColumn(bar_width=20),
            _Count(what),
            _Left() if even and what else _SoFar(),
        )
        self._command = command
        self._bar = _AfterOneSecond(
            *columns,
            console=console,
            transient=True,
            redirect_stdout=False,
            disable=silent or not console.is_terminal,
        )
        self._task = self._bar.add_task(command, total=None)
        self.done = self.total = 0

    def show(self, done: int, total: int) -> None:
        """So much is done."""
        self.done, self.total = done, total
        self._bar.update(self._task, completed=done, total=total)

    def steps(self, total: int) -> Callable[[str], None]:
        """What is to be told of each of so many steps as it begins: the one before is done."""
        begun = 0

        def begin(name: str) -> None:
            nonlocal begun
            self.describe(name)
            self.show(begun, total)
            begun += 1

        return begin

    def describe(self, what: str) -> None:
        """What is being done."""
        self._bar.update(self._task, description=f"{self._command}: {what}")

    def stop(self) -> None:
        """Takes the line off the terminal."""
        self._bar.stop()

    def __enter__(self) -> "Bar":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()


@contextmanager
def all_or_nothing(command: str, what: str = "", *, silent: bool, even: bool = True) -> Iterator[Bar]:
    """A ``Bar`` over work that writes at its end: an interruption prints that nothing is written."""
    with Bar(command, what, silent=silent, even=even) as bar:
        try:
            yield bar
        except KeyboardInterrupt:
            bar.stop()
            print("\nforcefeel: interrupted; nothing is written", file=sys.stderr)
            raise SystemExit(INTERRUPTED) from None


class _AfterOneSecond(Progress):
    """A display that stays empty for its first second."""

    def __init__(self, *columns: ProgressColumn, **options: Any) -> None:
        self._begin = time.monotonic()
        super().__init__(*columns, **options)

    def get_renderables(self) -> Iterable[RenderableType]:
        if time.monotonic() - self._begin >= _QUIET_S:
            yield from super().get_renderables()


_QUIET_S = 1.0


class _Count(ProgressColumn):
    """How many are done, of how many."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self._what = what

    def render(self, task: Task) -> Text:
        if task.total is None:
            return Text("")
        return Text(f"{task.completed:,.0f} of {task.total:,.0f} {self._what}")


class _Left(ProgressColumn):
    """The time that is left, if the rest goes as fast as all that is done: the pace of the last seconds alone leaps.

    What comes after what is counted, files and the page, takes a second or two: a time in which these weigh is not told in
    seconds.
    """

    def __init__(self) -> None:
        super().__init__()
        self._done, self._at = 0.0, 0.0

    def render(self, task: Task) -> Text:
        if not task.completed or not task.elapsed or not task.total:
            return Text("")
        if task.completed != self._done:
            self._done, self._at = task.completed, task.elapsed
        left = self._at * (task.total - self._done) / self._done - (task.elapsed - self._at)
        return Text(f"{_time(left) if left > _FEW_SECONDS else 'a few seconds'} left")


_FEW_SECONDS = 8.0


class _SoFar(ProgressColumn):
    """The time that has gone by."""

    max_refresh = 0.5

    def render(self, task: Task) -> Text:
        return Text(f"{_time(task.elapsed)} so far" if task.elapsed else "")


def _time(seconds: float) -> str:
    """A time as a person says it: 45 s, 3 min 20 s, 2 h 5 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
