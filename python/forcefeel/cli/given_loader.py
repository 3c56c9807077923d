"""The loader that a command is given, with ``--set``, and the law of ``--compensator`` that is designed for it."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from forcefeel.cli.scenario_text import assignments
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from forcefeel._core import Compensator
    from forcefeel.loader import Loader
    from forcefeel.sampled_compensator import SampledCompensator


def given_loader(path: Path | None, changes: Sequence[str] | None) -> "Loader":
    """The loader of ``path``, with ``--set``.

    Raises:
        InputError: If the file or a change is bad.
    """
    from forcefeel.loader import open_loader  # noqa: PLC0415  the numerical libraries

    given = assignments("--set", tuple(changes or ()))
    loader = open_loader(path)
    return loader.replace(given) if given else loader


def designed_law(law: str, loader: "Loader") -> "Compensator | SampledCompensator | None":
    """The law of ``--compensator``, designed for ``loader``.

    Raises:
        InputError: Naming the option, if it cannot be designed.
    """
    from forcefeel.designs.setting_laws import own_law  # noqa: PLC0415

    try:
        return own_law(law, loader)
    except InputError as error:
        raise InputError(f"--compensator: {str(error).removeprefix('compensator: ')}") from error
