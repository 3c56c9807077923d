"""Builds the firmware libraries of the package, of the targets given or of all: ``make firmware-libraries``.

Needs what tests/export/install installs. A library of the same sources is kept.

Each is one object without bitcode and debugging text, in which only the functions of the header are global: an archive of
5 MB becomes one of 40 to 160 kB, and no name of Rust's or of its floating-point routines meets one of the program's.
"""

import shutil
import subprocess
import sys
import tempfile
from itertools import product
from pathlib import Path

from forcefeel.export.firmware_library import DIGEST, LIBRARIES, TARGETS, compiled, library_name, source_digest

TOOLS = dict(zip(TARGETS, ("arm-none-eabi-", "arm-none-eabi-", "aarch64-linux-gnu-", "x86_64-linux-gnu-"), strict=True))
FUNCTIONS = ("forcefeel_init", "forcefeel_step", "forcefeel_hinge_moment")
SECTIONS = (".llvmbc", ".llvmcmd", ".comment")


def one_object(tools: str, archive: bytes) -> bytes:
    """The archive with one object in it, in which there is only what these functions reach."""

    def run(tool: str, *words: str) -> None:
        subprocess.run([tools + tool, *words], cwd=folder, check=True)

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        (path / "all.a").write_bytes(archive)
        run("ld", "-r", "--gc-sections", *(f"--undefined={name}" for name in FUNCTIONS), "-o", "linked.o", "all.a")
        kept = (f"--keep-global-symbol={name}" for name in FUNCTIONS)
        removed = (f"--remove-section={name}" for name in SECTIONS)
        run("objcopy", "--strip-unneeded", *kept, *removed, "linked.o", "forcefeel.o")
        run("ar", "rcsD", "one.a", "forcefeel.o")
        return (path / "one.a").read_bytes()


def main(*triples: str) -> None:
    digest = LIBRARIES / DIGEST
    if not (digest.is_file() and digest.read_text(encoding="utf-8").strip() == source_digest()):
        shutil.rmtree(LIBRARIES, ignore_errors=True)
    LIBRARIES.mkdir(exist_ok=True)
    for triple, single in product(triples or TARGETS, (False, True)):
        name = library_name(triple, single=single)
        if (LIBRARIES / name).is_file():
            continue
        if not shutil.which(TOOLS[triple] + "ld"):
            print(f"{name}: {TOOLS[triple]}ld was not found; not built")
            continue
        archive = one_object(TOOLS[triple], compiled(triple, single=single))
        (LIBRARIES / name).write_bytes(archive)
        print(f"{name}: {len(archive)} bytes")
    digest.write_text(source_digest() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
