"""A measured frequency response."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.experiments import Experiment


@dataclass(frozen=True, eq=False)
class Response:
    """A frequency response ``G = output / input`` as measured, SI units.

    Attributes:
        name: Name in messages and pictures.
        experiment: The experiment.
        input, output: Input and output channel.
        frequency_hz: Rising frequencies, (lines,).
        value: Complex response in SI units of output per input, (lines,).
        coherence: Coherence gamma^2 at each line, 0 to 1, (lines,); ``None`` if unknown.
        deviation: Standard deviation of each line's relative error, (lines,): that of ``|G|`` in shares and of its phase in rad;
            ``None`` if unknown.
        data_hash: SHA-256 of its file, in hexadecimal; empty without a file.
    """

    name: str
    experiment: Experiment
    input: str
    output: str
    frequency_hz: NDArray[np.float64]
    value: NDArray[np.complex128]
    coherence: NDArray[np.float64] | None = None
    deviation: NDArray[np.float64] | None = None
    data_hash: str = field(default="", repr=False)
