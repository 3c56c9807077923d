"""How right the remaining time is that a command shows: a tenth of the way, a quarter, half.

    python benchmarks/remaining_time.py [COMMAND ...]

Commands whose steps are of unequal length show the time so far, and none that is left. Each command here runs in a folder that
goes; "shown over actual" is to lie between 1/1.5 and 1.5 from a tenth of its time on.
"""

import os
import sys
import tempfile
import time
from contextlib import redirect_stdout
from io import StringIO

from forcefeel.cli import main, progress

GRID = "--grid stiffness=5..100%:4:log --grid frequency=0.6..3Hz:4:log --grid damping=0.3,0.7 --draws 10"
SMALL = "--grid stiffness=5..100%:2:log --grid frequency=0.8..3Hz:3:log --grid damping=0.3,0.7"
COMMANDS = {
    "envelope": f"elevator-2khz --law robust {GRID}",
    "sweep": "--set column.coulomb_friction=2lb --runs 60000",
    "frontier": "elevator-2khz --grid stiffness=2..60%:3:log --grid frequency=1..3Hz:2 --grid damping=0.3,0.7",
    "law": f"elevator-2khz --law auto {SMALL}",
}
MARKS = (0.1, 0.25, 0.5)


class Watched(progress.Bar):
    """A line that remembers when how much was done."""

    told: list[tuple[float, int, int]]
    ended = 0.0

    def show(self, done: int, total: int) -> None:
        """So much is done."""
        super().show(done, total)
        LINES[-1].told.append((time.perf_counter(), done, total))

    def __enter__(self) -> "Watched":
        self.told = []
        LINES.append(self)
        super().__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.ended = time.perf_counter()
        super().__exit__()


LINES: list[Watched] = []


def ratios(line: Watched) -> list[float]:
    """Shown over actual remaining time at each of the marks; not a number where nothing is shown yet."""
    begun = line.told[0][0]
    found = []
    for mark in MARKS:
        now = begun + mark * (line.ended - begun)
        _, done, total = [one for one in line.told if one[0] <= now][-1]
        shown = (now - begun) * (total - done) / done if done else float("nan")
        found.append(shown / (line.ended - now))
    return found


if __name__ == "__main__":
    progress.Bar = Watched  # type: ignore[misc]
    for name in sys.argv[1:] or COMMANDS:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            sys.argv = ["forcefeel", name, *COMMANDS[name].split()]
            try:
                with redirect_stdout(StringIO()):
                    main()
            except SystemExit:
                pass
            os.chdir("/")
        line = LINES[-1]
        shown = ", ".join(f"{ratio:.2f} at {mark:.0%}" for mark, ratio in zip(MARKS, ratios(line), strict=True))
        print(f"{name}: {line.ended - line.told[0][0]:.1f} s; shown over actual: {shown}", flush=True)
