"""A time record from a bench."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.experiments import Experiment

Hold = Literal["straight", "staircase"]

HOLDS: Mapping[str, Hold] = MappingProxyType({"straight": "straight", "staircase": "staircase"})
"""Names in files and options."""


@dataclass(frozen=True, eq=False)
class BenchRecord:
    """Channels over time as recorded, SI units.

    Attributes:
        name: Name in messages and pictures.
        experiment: The experiment. A record of a test signal or a force holds that channel; in a release the column's
            angle shows where the grip was held and when it was released.
        time_s: Rising times, (samples,).
        channels: Values by channel, (samples,) each; the drive and at least one measured channel.
        hold: Course of the drive between two samples: straight, or as a staircase that keeps each value until the next.
        data_hash: SHA-256 of its file, in hexadecimal; empty without a file.
        run: Loader, law and machine of a live record, or the law that a file states; empty for other records.
    """

    name: str
    experiment: Experiment
    time_s: NDArray[np.float64]
    channels: Mapping[str, NDArray[np.float64]]
    hold: Hold = "straight"
    data_hash: str = field(default="", repr=False)
    run: Mapping[str, str] = field(default_factory=dict, repr=False)
