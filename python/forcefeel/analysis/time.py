"""Responses to a step of pilot force, and exact integrals over them."""

import control
import numpy as np
import scipy.linalg
import xarray as xr
from numpy.typing import NDArray

DURATION_S = 2.0
"""Length of the time responses, and of the window over which they are judged."""

_UNITS = {"rad": "rad", "v": "V", "m": "m", "n": "N", "a": "A", "s": "m^3/s"}


def step_response(
    model: control.StateSpace, force_n: float, duration_s: float = DURATION_S, samples: int = 2001
) -> xr.Dataset:
    """Response from rest to a step of pilot force at time zero (figs. 11, 14).

    Args:
        model: A model whose first input is the pilot force.
        force_n: Height of the step.
        duration_s: Length of the response.
        samples: How many samples, the first at time zero.

    Returns:
        Every output of the model over the coordinate ``time_s``; exact at the samples, since the input is constant.
    """
    time = np.linspace(0.0, duration_s, samples)
    force = np.zeros((model.ninputs, samples))
    force[0] = force_n
    response = control.forced_response(model, time, force, squeeze=False)
    data = {
        name: ("time_s", row, {"units": _UNITS.get(name.rsplit("_", 1)[-1], "")})
        for name, row in zip(model.output_labels, response.outputs, strict=True)
    }
    return xr.Dataset(data, {"time_s": ("time_s", time, {"units": "s"})}, {"model": model.name, "pilot_force_n": force_n})


def integral_of_squares(
    a: NDArray[np.float64], weight: NDArray[np.float64], start: NDArray[np.float64], duration_s: float
) -> float:
    """Integral of ``x' W x`` along ``x' = A x`` from ``start``.

    Van Loan's exponential gives the integral over a short step; doubling the step carries it to ``duration_s`` without
    ever forming the exponential of a stiff matrix over a long time.

    Args:
        a: State matrix A.
        weight: Symmetric weight W.
        start: State at time zero.
        duration_s: End of the integral.

    Source: C. Van Loan, IEEE Trans. Automatic Control 23 (1978) 395, eq. (1.4).
    """
    n = len(a)
    doublings = max(0, int(np.ceil(np.log2(duration_s * max(np.linalg.norm(a, 1), 1e-12)))))
    step = duration_s / 2**doublings
    block = scipy.linalg.expm(np.block([[-a.T, weight], [np.zeros((n, n)), a]]) * step)
    phi = block[n:, n:]
    gram = phi.T @ block[:n, n:]
    for _ in range(doublings):
        gram = gram + phi.T @ gram @ phi
        phi = phi @ phi
    return float(start @ gram @ start)
