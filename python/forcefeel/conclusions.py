"""What an engineer should conclude from a result, in sentences."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

from forcefeel.units import to_text

Result = TypeVar("Result")
Found = TypeVar("Found")
Others = ParamSpec("Others")

_KEPT = "_found"


def of_result(findings: Callable[Concatenate[Result, Others], Found]) -> Callable[Concatenate[Result, Others], Found]:
    """What follows from a frozen result, worked out once and kept with it: terminal, JSON and page are handed the same.

    Args:
        findings: A function of a result and of arguments that can be keys, such as the units. Two results never share what it
            gives, and a result that ``dataclasses.replace`` makes begins without.
    """

    @wraps(findings)
    def kept(result: Result, /, *args: Others.args, **options: Others.kwargs) -> Found:
        known: dict[Any, Found] = vars(result).setdefault(_KEPT, {})
        key = (findings.__module__, findings.__qualname__, args, tuple(options.items()))
        if key not in known:
            known[key] = findings(result, *args, **options)
        return known[key]

    return kept


@dataclass(frozen=True)
class Conclusions:
    """What an engineer should conclude.

    Attributes:
        ok: Whether the recursion gave gains and the loader is stable with them at the programmed setting.
        verdict: The result in a line.
        findings: What it rests on and what it does not promise, a sentence or two each.
    """

    ok: bool
    verdict: str
    findings: tuple[str, ...]


def share_text(share: float) -> str:
    """A share in percent; what is not all never reads as 100 %."""
    missing = float(f"{100 * (1 - share):.2g}")
    return f"{to_text(100 - missing, 7) if 0 < missing < 1 else to_text(100 * share, 3)} %"


def interval_text(low: float, high: float) -> str:
    """From one share to another in percent."""
    return f"{share_text(low).removesuffix(' %')} to {share_text(high)}"


def capital(text: str) -> str:
    """The text with a capital at its beginning, unless it begins with the name of a file or a parameter, which has a dot."""
    named = "." in text.partition(" ")[0].rstrip(".:,")
    return text if named else text[:1].upper() + text[1:]
