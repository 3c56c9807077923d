"""The library inside an FMU: built with the package, one file for every FMU."""

import platform
import sys
from pathlib import Path

from forcefeel.errors import InputError

LIBRARY = Path(__file__).parent / "fmu" / "libforcefeel_fmi.so"
"""Where the build puts it."""

_BUILT_FOR = ("linux", "x86_64")

PLATFORMS = {"2.0": "linux64", "3.0": "x86_64-linux"}
"""What each version of FMI calls the machine that it runs on."""


def library() -> bytes:
    """The library's bytes.

    Raises:
        InputError: If this installation has none.
    """
    machine = (sys.platform, platform.machine())
    if machine != _BUILT_FOR:
        raise InputError(f"to: an FMU is made on {' '.join(_BUILT_FOR)} so far, and this is {' '.join(machine)}")
    try:
        return LIBRARY.read_bytes()
    except OSError as error:
        raise InputError(
            f"to: {LIBRARY.name}, the library inside an FMU, is not in this installation; install the wheel, or build it with make"
        ) from error
