"""The extras of the package: what ``pip install forcefeel`` leaves out, and the command that brings it.

A module imports what it needs where it needs it. What is missing ends in one sentence, here.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from forcefeel.errors import InputError

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
