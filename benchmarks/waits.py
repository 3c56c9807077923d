"""How long a user waits: each command of the table on the built-in loader, from the shell to its end, median of three.

    python benchmarks/waits.py [COMMAND ...]

Beside each time stand the processor time, the largest memory, and the time before (two idle cores, another machine). A command must
end with the status of a good or bad answer. `commission` runs on a minute of the bench of `examples/bench-2khz`.

Two idle cores of one machine, s; in brackets the version behind the column ``before``, on the same machine: envelope 33.1
(237), frontier 29.7 (142), law 11.7 (54.6), sweep 14.7 (26.8), design 7.1 (15.4); qualify 2.2 (5.3), simulate 1.1 (2.0).
Of the 26 s of processor time of sweep, 13 are the steps, 4 their noise.
"""

import os
import statistics
import subprocess
import sys
import sysconfig
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

BENCH = Path(__file__).parents[1] / "examples" / "bench-2khz"
"""A minute of a machine of 2 kHz."""
REPEATS = 3
ANSWERS = (0, 1)


@dataclass(frozen=True)
class Command:
    """A command, the seconds that it took before, and those that are asked."""

    words: str
    before_s: float
    asked_s: float


COMMANDS = {
    "envelope": Command("envelope elevator-2khz --law robust", 192, 30),
    "frontier": Command("frontier elevator-2khz", 134, 30),
    "law": Command("law elevator-2khz --law auto", 61, 15),
    "sweep": Command("sweep elevator-2khz --runs 100000", 23, 8),
    "commission": Command(f"commission {BENCH / 'loader.toml'} --data {BENCH / 'shaken.parquet'}", 31, 25),
    "design": Command("design elevator-2khz", 13.9, 5),
    "qualify": Command("qualify elevator-2khz --law robust", 4.8, 2),
    "simulate": Command("simulate elevator-2khz", 3.8, 2),
    "export": Command("export elevator-2khz --to fmu", 4.3, 2),
}


def waited(words: str) -> tuple[float, float, float]:
    """Seconds, seconds of processor time and largest memory in MB of one command in a folder of its own."""
    program = Path(sysconfig.get_path("scripts")) / "forcefeel"
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        child = subprocess.Popen([program, *words.split(), "--out", "out"], cwd=folder, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        seconds = time.perf_counter() - begun
    if os.waitstatus_to_exitcode(status) not in ANSWERS:
        raise SystemExit(f"forcefeel {words}: no answer, status {os.waitstatus_to_exitcode(status)}")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main(names: list[str]) -> None:
    """Print the table."""
    print(f"{'command':10s} {'s':>7s} {'cpu s':>7s} {'MB':>6s} {'before':>7s} {'asked':>6s}")
    for name in names or COMMANDS:
        command = COMMANDS[name]
        seconds, processor, memory = (
            statistics.median(row) for row in zip(*(waited(command.words) for _ in range(REPEATS)), strict=True)
        )
        print(
            f"{name:10s} {seconds:7.1f} {processor:7.1f} {memory:6.0f} {command.before_s:7.1f} {command.asked_s:6.0f}",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
