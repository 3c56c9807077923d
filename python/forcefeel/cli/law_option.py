"""The laws that ``--compensator`` takes, by name or from a file; listed here so that ``--help`` waits for no numerical library."""

import typer

LAWS = ("original", "published", "converged", "load-cell", "observer", "recovered", "h-infinity", "robust")
"""As ``forcefeel.laws.law.NAMED_LAWS``."""

ORIGINAL = LAWS[0]

METAVAR = f"{'|'.join(LAWS)}|FILE.json"


def law_name(given: str) -> str:
    """A name, or the file of a law.

    Raises:
        typer.BadParameter: If it is neither.
    """
    if given not in LAWS and not given.endswith(".json"):
        names = ", ".join(map(repr, LAWS))
        raise typer.BadParameter(
            f"{given!r} is not one of {names}, nor the file of a law (.json, from compensate --save-law)"
        )
    return given
