"""What is most likely wrong with a response that a model predicts quite differently."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import CHANNELS
from forcefeel.bench.response_checks import check_response
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.units import factor

CLEAR = 1 / 3
"""Share of its distance as read to which a response must come when it is read in another way."""
LIKELY = 1 / 2
"""The same where something else, that no loader off its file does, speaks for that reading too."""
FAR = 0.8
"""Distance below which neither sign, nor direction, nor frequencies are suspected."""

_FLATTER = 8.0
"""A phase that turns less than the prediction's by this factor was divided by 57."""
_LARGEST_RAD = 0.25
"""Phases in degrees as large as those in rad of eight poles, read as degrees."""
_TURNS = 0.3
"""Turn of the predicted phase over the band, rad, from which its unit can be told."""
_WANDERS = (20.0, 4.0)
"""A phase that turns from line to line more than the prediction's by the first factor was multiplied by 57; by the second if it
turns by more than 0.3 rad from line to line, so that whole turns may be lost."""
_GAIN_FITS = 1.0
"""Median of |ln gain ratio| up to which it is the phase alone that is wrong."""
_LEAST_SPAN = 0.7
"""Span of the logarithm of the predicted gain from which ratios and dB can be told apart: a factor of two."""
_SPANS = 3.0
"""Factor between the spans of two logarithmic gains that no loader makes."""
_SPAN_FITS = 1.5
"""Factor within which the spans of two logarithmic gains may be those of one machine."""
_MOST_DECIBELS = 400.0
"""No gain of a machine has more."""
_AGAINST = -0.5
"""Correlation of two logarithmic responses below which one runs against the other."""
_FEWEST = 3
"""Lines on which two responses are compared."""

# What a bench may have been recorded in, by SI unit.
_USUAL = {
    "rad": ("rad", "deg"),
    "rad/s": ("rad/s", "deg/s"),
    "m": ("m", "cm", "mm", "in"),
    "N": ("N", "lb", "kN"),
    "Pa": ("Pa", "kPa", "MPa", "bar", "psi"),
    "m^3/s": ("m^3/s", "cm^3/s", "L/min", "in^3/s", "gpm"),
    "A": ("A", "mA"),
    "V": ("V", "mV"),
}


Complex = NDArray[np.complex128]


def distance(value: Complex, predicted: Complex) -> float:
    """How far two responses are apart: the median over the lines of ``|ln(G / G_p)|``, its phase within half a turn."""
    return float(np.median(np.abs(_apart(value, predicted))))


def misreading(response: Response, predicted: Complex) -> str | None:
    """The most likely cause why a response is far from its prediction, in a sentence; ``None`` if none stands out.

    The same numbers are read in other ways. A reading is suspected where it brings the response clearly nearer to the prediction
    and shows what no loader does whose values are merely off:

    =========================  ===================================================================================
    the other sign             distance down to ``CLEAR``
    from and to exchanged      to ``LIKELY``, and the logarithms run against each other
    Hz and rad/s               r.m.s. to ``LIKELY``, and nearer than with frequencies off by half of that factor
    radians read as degrees    phase nearer at all, and all phases small where the prediction's turn
    degrees read as radians    the gain fits, and the phase turns from line to line many times as much as predicted
    a ratio read as dB, or     gain to ``CLEAR``, and only then its logarithm spans what is predicted; or to ``LIKELY`` if it spans
    dB read as a ratio         a third or three times of that as it was read
    =========================  ===================================================================================

    Args:
        response: As measured and read.
        predicted: What the model predicts at the same lines in SI units, (lines,).

    Raises:
        InputError: As ``check_response``; if there are not as many predictions as lines, or one is not finite or zero.
    """
    check_response(response)
    predicted = np.asarray(predicted, dtype=np.complex128)
    if predicted.shape != response.value.shape:
        raise InputError(
            f"predicted: expected one for each of {len(response.value)} lines, got shape {predicted.shape}"
        )
    if not (np.isfinite(predicted) & (predicted != 0)).all():
        raise InputError("predicted: expected finite numbers other than zero")
    g, ratios = response.value, _ratios(response)
    turned = f"it seems to lead from {response.output} to {response.input}, the inverse of what is said; exchange from and to"
    readings = [
        (_reversed(g, predicted), "its polarity seems reversed; turn the sign of one channel"),
        (min(_inverse(g, predicted, ratio) for ratio in ratios), turned),
        (
            _other_phase(g, predicted),
            "its phase seems to be in radians, read as degrees; name the column 'phase (rad)'",
        ),
        (
            min(_was_ratio(g, predicted, ratio) for ratio in ratios),
            "its gain seems to be a ratio, read as dB; name the column with its unit, such as 'gain (V/V)'",
        ),
        (
            min(_was_decibels(g, predicted, ratio) for ratio in ratios),
            "its gain seems to be in dB, read as a ratio; name the column 'gain (dB)'",
        ),
        (
            _other_frequency(response, predicted, 1 / (2 * np.pi)),
            "its frequencies seem to be in rad/s, read as Hz; name the column 'frequency (rad/s)'",
        ),
        (
            _other_frequency(response, predicted, 2 * np.pi),
            "its frequencies seem to be in Hz, read as rad/s; name the column 'frequency (Hz)'",
        ),
    ]
    nearest, sentence = min(readings)
    if nearest == np.inf and _wanders(g, predicted):
        nearest, sentence = 0.0, "its phase seems to be in degrees, read as radians; name the column 'phase (deg)'"
    return None if nearest == np.inf else f"{response.name}: {sentence}"


