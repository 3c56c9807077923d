"""What is wrong with a record in time, without a model."""

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
"""Samples that a record has at least."""

_LONGEST_STEP_S = 0.2
"""Median step that a bench records at: two and a half samples in the period of a feel of 2 Hz."""
_ROUNDING = 1e-9
"""Share of a signal's largest value within which it is constant."""
_FLICKER = 2
"""Samples for which a signal of nothing but its resolution stays at a level, half of the time at most."""
_QUIET = 1e-3
"""Share of its range by which a drive that has not begun may move."""
_STILL = 0.1
"""Share of its range by which a channel may move before the drive has begun."""
NOISE = 12.0
"""Standard deviations of noise from its lowest to its highest value, and more than that of a million samples."""
_FEWEST_QUIET = 5
"""Samples before the drive begins from which one can tell whether the channels rest."""
_EVEN = 0.7
"""Smallest of the first steps as a share of the largest, above which the motion was there before; from rest it grows."""
_FIRST = 4
"""First steps that are looked at."""
_TYPICAL = 0.3
"""Share of a channel's r.m.s. step that its first steps have when it does not begin at rest."""
_DRIVEN = 0.02
"""Share of its range within which a drive begins at zero."""
_HELD = 0.02
"""Share of the way of a release by which the held grip may move."""
_TAIL = 0.1
"""Share of a release at its end over which its steady state is the mean."""
_SMOOTH = ("column_angle", "piston_position", "potentiometer", "drive_position", "motor_angle")
"""Channels that cannot set out at speed from rest."""


@dataclass(frozen=True)
class ChannelText:
    """Values of channels as messages have them: in the units of the file."""

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
    """Refuses a record that no model can be held against.

    Args:
        record: The record.
        places: Where each row stands, after the header's place, for messages; its name and row numbers from 1 if not given.
        units: Unit of each channel in messages, such as that of its file; SI if not given.

    Raises:
        InputError: With the place, what is wrong, what was expected and the remedy: numbers that are not finite, times that do
            not rise, a gap, fewer than 100 samples, a median step outside 10 microseconds to 0.2 s, a drive or a measured
            channel that never moved, a channel that is clipped, a drive under which the loader does not begin at rest, a grip
            that is never let go or not held before.
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
            f"{where}: has {len(record.time_s)} samples; expected {FEWEST_SAMPLES} at least; record for longer"
        )
    check_step(record.time_s, where, _LONGEST_STEP_S)
    text = ChannelText(units)
    measured = {name: values for name, values in record.channels.items() if name in OUTPUTS}
    drive = _drive(record, where, text)
    for name, values in measured.items():
        _check_moved(name, values, where, text)
        if at := clipped(values, drive):
            raise InputError(
                f"{where}: {name} is clipped at {text(name, values[at.begin])} from {record.time_s[at.begin]:.6g} s to "
                f"{record.time_s[at.end - 1]:.6g} s; expected the whole swing; record with a larger range or drive less"
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
        raise InputError(
            f"{where}: has no {name}, which drives {record.experiment}; expected what drove the bench beside what came"
        )
    values = record.channels[name]
    reach = float(np.ptp(values))
    if reach <= _ROUNDING * float(np.max(np.abs(values))):
        raise InputError(
            f"{where}: {name} never moves from {text(name, values[0])}; expected a drive that moves the loader; record "
            "the channel that drives it"
        )
    if _flickers(values):
        raise InputError(
            f"{where}: {name} moves by {text(name, reach, 3)}, which is no more than the resolution it is recorded with; "
            "expected a drive of many steps; drive harder"
        )
    return values


def _flickers(values: NDArray[np.float64]) -> bool:
    """Whether a signal is its resolution alone: two or three neighbouring steps of a ladder through zero, hopped at random.

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
    """Refuses a release whose grip is not held and then let go."""
    angle = Record(record.time_s, record.channels["column_angle"], shown_unit=text.unit("column_angle"), name=where)
    check_rate(angle)
    let_go = find_release(angle, _TAIL, load_rules().release)
    check_clipping(angle, let_go)
    held = angle.position[: let_go.held]
    noise = max(NOISE * angle.position_noise, 2 * angle.position_resolution)
    if float(np.ptp(held)) > max(noise, _HELD * abs(let_go.displacement)) or _under_way(
        angle.position, let_go.held, noise
    ):
        came = text("column_angle", np.ptp(held), 3)
        raise InputError(
            f"{where}: column_angle moves before it is let go at {let_go.time_s:.6g} s, by {came}; expected a grip "
            "that is held still; hold it until it rests, then let go"
        )


def _under_way(x: NDArray[np.float64], held: int, noise: float) -> bool:
    """Whether a release that is held for no more than a few samples is under way at its first."""
    return held < _FEWEST_QUIET and _sets_out(np.diff(x), noise)


def _check_rest(
    record: BenchRecord, drive: NDArray[np.float64], measured: Mapping[str, NDArray[np.float64]], where: str
) -> None:
    """Refuses a record that does not begin at rest: a simulation of it does."""
    reach = float(np.ptp(drive))
    # A noisy drive has begun where it leaves its noise.
    off = np.abs(drive - drive[0]) > max(_QUIET * reach, NOISE * found_noise(drive[: len(drive) // 100 + 20]))
    quiet = int(np.argmax(off))
    # A drive that is not zero at its first sample may have jumped there from rest; from rest the channels set out slowly.
    jumped = abs(float(drive[0])) > _DRIVEN * reach
    # A servo that rests still hunts in its forces and flows; where motion was recorded, that says whether it rests.
    telling = {name: x for name, x in measured.items() if name in _SMOOTH} or measured
    for name, x in telling.items():
        noise = max(NOISE * found_noise(x), 2 * found_resolution(x))
        moved = quiet >= _FEWEST_QUIET and float(np.ptp(x[:quiet])) > max(_STILL * float(np.ptp(x)), noise)
        if (moved and not jumped) or (jumped and name in _SMOOTH and _sets_out(np.diff(x), noise)):
            seen = f"in the first {record.time_s[max(quiet, _FIRST)] - record.time_s[0]:.3g} s"
            raise InputError(
                f"{where}: does not begin at rest: {name} moves {seen} as it does later; expected a loader that rests, because "
                "the model that it is held against begins at rest; start to record before the drive begins"
            )


def _sets_out(steps: NDArray[np.float64], noise: float) -> bool:
    """Whether the first steps are those of a motion that was there before: as even as the rest, not growing from nothing."""
    first = steps[:_FIRST]
    even = float(np.min(np.abs(first))) >= _EVEN * float(np.max(np.abs(first))) and np.all(
        np.sign(first) == np.sign(first[0])
    )
    typical = _TYPICAL * float(np.sqrt(np.mean(steps**2)))
    return bool(even and abs(float(np.mean(first))) > typical and abs(float(np.sum(first))) > noise)
