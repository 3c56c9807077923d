"""Gains for many computer settings of one loader, from the structure of the problem.

The plant's four states do not see the feel model, so its Riccati equation is solved once; each setting then costs one
linear equation, solved in Rust (``crates/solve/src/schedule.rs`` derives it).
"""

from dataclasses import dataclass

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel.compensation import DesignSettings, SampledProblem, state_scale
from forcefeel.errors import InputError
from forcefeel.loader import Loader
from forcefeel.models import design_plant

_PLANT = [0, 1, 4, 5]  # x_p, p, x_b, x_b' among DESIGN_STATES
_FEEL = [2, 3]  # delta, delta'


@dataclass(frozen=True, eq=False)
class GainSchedule:
    """Converged gains over settings.

    Attributes:
        settings: I, B, G in SI units, a row per setting.
        gains: SI gains c_1 .. c_6 on the first six of ``DESIGN_STATES``, a row per setting.
    """

    settings: NDArray[np.float64]
    gains: NDArray[np.float64]


def schedule_gains(
    loader: Loader, settings: ArrayLike, design: DesignSettings | None = None, *, continuous: bool = False
) -> GainSchedule:
    """Converged gains for every setting.

    Args:
        loader: The loader; its own feel setting is not used.
        settings: I, B, G in SI units (N m s^2/rad, N m s/rad, N m/rad), a row per setting.
        design: Weights of eq. (21) and step; the horizon is endless.
        continuous: Design in continuous time, the limit of a small step, instead of at ``design.step_s``.

    Raises:
        InputError: If a setting is not a row of three finite numbers with I > 0, B >= 0, G > 0, or has no gains in double
            precision; if ``design`` has a horizon or [Q] whole.
    """
    design = design or DesignSettings()
    if design.horizon_s is not None or design.q is not None:
        raise InputError("design: expected an endless horizon and the weights of eq. (21); leave out horizon_s and q")
    rows = _rows(settings)
    solve = _continuous_plant if continuous else _sampled_plant
    plant = solve(loader, design)
    period = None if continuous else design.step_s
    feel_gains = _core.schedule(plant.closed, plant.coupling, plant.gain_row, period, rows)
    if not np.isfinite(feel_gains).all():
        bad = int(np.argmin(np.isfinite(feel_gains).all(axis=1)))
        raise InputError(f"settings: row {bad}, {rows[bad].tolist()}, has no gains: its numbers are too far apart")
    gains = np.empty((len(rows), 6))
    gains[:, _PLANT] = plant.gains / plant.scale
    gains[:, _FEEL] = feel_gains
    return GainSchedule(rows, gains)


def _rows(settings: ArrayLike) -> NDArray[np.float64]:
    try:
        rows = np.ascontiguousarray(settings, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"settings: expected rows of I, B, G ({error})") from error
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InputError(f"settings: expected rows of I, B, G, got shape {rows.shape}")
    good = np.isfinite(rows).all(axis=1) & (rows[:, 0] > 0) & (rows[:, 1] >= 0) & (rows[:, 2] > 0)
    if not good.all():
        bad = int(np.argmin(good))
        raise InputError(f"settings: expected finite I > 0, B >= 0, G > 0, got {rows[bad].tolist()} in row {bad}")
    return rows


@dataclass(frozen=True)
class _SolvedPlant:
    """What all settings share, the states scaled to the order of one.

    Attributes:
        gains: Gains of the plant's four states.
        closed: Closed-loop matrix M of the plant.
        coupling: Weight between the plant's and the feel's states.
        gain_row: Row k that turns the coupling block of the cost into gains of the feel's states.
        scale: SI value of one unit of each scaled state.
    """

    gains: NDArray[np.float64]
    closed: NDArray[np.float64]
    coupling: NDArray[np.float64]
    gain_row: NDArray[np.float64]
    scale: NDArray[np.float64]


def _sampled_plant(loader: Loader, design: DesignSettings) -> _SolvedPlant:
    problem = SampledProblem.of(loader, design)
    phi, h = problem.phi[np.ix_(_PLANT, _PLANT)], problem.h[_PLANT]
    scale = problem.scale[_PLANT]
    k, cost, _ = control.dlqr(phi, h, problem.q[np.ix_(_PLANT, _PLANT)], problem.r)
    row = h.T / (problem.r + h.T @ cost @ h)
    return _SolvedPlant(-k[0], phi - h @ k, _coupling(loader, design, scale), row[0], scale)


def _continuous_plant(loader: Loader, design: DesignSettings) -> _SolvedPlant:
    plant, scale = design_plant(loader), state_scale(loader)[_PLANT]
    a = plant.A[np.ix_(_PLANT, _PLANT)] * scale / scale[:, None]
    b = plant.B[_PLANT] / scale[:, None]
    q = design.weight(loader)[np.ix_(_PLANT, _PLANT)] * np.outer(scale, scale)
    k, _, _ = control.lqr(a, b, q, [[design.r2]])
    return _SolvedPlant(-k[0], a - b @ k, _coupling(loader, design, scale), (b.T / design.r2)[0], scale)


def _coupling(loader: Loader, design: DesignSettings, scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weight between the scaled plant states and the feel states, which stay in SI: their matrix is per setting."""
    return np.asarray(design.weight(loader)[np.ix_(_PLANT, _FEEL)] * scale[:, None])
