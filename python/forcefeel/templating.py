"""Text from templates, each beside the code that fills it; their names are paths within the package."""

from collections.abc import Callable
from functools import cache

import jinja2


@cache
def environment(*, html: bool, **filters: Callable[..., str]) -> jinja2.Environment:
    """How templates are read: a missing value is an error, tags leave no blank lines, HTML is escaped.

    One for each set of filters, which keeps the templates that it has compiled.
    """
    templates = jinja2.Environment(
        loader=jinja2.PackageLoader("forcefeel", ""),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=html,
    )
    templates.filters.update(filters)
    return templates
