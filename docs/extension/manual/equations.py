"""Equations as pictures in the page, in the color of its text: no script, and nothing fetched from elsewhere."""

import io
import re

from docutils import nodes
from matplotlib import rc_context
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import math_to_image
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

_SIZE_PT = 12.0
_SIZES = re.compile(r'<svg .*?width="([\d.]+)pt" height="([\d.]+)pt" viewBox="([^"]+)"', re.DOTALL)


def drawn(latex: str) -> str:
    """The equation as an SVG that has no size in pixels but in widths of the text's letters.

    Raises:
        ExtensionError: If matplotlib's mathtext cannot draw it.
    """
    picture = io.StringIO()
    try:
        with rc_context({"mathtext.fontset": "dejavuserif", "svg.fonttype": "path", "svg.hashsalt": latex}):
            depth = math_to_image(f"${latex}$", picture, prop=FontProperties(size=_SIZE_PT), format="svg")
    except ValueError as error:
        raise ExtensionError(f"equation {latex!r}: {error}") from error
    text = picture.getvalue()
    width, height, box = _SIZES.search(text).groups()
    paths = text[text.index("<defs>") if "<defs>" in text else text.index("<g ") :]
    paths = re.sub(r"<metadata>.*?</metadata>", "", paths, flags=re.DOTALL)
    # Each picture's letters have names of their own.
    paths = re.sub(r'(id="|href="#)', rf"\g<1>{abs(hash(latex)):x}-", paths)
    # The ground is the page's, not a white sheet.
    paths = re.sub(r'<g id="[^"]*patch_1">.*?</g>', "", paths, count=1, flags=re.DOTALL)
    em = 1 / _SIZE_PT
    style = (
        f"width:{float(width) * em:.3f}em;height:{float(height) * em:.3f}em;vertical-align:{-depth * em / 1.0:.3f}em"
    )
    escaped = latex.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    head = (
        f'<svg class="equation" role="img" aria-label="{escaped}" style="{style}" viewBox="{box}" fill="currentColor">'
    )
    return head + paths.strip()


def inline(self, node: nodes.math) -> None:
    self.body.append(drawn(" ".join(node.astext().split())))
    raise nodes.SkipNode


def block(self, node: nodes.math_block) -> None:
    self.body.append('<div class="equations">')
    for line in re.split(r"\\\\|\n\n", node.astext()):
        if line.strip():
            self.body.append(f"<p>{drawn(' '.join(line.split()))}</p>")
    self.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    app.add_html_math_renderer("pictures", inline_renderers=(inline, None), block_renderers=(block, None))
