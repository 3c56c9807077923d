"""Most likely labeling error of a response far from its prediction."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import CHANNELS
from forcefeel.bench.response_checks import check_response
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.units import factor

CLEAR = 1 / 3
"""Distance of a response in another reading over its distance as read, at most."""
LIKELY = 1 / 2
"""The same where further evidence, beyond wrong loader values, supports that reading."""
FAR = 0.8
"""Distance below which neither sign, nor direction, nor frequencies are suspected."""

_FLATTER = 8.0
"""Factor of phase turn below the prediction at which the phase was divided by 57."""
_LARGEST_RAD = 0.25
"""Phases in degrees as large as those in rad of eight poles, read as degrees."""
_TURNS = 0.3
"""Least turn of the predicted phase over the band that determines its unit, rad."""
_WANDERS = (20.0, 4.0)
"""A phase that turns from line to line more than the prediction's by the first factor was multiplied by 57; by the second if it
turns by more than 0.3 rad from line to line, so that whole turns may be lost."""
_GAIN_FITS = 1.0
"""Largest median of |ln gain ratio| with only the phase in error."""
_LEAST_SPAN = 0.7
"""Least span of the logarithm of the predicted gain that separates ratios from dB: a factor of two."""
_SPANS = 3.0
"""Factor between the spans of two logarithmic gains beyond that of any loader."""
_SPAN_FITS = 1.5
"""Factor within which the spans of two logarithmic gains may be those of one machine."""
_MOST_DECIBELS = 400.0
"""Largest gain of a machine."""
_AGAINST = -0.5
"""Correlation of two logarithmic responses below which they run in opposite directions."""
_FEWEST = 3
"""Lines on which two responses are compared."""

# Units in use on benches, by SI unit.
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
    """The most likely labeling error of a response far from its prediction; ``None`` if none stands out.

    The same numbers are read in other units, signs or directions. A reading is suspected if it brings the response clearly nearer
    to the prediction and wrong loader values cannot explain the difference:

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
        predicted: Response of the model at the same lines in SI units, (lines,).

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
    turned = f"it seems to lead from {response.output} to {response.input}; exchange from and to"
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
    """R.m.s. distance of ``-G`` from the prediction; infinite, as for the others, without evidence."""
    as_read = distance(g, predicted)
    return _rms(_apart(-g, predicted)) if as_read > FAR and distance(-g, predicted) < CLEAR * as_read else np.inf


def _inverse(g: Complex, predicted: Complex, ratio: float) -> float:
    """Distance of ``1/G``, in the units ``ratio`` of the reading."""
    turned, as_read = ratio**2 / g, distance(g, predicted)
    if as_read <= FAR or distance(turned, predicted) >= LIKELY * as_read:
        return np.inf
    return _rms(_apart(turned, predicted)) if _correlation(g, predicted) < _AGAINST else np.inf


def _other_phase(g: Complex, predicted: Complex) -> float:
    """Distance with the phase times 57."""
    phase, expected = np.angle(g), np.unwrap(np.angle(predicted))
    turns = float(np.ptp(expected))
    if turns < _TURNS or np.ptp(phase) * _FLATTER > turns or np.max(np.abs(phase)) > _LARGEST_RAD:
        return np.inf
    read = np.abs(g) * np.exp(1j * np.degrees(phase))
    before, after = (_rms(_apart(gains, predicted).imag) for gains in (g, read))
    return _rms(_apart(read, predicted)) if after < before else np.inf


def _was_ratio(g: Complex, predicted: Complex, ratio: float) -> float:
    """Distance if the gain was a ratio, read as dB."""
    numbers = 20 * np.log10(np.abs(g) / ratio)
    return _other_gain(g, ratio * numbers, predicted) if np.min(numbers) > 0 else np.inf


def _was_decibels(g: Complex, predicted: Complex, ratio: float) -> float:
    """Distance if the gain was in dB, read as a ratio."""
    numbers = np.abs(g) / ratio
    return _other_gain(g, ratio * 10 ** (numbers / 20), predicted) if np.max(numbers) < _MOST_DECIBELS else np.inf


def _other_gain(g: Complex, gain: NDArray[np.float64], predicted: Complex) -> float:
    """Distance with another gain, if it is clearly nearer and only its span fits the prediction."""
    read = gain * g / np.abs(g)
    expected = _span(predicted)
    before, after = (abs(np.log(_span(gains) / expected)) for gains in (g, read))
    if expected < _LEAST_SPAN or before < np.log(_SPAN_FITS) or after > np.log(_SPAN_FITS):
        return np.inf
    share = LIKELY if before > np.log(_SPANS) else CLEAR
    misfit, residual = (_rms(_apart(gains, predicted).real) for gains in (g, read))
    return _rms(_apart(read, predicted)) if residual < share * misfit else np.inf


def _other_frequency(response: Response, predicted: Complex, scale: float) -> float:
    """Distance at ``scale`` times the frequencies, on the lines within the band of the prediction."""
    f = np.log(response.frequency_hz)
    inside = (f + np.log(scale) >= f[0]) & (f + np.log(scale) <= f[-1])
    if np.count_nonzero(inside) < _FEWEST or distance(response.value, predicted) <= FAR:
        return np.inf

    def apart(shift: float) -> float:
        shifted = f[inside] + shift * np.log(scale)
        reference = np.interp(shifted, f, np.log(np.abs(predicted))) + 1j * np.interp(
            shifted, f, np.unwrap(np.angle(predicted))
        )
        return _rms(_apart(response.value[inside], np.exp(reference)))

    return apart(1.0) if apart(1.0) < min(LIKELY * apart(0.0), apart(0.5)) else np.inf


def _wanders(g: Complex, predicted: Complex) -> bool:
    """Whether the phase was multiplied by 57, and whole turns are lost."""
    turns, expected = (float(np.sum(np.abs(np.angle(gains[1:] / gains[:-1])))) for gains in (g, predicted))
    limit = _WANDERS[0] if turns < _TURNS * (len(g) - 1) else _WANDERS[1]
    fits = float(np.median(np.abs(_apart(g, predicted).real))) < _GAIN_FITS
    return fits and turns > limit * expected and turns > _TURNS * _WANDERS[0]


def _ratios(response: Response) -> list[float]:
    """SI values of one output unit per input unit, for the units that a bench may use."""
    start, end = CHANNELS[response.input], CHANNELS[response.output]
    return sorted({factor(o, end) / factor(i, start) for o in _USUAL[end] for i in _USUAL[start]})


def _apart(value: Complex, predicted: Complex) -> Complex:
    return np.asarray(np.log(value / predicted))


def _rms(values: NDArray[np.generic]) -> float:
    return float(np.sqrt(np.mean(np.abs(values) ** 2)))


def _span(value: Complex) -> float:
    """Span of the logarithm of the gain without the outermost tenths; above zero."""
    low, high = np.quantile(np.log(np.abs(value)), (0.1, 0.9))
    return max(float(high - low), 1e-3)


def _correlation(value: Complex, predicted: Complex) -> float:
    """Correlation of two complex logarithms over the lines, -1 to 1."""
    a, b = (np.log(np.abs(gains)) + 1j * np.unwrap(np.angle(gains)) for gains in (value, predicted))
    a, b = a - np.mean(a), b - np.mean(b)
    size = _rms(a) * _rms(b)
    return float(np.mean((a * b.conj()).real) / size) if size > 0 else 0.0
