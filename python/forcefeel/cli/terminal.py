"""The terminal: names and texts of others are printed as they are, neither as mark-up nor as control sequences."""

import json
from typing import Any

from rich.console import Console
from rich.text import Text

from forcefeel.printable import visible


class Terminal(Console):
    """A console on which text is text; what is to be red says so by its style."""

    def __init__(self) -> None:
        super().__init__(markup=False, emoji=False)

    def render_str(self, text: str, **options: Any) -> Text:
        """Text as it is to be printed."""
        return super().render_str(visible(text), **options)


def print_json(document: object) -> None:
    """What ``--json`` prints."""
    print(json.dumps(document, indent=2, allow_nan=False))
