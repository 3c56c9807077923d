"""Text from templates, each beside the code that fills it; their names are paths within the package."""

import jinja2


def environment(*, html: bool) -> jinja2.Environment:
    """How templates are read: a missing value is an error, tags leave no blank lines, HTML is escaped."""
    return jinja2.Environment(
        loader=jinja2.PackageLoader("forcefeel", ""),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=html,
    )
