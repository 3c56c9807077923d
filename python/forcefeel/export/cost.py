"""Stack and instructions of an exported step on each target whose compiler and emulator are installed.

The stack is the sum of all functions' frames (``-fstack-usage``): an upper bound, for nothing is recursive. The instructions are
the most of any golden sample under QEMU (``-icount shift=0``): a measurement, no bound.
"""

import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from forcefeel.errors import InputError
from forcefeel.templating import environment

_BOARD = Path(__file__).parent / "board"
_EMULATED = {"cortex-m4": "mps2-an386", "cortex-m7": "mps2-an500"}
_STRICT = ("-std=c99", "-O2", "-ffp-contract=off")
_TIMES, _PER_TICK = 8, 40
_LONGEST_S = 300


@dataclass(frozen=True)
class Cost:
    """Cost of a step on a target.

    Attributes:
        target: Processor and compiler.
        stack_bytes: Bound of the stack.
        instructions: Most of any golden sample; 0 if the target is not emulated.
    """

    target: str
    stack_bytes: int
    instructions: int = 0


def measured(
    files: Mapping[str, str | bytes], fields: Mapping[str, object], source: str, program: str = "cost.c"
) -> tuple[Cost, ...]:
    """Costs of the C in ``files``, ``source`` with the step among them, for every target that is installed.

    ``program`` is the template of the program that counts.

    Raises:
        InputError: If no compiler is installed, or one fails.
    """
    with TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(str(text), encoding="utf-8")
        counts = environment(html=False).get_template(f"export/board/{program}.j2").render(fields, times=_TIMES)
        (folder / "cost.c").write_text(counts, encoding="utf-8")
        costs = [_native(folder, source)] if shutil.which("gcc") else []
        if shutil.which("arm-none-eabi-gcc") and shutil.which("qemu-system-arm"):
            costs += [_emulated(folder, source, core) for core in _EMULATED]
    if not costs:
        raise InputError("--measure: expected gcc, or arm-none-eabi-gcc and qemu-system-arm, found none; install one")
    return tuple(costs)


def _native(folder: Path, source: str) -> Cost:
    machine = _run(folder, "gcc", "-dumpmachine").partition("-")[0]
    return Cost(f"{machine}, gcc -O2", _stack(folder, source, "gcc"))


def _emulated(folder: Path, source: str, core: str) -> Cost:
    cpu = (f"-mcpu={core}", "-mthumb", "-mfloat-abi=hard", "-mfpu=auto")
    compiler = ("arm-none-eabi-gcc", *cpu, "-O2", "-ffp-contract=off", "-std=gnu99")
    stack = _stack(folder, source, "arm-none-eabi-gcc", *cpu)
    link = ("--specs=rdimon.specs", "-nostartfiles", "-T", str(_BOARD / "board.ld"), "-Wl,--gc-sections")
    sources = ("cost.c", source, str(_BOARD / "reset.c"))
    _run(folder, *compiler, *link, "-Wl,--no-warnings", "-o", "cost.elf", *sources, "-lm")
    semihosting = ("-nographic", "-semihosting-config", "enable=on,target=native", "-icount", "shift=0")
    ticks = _run(folder, "qemu-system-arm", "-M", _EMULATED[core], *semihosting, "-kernel", "cost.elf")
    return Cost(f"{core}, gcc -O2", stack, round(int(ticks) * _PER_TICK / _TIMES))


def _stack(folder: Path, source: str, *compiler: str) -> int:
    _run(folder, *compiler, *_STRICT, "-fstack-usage", "-c", "-o", "law.o", source)
    frames = next(folder.glob("*.su")).read_text(encoding="utf-8").splitlines()
    return sum(int(line.split("\t")[1]) for line in frames)


def _run(folder: Path, *command: str) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=_LONGEST_S)
    if done.returncode:
        raise InputError(f"--measure: {command[0]} failed: {done.stderr.strip()[:200]}")
    return done.stdout
