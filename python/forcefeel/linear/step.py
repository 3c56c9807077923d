"""Responses to a step of pilot force, and exact integrals over them."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import balanced, exponential, propagated
from forcefeel.errors import InputError, expect_number
from forcefeel.linear.models import StateSpaceLike, check_model
from forcefeel.tables.labeled_arrays import LabeledArrays

if TYPE_CHECKING:
    import xarray as xr

DURATION_S = 2.0
"""Length of the time responses, and of the window over which they are judged."""

_UNITS = {"_m3_per_s": "m^3/s", "_rad": "rad", "_v": "V", "_m": "m", "_n": "N", "_a": "A"}
"""Units by the ends of the names of outputs."""


def step_response(
    model: StateSpaceLike, force_n: float, duration_s: float = DURATION_S, samples: int = 2001
) -> "xr.Dataset":
    """Response from rest to a step of pilot force at time zero (figs. 11, 14).

    Args:
        model: A model whose first input is the pilot force.
        force_n: Height of the step.
        duration_s: Length of the response.
        samples: How many samples, the first at time zero.

    Returns:
        Every output of the model over the coordinate ``time_s``; exact at the samples, since the input is constant;
        not a number once an unstable response has left the range of double precision.

    Example:
        >>> response = ff.step_response(ff.compliant_model(ff.elevator()), force_n=100.0)
        >>> f"{float(response.column_angle_rad[-1]):.3f} rad"
        '0.045 rad'
    """
    return step_arrays(model, force_n, duration_s, samples).dataset


def step_arrays(
    model: StateSpaceLike, force_n: float, duration_s: float = DURATION_S, samples: int = 2001
) -> LabeledArrays:
    """What ``step_response`` makes its data set of; the same arguments."""
    time, outputs = step_outputs(model, force_n, duration_s, samples)
    data = {
        name: ("time_s", row, {"units": _unit_of(name)}) for name, row in zip(model.output_labels, outputs, strict=True)
    }
    return LabeledArrays(
        data, {"time_s": ("time_s", time, {"units": "s"})}, {"model": model.name, "pilot_force_n": force_n}
    )


def step_outputs(
    model: StateSpaceLike, force_n: float, duration_s: float = DURATION_S, samples: int = 2001
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times, and a row for each output of the model, of ``step_response``."""
    check_model("model", model)
    for name, number in (("force_n", force_n), ("duration_s", duration_s)):
        expect_number(name, number)
    expect_number("samples", samples, whole=True)
    if not 0 < duration_s < np.inf or samples < 2:
        raise InputError(
            f"duration_s, samples: expected a length of time and two samples or more, got {duration_s:g} s and {samples}"
        )
    time = np.linspace(0.0, duration_s, samples)
    b = np.asarray(model.B)[:, 0]
    phi, level, _ = transition(np.asarray(model.A), b, duration_s / (samples - 1))
    with np.errstate(over="ignore", invalid="ignore"):
        states = propagated(phi, np.zeros(len(b)), np.tile(level * force_n, (samples - 1, 1)))
        outputs = np.asarray(model.C) @ states.T + np.asarray(model.D)[:, :1] * force_n
    return time, np.where(np.isfinite(outputs), outputs, np.nan)


def transition(
    a: NDArray[np.float64], b: NDArray[np.float64], step_s: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Phi, Gamma_0 and Gamma_1 of ``x_{k+1} = Phi x_k + Gamma_0 u_k + Gamma_1 (u_{k+1} - u_k)``, ``u`` even within each step.

    Source: C. Van Loan, Computing Integrals Involving the Matrix Exponential, IEEE Trans. Automatic Control 23 (1978).
    """
    n = len(a)
    # States in SI units differ by ten powers of ten: balance them, or rounding eats the small ones.
    like, scale = balanced(a)
    block = np.zeros((n + 2, n + 2))
    block[:n, :n] = like * step_s
    block[:n, n] = b / scale * step_s
    block[n, n + 1] = 1.0
    whole = exponential(block)
    phi = whole[:n, :n] * scale[:, np.newaxis] / scale
    return phi, whole[:n, n] * scale, whole[:n, n + 1] * scale


def _unit_of(name: str) -> str:
    return next((unit for end, unit in _UNITS.items() if name.endswith(end)), "")


def equilibrium(model: StateSpaceLike) -> NDArray[np.float64]:
    """The state in which a model stays under a pilot force of one newton, ``0 = A x + B``.

    Raises:
        numpy.linalg.LinAlgError: If it has no solution, or rounding leaves it fewer digits than people read.
    """
    # States in SI units differ by ten powers of ten: balance them, or rounding eats the small ones.
    like, scale = balanced(np.asarray(model.A))
    state = np.linalg.solve(like, np.asarray(model.B)[:, 0] / scale)
    # |A^-1| |A| |x| u, the bound of what rounding the entries of A moves it (Skeel 1979)
    moved = np.abs(np.linalg.inv(like)) @ (np.abs(like) @ np.abs(state)) * np.finfo(np.float64).eps
    if not np.max(moved) <= _LEAST_DIGITS * np.max(np.abs(state)):
        raise np.linalg.LinAlgError("the equilibrium is lost in rounding")
    return np.asarray(-scale * state)


_LEAST_DIGITS = 1e-6
"""Relative: people read four digits, and a stepped run finds its equilibrium to 1e-5 of full travel."""


def gramian(a: NDArray[np.float64], start: NDArray[np.float64], duration_s: float) -> NDArray[np.float64]:
    """Integral ``X`` of ``x x'`` along ``x' = A x`` from ``start``; the integral of ``x' W x`` is then ``sum(W * X)``.

    Van Loan's exponential gives the integral over a short step; doubling the step carries it to ``duration_s`` without
    ever forming the exponential of a stiff matrix over a long time.

    Args:
        a: State matrix A, n by n.
        start: State at time zero.
        duration_s: End of the integral.

    Source: C. Van Loan, Computing Integrals Involving the Matrix Exponential, IEEE Trans. Automatic Control 23 (1978).
    """
    n = len(a)
    # States in SI units differ by ten powers of ten: balance them, or rounding eats the small ones.
    like, scale = balanced(a)
    doublings = max(0, int(np.ceil(np.log2(duration_s * max(float(np.linalg.norm(like, 1)), 1e-12)))))
    step = duration_s / 2**doublings
    start = start / scale
    block = exponential(np.block([[-like, np.outer(start, start)], [np.zeros((n, n)), like.T]]) * step)
    phi = block[n:, n:].T
    integral = phi @ block[:n, n:]
    for _ in range(doublings):
        integral = integral + phi @ integral @ phi.T
        phi = phi @ phi
    return np.asarray(integral * np.outer(scale, scale))
