"""The laws that ``--law`` takes, by name or from a file; listed here so that ``--help`` waits for no numerical library."""

from collections.abc import Iterator
from contextlib import contextmanager

from forcefeel.errors import InputError
from forcefeel.printable import visible

LAWS = (
    "original",
    "published",
    "converged",
    "load-cell",
    "observer",
    "recovered",
    "h-infinity",
    "robust",
    "agile",
    "grip",
    "torque-mode",
)
"""As ``forcefeel.laws.law.NAMED_LAWS``."""

ORIGINAL = LAWS[0]

DEFAULT_LAW = "original; robust of an electric loader"
"""For help."""

LAW_METAVAR = "NAME|FILE.json"

LAW_NAMES = (
    f"{', '.join(LAWS[:3])}; with a digital controller {', '.join(LAWS[3:-3])} or {LAWS[-3]}; with a force sensor at the grip too "
    f"{LAWS[-2]}; with a motor {LAWS[-1]}"
)
"""For help."""


def check_law_name(given: str) -> str:
    """A name, or the file of a law.

    Raises:
        InputError: If it is neither.
    """
    if given not in LAWS and not given.endswith(".json"):
        raise InputError(
            f"--law: expected {', '.join(LAWS[:-1])} or {LAWS[-1]}, or the file of a law (.json, from compensate --save-law), "
            f"got {visible(repr(given))}"
        )
    return given


@contextmanager
def law_option_named() -> Iterator[None]:
    """Names the option where a message names the argument that it gives."""
    try:
        yield
    except InputError as error:
        said = str(error)
        if not said.startswith(_ARGUMENT):
            raise
        raise InputError(f"--law: {said.removeprefix(_ARGUMENT)}") from error


_ARGUMENT = "law: "
