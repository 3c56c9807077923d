"""Properties of bench data stated in the file or by the arguments of its reader."""

from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.errors import InputError
from forcefeel.tables.table import Table
from forcefeel.units import show


def stated(table: Table, key: str, argument: str | None, name: str) -> str | None:
    """The property ``key`` from the file or from the argument ``name``.

    Raises:
        InputError: If they contradict each other.
    """
    note = table.notes.get(key)
    if note is not None and argument is not None and note.split() != argument.split():
        raise InputError(
            f"{table.path}: states '{key}: {note}', but the argument {name} is {show(argument)}; leave one of them out"
        )
    return argument if note is None else note


def stated_experiment(table: Table, argument: Experiment | str | None) -> Experiment:
    """The experiment that a file or the argument states.

    Raises:
        InputError: If neither does, they contradict each other, or the text names no experiment.
    """
    note = table.notes.get("experiment")
    in_file = None if note is None else _experiment(f"{table.path}: ", note)
    from_argument = _experiment(f"{table.path}: the argument ", argument) if isinstance(argument, str) else argument
    if in_file is not None and from_argument is not None and in_file != from_argument:
        raise InputError(
            f"{table.path}: states {in_file}, but the argument experiment is {from_argument}; leave one of them out"
        )
    if (experiment := in_file or from_argument or (OF_A_RUN if table.run else None)) is None:
        remedy = "state it at the top of a CSV file, as in '# experiment: servo-closed', or by the argument experiment"
        raise InputError(f"{table.path}: has no experiment; {remedy}")
    return experiment


OF_A_RUN = Experiment(Loop.LOADER, Drive.PILOT_FORCE)
"""Default experiment of a live record: the whole loader under its law, driven by the pilot."""


def drive_channel(experiment: Experiment) -> str | None:
    """The channel that drives an experiment; ``None`` of a release."""
    return None if experiment.drive is Drive.RELEASE else str(experiment.drive)


def _experiment(prefix: str, text: str) -> Experiment:
    try:
        return Experiment.read(text)
    except InputError as error:  # which begins with the word experiment
        raise InputError(f"{prefix}{error}") from error
