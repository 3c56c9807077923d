"""The commands by the place where each stands: loaded when it is called, so that help answers at once.

A command's file holds its options, a frozen dataclass, and ``run``, which takes them.
"""

import ast
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

from cyclopts import App, Parameter
from cyclopts.exceptions import (
    CoercionError,
    CycloptsError,
    MissingArgumentError,
    RepeatArgumentError,
    UnknownCommandError,
    UnusedCliTokensError,
)

from forcefeel.cli.options import HELP_ALL
from forcefeel.cli.terminal import Output
from forcefeel.errors import InputError, named_extra, suggestion

_LOADER = "[LOADER]"
_COMMANDS = {
    "new": "FILE",
    "feel": "[LOADER] --from FILE --out FILE",
    "size": _LOADER,
    "design": _LOADER,
    "analyze": _LOADER,
    "law": _LOADER,
    "simulate": _LOADER,
    "sweep": _LOADER,
    "envelope": _LOADER,
    "frontier": _LOADER,
    "schedule": f"{_LOADER} --knots FILE",
    "qualify": _LOADER,
    "identify": f"{_LOADER} --data FILE --fit PARAMETERS",
    "resonance": f"{_LOADER} --data FILE",
    "excite": f"{_LOADER} --fit PARAMETERS",
    "commission": f"{_LOADER} --data FILE",
    "run": _LOADER,
    "emulate": _LOADER,
    "bus": _LOADER,
    "bridge": "SIMULATOR",
    "fly": _LOADER,
    "export": f"{_LOADER} --to TARGET",
    "reproduce": "",
}
"""The commands in the order of the work, and what each takes and needs."""


def _version() -> str:
    from importlib.metadata import version

    return f"forcefeel {version('forcefeel')}"


def command_line(*, listed: bool, helped: str = "") -> App:
    """The commands; ``listed`` with a line on each, for the list of them; ``helped`` with its help in whole paragraphs."""
    app = App(
        name="forcefeel",
        help="Design, prove and run the force feel of aircraft simulator controls.",
        usage="Usage: forcefeel COMMAND [OPTIONS]",
        help_epilogue="forcefeel COMMAND --help lists the options of a command.\n\n"
        "Exit status: 0 fine, 1 the answer is bad (such as an unstable design), 2 the input is bad, 70 internal error: please "
        "report it with the output under FORCEFEEL_TRACEBACK=1.",
        help_format="plaintext",
        help_flags=["--help", HELP_ALL],
        version=_version,
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
        result_action="return_none",
        console=Output(),
    )
    for place, (name, takes) in enumerate(_COMMANDS.items()):
        app.command(
            f"{_PLACE}.{name}:run",
            name=name,
            help=_paragraphs(name)[0] if listed else "\n\n".join(_paragraphs(name)) if name == helped else None,
            sort_key=place,
            usage=" ".join(f"Usage: forcefeel {name} {takes} [OPTIONS]".split()),
            help_epilogue="",
        )
    return app


_PLACE = "forcefeel.cli"


def _paragraphs(command: str) -> list[str]:
    """The paragraphs of a command's help, a line each, which the terminal breaks.

    They are read and not run: the command's file would load the numerical libraries.
    """
    spec = find_spec(f"{_PLACE}.{command}")
    source = Path(spec.origin).read_text(encoding="utf-8") if spec and spec.origin else ""
    (function,) = (node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef) and node.name == "run")
    return [" ".join(paragraph.split()) for paragraph in (ast.get_docstring(function) or "").split("\n\n")]


def run(tokens: list[str]) -> None:
    """Carries out a command line.

    Raises:
        CycloptsError: If the command line is invalid.
        InputError: If what it gives is bad.
        MissingExtraError: If a package of an extra is not installed.
    """
    if tokens[:1] == ["help"]:
        tokens = [*tokens[1:], "--help"]
    listed = not tokens or tokens[0].startswith("-")
    app = command_line(listed=listed, helped=tokens[0] if "--help" in tokens or HELP_ALL in tokens else "")
    with named_extra():
        app(tokens, print_error=False, exit_on_error=False)


def command_line_error(error: CycloptsError) -> str:
    """What is wrong with a command line: what was given, what was expected, the remedy."""
    chain = " ".join(("forcefeel", *(error.command_chain or ())))
    if isinstance(error.__cause__, InputError):
        return str(error.__cause__)
    if isinstance(error, UnknownCommandError):
        (name, *_) = error.unused_tokens or ("",)
        return f"{name}: expected a command{suggestion(name, _COMMANDS) or ';'} forcefeel --help lists the commands"
    argument = error.argument
    if isinstance(error, MissingArgumentError) and argument is not None:
        name = argument.name if argument.name.startswith("--") else argument.parameter.metavar or argument.name
        given = "expected a value" if error.keyword or argument.tokens else "required"
        return f"{name}: {given}; {chain} --help lists the options"
    if isinstance(error, RepeatArgumentError):
        return f"{error.token.keyword}: given twice; give it once"
    if isinstance(error, UnusedCliTokensError):
        unused, name = " ".join(map(repr, error.unused_tokens or ())), _without_value(error)
        missing = f"{name}: expected a value; {chain} --help lists the options"
        return missing if name else f"{unused}: one argument too many; put quotes around a value with blanks"
    if isinstance(error, CoercionError) and argument is not None and error.token is not None:
        name, choices = error.token.keyword or argument.name, argument.get_choices()
        expected = (
            " or ".join(filter(None, (", ".join(choices[:-1]), choices[-1])))
            if choices
            else _KINDS.get(error.target_type or object, "")
        )
        if expected:
            return f"{name}: expected {expected}, got {error.token.value!r}"
    return str(error)


def _without_value(error: UnusedCliTokensError) -> str:
    """The option that takes a value and has another option behind it, which was then taken for the value."""
    options = error.app.assemble_argument_collection() if error.app else ()
    takes = {name: argument.token_count()[0] > 0 for argument in options for name in argument.names}
    return next(
        (name for name, value in pairwise(error.root_input_tokens or ()) if takes.get(name) and value in takes), ""
    )


_KINDS = {int: "a whole number", float: "a number", bool: "no value: it is a switch"}
