"""Whether the record of a live run has what an experiment takes."""

from forcefeel.bench.experiments import Experiment, Loop
from forcefeel.bench.stated import drive_channel
from forcefeel.errors import InputError
from forcefeel.tables.table import LocatedColumns, Table


def check_live_columns(table: Table, located: LocatedColumns, experiment: Experiment) -> None:
    """Refuses an experiment that no live run is.

    Raises:
        InputError: If the servo alone is to be moved, or what moves the loader was not recorded, with the remedy.
    """
    if experiment.loop is not Loop.LOADER:
        raise InputError(
            f"{table.path}: is the record of a live run, of the whole loader under its law, and the argument experiment is "
            f"{experiment}; expected 'loader pilot_force' or 'release'; leave it out"
        )
    drive = drive_channel(experiment)
    if drive is not None and drive not in located:
        raise InputError(
            f"{table.path}: has no {drive}: nothing measured it in this run, whose machine is {table.run.get('machine', 'real')}; "
            "hold the grip, let it go, and give that part as a release, by the argument experiment; or record the force at "
            "the grip on a bench"
        )
