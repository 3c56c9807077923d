"""The line of a command that works for a while, and what an interruption of it means."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from forcefeel.cli.exit_status import INTERRUPTED


class Bar:
    """The command, how much is done and the time that is left, on the terminal's error stream; nothing where that is no terminal.

    Args:
        command: Whose line it is.
        what: What is counted, such as runs.
        silent: Whether there is to be no line.
        even: Whether each takes as long, so that the time that is left can be told; the time so far is, where they do not.
    """

    def __init__(self, command: str, what: str, *, silent: bool, even: bool = True) -> None:
        console = Console(stderr=True)
        columns = (
            TextColumn("{task.description}"),
            BarColumn(bar_width=20),
            TextColumn("{task.completed:,.0f} of {task.total:,.0f} " + what),
            _Left() if even else _SoFar(),
        )
        self._command = command
        self._bar = Progress(*columns, console=console, transient=True, disable=silent or not console.is_terminal)
        self._task = self._bar.add_task(command, total=1, start=False, visible=False)
        self.done = self.total = 0

    def show(self, done: int, total: int) -> None:
        """So much is done."""
        if not self.total:
            self._bar.start_task(self._task)
        self.done, self.total = done, total
        self._bar.update(self._task, completed=done, total=total, visible=True)

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
def all_or_nothing(command: str, what: str, *, silent: bool, even: bool = True) -> Iterator[Bar]:
    """A line over work that writes at its end: interrupted, it says so, and nothing is written."""
    with Bar(command, what, silent=silent, even=even) as bar:
        try:
            yield bar
        except KeyboardInterrupt:
            bar.stop()
            print("\nforcefeel: interrupted; nothing is written", file=sys.stderr)
            raise SystemExit(INTERRUPTED) from None


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
