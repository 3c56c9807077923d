"""The bar of a command that works for a while, and what an interruption of it means."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from forcefeel.cli.exit_status import INTERRUPTED


class Bar:
    """Runs done, their rate and the time that is left, on the terminal's error stream; nothing where that is no terminal."""

    def __init__(self, *, silent: bool) -> None:
        console = Console(stderr=True)
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:,.0f} of {task.total:,.0f} runs"),
            _Rate(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        self._bar = Progress(*columns, console=console, transient=True, disable=silent or not console.is_terminal)
        self._task = self._bar.add_task("sweep", total=1, start=False, visible=False)
        self.done = self.total = 0

    def show(self, done: int, total: int) -> None:
        """So many runs are done."""
        if not self.total:
            self._bar.start_task(self._task)
        self.done, self.total = done, total
        self._bar.update(self._task, completed=done, total=total, visible=True)

    def describe(self, what: str) -> None:
        """What is being done."""
        self._bar.update(self._task, description=what)

    def stop(self) -> None:
        """Takes the bar off the terminal."""
        self._bar.stop()

    def __enter__(self) -> "Bar":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()


@contextmanager
def all_or_nothing(*, silent: bool) -> Iterator[Bar]:
    """A bar over work that writes at its end: interrupted, it says so, and nothing is written."""
    with Bar(silent=silent) as bar:
        try:
            yield bar
        except KeyboardInterrupt:
            bar.stop()
            print("\nforcefeel: interrupted; nothing is written", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None


class _Rate(ProgressColumn):
    """Runs per second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text(f"{speed:,.0f} per s" if speed else "")
