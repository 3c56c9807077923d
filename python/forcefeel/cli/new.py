"""``forcefeel new``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Group, Parameter

from forcefeel.cli.options import OUTPUT, OutputOptions, option
from forcefeel.cli.terminal import print_json
from forcefeel.errors import InputError
from forcefeel.files import write_whole

WHICH = Group("Which loader", sort_key=10)


@dataclass(frozen=True, kw_only=True)
class NewOptions(OutputOptions):
    """The options of ``forcefeel new``."""

    drive: Annotated[Literal["hydraulic", "electric"] | None, option("What moves the linkage.", WHICH)] = None
    axis: Annotated[Literal["pitch", "roll", "yaw", "stick"] | None, option("Which control it is.", WHICH)] = None
    built_in: Annotated[
        Literal[
            "elevator",
            "elevator-2khz",
            "elevator-electric",
            "aileron-wheel",
            "rudder-pedals",
            "sidestick-pitch",
            "sidestick-roll",
            "desktop-yoke",
        ]
        | None,
        option(
            "Which by its name: the elevators with a valve, the latter with a digital controller; the others with a motor.",
            WHICH,
            default="the first of that drive and axis",
        ),
    ] = None
    replace: Annotated[bool, option("Replace the file if it is there.", OUTPUT)] = False


def run(
    path: Annotated[Path, Parameter("FILE", help="Loader file to write.")],
    /,
    *,
    options: NewOptions = NewOptions(),
) -> None:
    """Write a built-in loader as a commented loader file: the 1974 elevator, or one with another drive, of another axis.

    Example: forcefeel new my.toml --drive electric --axis stick --units si
    """
    from forcefeel.loader.built_in import BUILT_IN

    if path.is_dir():
        raise InputError(f"{path}: is a folder; expected the name of a file to write")
    if path.exists() and not options.replace:
        raise InputError(f"{path}: is there already; choose another name, or --replace to replace it")
    loader = BUILT_IN[_chosen(options)]()
    write_whole(path, loader.to_toml(options.units))
    if options.json:
        print_json({"loader_file": str(path), **loader.as_json(options.units)})
    else:
        print(f"wrote {path}")


def _chosen(options: NewOptions) -> str:
    """The name of the loader that the options mean.

    Raises:
        InputError: If there is none.
    """
    from forcefeel.loader.built_in import ELECTRIC_AXES

    axes = dict.fromkeys(("elevator", "elevator-2khz"), ("hydraulic", "pitch"))
    axes |= {name: ("electric", axis) for name, axis in ELECTRIC_AXES.items()}
    fitting = [
        name
        for name, (drive, axis) in axes.items()
        if options.drive in (None, drive) and options.axis in (None, axis) and options.built_in in (None, name)
    ]
    if not fitting:
        asked = {"--drive": options.drive, "--axis": options.axis, "--built-in": options.built_in}
        given = " ".join(f"{name} {value}" for name, value in asked.items() if value)
        known = ", ".join(f"{name} ({drive}, {axis})" for name, (drive, axis) in axes.items())
        raise InputError(f"{given}: there is no such loader; built in are {known}")
    return fitting[0]
