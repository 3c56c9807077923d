"""Directives of the reference, each made from the program: commands, parameters of a loader, public Python."""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import make_id

from manual.terminal import answered

_COMMAND = re.compile(r"^[│|\s]{1,3}([a-z][a-z-]+)\s{2,}\S", re.MULTILINE)
"""A command in the table of ``forcefeel --help``."""


def command_names() -> list[str]:
    """The commands, as the program's own help lists them."""
    status, page = answered(["--help"], Path.cwd())
    names = [name for name in _COMMAND.findall(page[page.index("Commands") :]) if not name.startswith("-")]
    if status or "qualify" not in names:
        raise ValueError(f"forcefeel --help does not list the commands: {page}")
    return names


class Commands(SphinxDirective):
    """A section for each command with what ``--help-all`` prints; ``#command-NAME`` links to it."""

    def run(self) -> list[nodes.Node]:
        return [self._section(name) for name in command_names()]

    def _section(self, name: str) -> nodes.section:
        status, text = answered([name, "--help-all"], Path.cwd())
        if status:
            raise self.error(f"forcefeel {name} --help-all: exit status {status}")
        text = "\n".join(line.rstrip() for line in text.strip("\n").splitlines())
        section = nodes.section(ids=[f"command-{name}"], names=[f"command-{name}"])
        section += nodes.title("", "", nodes.literal("", f"forcefeel {name}"))
        section += nodes.literal_block(text, text, language="text", classes=["help"])
        return _linked(self, section, f"command-{name}", f"forcefeel {name}")


def _linked(directive: SphinxDirective, section: nodes.section, label: str, title: str) -> nodes.section:
    """Makes the section one that other pages may link to."""
    standard = directive.env.domains.standard_domain
    standard.anonlabels[label] = directive.env.docname, label
    standard.labels[label] = directive.env.docname, label, title
    return section


class Parameters(SphinxDirective):
    """A section for each part of a loader with its rows, from the table that checks loader files."""

    def run(self) -> list[nodes.Node]:
        from forcefeel.loader.parameters import ALTERNATIVES, PARTS, TABLE  # noqa: PLC0415

        rows = {**TABLE, **ALTERNATIVES}
        return [
            self._part(part, words, {key: row for key, row in rows.items() if row.part == part})
            for part, words in PARTS.items()
        ]

    def _part(self, part: str, words: str, rows: dict) -> nodes.section:
        from forcefeel.loader.parameters import range_text  # noqa: PLC0415

        section = nodes.section(ids=[f"part-{part}"], names=[f"part-{part}"])
        section += nodes.title("", "", nodes.literal("", f"[{part}]"))
        section += nodes.paragraph("", f"{words[:1].upper()}{words[1:]}".rstrip(".") + ".")
        table = [("value", "symbol", "meaning", "range", "source")]
        for row in rows.values():
            needed = "" if row.off_si is None else " Optional."
            instead = f" Instead of {', '.join(row.instead_of)}." if row.instead_of else ""
            meaning = row.meaning.rstrip(".") + "." + (instead or needed)
            table.append((row.name, row.symbol, meaning, range_text(row), row.source))
        section += _table(table)
        return _linked(self, section, f"part-{part}", f"[{part}]")


def _table(rows: list[tuple[str, ...]]) -> nodes.table:
    widths = (18, 8, 38, 22, 14)
    group = nodes.tgroup(cols=len(widths))
    group += [nodes.colspec(colwidth=width) for width in widths]
    lines = [
        nodes.row("", *(_entry(cell, literal=n > 0 and k == 0) for k, cell in enumerate(row)))
        for n, row in enumerate(rows)
    ]
    head, body = nodes.thead("", lines[0]), nodes.tbody("", *lines[1:])
    group += [head, body]
    return nodes.table("", group, classes=["parameters"])


def _entry(cell: str, *, literal: bool) -> nodes.entry:
    text = nodes.literal("", cell) if literal else nodes.Text(cell)
    return nodes.entry("", nodes.paragraph("", "", text))


def public_modules() -> Iterator[ModuleType]:
    """The package, then those of its folders that list public names; the commands and the pages are no part of it."""
    package = importlib.import_module("forcefeel")
    yield package
    for info in pkgutil.iter_modules(package.__path__):
        if info.ispkg and info.name not in {"cli", "page"}:
            module = importlib.import_module(f"forcefeel.{info.name}")
            if hasattr(module, "__all__"):
                yield module


class PublicPython(SphinxDirective):
    """All public names, each where it is first listed, as autodoc describes them."""

    def run(self) -> list[nodes.Node]:
        described: dict[int, str] = {}
        return [self._module(module, described) for module in public_modules()]

    def _module(self, module: ModuleType, described: dict[int, str]) -> nodes.section:
        name = module.__name__
        section = nodes.section(ids=[make_id(self.env, self.state.document, "", name)])
        section += nodes.title("", "", nodes.literal("", name))
        lines = [f".. currentmodule:: {name}", ""]
        if name != "forcefeel":
            lines += [*inspect.cleandoc(module.__doc__ or "").splitlines(), ""]
        also = []
        for public in sorted(module.__all__, key=str.lower):
            thing = getattr(module, public)
            if inspect.ismodule(thing):
                continue
            if id(thing) in described:
                also.append(f":py:obj:`~{described[id(thing)]}`")
                continue
            described[id(thing)] = f"{name}.{public}"
            lines += self._described(name, public, thing)
        if also:
            lines += [f"Also here: {', '.join(also)}.", ""]
        self.state.nested_parse(StringList(lines, source=f"{name}.__all__"), 0, section)
        return section

    @staticmethod
    def _described(module: str, name: str, thing: object) -> list[str]:
        if inspect.isclass(thing):
            return [f".. autoclass:: {module}.{name}", "   :members:", ""]
        if callable(thing):
            return [f".. autofunction:: {module}.{name}", ""]
        return [f".. autodata:: {module}.{name}", "   :no-value:", ""]


_AS_WRITTEN: dict[str, list[str]] = {}
"""Docstrings of properties, which napoleon would cut at their first colon."""


def _keep(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    if what in {"property", "attribute"}:
        _AS_WRITTEN[name] = list(lines)


def _restore(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    written = _AS_WRITTEN.pop(name, [])
    if written and not any(re.fullmatch(r"(Raises|Returns|Args):", line) for line in written):
        lines[:] = written


def setup(app: Sphinx) -> None:
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", _keep, priority=400)
    app.connect("autodoc-process-docstring", _restore, priority=600)
    app.add_directive("commands", Commands)
    app.add_directive("parameters", Parameters)
    app.add_directive("public-python", PublicPython)
