"""Frequency responses and the margins of a loop."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import balanced
from forcefeel.linear.bracketing import root_between
from forcefeel.linear.models import StateSpaceLike, check_model
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import ANGLE, HERTZ, RATIO

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Margins:
    """Gain and phase margin of a loop; infinite where the phase or the gain never crosses.

    Attributes:
        gain_margin: Factor by which the loop's gain may grow until it is on the edge of stability; below one the
            closed loop is already past it.
        phase_margin_rad: Lag that the loop bears at the crossover of its gain.
        phase_crossover_rad_per_s: Where the phase is -180 degrees.
        gain_crossover_rad_per_s: Where the gain is one.
    """

    gain_margin: Annotated[float, RATIO]
    phase_margin_rad: Annotated[float, ANGLE]
    phase_crossover_rad_per_s: Annotated[float, HERTZ]
    gain_crossover_rad_per_s: Annotated[float, HERTZ]


@dataclass(frozen=True)
class Peak:
    """Largest gain of a frequency response.

    Attributes:
        frequency_rad_per_s: Where it is.
        gain: How large it is.
    """

    frequency_rad_per_s: Annotated[float, HERTZ]
    gain: Annotated[float, RATIO]


def frequency_response(model: StateSpaceLike, frequency_hz: NDArray[np.float64]) -> "xr.Dataset":
    """Gain and unwrapped phase of a model with one input and one output.

    Args:
        model: The model.
        frequency_hz: Frequencies, rising.

    Returns:
        ``gain_db`` and ``phase_deg`` over the coordinate ``frequency_hz``.

    Example:
        >>> found = ff.linear.frequency_response(ff.linear.ideal_feel(ff.elevator()), np.array([0.1, 1.0, 10.0]))
        >>> sorted(found.data_vars)
        ['gain_db', 'phase_deg']
    """
    return frequency_arrays(model, frequency_hz).dataset


def frequency_arrays(model: StateSpaceLike, frequency_hz: NDArray[np.float64]) -> LabeledArrays:
    """What ``frequency_response`` makes its data set of; the same arguments."""
    check_model("model", model, single=True)
    gain = np.abs(response(model, 2j * np.pi * frequency_hz))
    phase = np.degrees(_phase(model, 2 * np.pi * frequency_hz))
    return LabeledArrays(
        {
            "gain_db": ("frequency_hz", 20 * np.log10(gain), {"units": "dB"}),
            "phase_deg": ("frequency_hz", phase, {"units": "deg"}),
        },
        {"frequency_hz": ("frequency_hz", frequency_hz, {"units": "Hz"})},
        {"model": model.name},
    )


def margins(loop: StateSpaceLike) -> Margins:
    """Gain and phase margin of the open loop ``loop``, closed by negative feedback.

    The overall loop of a control loader rises like s^2 at low frequency (phase +180 degrees) before it falls, so its gain
    may cross one upwards and downwards. The phase is followed without jumps from low frequency, and the phase margin is
    the smallest of ``180 degrees + phase`` over all crossings: the lag that the loop bears, negative if it has too much.

    Example:
        >>> loop = ff.linear.overall_open_loop(ff.elevator(), ff.linear.Linkage.COMPLIANT)
        >>> f"{ff.linear.margins(loop).gain_margin:.1f}"
        '2.5'
    """
    check_model("loop", loop, single=True)
    w = _path(loop)
    values = response(loop, 1j * w)

    def at(frequency: float) -> complex:
        return complex(response(loop, np.array([1j * frequency]))[0])

    turned = [
        (at(frequency), frequency) for frequency in crossings(w, values.imag, lambda frequency: at(frequency).imag)
    ]
    gains = [(-1 / value.real, frequency) for value, frequency in turned if -1 / _NOTHING < value.real < -_NOTHING]
    gain = min(gains, key=lambda pair: abs(np.log(pair[0])), default=(np.inf, np.nan))
    with np.errstate(divide="ignore"):
        level = np.log(np.abs(values))
    w_gain = crossings(w, level, lambda frequency: float(np.log(abs(at(frequency)))))
    lags = zip(np.pi + _phase(loop, np.array(w_gain)), w_gain, strict=True)
    lag, w_lag = min(lags, default=(np.inf, np.nan))
    return Margins(float(gain[0]), float(lag), float(gain[1]), float(w_lag))


_NOTHING = 1e-6
"""A gain that counts as zero: where the loop has none or is without bound, on a pole, the phase jumps and crosses nothing."""


def crossings(w: NDArray[np.float64], values: NDArray[np.float64], at: Callable[[float], float]) -> list[float]:
    """Where a curve goes through zero, between two points that differ in sign."""
    places = np.flatnonzero(np.diff(np.sign(values)) != 0)
    return [root_between(at, float(w[k]), float(w[k + 1])) for k in places if at(w[k]) * at(w[k + 1]) < 0]


def response(model: StateSpaceLike, s: NDArray[Any]) -> NDArray[Any]:
    """``C (s - A)^-1 B + D`` of a model with one input and one output at complex points s in 1/s; infinite on a pole."""
    resolvent = s[:, np.newaxis, np.newaxis] * np.eye(len(model.A)) - model.A
    try:
        states = np.linalg.solve(resolvent, np.tile(np.asarray(model.B, dtype=complex), (len(s), 1, 1)))
    except np.linalg.LinAlgError:
        if len(s) == 1:
            return np.array([complex(np.inf, np.nan)])
        return np.concatenate([response(model, half) for half in np.array_split(s, 2)])
    return np.asarray((np.asarray(model.C) @ states)[:, 0, 0] + np.asarray(model.D)[0, 0])


def _phase(model: StateSpaceLike, w: NDArray[np.float64]) -> NDArray[np.float64]:
    """Phase at the frequencies ``w`` in rad/s, followed without jumps from low frequency.

    The path runs just to the right of the imaginary axis, as Nyquist's does, so that a pole on the axis turns the phase the
    way that a stable one does.
    """
    if len(w) == 0:
        return np.empty(0)
    path = np.union1d(_path(model), w)
    followed = np.unwrap(np.angle(response(model, path * (1e-6 + 1j))))[np.searchsorted(path, w)]
    exact = np.angle(response(model, 1j * w))
    return np.asarray(exact + 2 * np.pi * np.round((followed - exact) / (2 * np.pi)))


def _path(model: StateSpaceLike) -> NDArray[np.float64]:
    """Frequencies in rad/s at which to look for what a response does.

    A lightly damped pole or zero turns the phase by 180 degrees within a part of its frequency, so the path is finer
    around each.
    """
    poles = np.linalg.eigvals(model.A)
    corners = np.abs(np.concatenate([poles, zeros(model)]).imag)
    offsets = np.geomspace(1e-7, 0.1, 40)
    beside = np.outer(corners[corners > 0], np.concatenate([1 - offsets, 1 + offsets])).ravel()
    return np.union1d(np.geomspace(1e-3, max(1e4, 10 * np.abs(poles).max()), 2000), beside)


def zeros(model: StateSpaceLike) -> NDArray[np.complex128]:
    """Where ``[A - s, B; C, D]`` of a model with one input and one output loses rank, in 1/s.

    Without a feedthrough D the row of A that the input drives holds the input alone: without it, the state that the input is
    turned into is the next input. Each turn takes one zero at infinity away.

    Source: A. Emami-Naeini and P. Van Dooren, Computation of zeros of linear multivariable systems, Automatica 18 (1982).
    """
    a, scale = balanced(np.asarray(model.A, dtype=np.float64))
    b, c, d = np.asarray(model.B) / scale[:, np.newaxis], np.asarray(model.C) * scale, np.asarray(model.D)
    through = abs(float(d[0, 0])) > 0
    while len(a) and not through:
        turned = np.linalg.qr(b, mode="complete").Q
        a, c = turned.T @ a @ turned, c @ turned
        through = abs(float(c[0, 0])) > _NONE * float(np.linalg.norm(c))
        a, b, c, d = a[1:, 1:], a[1:, :1], c[:, 1:], c[:, :1]
    return np.asarray(np.linalg.eigvals(a - b @ c / d) if len(a) else np.empty(0), dtype=np.complex128)


_NONE = 1e-12
"""Share of an output's row that is the rounding of no feedthrough."""


