"""What the pages of the site say with the program itself: commands and their output, pictures, tables, references."""

from pygments.lexers.shell import BashLexer
from sphinx.application import Sphinx

from manual import directives, equations, reference


def setup(app: Sphinx) -> dict[str, bool]:
    """Directives, and the two values of the configuration that say how much is run."""
    app.add_config_value("manual_runs", True, "env", types=[bool])
    app.add_config_value("manual_pictures", True, "env", types=[bool])
    app.add_lexer("console", BashLexer)  # commands without a prompt
    directives.setup(app)
    reference.setup(app)
    equations.setup(app)
    return {"parallel_read_safe": False}
