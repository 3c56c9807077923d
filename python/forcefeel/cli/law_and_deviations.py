"""What ``--deviation`` and ``--law`` make of a loader: how far its parameters may be off, and the law that is designed for it."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from forcefeel.errors import InputError
from forcefeel.units import parse

if TYPE_CHECKING:
    from forcefeel.envelope.deviations import Deviation
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader


def plant_deviations(loader: "Loader", deviations: tuple[str, ...]) -> "Mapping[str, Deviation]":
    """How far the parameters of a loader may be off: by its tolerances, or as assumed, changed by ``--deviation``.

    Raises:
        InputError: If an option is bad, or a tolerance of the loader leads out of its row's range.
    """
    from forcefeel.envelope.deviations import chosen_deviations, deviations_of
    from forcefeel.sweep import text

    usual = deviations_of(loader)
    shares = {
        key: _share_off(key, given)
        for key, given in text.assignments("--deviation", deviations, _DEVIATION_EXAMPLE).items()
    }
    asked = chosen_deviations(loader, {key: share for key, share in shares.items() if share is not None})
    for key, share in shares.items():
        if share is None and key not in usual:
            raise InputError(f"--deviation: {key}: has no case to leave out; there are {', '.join(usual)}")
    kept = {key: it for key, it in usual.items() if shares.get(key, 0.0) is not None}
    return {**kept, **asked}


_DEVIATION_EXAMPLE = "column.inertia=2 %"


def _share_off(key: str, given: str) -> float | None:
    """What ``--deviation`` says of one parameter; nothing where it is to have no case."""
    try:
        return None if given == "none" else parse(given, "", "2 %")
    except InputError as error:
        raise InputError(f"--deviation: {key}: {error}") from error


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
