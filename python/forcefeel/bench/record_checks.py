"""Faults of a time record that show without a model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import OUTPUTS, RECORDED
from forcefeel.bench.clipping import clipped
from forcefeel.bench.experiments import Drive
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.stated import drive_channel
from forcefeel.errors import InputError
from forcefeel.qualification import load_rules
from forcefeel.qualification.let_go import check_clipping, check_rate, find_release
from forcefeel.qualification.records import Record, found_noise, found_resolution
from forcefeel.tables.faults import check_step, fault, in_file
from forcefeel.units import factor

FEWEST_SAMPLES = 100
"""Least number of samples of a record."""

_LONGEST_STEP_S = 0.2
"""Longest median step of a record, s: two and a half samples per period of a feel of 2 Hz."""
_ROUNDING = 1e-9
"""Largest motion of a constant signal, as a share of its largest value."""
_FLICKER = 2
"""Median number of samples per level of a signal that consists of its resolution only, at most."""
_QUIET = 1e-3
"""Largest motion of a drive before it begins, as a share of its range."""
_STILL = 0.1
"""Largest motion of a channel before the drive begins, as a share of its range."""
NOISE = 12.0
"""Standard deviations from the lowest to the highest value of noise, more than in a million samples."""
_FEWEST_QUIET = 5
"""Least number of samples before the drive begins for a test of rest."""
_EVEN = 0.7
"""Ratio of smallest to largest of the first steps above which motion was present before; from rest it grows."""
_FIRST = 4
"""Number of first steps in this test."""
_TYPICAL = 0.3
"""Least mean of the first steps of a channel that does not begin at rest, as a share of its r.m.s. step."""
_DRIVEN = 0.02
"""Largest first value of a drive that begins at zero, as a share of its range."""
_HELD = 0.02
"""Largest motion of the held grip, as a share of the displacement of a release."""
_TAIL = 0.1
"""Share of a release at its end whose mean is the steady state."""
_SMOOTH = ("column_angle", "piston_position", "potentiometer", "drive_position", "motor_angle")
"""Channels whose speed cannot jump."""


@dataclass(frozen=True)
class ChannelText:
    """Values of channels in messages, in the units of the file."""

    units: Mapping[str, str]

    def unit(self, channel: str) -> str:
        """The channel's unit."""
        return self.units.get(channel) or RECORDED[channel]

    def __call__(self, channel: str, value: float, digits: int = 6) -> str:
        """The value with its unit."""
        return f"{float(value) * factor(RECORDED[channel], self.unit(channel)):.{digits}g} {self.unit(channel)}"


def check_record(
    record: BenchRecord, places: Sequence[str] | None = None, units: Mapping[str, str] = MappingProxyType({})
) -> None:
    """Refuse a record that cannot be compared with a model.

    Args:
        record: The record.
        places: Where each row stands, after the header's place, for messages; its name and row numbers from 1 if not given.
        units: Unit of each channel in messages, such as that of its file; SI if not given.

    Raises:
        InputError: With the row, the fault, the expected value and the remedy. Faults are numbers that are not finite, times not
            rising, a gap, fewer than 100 samples, a median step outside 10 microseconds to 0.2 s. Others are a drive or a channel
            that never moves, a clipped channel, a loader not at rest at the start, a grip never released or not held before.
    """
    where = record.name if places is None else places[0].rsplit(": ", 1)[0]
    columns = {"time": record.time_s, **record.channels}
    for name, values in columns.items():
        if np.shape(values) != np.shape(record.time_s) or np.ndim(values) != 1:
            raise InputError(
                f"{where}: expected {name} at each of the times, got shapes {np.shape(values)}, {np.shape(record.time_s)}"
            )
    if problem := fault(columns, {"time": "s", **RECORDED}):
        row, sentence = problem
        raise InputError(f"{where}: row {row}: {sentence}" if places is None else f"{places[row]}: {in_file(sentence)}")
    if len(record.time_s) < FEWEST_SAMPLES:
        raise InputError(
            f"{where}: has {len(record.time_s)} samples; expected at least {FEWEST_SAMPLES}; record for longer"
        )
    check_step(record.time_s, where, _LONGEST_STEP_S)
    text = ChannelText(units)
    measured = {name: values for name, values in record.channels.items() if name in OUTPUTS}
    drive = _drive(record, where, text)
    for name, values in measured.items():
        _check_moved(name, values, where, text)
        if clipping := clipped(values, drive):
            raise InputError(
                f"{where}: {name} is clipped at {text(name, values[clipping.begin])} from {record.time_s[clipping.begin]:.6g} s to "
                f"{record.time_s[clipping.end - 1]:.6g} s; expected the whole swing; record with a larger range or drive less"
            )
    if record.experiment.drive is Drive.RELEASE:
        _check_release(record, where, text)
    elif drive is not None:
        _check_rest(record, drive, measured, where)


