"""How options are spelled: once, as the fields of a frozen dataclass, which the command line parses and the command takes.

A field's annotation holds its help and its group; `option` makes that. Options that mean the same everywhere are fields of the
classes here, from which a command's own options are derived::

    @dataclass(frozen=True, kw_only=True)
    class QualifyOptions(LoaderOptions, FolderOptions, OutputOptions):
        axis: Annotated[ControlAxis, option("Which control of the rule.", TESTS)] = ControlAxis.PITCH
"""

import shlex
import sys
from collections.abc import Iterator
from dataclasses import Field, dataclass, fields, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

from cyclopts import Group, Parameter
from cyclopts.help import DefaultFormatter, HelpPanel
from rich.console import Console, ConsoleOptions

from forcefeel.cli.law_option import BENCH_LAW, DEFAULT_LAW, LAW_METAVAR, LAW_NAMES, check_law_name
from forcefeel.cli.scenario_text import assignments
from forcefeel.errors import InputError, install_command, installed
from forcefeel.loader.axes import ELECTRIC_AXES, HYDRAULIC_AXES
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.loader.loader import Loader
    from forcefeel.loader.project import Project

HELP_ALL = "--help-all"

EDITION = "part60-a-2014"
"""As ``forcefeel.qualification.DEFAULT_EDITION``; here so that help waits for no numerical library."""


class _Rare(DefaultFormatter):
    """The panel of options that are seldom needed: their names alone, unless all help is asked for."""

    def __call__(self, console: Console, options: ConsoleOptions, panel: HelpPanel) -> None:
        if HELP_ALL in sys.argv:
            super().__call__(console, options, panel)
        elif panel.entries:
            names = ", ".join(name for entry in panel.entries for name in entry.positive_names)
            console.print(f"Rarely needed, shown by {HELP_ALL}: {names}\n", highlight=False, style="dim")


LOADER = Group("Loader and law", sort_key=80)
OUTPUT = Group("Output", sort_key=90)
WORK = Group("Computation", sort_key=95)
RARE = Group("Rarely needed", sort_key=99, help_formatter=_Rare())


def option(help: str, group: Group, *names: str, default: str | None = None, **more: Any) -> Parameter:  # noqa: A002
    """The help of an option and its group, as what `typing.Annotated` holds.

    Args:
        help: What it is for.
        group: Under which head the help shows it.
        names: Its name, where it is not the field's.
        default: What holds where it is not given, in words; where it is not given either, the field's default is shown.
        more: What else Cyclopts takes.
    """
    shown: Any = default if default is not None else _default_text
    # A value may begin with a minus: -10 deg.
    return Parameter(names or None, help=help, group=group, show_default=shown, allow_leading_hyphen=True, **more)


def _default_text(value: object) -> str | None:
    """A default that is worth a word; nothing given, none, and a switch that is off are not."""
    return None if value is None or value is False or value in ((), "") else str(value)


_LOADER = f"Loader file, or a built-in one: {', '.join(HYDRAULIC_AXES)}; electric: {', '.join(ELECTRIC_AXES)}"

LoaderFile = Annotated[Path | None, Parameter("LOADER", help=f"{_LOADER}.", show_default="elevator-2khz")]
"""The argument that every command on a loader takes."""

LoaderOrProject = Annotated[
    Path | None,
    Parameter(
        "LOADER",
        help=f"{_LOADER}; or a project file, whose table [axes] names the loader of each axis of a cockpit.",
        show_default="elevator-2khz",
    ),
]
"""The argument of a command that takes a cockpit too."""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class JsonOptions:
    """What every command has."""

    json: Annotated[bool, option("Print the result as JSON.", OUTPUT)] = False

    def command_line(self, path: Path | None) -> str:
        """The command that these options ask of a loader, as it is typed.

        What is left out has no say in the result: where it is written, where it is computed, and what is as it is without.
        """
        command = type(self).__name__.removesuffix("Options").lower()
        words = ["forcefeel", command, *([] if path is None else [str(path)])]
        for field, name, group in named_options(type(self)):
            if group in ((OUTPUT,), (WORK,)) and field.name != "units":
                continue
            value = getattr(self, field.name)
            if value == field.default:
                continue
            for item_value in value if isinstance(value, tuple) else (value,):
                words += [name] if item_value is True else [name, _typed(item_value)]
        return shlex.join(words)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class OutputOptions(JsonOptions):
    """What every command has that shows or writes numbers with units."""

    units: Annotated[UnitSystem, option("Units of printed and written values.", OUTPUT)] = UnitSystem.US


def named_options(kind: type) -> Iterator[tuple[Field[Any], str, object]]:
    """The fields of an options class, each with its name on the command line and its group."""
    hints = get_type_hints(kind, include_extras=True)
    for field in fields(kind):
        (parameter,) = (metadata for metadata in hints[field.name].__metadata__ if isinstance(metadata, Parameter))
        (name,) = parameter.name or (f"--{field.name.replace('_', '-')}",)
        yield field, name, parameter.group


