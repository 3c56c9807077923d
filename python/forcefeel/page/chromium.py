"""PDF from a page, by a Chromium on the machine: the plots are drawn by the page's own script."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.page.script import SCRIPT, script

VARIABLE = "FORCEFEEL_CHROMIUM"
_NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
_LONGEST_S = 180
_DRAWING_MS = 30_000
"""Time of the page's own clock in which its plots are drawn."""


def find_chromium() -> str:
    """The program.

    Raises:
        InputError: If no Chromium is found.
    """
    given = os.environ.get(VARIABLE)
    executable = shutil.which(given) if given else next(filter(None, map(shutil.which, _NAMES)), None)
    if executable:
        return executable
    what = f"{given!r} of {VARIABLE} is no program" if given else f"none of {', '.join(_NAMES)} is installed"
    raise InputError(
        f"--pdf: the PDF is printed by Chromium, and {what}; install one, set {VARIABLE} to it, or leave --pdf out"
    )


def page_pdf(page: str) -> bytes:
    """A page as PDF.

    Args:
        page: HTML that needs nothing beside it but the script of its plots.

    Raises:
        InputError: If there is no Chromium, or it does not print.
    """
    program = find_chromium()
    with tempfile.TemporaryDirectory(prefix="forcefeel-") as folder:
        source, printed = Path(folder) / "page.html", Path(folder) / "page.pdf"
        source.write_text(page, encoding="utf-8")
        source.with_name(SCRIPT).write_text(script(), encoding="utf-8")
        command = [
            program,
            "--headless",
            "--disable-gpu",
            "--no-first-run",
            "--no-pdf-header-footer",
            f"--user-data-dir={folder}/profile",
            f"--virtual-time-budget={_DRAWING_MS}",
            f"--print-to-pdf={printed}",
            source.as_uri(),
        ]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # Chromium refuses to run as root with it; the page is our own
        try:
            done = subprocess.run(command, capture_output=True, timeout=_LONGEST_S, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise InputError(f"--pdf: {program} does not print ({error}); leave --pdf out") from error
        if not printed.is_file() or not (data := printed.read_bytes()).startswith(b"%PDF"):
            last = done.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
            raise InputError(f"--pdf: {program} printed no PDF ({last[0][:200]}); leave --pdf out")
        return data
