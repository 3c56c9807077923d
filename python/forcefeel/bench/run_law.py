"""The law under which records were made."""

from collections.abc import Sequence

from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.laws.law import NAMED_LAWS, Law
from forcefeel.loader.loader import Loader


def law_of_runs(data: Sequence[Response | BenchRecord], loader: Loader) -> Law | None:
    """The law that records among the data state, designed for the loader; ``None`` if the data state no law.

    Raises:
        InputError: If they state two, or one from a file, or a live run was of another loader, whose law is another.
    """
    runs = {record.name: record.run for record in data if isinstance(record, BenchRecord) and record.run}
    laws = {run.get("law", ""): name for name, run in runs.items()}
    if len(laws) > 1:
        came = " and ".join(f"{law} in {name}" for law, name in laws.items())
        raise InputError(f"--data: records under two laws, {came}; expected one law; identify from the records of one")
    for name, run in runs.items():
        if run.get("loader_hash", loader.fingerprint) != loader.fingerprint:
            came = run.get("loader", "unknown")
            raise InputError(
                f"{name}: was run on a loader {came} of other values than {loader.name}, so that its law is another; give the "
                "loader file of the run, or identify with the law's own file by --law"
            )
    for law, name in laws.items():
        if law not in NAMED_LAWS:
            raise InputError(
                f"{name}: was run under the law {law}, which is no design of its own name; identify with its file by --law"
            )
        return Law.of(law, loader)
    return None
