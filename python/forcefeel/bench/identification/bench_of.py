"""Check that data fit their loader: experiments and channels of its drive, and a motor that moves."""

from collections.abc import Sequence

import numpy as np

from forcefeel.bench.channels import INPUTS, OUTPUTS, inputs, outputs
from forcefeel.bench.experiments import Drive, check_experiment
from forcefeel.bench.record_checks import NOISE
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, a_drive
from forcefeel.qualification.records import found_noise

_AT_LIMIT = 0.999
"""Share of the current limit above which a current is at the limit."""

_FEW = 3
"""Least number of samples at the limit."""

_POSITIONS = ("motor_angle", "drive_position", "column_angle")


def check_bench(loader: Loader, data: Sequence[Response | BenchRecord]) -> None:
    """Refuse data of another kind of loader, and records of a motor without information.

    Raises:
        InputError: If an experiment or channel is of the other drive, a motor did not break away, or its current was at its limit.
    """
    for measurement in data:
        check_experiment(measurement.experiment, loader, measurement.name)
        _check_channels(loader, measurement)
        if loader.drive == ELECTRIC and isinstance(measurement, BenchRecord):
            _check_moves(measurement)
            _check_current(loader, measurement)


def _check_channels(loader: Loader, data: Response | BenchRecord) -> None:
    channels = {**inputs(loader.drive), **outputs(loader.drive)}
    named = (data.input, data.output) if isinstance(data, Response) else data.channels
    if strange := [name for name in named if name not in channels and (name in INPUTS or name in OUTPUTS)]:
        raise InputError(
            f"{data.name}: {', '.join(strange)} is no channel of {a_drive(loader.drive)}, which {loader.name} has; expected some "
            f"of {', '.join(channels)}; give the loader file of this bench, or leave the column out"
        )


def _check_moves(record: BenchRecord) -> None:
    """Refuse a motor held by dry friction or cogging, which shows only sensor noise."""
    for name in _POSITIONS:
        if name in record.channels:
            swing, noise = float(np.ptp(record.channels[name])), found_noise(record.channels[name])
            if swing <= NOISE * noise:
                raise InputError(
                    f"{record.name}: {name} moves by no more than its noise ({swing:.2g} of {noise:.2g} r.m.s.); expected a motor "
                    "that breaks away from its friction and cogging; drive harder or slower, with the brake off"
                )


def _check_current(loader: Loader, record: BenchRecord) -> None:
    """Refuse a motor current at its limit: saturation hides the motor, and the limit in the file is rarely exact."""
    limit = loader["current_loop.current_limit"]
    for name in (Drive.TEST_CURRENT, Drive.COMMAND_CURRENT, "motor_current"):
        if name in record.channels:
            limited = np.abs(record.channels[name]) >= _AT_LIMIT * limit
            if np.count_nonzero(limited) >= _FEW:
                raise InputError(
                    f"{record.name}: {name} is at current_loop.current_limit, {limit:.4g} A, in "
                    f"{np.count_nonzero(limited)} samples from {record.time_s[int(np.argmax(limited))]:.4g} s; "
                    "expected a current below it; drive less, or correct the limit in the loader file"
                )
