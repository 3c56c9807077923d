"""``forcefeel new``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from forcefeel.cli.options import OUTPUT, OutputOptions, option
from forcefeel.cli.terminal import print_json
from forcefeel.errors import InputError
from forcefeel.files import write_whole


@dataclass(frozen=True, kw_only=True)
class NewOptions(OutputOptions):
    """The options of ``forcefeel new``."""

    built_in: Annotated[
        Literal["elevator", "elevator-2khz"], option("Which: the latter has a digital controller.", OUTPUT)
    ] = "elevator"
    replace: Annotated[bool, option("Replace the file if it is there.", OUTPUT)] = False


def run(
    path: Annotated[Path, Parameter("FILE", help="Loader file to write.")],
    /,
    *,
    options: NewOptions = NewOptions(),
) -> None:
    """Write the built-in elevator loader as a commented loader file.

    Example: forcefeel new my.toml --units si
    """
    from forcefeel.loader.built_in import BUILT_IN

    if path.is_dir():
        raise InputError(f"{path}: is a folder; expected the name of a file to write")
    if path.exists() and not options.replace:
        raise InputError(f"{path}: is there already; choose another name, or --replace to replace it")
    loader = BUILT_IN[options.built_in]()
    write_whole(path, loader.to_toml(options.units))
    if options.json:
        print_json({"loader_file": str(path), **loader.as_json(options.units)})
    else:
        print(f"wrote {path}")
