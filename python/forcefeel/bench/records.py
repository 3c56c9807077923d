"""A record in time from a bench."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.experiments import Experiment

Hold = Literal["straight", "staircase"]

HOLDS: Mapping[str, Hold] = MappingProxyType({"straight": "straight", "staircase": "staircase"})
"""How files and options say it."""


@dataclass(frozen=True, eq=False)
class BenchRecord:
    """Channels over time as recorded, SI units.

    Attributes:
        name: What messages and pictures call it.
        experiment: Under which it was recorded. A record of a test signal or a force holds that channel; in a release the column's
            angle says where the grip was held and when it was let go.
        time_s: Rising times, (samples,).
        channels: Values by channel, (samples,) each; those of the drive and at least one that is measured.
        hold: How the drive runs between two samples: straight, or as a staircase that keeps each value until the next.
        data_hash: SHA-256 of the file that it came from, in hexadecimal; empty if from none.
        run: What the record of a live run says of it: loader, law, machine; empty of other records.

    Example:
        >>> import forcefeel as ff
        >>> record = ff.bench.read_bench_record("examples/bench/sweep.csv")
        >>> len(record.time_s) == len(record.channels["column_angle"])
        True
    """

    name: str
    experiment: Experiment
    time_s: NDArray[np.float64]
    channels: Mapping[str, NDArray[np.float64]]
    hold: Hold = "straight"
    data_hash: str = field(default="", repr=False)
    run: Mapping[str, str] = field(default_factory=dict, repr=False)
