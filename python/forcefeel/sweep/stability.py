"""Linear stability of many loops: a verdict for each of a million, and the least damped mode over a grid of settings."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.laws.analog.gains import analog
from forcefeel.loader.loader import Loader, check_hydraulic
from forcefeel.loader.parameters import HYDRAULIC, INDEX, TABLE, did_you_mean, required
from forcefeel.loops.sampled_loop import sampled_loops
from forcefeel.simulation.linear import STABLE, STABLE_BY_POLES
from forcefeel.sweep.plan import Sweep
from forcefeel.threads import cores, threads_or_cores
from forcefeel.units import show

MOST_POINTS = 2_000_000
"""Largest number of points of a map: some ten seconds on one core."""

_AT_ONCE = float(np.finfo(np.float64).tiny)
"""In place of a pole at z = 0, such as that of a delay, whose logarithm is infinite: as well damped, and finite."""

_AT_A_TIME = 16_384
"""Points whose poles are in memory together."""


def stability_batch(
    loader: Loader,
    varied: Mapping[str, ArrayLike],
    law: GainLaw | NDArray[np.float64] | None = None,
    *,
    threads: int | None = None,
) -> xr.Dataset:
    """Whether each of many closed loops is stable: all poles of eq. (17), the compliant link, left of the axis.

    Each loop's matrix is built from its parameters, brought to Hessenberg form and to its characteristic polynomial, and judged
    by the signs of Routh's array, all in twice double precision with a bound on the error: a sign counts only if the bound
    leaves no other. Loops so close to the axis that it does leave one are judged by their computed poles.

    Args:
        loader: The common loader. Its optional rows have no part in the linear model.
        varied: SI values of the rows ``part.name`` that differ, one for each loop.
        law: One law for all, or state-feedback gains c_1 .. c_7 (loops, 7). Not given, each loop has the original
            position loop, eq. (13), of its own parameters.
        threads: Number of threads, without effect on the verdicts; default, all cores.

    Returns:
        Over ``loop``, with ``varied`` as coordinates: ``stable``, and ``proved``, whether the signs decided. A loop whose matrix
        leaves the range of double precision is neither.

    Raises:
        InputError: If a row is unknown or no part of the linear model, values are not finite or not one for each loop.

    Source:
        Routh's criterion, E. J. Routh, 1877; reduction: Wilkinson, The Algebraic Eigenvalue Problem, 1965, chapter 6, section 8.

    Example:
        >>> found = ff.sweep.stability_batch(ff.elevator(), {"feel.stiffness": np.array([200.0, 1000.0])})
        >>> sorted(found.data_vars)
        ['proved', 'stable']
    """
    check_hydraulic(
        loader, "stability of the loops of eq. (17)", "loops.sampled_loops has those of a motor under its law"
    )
    columns = {key: np.asarray(values, dtype=np.float64) for key, values in varied.items()}
    _check(columns, law)
    table = np.column_stack(list(columns.values()))
    loops = _core.Loops(loader.si_values, [INDEX[key] for key in columns], table, **analog(law).engine())
    verdict = loops.stability(threads_or_cores(threads))
    coordinates = {key: ("loop", values, {"units": TABLE[key].unit_si}) for key, values in columns.items()}
    data = {
        "stable": ("loop", (verdict == STABLE) | (verdict == STABLE_BY_POLES)),
        "proved": ("loop", verdict <= STABLE),  # up to this one they are proved,
    }
    return xr.Dataset(data, coordinates, {"loader": loader.name})


def damping_map(sweep: Sweep) -> xr.DataArray | None:
    """Damping ratio ``-Re p / |p|`` of the least damped pole at each point of the grid; below zero where it is unstable.

    Of the linear model with the compliant link and the sweep's law, the loader at its nominal values; ``None`` for a grid of
    more than two million points.
    """
    if np.prod(sweep.shape) > MOST_POINTS:
        return None
    keys, axes = list(sweep.axes), [np.array(axis) for axis in sweep.axes.values()]
    damping = np.empty(int(np.prod(sweep.shape)))
    for start in range(0, len(damping), _AT_A_TIME):
        points = slice(start, start + _AT_A_TIME)
        places = np.unravel_index(np.arange(len(damping))[points], sweep.shape)
        table = np.column_stack([axis[index] for axis, index in zip(axes, places, strict=True)])
        poles = _poles(sweep, keys, table)
        damping[points] = np.min(-poles.real / np.maximum(np.abs(poles), np.finfo(float).tiny), axis=1)
    coordinates = {key: (key, axis, {"units": TABLE[key].unit_si}) for key, axis in zip(keys, axes, strict=True)}
    return xr.DataArray(damping.reshape(sweep.shape), coordinates, tuple(keys), "least_damping_ratio")


def _poles(sweep: Sweep, keys: list[str], table: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Poles of the loops; under a sampled law ``ln z / T`` of those of the sampled loop."""
    values = sweep.loader.rows(keys, table)
    law = sweep.law_of(values)
    if law.sampled:
        loops = sampled_loops(sweep.loader, law, values)
        poles = np.where(loops.poles == 0, _AT_ONCE, loops.poles)
        return np.asarray(np.log(poles) / loops.period_s)
    analog_loops = _core.Loops(sweep.loader.si_values, [INDEX[key] for key in keys], table, **law.engine(sweep.loader))
    parts = analog_loops.poles(cores())
    return np.asarray(parts[..., 0] + 1j * parts[..., 1])


def _check(columns: Mapping[str, NDArray[np.float64]], law: GainLaw | NDArray[np.float64] | None) -> None:
    if not columns:
        raise InputError("varied: expected values of at least one parameter, such as feel.stiffness, got none")
    counts = {values.shape for values in columns.values()}
    for key, values in columns.items():
        if key not in TABLE:
            raise InputError(f"varied: unknown parameter {show(key)}; {did_you_mean(key)}")
        if key not in required(HYDRAULIC):
            raise InputError(f"varied: {key} is no part of the linear model; leave it out")
        if values.ndim != 1 or not len(values) or len(counts) > 1:
            raise InputError(f"varied: expected one value for each loop, got {key} of shape {values.shape}")
        if not np.all(np.isfinite(values)):
            raise InputError(f"varied: expected finite numbers, got others for {key}")
    loops = next(iter(counts))[0]
    if isinstance(law, np.ndarray) and law.shape != (loops, 7):
        raise InputError(f"law: expected gains of shape ({loops}, 7), got {law.shape}")
