"""The laws whose loaders are tested, by name."""

from collections.abc import Sequence

from forcefeel.errors import InputError
from forcefeel.laws.law import NAMED_LAWS, ORIGINAL, Law, default_law
from forcefeel.laws.law_file import LAW_FILE
from forcefeel.loader.loader import Loader

LAW_TEXTS = {ORIGINAL: "original loop"} | {name: f"law {name}" for name in NAMED_LAWS if name != ORIGINAL}
"""What each is called in a sentence."""


def named_laws(loader: Loader, names: Sequence[str] | None) -> dict[str, Law]:
    """The laws, designed for a loader or read from their files, for its own setting; its default law where none is named.

    Raises:
        InputError: If a name is unknown or stands twice, or a law cannot be designed or read.
    """
    if names is None:
        names = (default_law(loader),)
    if not names or len(set(names)) < len(names) or not all(_is_law(name) for name in names):
        raise InputError(
            f"laws: expected different ones of {', '.join(NAMED_LAWS)} or files of laws, got "
            f"{', '.join(map(str, names)) or 'none'}"
        )
    return {name: Law.of(name, loader) for name in names}


def _is_law(name: str) -> bool:
    return name in NAMED_LAWS or str(name).endswith(LAW_FILE)
