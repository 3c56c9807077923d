"""Frequency responses from records in time."""

import math

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import channel
from forcefeel.bench.periods import Periods, find_periods, settled
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.response_checks import FEWEST_LINES, check_response
from forcefeel.bench.responses import Response
from forcefeel.bench.spectra import Signals, Spectra, by_hann, by_periods
from forcefeel.bench.stated import drive_channel
from forcefeel.errors import InputError
from forcefeel.units import show

SEGMENTS = 8
"""Default number of segments of a record without periods."""

_JITTER = 0.01
"""Largest jitter of the samples, as a share of a step."""
_ON_SAMPLE = 1e-3
"""Largest distance of a given period from a whole number of samples, in samples."""
_DRIVEN_PERIODIC = 1e-4
"""Least power of a line as a share of the strongest: whole periods leak nothing, but noise and resolution are on every line."""
_DRIVEN = 1e-3
"""The same for Hann segments, whose first side lobe has 7e-4 of a strong line's power: less may leak from another line."""
_SHORTEST = 16
"""Least number of samples of a Hann segment."""
_ROUNDING = float(np.finfo(np.float64).eps)
"""Least ``1 - gamma^2`` distinguishable from zero."""
_AT_ONCE = ("valve_current",)
"""Channels that jump when the drive does: their samples follow the drive's samples, however it runs between them."""


def estimate_response(
    record: BenchRecord,
    output: str,
    *,
    input: str | None = None,  # noqa: A002  the word for it
    period_s: float | None = None,
    segments: int | None = None,
) -> Response:
    """The frequency response between two channels of a record: ``G = S_uy / S_uu``, where the input has power.

    A periodic drive is cut into its periods, without those at the beginning in which the output still settles: nothing
    leaks from line to line. Any other drive is cut into Hann segments that overlap by half. The mean of each is removed.

    Coherence is ``gamma^2 = |S_uy|^2 / (S_uu S_yy)``. The deviation of a line, of its gain as a share and of its phase in rad, is
    ``sqrt((1 - gamma^2) / (2 (n - 1) gamma^2))``: the response uses one of n averages. n counts periods; overlapping segments
    count as fewer, see ``spectra.independent_averages``. With one average both are ``None``. The deviation is due to noise at the
    output; noise at the input lowers the gain, and segments without periods leak where a response changes within a line.

    ``record.hold`` defines the drive between samples, and the response is to this drive: its spectrum is that of its
    samples times ``exp(-i pi f T) sinc(f T)`` for a staircase, ``sinc(f T)^2`` for straight lines. The factor is omitted for the
    valve current, which jumps with the drive, and for a measured input.

    Args:
        record: The record; evenly sampled, to 1 % of a step.
        output: Output channel of the response.
        input: Input channel; default, the drive of the experiment.
        period_s: Period of the drive; default, detected.
        segments: Number of periods at the end of the record, default all; or of Hann segments, default ``SEGMENTS``.

    Raises:
        InputError: If a channel is missing, samples are uneven, the drive does not have that period, the record is too short,
            or fewer than three lines are driven.

    Source: J. S. Bendat and A. G. Piersol, Random Data, 4th ed. (2010), ch. 9; R. Pintelon and J. Schoukens, System
    Identification, 2nd ed. (2012), ch. 2.

    Example:
        >>> record = ff.bench.read_bench_record("examples/bench/sweep.csv")
        >>> sorted(record.channels)
        ['column_angle', 'pilot_force']
        >>> response = ff.bench.estimate_response(record, "column_angle", segments=4)
        >>> response.input
        'pilot_force'
    """
    drive = drive_channel(record.experiment)
    if drive is None:
        raise InputError(f"{record.name}: a release has no drive; fit its record in time instead")
    start, end = channel(input or drive), channel(output)
    for name in (start, end):
        if name not in record.channels:
            raise InputError(f"{record.name}: has no channel {name}; it has {', '.join(record.channels)}")
    if start == end:
        raise InputError(f"{record.name}: expected two channels, got {start} twice")
    if segments is not None and (not isinstance(segments, int) or segments < 1):
        raise InputError(f"{record.name}: segments: expected a whole number above 0, got {show(segments)}")
    step = _step(record)
    u, y = record.channels[start], record.channels[end]
    periods = _periods(record, drive, step, period_s)
    spectra = _spectra(record, (u, y), step, periods, segments)
    driven = spectra.uu >= (_DRIVEN if periods is None else _DRIVEN_PERIODIC) * np.max(spectra.uu)
    f = spectra.frequency_hz
    if (lines := int(np.count_nonzero(driven))) < FEWEST_LINES:
        raise InputError(
            f"{record.name}: {start} drives {lines} lines; expected at least {FEWEST_LINES}; drive with a multisine, a chirp "
            "or noise, or record for longer"
        )
    value = spectra.uy[driven] / spectra.uu[driven]
    if start == drive and end not in _AT_ONCE:
        value = value / _between_samples(record.hold, f[driven] * step)
    coherence, deviation = _quality(spectra, driven)
    name = f"{record.name} {start} to {end}"
    response = Response(name, record.experiment, start, end, f[driven], value, coherence, deviation, record.data_hash)
    check_response(response)
    return response


