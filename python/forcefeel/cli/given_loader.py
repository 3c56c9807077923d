"""The loader that a command is given, with ``--set`` and ``--off``, and the law of ``--compensator`` that is designed for it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from forcefeel.cli.scenario_text import assignments
from forcefeel.errors import InputError
from forcefeel.units import parse

if TYPE_CHECKING:
    from forcefeel.envelope.deviations import Deviation
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader


def given_loader(path: Path | None, changes: Sequence[str] | None) -> "Loader":
    """The loader of ``path``, with ``--set``.

    Raises:
        InputError: If the file or a change is bad.
    """
    from forcefeel.loader.built_in import open_loader  # noqa: PLC0415

    given = assignments("--set", tuple(changes or ()))
    loader = open_loader(path)
    return loader.replace(given) if given else loader


def given_deviations(loader: "Loader", off: Sequence[str] | None) -> "Mapping[str, Deviation]":
    """How far the parameters of a loader may be off: by its tolerances, or as assumed, changed by ``--off``.

    Raises:
        InputError: If an option is bad, or a tolerance of the loader leads out of its row's range.
    """
    from forcefeel.envelope.deviations import chosen_deviations, deviations_of  # noqa: PLC0415
    from forcefeel.sweep import text  # noqa: PLC0415

    usual = deviations_of(loader)
    shares = {key: _share_off(key, given) for key, given in text.assignments("--off", off, _OFF_EXAMPLE).items()}
    asked = chosen_deviations(loader, {key: share for key, share in shares.items() if share is not None})
    for key, share in shares.items():
        if share is None and key not in usual:
            raise InputError(f"--off: {key}: has no case to leave out; there are {', '.join(usual)}")
    kept = {key: it for key, it in usual.items() if shares.get(key, 0.0) is not None}
    return {**kept, **asked}


_OFF_EXAMPLE = "column.inertia=2 %"


def _share_off(key: str, given: str) -> float | None:
    """What ``--off`` says of one parameter; nothing where it is to have no case."""
    try:
        return None if given == "none" else parse(given, "", "2 %")
    except InputError as error:
        raise InputError(f"--off: {key}: {error}") from error


def given_law(law: str | None, loader: "Loader") -> "Law":
    """The law of ``--compensator`` for a loader's own setting: designed for it, or read from its file; the original if not given.

    Raises:
        InputError: Naming the option, if it cannot be designed or read, or is for another controller.
    """
    from forcefeel.laws.law import Law  # noqa: PLC0415

    try:
        return Law.of(law, loader)
    except InputError as error:
        raise InputError(f"--compensator: {str(error).removeprefix('compensator: ')}") from error
