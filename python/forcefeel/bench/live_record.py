"""Check of the channels of a live record for an experiment."""

from forcefeel.bench.experiments import Experiment, Loop
from forcefeel.bench.stated import drive_channel
from forcefeel.errors import InputError
from forcefeel.tables.table import LocatedColumns, Table


def check_live_columns(table: Table, located: LocatedColumns, experiment: Experiment) -> None:
    """Refuse an experiment that a live record cannot be of.

    Raises:
        InputError: If the experiment moves the servo alone, or the drive was not recorded, with the remedy.
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
