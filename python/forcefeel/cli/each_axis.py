"""A command of one loader on a project: on each axis in turn."""

import json
from collections.abc import Callable
from contextlib import nullcontext, redirect_stdout
from dataclasses import replace
from functools import wraps
from inspect import signature
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from forcefeel.cli.options import OUTPUT, JsonOptions, named_options
from forcefeel.cli.terminal import print_json
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from forcefeel.loader.project import Project


def each_axis(
    *,
    of_axis: Callable[["Project", Any, str], Any] = lambda _, options, __: options,
    unless: Callable[["Project"], bool] = lambda _: False,
    of_links: Callable[["Project", Any], dict[str, Any]] | None = None,
    notes: Callable[["Project"], list[str]] = lambda _: [],
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Lets a command take a project: it runs on the loader of each axis, and writes into a folder or file of its name.

    A record of ``forcefeel run`` on the project, or another project, given as input, stands for that of each axis. With ``--json``
    the results stand under ``axes``. The exit status is that of the worst axis.

    Args:
        of_axis: What else the options of an axis have for themselves.
        unless: Whether the command takes a project as a whole.
        of_links: What it does with the links afterwards, from its options; the results stand under ``links``.
        notes: What is to be known of a project before the work; with ``--json`` under ``notes``.
    """
    return lambda run: _on_each(run, of_axis, unless, of_links, notes)


def _on_each(
    run: Callable[..., None],
    of_axis: Callable[["Project", Any, str], Any],
    unless: Callable[["Project"], bool],
    of_links: Callable[["Project", Any], dict[str, Any]] | None,
    notes: Callable[["Project"], list[str]],
) -> Callable[..., None]:
    default = signature(run).parameters["options"].default

    @wraps(run)
    def on_each(path: Path | None = None, /, *, options: Any = default) -> None:
        from forcefeel.loader.axes import judged_alone
        from forcefeel.loader.project import is_project, read_project

        project = read_project(path) if path is not None and is_project(path) else None
        if path is None or project is None or unless(project):
            run(path, options=options)
            return
        of_axes = {axis: of_axis(project, _of_axis(project, axis, options), axis) for axis in project.loaders}
        results, worst, known = {}, 0, notes(project)
        if known and not options.json:
            print(*known, sep="\n")
        for axis, own in of_axes.items():
            printed = StringIO()
            if not options.json:
                print(f"\n{axis}")
            try:
                with redirect_stdout(printed) if options.json else nullcontext():
                    run(project.paths[axis], options=own)
            except InputError as error:
                raise InputError(f"{path}: axes.{axis}: {error}") from error
            except SystemExit as ended:
                worst = max(worst, int(ended.code or 0))
            results[axis] = json.loads(printed.getvalue()) if options.json else None
        links = {} if of_links is None else of_links(project, options)
        if options.json:
            beside = {"links": links, "notes": known}
            print_json(
                {"project": project.name, "axes": results} | {key: value for key, value in beside.items() if value}
            )
        elif of_links is None and (alone := judged_alone(project.loaders)):
            print("", *alone, sep="\n")
        if worst:
            raise SystemExit(worst)

    return on_each


def shaft_notes(project: "Project") -> list[str]:
    """A note for each shaft of a project whose axes are identified one by one."""
    return [
        f"{' and '.join(link.between)} are joined by a shaft: data recorded while it was closed have both columns in them. Take "
        "them with the shaft disconnected."
        for link in project.links.values()
        if link.kind == "mechanical"
    ]


def _of_axis(project: "Project", axis: str, options: JsonOptions) -> JsonOptions:
    """The options for an axis: its own place for each output, its own part of each input.

    Raises:
        InputError: If an input is of one loader.
    """
    changes: dict[str, Any] = {}
    for field, name, group in named_options(type(options)):
        value = getattr(options, field.name)
        if isinstance(value, Path):
            changes[field.name] = _output(value, axis) if group == (OUTPUT,) else _input(project, axis, name, value)
        elif isinstance(value, tuple) and any(isinstance(item, Path) for item in value):
            changes[field.name] = tuple(_input(project, axis, name, item) for item in value)
    return replace(options, **changes)


def _output(path: Path, axis: str) -> Path:
    return path.with_stem(f"{path.stem}-{axis}") if path.suffix else path / axis


def _input(project: "Project", axis: str, name: str, path: Path) -> Path:
    from forcefeel.loader.project import is_project, read_project
    from forcefeel.tables.mcap_table import RECORD

    if path.suffix.lower() == RECORD:
        return path / axis
    if is_project(path) and axis in (other := read_project(path)).paths:
        return other.paths[axis]
    raise InputError(
        f"{name}: {path} is of one loader, and {project.path} is a project; expected a record of forcefeel run on it "
        f"({RECORD}), or a project with the axis {axis}; or give {path} with one of its loaders"
    )
