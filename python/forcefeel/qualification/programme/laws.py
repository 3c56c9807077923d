"""The laws whose loaders are tested, by name."""

from collections.abc import Sequence

from forcefeel._core import Compensator
from forcefeel.errors import InputError
from forcefeel.laws.sampled.setting_laws import NAMED_LAWS, own_law
from forcefeel.laws.sampled_compensator import SampledCompensator
from forcefeel.loader.loader import Loader

ORIGINAL = "original"

LAW_WORDS = {ORIGINAL: "original loop"} | {name: f"{name} compensation" for name in NAMED_LAWS if name != ORIGINAL}
"""What each is called in a sentence."""


def named_laws(loader: Loader, names: Sequence[str]) -> dict[str, Compensator | SampledCompensator | None]:
    """The laws, designed for a loader; ``None`` is the original position loop.

    Raises:
        InputError: If a name is unknown or stands twice, or the recursion does not give the gains.
    """
    if not names or len(set(names)) < len(names) or not set(names) <= set(NAMED_LAWS):
        raise InputError(
            f"laws: expected different ones of {', '.join(NAMED_LAWS)}, got {', '.join(map(str, names)) or 'none'}"
        )
    return {name: own_law(name, loader) for name in names}
