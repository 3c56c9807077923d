"""Information of a spectrum on the parameters: Fisher information, standard errors, inseparable parameters.

White noise of standard deviation sigma_c on each measured channel c, N samples. A line of power P_i (mean square) of the drive has
the information ``N P_i M_i``,

``M_i = sum_c Re(g_c^H g_c) / sigma_c^2``,   ``g_c = theta dG_c/dtheta`` at line i,

in parameters relative to their values, so that units do not matter. Its inverse is the covariance of the relative errors of the
best unbiased estimate (Cramer and Rao), which least squares reaches.

Source: G. C. Goodwin and R. L. Payne, Dynamic System Identification, 1977, ch. 6; R. Pintelon and J. Schoukens, System
Identification: A Frequency Domain Approach, 2nd ed. 2012, ch. 5.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE

UNSEEN = 1e-9
"""Relative change of the responses per relative change of a parameter that counts as zero."""

SEPARABLE = 1e-7
"""Smallest singular value of independent slopes, each of length 1; the slopes are accurate to some 1e-12."""

_NAMED = 0.1  # least share of a named parameter in a combination
_NOT_LINEAR = {
    key for key in TABLE if key.startswith(("motor.cogging", "motor.coulomb", "motor.static", "transmission.back"))
}
_LINEAR_VALVE = {"valve.current_gain", "valve.pressure_gain"}


class NotSeparableError(InputError):
    """No excitation of this experiment separates the chosen parameters."""


def named(key: str) -> str:
    """A parameter in sentences: its symbol and key."""
    return f"{TABLE[key].symbol} ({key})"


def line_information(slopes: NDArray[np.complex128], sigma: NDArray[np.float64]) -> NDArray[np.float64]:
    """M_i of each line per sample.

    Args:
        slopes: ``theta dG/dtheta``, (parameters, channels, lines).
        sigma: Standard deviation of the noise of each channel, (channels,).

    Returns:
        (lines, parameters, parameters).
    """
    weighted = slopes / sigma[:, np.newaxis]
    return np.real(np.einsum("jci,kci->ijk", weighted.conj(), weighted))


def relative_errors(information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard errors of the parameters, relative to their values, from their information, (parameters,)."""
    size = np.sqrt(np.diag(information))
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information / np.outer(size, size)))) / size)


def check_separable(
    keys: Sequence[str],
    slopes: NDArray[np.complex128],
    value: NDArray[np.complex128],
    sigma: NDArray[np.float64],
    loader: Loader,
    experiment: str,
) -> None:
    """Refuse parameters that no excitation of this experiment determines.

    Args:
        keys: The parameters.
        slopes: ``theta dG/dtheta``, (parameters, channels, lines).
        value: G, (channels, lines).
        sigma: Noise of each channel, (channels,).
        loader: The loader.
        experiment: Its name in messages.

    Raises:
        InputError: If a parameter changes no measured channel.
        NotSeparableError: If only a combination of parameters changes them.
    """
    scale = sigma[:, np.newaxis]
    columns = np.array([np.concatenate([slope.real.ravel(), slope.imag.ravel()]) for slope in slopes / scale]).T
    size = np.linalg.norm(columns, axis=0)
    unseen = [
        key for key, small in zip(keys, size <= UNSEEN * float(np.linalg.norm(value / scale)), strict=True) if small
    ]
    if unseen:
        follows = loader["valve.orifice"] and set(unseen) & _LINEAR_VALVE
        why = (
            f"; this valve follows its orifice, where {named('valve.rated_flow')} stands for its gains"
            if follows
            else "; dry friction, cogging and free play show in a slow, large record in time, not in a spectrum"
            if set(unseen) & _NOT_LINEAR
            else ""
        )
        raise InputError(
            f"fit: {', '.join(map(named, unseen))} changes nothing that is measured in {experiment}{why}; leave it out, measure "
            "another channel, or take another experiment"
        )
    _, singular, directions = np.linalg.svd(columns / size, full_matrices=False)
    if singular[-1] > SEPARABLE:
        return
    weights = (
        directions[-1] / np.abs(directions[-1]).max()
    )  # of slopes of length 1 at least two are large if they cancel
    *several, last = [named(key) for key, weight in zip(keys, weights, strict=True) if abs(weight) > _NAMED]
    raise NotSeparableError(
        f"fit: {experiment} cannot tell {', '.join(several)} and {last} apart: they can change together so that nothing "
        "that is measured changes; leave one out, measure a channel that lies between them, or take another experiment"
    )
