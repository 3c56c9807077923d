"""What can be wrong with what a user hands over."""

MOST_LINES = 20
"""Lines that a message shows; of more, how many there are."""

_LONGEST_LINE = 4000
"""Characters: the longest sentence of this package, which lists all parameters, has some 3000."""


class InputError(ValueError):
    """The input is bad: the message names what was given, what was expected and the remedy, and is of bounded length.

    The command line prints the message alone and exits with status 2.
    """

    def __init__(self, message: str) -> None:
        lines = [shortened(line, _LONGEST_LINE) for line in message.split("\n")]
        if len(lines) > MOST_LINES + 1:  # one more than shown is the line that says how many more
            lines[MOST_LINES:] = [f"... and {len(lines) - MOST_LINES:,} more"]
        super().__init__("\n".join(lines))


def shortened(text: str, longest: int) -> str:
    """The text; of one that is longer than so many characters, its beginning."""
    return text if len(text) <= longest else f"{text[: longest - 4]} ..."
