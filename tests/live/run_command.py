"""The command ``forcefeel run`` in a process of its own."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def run_command(*options, cwd=None) -> Iterator[subprocess.Popen]:
    """Begun, its pipes as text; at the end it is gone, whatever became of it."""
    begun = [sys.executable, "-c", "from forcefeel.cli import main; main()", "run", *options]
    process = subprocess.Popen(begun, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()
