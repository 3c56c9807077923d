"""Whether data are of the loader that they are given for: its drive's experiments and channels; a motor that moves."""

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
"""Share of the largest current from which on a current is at it."""

_FEW = 3
"""Samples at the limit that are no accident."""

_POSITIONS = ("motor_angle", "drive_position", "column_angle")


def check_bench(loader: Loader, data: Sequence[Response | BenchRecord]) -> None:
    """Refuses data of another kind of loader, and records of a motor that say nothing of it.

    Raises:
        InputError: If an experiment or a channel is the other drive's, a motor did not break away, or its current was at its limit.
    """
    for measurement in data:
        check_experiment(measurement.experiment, loader, measurement.name)
        _check_channels(loader, measurement)
        if loader.drive == ELECTRIC and isinstance(measurement, BenchRecord):
            _check_moves(measurement)
            _check_current(loader, measurement)


def _check_channels(loader: Loader, data: Response | BenchRecord) -> None:
    known = {**inputs(loader.drive), **outputs(loader.drive)}
    named = (data.input, data.output) if isinstance(data, Response) else data.channels
    if strange := [name for name in named if name not in known and (name in INPUTS or name in OUTPUTS)]:
        raise InputError(
            f"{data.name}: {', '.join(strange)} is no channel of {a_drive(loader.drive)}, which {loader.name} has; expected some "
            f"of {', '.join(known)}; give the loader file of this bench, or leave the column out"
        )


def _check_moves(record: BenchRecord) -> None:
    """A motor that dry friction or cogging holds shows nothing but its sensor's noise."""
    for name in _POSITIONS:
        if name in record.channels:
            moved, noise = float(np.ptp(record.channels[name])), found_noise(record.channels[name])
            if moved <= NOISE * noise:
                raise InputError(
                    f"{record.name}: {name} moves by no more than its noise ({moved:.2g} of {noise:.2g} r.m.s.); expected a motor "
                    "that breaks away from its friction and cogging; drive harder or slower, with the brake off"
                )


def _check_current(loader: Loader, record: BenchRecord) -> None:
    """What is cut off says nothing of the motor, and hardly ever what the file's limit is exactly."""
    limit = loader["current_loop.current_limit"]
    for name in (Drive.TEST_CURRENT, Drive.COMMAND_CURRENT, "motor_current"):
        if name in record.channels:
            at = np.abs(record.channels[name]) >= _AT_LIMIT * limit
            if np.count_nonzero(at) >= _FEW:
                raise InputError(
                    f"{record.name}: {name} is at current_loop.current_limit, {limit:.4g} A, for {np.count_nonzero(at)} samples "
                    f"from {record.time_s[int(np.argmax(at))]:.4g} s on; expected a current that follows its command; drive less, "
                    "or correct the limit in the loader file"
                )