def _step(record: BenchRecord) -> float:
    """The time between samples, s."""
    steps = np.diff(record.time_s)
    step = float(np.mean(steps))
    if (worst := float(np.max(np.abs(steps - step)))) > _JITTER * step:
        raise InputError(
            f"{record.name}: samples come at uneven times, up to {worst / step:.1%} of a step of {step:.6g} s early or late; "
            f"expected {_JITTER:.0%} at most for a frequency response; record with a steady clock, or fit the record in time"
        )
    return step


def _periods(record: BenchRecord, drive: str, step: float, period_s: float | None) -> Periods | None:
    u = record.channels.get(drive)
    if period_s is None:
        return None if u is None else find_periods(u)
    samples = period_s / step if math.isfinite(period_s) else math.nan
    if not samples >= 2 or abs(samples - round(samples)) > max(_ON_SAMPLE, _ROUNDING * samples):
        raise InputError(
            f"{record.name}: period_s: expected a whole number of steps of {step:.9g} s, got {period_s:.9g} s, "
            f"which is {samples:.6g} of them; sample at a multiple of the drive's frequency, or leave period_s out"
        )
    periods = None if u is None else find_periods(u, round(samples))
    if periods is None:
        raise InputError(
            f"{record.name}: {drive} does not repeat every {period_s:.6g} s for two periods; expected a periodic drive; "
            "correct period_s or leave it out"
        )
    return periods


def _spectra(
    record: BenchRecord, signals: Signals, step: float, periods: Periods | None, segments: int | None
) -> Spectra:
    """Spectra of the periods, or of Hann segments if there are none."""
    if periods is not None:
        count = settled(periods, signals[1]).count if segments is None else segments
        if count > periods.count:
            counts = f"{periods.count} at most, as many as there are periods, got {count}"
            raise InputError(f"{record.name}: segments: expected {counts}; take fewer")
        u, y = (signal[periods.end - count * periods.samples : periods.end] for signal in signals)
        return by_periods((u, y), step, periods.samples)
    count = SEGMENTS if segments is None else segments
    samples = len(signals[0]) // (count + 1) * 2 if count > 1 else len(signals[0]) // 2 * 2
    if samples < _SHORTEST:
        raise InputError(
            f"{record.name}: segments: {count} of {len(signals[0])} samples are too short; take fewer, or record for longer"
        )
    return by_hann(signals, step, samples)


def _between_samples(hold: str, cycles: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Ratio of a drive's spectrum to that of its samples; ``cycles`` is f T."""
    straight = np.sinc(cycles).astype(np.complex128)
    return straight * (straight if hold == "straight" else np.exp(-1j * np.pi * cycles))


def _quality(
    spectra: Spectra, driven: NDArray[np.bool_]
) -> tuple[NDArray[np.float64] | None, NDArray[np.float64] | None]:
    """Coherence and deviation of each line."""
    if spectra.averages <= 1:
        return None, None
    power = spectra.uu[driven] * spectra.yy[driven]
    coherence = np.clip(np.abs(spectra.uy[driven]) ** 2 / power, _ROUNDING, 1.0)
    incoherent = np.maximum(1 - coherence, _ROUNDING)
    return coherence, np.sqrt(incoherent / (2 * (spectra.averages - 1) * coherence))
