"""What can be wrong with what a user hands over."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from importlib.util import find_spec
from numbers import Integral, Real

MOST_LINES = 20
"""Lines that a message shows; of more, how many there are."""

_LONGEST_LINE = 4000
"""Characters: the longest sentence of this package, which lists all parameters, has some 3000."""


class InputError(ValueError):
    """The input is bad: the message names what was given, what was expected and the remedy, and is of bounded length.

    The command line prints the message alone and exits with status 2.

    Example:
        >>> try:
        ...     ff.elevator().replace({"linkage.stiffness": "7000 lb"})
        ... except ff.InputError as error:
        ...     print(str(error).split(", got ")[1])
        '7000 lb': 'lb' measures a force, not a spring rate
    """

    def __init__(self, message: str) -> None:
        lines = [shortened(line, _LONGEST_LINE) for line in message.split("\n")]
        if len(lines) > MOST_LINES + 1:  # one more than shown is the line that says how many more
            lines[MOST_LINES:] = [f"... and {len(lines) - MOST_LINES:,} more"]
        super().__init__("\n".join(lines))


class UnknownKeyError(InputError, KeyError):
    """A mapping has no such key: a ``KeyError`` for Python's mappings, an ``InputError`` for its user."""

    def __str__(self) -> str:
        return ValueError.__str__(self)


def nearest(name: str, names: Iterable[str]) -> str | None:
    """The known name that is most like an unknown one; ``None`` if none is near."""
    return next(iter(get_close_matches(name, list(names), n=1)), None)


def suggestion(name: str, names: Iterable[str]) -> str:
    """What ends a message on an unknown name: the nearest known one as a question; empty if none is near.

    Example:
        >>> suggestion("robusst", ("original", "robust"))
        '; did you mean robust?'
    """
    close = nearest(name, names)
    return f"; did you mean {close}?" if close else ""


def shortened(text: str, longest: int) -> str:
    """The text; of one that is longer than so many characters, its beginning."""
    return text if len(text) <= longest else f"{text[: longest - 4]} ..."


def expect(name: str, given: object, kind: type | tuple[type, ...], what: str) -> None:
    """Refuses an argument of another type.

    Args:
        name: The argument.
        given: What came.
        kind: What it may be.
        what: The same in words, with an example.

    Raises:
        InputError: If it is something else.
    """
    if not isinstance(given, kind):
        raise InputError(f"{name}: expected {what}, got {type_text(given)}")


def expect_number(name: str, given: object, *, whole: bool = False) -> None:
    """Refuses an argument that is no real number, or no whole one.

    Raises:
        InputError: If so.
    """
    if isinstance(given, bool) or not isinstance(given, Integral if whole else Real):
        raise InputError(f"{name}: expected a {'whole ' if whole else ''}number, got {type_text(given)}")


def type_text(given: object) -> str:
    """What came, by its type; numbers and short texts as they are."""
    match given:
        case None | bool() | int() | float():
            return shortened(repr(given), _LONGEST_GIVEN)
        case str():
            return f"the text {shortened(given, _LONGEST_GIVEN)!r}"
        case type():
            return f"the class {given.__name__} itself"
    return f"a value of type {type(given).__name__}"


_LONGEST_GIVEN = 60


EXTRAS = {
    "pages": ("control", "h5netcdf", "h5py", "matplotlib", "pandas", "plotly", "scipy", "xarray"),
    "cluster": ("dask", "distributed"),
    "fly": ("jsbsim",),
    "parquet": ("pyarrow",),
}
"""Import names by extra, as ``pyproject.toml`` has them."""


class MissingExtraError(InputError, ImportError):
    """A package of an extra is not installed."""


def install_command(extra: str) -> str:
    """What to type for an extra."""
    return f"install it with: pip install 'forcefeel[{extra}]'"


def installed(extra: str) -> bool:
    """Whether the packages of an extra can be imported."""
    return all(find_spec(package) for package in EXTRAS[extra])


@contextmanager
def named_extra() -> Iterator[None]:
    """Names the extra of what is imported within and missing.

    Raises:
        MissingExtraError: If a package of an extra is not installed; other modules' errors pass.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        for extra, packages in EXTRAS.items():
            if missing in packages:
                remedy = f"{missing}: expected an installed package, found none; {install_command(extra)}"
                raise MissingExtraError(remedy) from error
        raise