def resonance(model: StateSpaceLike, low_rad_per_s: float, high_rad_per_s: float) -> Peak | None:
    """The peak of a model with one input and one output between two frequencies; ``None`` if its gain only falls or rises.

    Example:
        >>> servo = ff.linear.servo(ff.elevator(), ff.linear.Linkage.COMPLIANT, closed=True)
        >>> ff.linear.resonance(servo[1, 0], 30.0, 200.0) is not None
        True
    """
    check_model("model", model, single=True)
    w = np.geomspace(low_rad_per_s, high_rad_per_s, 500)
    top = int(np.argmax(np.abs(response(model, 1j * w))))
    if top in {0, len(w) - 1}:
        return None
    frequency = root_between(lambda frequency: _steepness(model, frequency), float(w[top - 1]), float(w[top + 1]))
    return Peak(frequency, float(abs(response(model, np.array([1j * frequency]))[0])))


def _steepness(model: StateSpaceLike, frequency: float) -> float:
    """Half the slope of ``|G|^2`` over frequency: ``Re(conj(G) dG/dw)``, ``dG/dw = -j C (jw - A)^-2 B``."""
    resolvent = 1j * frequency * np.eye(len(model.A)) - np.asarray(model.A)
    states = np.linalg.solve(resolvent, np.asarray(model.B, dtype=complex))
    gain = np.asarray(model.C) @ states + np.asarray(model.D)
    slope = -1j * np.asarray(model.C) @ np.linalg.solve(resolvent, states)
    return float((np.conj(gain) * slope)[0, 0].real)
