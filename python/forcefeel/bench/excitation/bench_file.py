"""The excitation as a CSV file for the bench; an identification reads it with measured columns added."""

import io
from pathlib import Path

import numpy as np

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.excitation.information import named
from forcefeel.bench.excitation.result import Excitation
from forcefeel.bench.identification.digits import percent
from forcefeel.errors import InputError
from forcefeel.files import Kind, check_output_file, input_kind, write_whole
from forcefeel.units import UnitSystem


def check_excitation_file(path: Path, *, replace: bool) -> None:
    """Refuse a path that cannot be written, before the work.

    Raises:
        InputError: If the path is a folder, or a file without ``replace``; if the name does not end in .csv or its folder is
            missing.
    """
    if path.suffix.lower() != ".csv":
        raise InputError(f"{path}: expected a name that ends in .csv, as an identification reads it")
    check_output_file(path, replace=replace)
    if input_kind(path.parent) is not Kind.FOLDER:
        raise InputError(f"{path}: expected a folder {path.parent} to write it into; make it first")


def write_excitation(
    excitation: Excitation, path: str | Path, units: UnitSystem = UnitSystem.US, *, replace: bool = False
) -> Path:
    """Write the signal as CSV, whole or not at all.

    Comment lines state experiment, loader, limits and predicted errors; then ``time (s)`` and ``test_signal (V)``, or
    ``pilot_force (lb)`` (N with SI units), a row for each sample.

    Raises:
        InputError: If a file exists and ``replace`` is false, or it cannot be written.

    Example:
        >>> plan = ff.bench.ExcitationPlan(time_s=4.0, rate_hz=200.0, to_hz=20.0)
        >>> found = ff.bench.excite(ff.elevator(), "k", "servo-closed", plan)
        >>> ff.bench.write_excitation(found, "excite.csv").name
        'excite.csv'
    """
    path = Path(path)
    check_excitation_file(path, replace=replace)
    write_whole(path, text(excitation, units))
    return path


def text(excitation: Excitation, units: UnitSystem) -> str:
    """Text of the file."""
    drive = str(excitation.experiment.drive)
    unit = channel_unit(drive)
    about = [
        f"experiment: {excitation.experiment}",
        f"loader: {excitation.loader.name}",
        *(f"law: {excitation.law.name}" for _ in [0] if excitation.law is not None),
        f"signal: {excitation.words}",
        *(f"period: {excitation.period_s:.9g} s" for _ in [0] if excitation.period_s is not None),
        *(
            f"{use.limit.name}: {use.limit.text(use.peak, units)} predicted of {use.limit.text(use.limit.value, units)}"
            for use in excitation.uses
        ),
        *(
            f"predicted standard error: {named(key)} {percent(error)}"
            for key, error in excitation.standard_errors.items()
        ),
        *excitation.findings(units)[-1:],
    ]
    rows = io.StringIO()  # adding 0 makes of -0 a 0
    np.savetxt(
        rows, np.column_stack([excitation.time_s, unit.from_si(1.0, units) * excitation.signal + 0.0]), "%.9g", ","
    )
    return (
        "".join(f"# {' '.join(line.split())}\n" for line in about)
        + f"time (s),{drive} ({unit.shown(units)})\n"
        + rows.getvalue()
    )
