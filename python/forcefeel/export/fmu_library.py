"""The library inside all FMUs, built with the package."""

import platform
import sys
from pathlib import Path

from forcefeel.errors import InputError

LIBRARY = Path(__file__).parent / "fmu" / "libforcefeel_fmi.so"
"""Path of the library in the package."""

_BUILT_FOR = ("linux", "x86_64")

PLATFORMS = {"2.0": "linux64", "3.0": "x86_64-linux"}
"""Platform name in each version of FMI."""


def library() -> bytes:
    """Bytes of the library.

    Raises:
        InputError: If this installation has no library.
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
