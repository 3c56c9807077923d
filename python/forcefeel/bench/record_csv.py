"""A record as text of a CSV file, as an identification reads it."""

import io

import numpy as np

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.records import BenchRecord
from forcefeel.units import UnitSystem


def record_csv(record: BenchRecord) -> str:
    """A record as a file for ``identify``, SI units, ten digits."""
    columns = {name: channel_unit(name) for name in record.channels}
    head = ",".join(("time (s)", *(f"{name} ({unit.shown(UnitSystem.SI)})" for name, unit in columns.items())))
    values = [unit.from_si(1.0, UnitSystem.SI) * record.channels[name] for name, unit in columns.items()]
    rows = io.StringIO()
    np.savetxt(rows, np.column_stack([record.time_s, *values]), "%.10g", ",")
    hold = "" if record.hold == "straight" else f"# hold: {record.hold}\n"
    law = f"# law: {record.run['law']}\n" if "law" in record.run else ""
    return f"# experiment: {record.experiment}\n{law}{hold}{head}\n{rows.getvalue()}"