def _typed(value: object) -> str:
    """A value as it is typed."""
    return value.name.lower().replace("_", "-") if isinstance(value, Enum) else str(value)


Setup = TypeVar("Setup")


def filled(kind: type[Setup], options: object, **others: Any) -> Setup:
    """A wing's frozen setup: each field from the option of the same name, ``others`` what is read from options first."""
    names = {field.name for field in fields(kind)} & {field.name for field in fields(options)} - others.keys()  # type: ignore[arg-type]
    given = {name: getattr(options, name) for name in names}
    return kind(**{name: it.value if isinstance(it, Enum) else it for name, it in given.items()}, **others)


@dataclass(frozen=True, kw_only=True)
class FolderOptions:
    """What every command that writes a folder has; each gives `out` its own default."""

    replace: Annotated[bool, option("Replace existing results in the folder.", OUTPUT)] = False


def page_folder(out: Path | None, default: Path) -> Path | None:
    """The folder of a command that writes a page by default; ``None`` and a message if none is given without the extra."""
    if out is None and not installed("pages"):
        print(f"no page is written: the extra 'pages' is not installed; {install_command('pages')}", file=sys.stderr)
        return None
    return default if out is None else out


@dataclass(frozen=True, kw_only=True)
class ThreadOptions:
    """What every command has that falls into pieces."""

    threads: Annotated[
        int | None,
        option("Number of threads.", WORK, default="all cores"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class LoaderOptions:
    """What every command on a loader has that may be changed."""

    set_: Annotated[
        tuple[str, ...],
        option(
            "Change a value of the loader, such as 'column.coulomb_friction=3 lb', 'controller.period=0.5 ms', "
            "'valve.orifice=true', 'feel.breakout=off'. Repeatable.",
            LOADER,
            "--set",
            metavar="NAME=VALUE",
        ),
    ] = ()

    def loader(self, path: Path | None) -> "Loader":
        """The loader of ``path``, or the built-in one, with ``--set``.

        Raises:
            InputError: If the file or a change is bad.
        """
        from forcefeel.loader.built_in import open_loader

        return self.changed(open_loader(path))

    def project(self, path: Path | None, **of_one_loader: object) -> "Project | None":
        """The project of ``path``, each of its loaders with ``--set``; ``None`` if it is no project.

        Args:
            path: The file.
            of_one_loader: What was given for options that are for one loader, by their names.

        Raises:
            InputError: If the project, a change or one of its loaders is bad, or an option is for one loader.
        """
        from forcefeel.loader.project import is_project, read_project

        if path is None or not is_project(path):
            return None
        for name, given in of_one_loader.items():
            if given:
                raise InputError(
                    f"--{name}: is for one loader, and {path} is a project; give it with one of its loaders"
                )
        project = read_project(path)
        return replace(project, loaders=project.each(lambda _, loader: self.changed(loader)))

    def changed(self, loader: "Loader") -> "Loader":
        """``loader`` with ``--set``.

        Raises:
            InputError: If a change is bad.
        """
        return loader.replace(assignments("--set", self.set_)) if self.set_ else loader


@dataclass(frozen=True, kw_only=True)
class DataSheetOptions(LoaderOptions):
    """What a command has for which a drive is chosen."""

    data_sheet: Annotated[
        Path | None,
        option(
            "Data sheet of motor, drive and gear: a TOML file with tables such as [motor] and [winding], each in place of "
            "the loader's.",
            LOADER,
            default="the loader's drive",
            metavar="FILE",
        ),
    ] = None

    def loader(self, path: Path | None) -> "Loader":
        """The loader of ``path``, with the drive of ``--data-sheet`` and with ``--set``.

        Raises:
            InputError: If a file or a change is bad.
        """
        from forcefeel.loader.built_in import open_loader
        from forcefeel.loader.data_sheet import with_drive

        loader = open_loader(path)
        return self.changed(loader if self.data_sheet is None else with_drive(loader, self.data_sheet))


def _law(_: type, tokens: Any) -> str:
    (token,) = tokens
    return check_law_name(token.value)


def _law_option(help: str, default: str) -> Any:  # noqa: A002
    return option(help, LOADER, "--law", default=default, metavar=LAW_METAVAR, converter=_law)


LawOption = Annotated[
    str | None,
    _law_option(
        f"Law, designed for this loader: {LAW_NAMES}; or a law file from forcefeel law --save-law.", DEFAULT_LAW
    ),
]
"""``--law`` of a command that takes one."""

SoftenOption = Annotated[
    bool,
    option(
        "Soften a feel that the drive cannot render, to the nearest that it can, instead of letting it saturate.",
        LOADER,
    ),
]
"""``--soften`` of a command that runs one loader."""

BenchLawOption = Annotated[
    str | None,
    _law_option(f"Law under which the whole loader is recorded: {LAW_NAMES}; or a law file.", BENCH_LAW),
]
"""``--law`` of a command on bench data."""