def _drive(record: BenchRecord, where: str, text: ChannelText) -> NDArray[np.float64] | None:
    """The drive's channel, if the experiment has one."""
    if (name := drive_channel(record.experiment)) is None:
        return None
    if name not in record.channels:
        raise InputError(f"{where}: has no {name}, which drives {record.experiment}; expected its column; add it")
    values = record.channels[name]
    swing = float(np.ptp(values))
    if swing <= _ROUNDING * float(np.max(np.abs(values))):
        raise InputError(
            f"{where}: {name} never moves from {text(name, values[0])}; expected a drive that moves the loader; record "
            "the channel that drives it"
        )
    if _flickers(values):
        raise InputError(
            f"{where}: {name} moves by {text(name, swing, 3)}, which is no more than the resolution it is recorded with; "
            "expected a drive of many steps; drive harder"
        )
    return values


def _flickers(values: NDArray[np.float64]) -> bool:
    """Whether a signal is its resolution only: random hops among two or three neighboring steps.

    A signal that is meant to have two or three levels stays at each for a while.
    """
    levels = np.unique(values)
    if len(levels) > 3:
        return False
    step = float(np.min(np.diff(levels)))
    ladder = levels / step
    if not np.all(np.abs(ladder - np.round(ladder)) < 1e-3) or levels[-1] - levels[0] > 2.5 * step:
        return False
    hops = np.flatnonzero(np.diff(values))
    return len(hops) > 1 and float(np.median(np.diff(hops))) <= _FLICKER


def _check_moved(name: str, values: NDArray[np.float64], where: str, text: ChannelText) -> None:
    if float(np.ptp(values)) <= _ROUNDING * float(np.max(np.abs(values))) or len(np.unique(values)) == 2:
        raise InputError(
            f"{where}: {name} never moves from {text(name, values[0])} by more than one step of its resolution; expected "
            "a channel that answers the drive; connect its sensor or leave the column out"
        )


def _check_release(record: BenchRecord, where: str, text: ChannelText) -> None:
    """Refuse a release whose grip is not held and then released."""
    angle = Record(record.time_s, record.channels["column_angle"], shown_unit=text.unit("column_angle"), name=where)
    check_rate(angle)
    let_go = find_release(angle, _TAIL, load_rules().release)
    check_clipping(angle, let_go)
    held = angle.position[: let_go.held]
    noise = max(NOISE * angle.position_noise, 2 * angle.position_resolution)
    if float(np.ptp(held)) > max(noise, _HELD * abs(let_go.displacement)) or _under_way(
        angle.position, let_go.held, noise
    ):
        motion = text("column_angle", np.ptp(held), 3)
        raise InputError(
            f"{where}: column_angle moves before it is let go at {let_go.time_s:.6g} s, by {motion}; expected a grip "
            "that is held still; hold it until it rests, then let go"
        )


def _under_way(x: NDArray[np.float64], held: int, noise: float) -> bool:
    """Whether a release held for only a few samples is already moving at its first sample."""
    return held < _FEWEST_QUIET and _sets_out(np.diff(x), noise)


def _check_rest(
    record: BenchRecord, drive: NDArray[np.float64], measured: Mapping[str, NDArray[np.float64]], where: str
) -> None:
    """Refuse a record that does not begin at rest, because its simulation does."""
    swing = float(np.ptp(drive))
    # A noisy drive has begun where it leaves its noise.
    driven = np.abs(drive - drive[0]) > max(_QUIET * swing, NOISE * found_noise(drive[: len(drive) // 100 + 20]))
    quiet = int(np.argmax(driven))
    # A drive that is not zero at its first sample may have jumped there; channels at rest then start slowly.
    jumped = abs(float(drive[0])) > _DRIVEN * swing
    # Forces and flows of a resting servo still hunt; a recorded motion is the better test of rest.
    telling = {name: x for name, x in measured.items() if name in _SMOOTH} or measured
    for name, x in telling.items():
        noise = max(NOISE * found_noise(x), 2 * found_resolution(x))
        moves = quiet >= _FEWEST_QUIET and float(np.ptp(x[:quiet])) > max(_STILL * float(np.ptp(x)), noise)
        if (moves and not jumped) or (jumped and name in _SMOOTH and _sets_out(np.diff(x), noise)):
            interval = f"in the first {record.time_s[max(quiet, _FIRST)] - record.time_s[0]:.3g} s"
            raise InputError(
                f"{where}: does not begin at rest: {name} moves {interval} as it does later; expected a loader that rests, because "
                "the model begins at rest; start to record before the drive begins"
            )


def _sets_out(steps: NDArray[np.float64], noise: float) -> bool:
    """Whether the first steps belong to an earlier motion: as even as the rest, not growing from zero."""
    first = steps[:_FIRST]
    even = float(np.min(np.abs(first))) >= _EVEN * float(np.max(np.abs(first))) and np.all(
        np.sign(first) == np.sign(first[0])
    )
    typical = _TYPICAL * float(np.sqrt(np.mean(steps**2)))
    return bool(even and abs(float(np.mean(first))) > typical and abs(float(np.sum(first))) > noise)
