"""What can be wrong with what a user hands over."""


class InputError(ValueError):
    """The input is bad: the message names what was given, what was expected and the remedy.

    The command line prints the message alone and exits with status 2.
    """
