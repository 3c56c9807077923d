"""``forcefeel new``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Group, Parameter

from forcefeel.cli.options import OUTPUT, OutputOptions, option
from forcefeel.cli.terminal import print_json
from forcefeel.errors import InputError, suggestion
from forcefeel.files import check_output_file, is_same, write_whole
from forcefeel.loader.axes import AXIS_OF, ELECTRIC_AXES, HYDRAULIC_AXES, control_of
from forcefeel.printable import visible

WHICH = Group("Loader", sort_key=10)


def _name(_: type, tokens: Any) -> str:
    (token,) = tokens
    if token.value not in AXIS_OF:
        got = f"{visible(repr(token.value))}{suggestion(token.value, AXIS_OF)}"
        raise InputError(f"--built-in: expected {', '.join(AXIS_OF)}, got {got}")
    return str(token.value)


@dataclass(frozen=True, kw_only=True)
class NewOptions(OutputOptions):
    """The options of ``forcefeel new``."""

    drive: Annotated[Literal["hydraulic", "electric"] | None, option("Kind of drive.", WHICH)] = None
    axis: Annotated[Literal["pitch", "roll", "yaw", "stick"] | None, option("Control of the cockpit.", WHICH)] = None
    built_in: Annotated[
        str | None,
        option(
            f"Built-in loader: {', '.join(HYDRAULIC_AXES)} with a valve; {', '.join(ELECTRIC_AXES)} with a motor.",
            WHICH,
            default="the first with this drive and axis",
            metavar="NAME",
            converter=_name,
        ),
    ] = None
    data_sheet: Annotated[
        Path | None,
        option(
            "Data sheet of motor, drive and gear: a TOML file with tables such as [motor] and [winding], each in place of the "
            "built-in loader's. Selects --drive electric.",
            WHICH,
            default="the built-in loader's drive",
            metavar="FILE",
        ),
    ] = None
    replace: Annotated[bool, option("Replace an existing file.", OUTPUT)] = False


def run(
    path: Annotated[Path, Parameter("FILE", help="Loader file to write.")],
    /,
    *,
    options: NewOptions = NewOptions(),
) -> None:
    """Write a built-in loader as a commented loader file.

    The default is elevator-2khz, the elevator of the 1974 report under a digital controller. --drive and --axis select others.

    Example: forcefeel new my.toml --drive electric --axis stick --units si
    """
    from forcefeel.loader.built_in import BUILT_IN
    from forcefeel.loader.data_sheet import with_drive

    sheet = options.data_sheet
    if sheet and is_same(sheet, path):
        raise InputError(f"{path} is the data sheet of this loader; name another file")
    check_output_file(path, replace=options.replace)
    loader = BUILT_IN[_chosen(options)]()
    if sheet:
        loader = with_drive(loader, sheet)
    write_whole(path, loader.to_toml(options.units))
    if options.json:
        print_json({"loader_file": str(path), **loader.as_json(options.units)})
    else:
        print(f"wrote {path}; next: forcefeel qualify {path}, forcefeel law {path} --law auto")


def _chosen(options: NewOptions) -> str:
    """The name of the loader that the options mean.

    Raises:
        InputError: If no loader fits.
    """
    drives = dict.fromkeys(HYDRAULIC_AXES, "hydraulic") | dict.fromkeys(ELECTRIC_AXES, "electric")
    drive = options.drive or ("electric" if options.data_sheet and not options.built_in else None)
    fitting = [
        name
        for name, axis in AXIS_OF.items()
        if drive in (None, drives[name])
        and options.axis in (None, control_of(axis))
        and options.built_in in (None, name)
    ]
    if not fitting:
        asked = {"--drive": options.drive, "--axis": options.axis, "--built-in": options.built_in}
        given = " ".join(f"{name} {value}" for name, value in asked.items() if value)
        known = ", ".join(f"{name} ({drives[name]}, {control_of(axis)})" for name, axis in AXIS_OF.items())
        raise InputError(f"{given}: no built-in loader has these; expected {known}")
    return fitting[0]
