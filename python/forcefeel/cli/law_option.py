"""The laws that ``--law`` takes, by name or from a file; listed here so that ``--help`` waits for no numerical library."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from forcefeel.errors import InputError, suggestion
from forcefeel.printable import visible

if TYPE_CHECKING:
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader

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

ORIGINAL, ROBUST = LAWS[0], LAWS[7]

DEFAULT_LAW = "robust; original on an analog controller"
BENCH_LAW = "original; robust of a motor"
"""For help: the laws under which a loader is recorded."""

LAW_METAVAR = "NAME|FILE.json"

LAW_NAMES = (
    f"{', '.join(LAWS[:3])}; with a digital controller {', '.join(LAWS[3:-3])} or {LAWS[-3]}; with a force sensor at the grip too "
    f"{LAWS[-2]}; with a motor {LAWS[-1]}"
)
"""For help."""


def check_law_name(name: str, others: Sequence[str] = ()) -> str:
    """The name or the file of a law, or one of ``others``, the names that a command takes besides.

    Raises:
        InputError: If it is neither.
    """
    if name not in LAWS and not name.endswith(".json"):
        names = (*others, *LAWS)
        raise InputError(
            f"--law: expected {', '.join(names[:-1])} or {names[-1]}, or a law file (.json, from forcefeel law --save-law), "
            f"got {visible(repr(name))}{suggestion(name, names)}"
        )
    return name


@contextmanager
def law_option_named() -> Iterator[None]:
    """Names the option where a message names the argument that it gives."""
    try:
        yield
    except InputError as error:
        message = str(error)
        if not message.startswith(_ARGUMENT):
            raise
        raise InputError(f"--law: {message.removeprefix(_ARGUMENT)}") from error


_ARGUMENT = "law: "


def chosen_law(law: str | None, loader: "Loader") -> "Law":
    """The law of ``--law`` for a loader's own setting: designed for it, or read from its file; its default law if not given.

    Raises:
        InputError: Naming the option, if it cannot be designed or read, or is for another controller.
    """
    from forcefeel.laws.law import Law

    try:
        return Law.of(law, loader)
    except InputError as error:
        raise InputError(f"--law: {str(error).removeprefix('law: ')}") from error
