"""The laws whose loaders are tested, by name."""

from collections.abc import Sequence

from forcefeel._core import Compensator
from forcefeel.compensation import NAMED_DESIGNS, compensate
from forcefeel.errors import InputError
from forcefeel.loader import Loader

ORIGINAL = "original"

LAW_WORDS = {ORIGINAL: "original loop", "published": "published compensation", "converged": "converged compensation"}
"""What each is called in a sentence."""


def named_laws(loader: Loader, names: Sequence[str]) -> dict[str, Compensator | None]:
    """The laws, designed for a loader; ``None`` is the original position loop.

    Raises:
        InputError: If a name is unknown or stands twice, or the recursion does not give the gains.
    """
    if not names or len(set(names)) < len(names) or not set(names) <= set(NAMED_DESIGNS):
        raise InputError(
            f"laws: expected different ones of {', '.join(NAMED_DESIGNS)}, got {', '.join(map(str, names)) or 'none'}"
        )
    return {name: _law(loader, name) for name in names}


def _law(loader: Loader, name: str) -> Compensator | None:
    settings = NAMED_DESIGNS[name](loader)
    if settings is None:
        return None
    found = compensate(loader, settings)
    if not found.reached:
        raise InputError(f"laws: the recursion does not give the {name} gains for this loader: {found.note}")
    return found.compensator(loader)
