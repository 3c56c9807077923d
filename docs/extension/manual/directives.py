"""Directives: a terminal that was typed in, Python that was run, a picture of what came of it, a recording of the console."""

import contextlib
import io
import tempfile
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives as options
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

from manual.pictures import Camera
from manual.terminal import Answer, Terminal, commands, missing, prepared

_CAMERA = Camera()
_FOLDERS = tempfile.TemporaryDirectory(prefix="forcefeel-site-")
_TERMINALS: dict[str, Terminal] = {}
_NAMES: dict[str, dict[str, Any]] = {}
"""What the Python of each page has defined so far."""

PICTURES = "_pictures"


def terminal(env: BuildEnvironment) -> Terminal:
    """The terminal of the page that is read, in a folder of its own, with what the page prepares unseen."""
    page = env.docname
    if page not in _TERMINALS:
        folder = Path(_FOLDERS.name, page.replace("/", "-"))
        folder.mkdir()
        _TERMINALS[page] = Terminal(folder)
        for body in prepared(Path(env.doc2path(page)).read_text(encoding="utf-8")):
            _TERMINALS[page].run(body)
    return _TERMINALS[page]


class TerminalBlock(SphinxDirective):
    """Commands, and under each what it prints; ``:shows:`` has to be among it, ``:lines:`` cuts it."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {"shows": options.unchanged, "lines": options.unchanged}

    def run(self) -> list[nodes.Node]:
        body = "\n".join(self.content)
        if not self.config.manual_runs:
            return [self._shown(line, "") for line in commands(body)]
        answers = terminal(self.env).run(body)
        _must_show(self.options, answers, self.get_location())
        return [self._shown(answer.command, self._cut(answer.output)) for answer in answers]

    def _cut(self, output: str) -> str:
        lines = [line.rstrip() for line in output.strip("\n").splitlines()]
        if "lines" in self.options:
            low, high = (int(text) if text else None for text in self.options["lines"].split("-"))
            first, last = (low or 1) - 1, high or len(lines)
            lines = ["..."] * (first > 0) + lines[first:last] + ["..."] * (last < len(lines))
        return "\n".join(lines)

    def _shown(self, command: str, output: str) -> nodes.Node:
        typed = f"$ {command}".replace("\n", "\n> ")
        block = nodes.container("", nodes.literal_block(typed, typed, language="shell-session"), classes=["terminal"])
        if output:
            block += nodes.literal_block(output, output, language="text", classes=["output"])
        return block


def _must_show(options: dict[str, Any], answers: list[Answer], where: str) -> None:
    expected = tuple(text.strip() for text in options.get("shows", "").split("|") if text.strip())
    lost = missing(expected, answers)
    if lost:
        raise ExtensionError(f"{where}: not printed: {lost}; printed: {answers[-1].output[-2000:]}")


class RunPython(SphinxDirective):
    """Python that is run, what it prints, and the figure that it leaves."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {"shows": options.unchanged, "alt": options.unchanged}

    def run(self) -> list[nodes.Node]:
        code = "\n".join(self.content)
        source = nodes.literal_block(code, code, language="python")
        if not self.config.manual_runs:
            return [source]
        import matplotlib as mpl  # noqa: PLC0415

        mpl.use("Agg")
        from matplotlib import pyplot  # noqa: PLC0415

        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, self.get_location(), "exec"), _NAMES.setdefault(self.env.docname, {}))
        output = printed.getvalue()
        _must_show(self.options, [Answer("", output, 0)], self.get_location())
        result: list[nodes.Node] = [source]
        if output.strip():
            result.append(nodes.literal_block(output, output, language="text", classes=["output"]))
        if pyplot.get_fignums():
            name = f"{self.env.docname.replace('/', '-')}-{self.lineno}.png"
            picture = Path(self.env.srcdir, PICTURES, name)
            picture.parent.mkdir(exist_ok=True)
            pyplot.savefig(picture, dpi=140, bbox_inches="tight")
            pyplot.close("all")
            result.append(_image(self, f"/{PICTURES}/{name}", self.options.get("alt", "")))
        return result


class Picture(SphinxDirective):
    """The part of a page, written by the terminal of this document, that a CSS selector finds."""

    required_arguments = 1
    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {
        "of": options.unchanged,
        "alt": options.unchanged_required,
        "width": options.positive_int,
    }

    def run(self) -> list[nodes.Node]:
        if "alt" not in self.options:
            raise self.error("a picture has a text for those who cannot see it: give :alt:")
        if not (self.config.manual_pictures and self.config.manual_runs):
            note = nodes.paragraph("", f"(A picture that this build leaves out: {self.options['alt']})")
            return [note]
        page = (terminal(self.env).folder / self.arguments[0]).resolve()
        name = f"{self.env.docname.replace('/', '-')}-{self.lineno}.png"
        _CAMERA.take(
            page, Path(self.env.srcdir, PICTURES, name), self.options.get("of", ""), self.options.get("width", 1100)
        )
        figure = nodes.figure("", _image(self, f"/{PICTURES}/{name}", self.options["alt"]))
        if self.content:
            figure += nodes.caption("", "", *self.parse_inline(" ".join(self.content), lineno=self.content_offset)[0])
        return [figure]


class Recording(SphinxDirective):
    """The console of a built-in loader while a hand moves the column."""

    required_arguments = 1
    option_spec: ClassVar[dict[str, Any]] = {"alt": options.unchanged_required}

    def run(self) -> list[nodes.Node]:
        if not (self.config.manual_pictures and self.config.manual_runs):
            return [nodes.paragraph("", f"(A recording that this build leaves out: {self.options['alt']})")]
        name = f"{self.arguments[0]}.webp"
        _CAMERA.record(self.arguments[0], Path(self.env.srcdir, PICTURES, name))
        return [_image(self, f"/{PICTURES}/{name}", self.options.get("alt", ""))]


def _image(directive: SphinxDirective, uri: str, alt: str) -> nodes.image:
    if not alt:
        raise directive.error("a picture has a text for those who cannot see it: give :alt:")
    return nodes.image("", uri=uri, alt=alt, classes=["picture"])


def setup(app: Sphinx) -> None:
    app.add_directive("terminal", TerminalBlock)
    app.add_directive("run-python", RunPython)
    app.add_directive("picture", Picture)
    app.add_directive("recording", Recording)
    app.connect("build-finished", lambda app, problem: _CAMERA.close())
