"""Frequency responses and the margins of a loop."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import control
import numpy as np
import scipy.optimize
from numpy.typing import NDArray

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

    Example:
        >>> import forcefeel as ff
        >>> loop = ff.linear.overall_open_loop(ff.elevator(), ff.linear.Linkage.COMPLIANT)
        >>> f"{ff.linear.margins(loop).phase_margin_rad:.2f} rad"
        'inf rad'
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

    Example:
        >>> import forcefeel as ff
        >>> servo = ff.linear.servo(ff.elevator(), ff.linear.Linkage.COMPLIANT, closed=True)
        >>> f"{ff.linear.resonance(servo[1, 0], 30.0, 200.0).frequency_rad_per_s:.0f} rad/s"
        '68 rad/s'
    """

    frequency_rad_per_s: Annotated[float, HERTZ]
    gain: Annotated[float, RATIO]


def frequency_response(model: control.StateSpace, frequency_hz: NDArray[np.float64]) -> "xr.Dataset":
    """Gain and unwrapped phase of a model with one input and one output.

    Args:
        model: The model.
        frequency_hz: Frequencies, rising.

    Returns:
        ``gain_db`` and ``phase_deg`` over the coordinate ``frequency_hz``.

    Example:
        >>> import forcefeel as ff
        >>> import numpy as np
        >>> found = ff.linear.frequency_response(ff.linear.ideal_feel(ff.elevator()), np.array([0.1, 1.0, 10.0]))
        >>> sorted(found.data_vars)
        ['gain_db', 'phase_deg']
    """
    import xarray as xr  # noqa: PLC0415  with pandas, for which `forcefeel analyze` need not wait

    response = _values(model, 2j * np.pi * frequency_hz)
    phase = np.degrees(_phase(model, 2 * np.pi * frequency_hz))
    return xr.Dataset(
        {
            "gain_db": ("frequency_hz", 20 * np.log10(np.abs(response)), {"units": "dB"}),
            "phase_deg": ("frequency_hz", phase, {"units": "deg"}),
        },
        coords={"frequency_hz": ("frequency_hz", frequency_hz, {"units": "Hz"})},
        attrs={"model": model.name},
    )


def margins(loop: control.StateSpace) -> Margins:
    """Gain and phase margin of the open loop ``loop``, closed by negative feedback.

    The overall loop of a control loader rises like s^2 at low frequency (phase +180 degrees) before it falls, so its gain
    may cross one upwards and downwards. The phase is followed without jumps from low frequency, and the phase margin is
    the smallest of ``180 degrees + phase`` over all crossings: the lag that the loop bears, negative if it has too much.

    Example:
        >>> import forcefeel as ff
        >>> loop = ff.linear.overall_open_loop(ff.elevator(), ff.linear.Linkage.COMPLIANT)
        >>> f"{ff.linear.margins(loop).gain_margin:.1f}"
        '2.5'
    """
    with np.errstate(over="ignore", invalid="ignore"):  # of its third margin, which is not asked for
        gains, _, _, w_phase, w_gain, _ = control.stability_margins(loop, returnall=True)
    # Where the loop's gain is without bound, on a pole, or nothing, the phase jumps and crosses nothing.
    passed = [pair for pair in zip(gains, w_phase, strict=True) if 0 < pair[0] < np.inf]
    gain = min(passed, key=lambda pair: abs(np.log(pair[0])), default=(np.inf, np.nan))
    crossings = zip(np.pi + _phase(loop, np.asarray(w_gain)), w_gain, strict=True)
    lag, w_lag = min(crossings, default=(np.inf, np.nan))
    return Margins(float(gain[0]), float(lag), float(gain[1]), float(w_lag))


def _phase(model: control.StateSpace, w: NDArray[np.float64]) -> NDArray[np.float64]:
    """Phase at the frequencies ``w`` in rad/s, followed without jumps from low frequency.

    A lightly damped pole or zero turns the phase by 180 degrees within a part of its frequency, so the path is refined
    around each; and it runs just to the right of the imaginary axis, as Nyquist's does, so that a pole on the axis turns
    it the way that a stable one does.
    """
    if len(w) == 0:
        return np.empty(0)
    corners = np.abs(np.concatenate([model.poles(), model.zeros()]).imag)
    offsets = np.geomspace(1e-7, 0.1, 40)
    beside = np.outer(corners[corners > 0], np.concatenate([1 - offsets, 1 + offsets])).ravel()
    path = np.union1d(np.concatenate([np.geomspace(1e-3, max(1e4, w.max()), 2000), beside]), w)
    followed = np.unwrap(np.angle(_values(model, path * (1e-6 + 1j))))[np.searchsorted(path, w)]
    exact = np.angle(_values(model, 1j * w))
    return np.asarray(exact + 2 * np.pi * np.round((followed - exact) / (2 * np.pi)))


def _values(
    model: control.StateSpace, s: NDArray[np.complexfloating[Any, Any]]
) -> NDArray[np.complexfloating[Any, Any]]:
    """Values of a model with one input and one output at the complex frequencies ``s`` in rad/s.

    The same as ``model(s)``, which solves for one after another, and takes ten times as long for a thousand.
    """
    if model.nstates < 2:  # has a formula there
        return np.asarray(model(s))
    try:
        states = np.linalg.solve(s[:, np.newaxis, np.newaxis] * np.eye(model.nstates) - model.A, model.B)
    except np.linalg.LinAlgError:  # on a pole, where the value is infinite
        return np.asarray(model(s))
    return np.asarray((model.C @ states + model.D)[:, 0, 0])


def resonance(model: control.StateSpace, low_rad_per_s: float, high_rad_per_s: float) -> Peak | None:
    """The peak of a model with one input and one output between two frequencies; ``None`` if its gain only falls or rises.

    Example:
        >>> import forcefeel as ff
        >>> servo = ff.linear.servo(ff.elevator(), ff.linear.Linkage.COMPLIANT, closed=True)
        >>> ff.linear.resonance(servo[1, 0], 30.0, 200.0) is not None
        True
    """
    w = np.geomspace(low_rad_per_s, high_rad_per_s, 500)
    top = int(np.argmax(np.abs(_values(model, 1j * w))))
    if top in {0, len(w) - 1}:
        return None
    best = scipy.optimize.minimize_scalar(
        lambda one: -abs(complex(model(1j * one))), bounds=(w[top - 1], w[top + 1]), method="bounded"
    )
    return Peak(float(best.x), float(-best.fun))