def _reversed(g: Complex, predicted: Complex) -> float:
    """How far ``-G`` is from the prediction, r.m.s.; infinite, as for the others, if nothing speaks for it."""
    as_read = distance(g, predicted)
    return _rms(_apart(-g, predicted)) if as_read > FAR and distance(-g, predicted) < CLEAR * as_read else np.inf


def _inverse(g: Complex, predicted: Complex, ratio: float) -> float:
    """``1/G``, in the units ``ratio`` of which it was read."""
    turned, as_read = ratio**2 / g, distance(g, predicted)
    if as_read <= FAR or distance(turned, predicted) >= LIKELY * as_read:
        return np.inf
    return _rms(_apart(turned, predicted)) if _correlation(g, predicted) < _AGAINST else np.inf


def _other_phase(g: Complex, predicted: Complex) -> float:
    """The phase times 57."""
    phase, expected = np.angle(g), np.unwrap(np.angle(predicted))
    turns = float(np.ptp(expected))
    if turns < _TURNS or np.ptp(phase) * _FLATTER > turns or np.max(np.abs(phase)) > _LARGEST_RAD:
        return np.inf
    read = np.abs(g) * np.exp(1j * np.degrees(phase))
    before, after = (_rms(_apart(gains, predicted).imag) for gains in (g, read))
    return _rms(_apart(read, predicted)) if after < before else np.inf


def _was_ratio(g: Complex, predicted: Complex, ratio: float) -> float:
    """The number whose ``10^(r / 20)`` was taken."""
    numbers = 20 * np.log10(np.abs(g) / ratio)
    return _other_gain(g, ratio * numbers, predicted) if np.min(numbers) > 0 else np.inf


def _was_decibels(g: Complex, predicted: Complex, ratio: float) -> float:
    """``10^(g / 20)`` of the number that was taken as it was."""
    numbers = np.abs(g) / ratio
    return _other_gain(g, ratio * 10 ** (numbers / 20), predicted) if np.max(numbers) < _MOST_DECIBELS else np.inf


def _other_gain(g: Complex, gain: NDArray[np.float64], predicted: Complex) -> float:
    """How far another gain is, if it is clearly nearer and alone spans what is predicted."""
    read = gain * g / np.abs(g)
    expected = _span(predicted)
    before, after = (abs(np.log(_span(gains) / expected)) for gains in (g, read))
    if expected < _LEAST_SPAN or before < np.log(_SPAN_FITS) or after > np.log(_SPAN_FITS):
        return np.inf
    share = LIKELY if before > np.log(_SPANS) else CLEAR
    off, left = (_rms(_apart(gains, predicted).real) for gains in (g, read))
    return _rms(_apart(read, predicted)) if left < share * off else np.inf


def _other_frequency(response: Response, predicted: Complex, scale: float) -> float:
    """The response at ``scale`` times its frequencies, on the lines where that is within those of the prediction."""
    f = np.log(response.frequency_hz)
    inside = (f + np.log(scale) >= f[0]) & (f + np.log(scale) <= f[-1])
    if np.count_nonzero(inside) < _FEWEST or distance(response.value, predicted) <= FAR:
        return np.inf

    def apart(by: float) -> float:
        at = f[inside] + by * np.log(scale)
        reference = np.interp(at, f, np.log(np.abs(predicted))) + 1j * np.interp(at, f, np.unwrap(np.angle(predicted)))
        return _rms(_apart(response.value[inside], np.exp(reference)))

    return apart(1.0) if apart(1.0) < min(LIKELY * apart(0.0), apart(0.5)) else np.inf


def _wanders(g: Complex, predicted: Complex) -> bool:
    """Whether the phase was multiplied by 57: whole turns of it are lost, so that no reading can be compared."""
    turns, expected = (float(np.sum(np.abs(np.angle(gains[1:] / gains[:-1])))) for gains in (g, predicted))
    most = _WANDERS[0] if turns < _TURNS * (len(g) - 1) else _WANDERS[1]
    fits = float(np.median(np.abs(_apart(g, predicted).real))) < _GAIN_FITS
    return fits and turns > most * expected and turns > _TURNS * _WANDERS[0]


def _ratios(response: Response) -> list[float]:
    """SI values of one output unit per input unit, for the units that a bench may use."""
    start, end = CHANNELS[response.input], CHANNELS[response.output]
    return sorted({factor(o, end) / factor(i, start) for o in _USUAL[end] for i in _USUAL[start]})


def _apart(value: Complex, predicted: Complex) -> Complex:
    return np.asarray(np.log(value / predicted))


def _rms(values: NDArray[np.generic]) -> float:
    return float(np.sqrt(np.mean(np.abs(values) ** 2)))


def _span(value: Complex) -> float:
    """How far the logarithm of the gain reaches, the outermost tenths aside; never quite nothing."""
    low, high = np.quantile(np.log(np.abs(value)), (0.1, 0.9))
    return max(float(high - low), 1e-3)


def _correlation(value: Complex, predicted: Complex) -> float:
    """Of two complex logarithms over the lines, -1 to 1."""
    a, b = (np.log(np.abs(gains)) + 1j * np.unwrap(np.angle(gains)) for gains in (value, predicted))
    a, b = a - np.mean(a), b - np.mean(b)
    size = _rms(a) * _rms(b)
    return float(np.mean((a * b.conj()).real) / size) if size > 0 else 0.0
