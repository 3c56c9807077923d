"""Gains for many computer settings of one loader, from the structure of the problem.

The plant's four states do not see the feel model, so its Riccati equation is solved once; each setting then costs one
linear equation, solved in Rust (``crates/solve/src/schedule.rs`` derives it), or over a horizon a polynomial of its 2 by 2
transition matrix.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.analog.recursion import DesignSettings, SampledProblem, state_scale
from forcefeel.linear.models import DESIGN_FEEL, DESIGN_PLANT, design_model
from forcefeel.linear.riccati import stationary, stationary_continuous
from forcefeel.loader.feel_settings import setting_rows
from forcefeel.loader.loader import Loader


@dataclass(frozen=True, eq=False)
class GainSchedule:
    """Gains over settings.

    Attributes:
        settings: I, B, G in SI units, a row per setting.
        gains: SI gains c_1 .. c_6 on the first six of ``DESIGN_STATES``, a row per setting.
    """

    settings: NDArray[np.float64]
    gains: NDArray[np.float64]


def schedule_gains(
    loader: Loader, settings: ArrayLike, design: DesignSettings | None = None, *, continuous: bool = False
) -> GainSchedule:
    """Gains for every setting, those that ``design_gains`` gives for it.

    Args:
        loader: The loader; its own feel setting is not used.
        settings: I, B, G in SI units (N m s^2/rad, N m s/rad, N m/rad), a row per setting.
        design: Weights of eq. (21), step and horizon; over an endless horizon the gains are the fixed point itself.
        continuous: Design in continuous time, the limit of a small step, instead of at ``design.step_s``; without a horizon.

    Raises:
        InputError: If a setting is not a row of three finite numbers with I > 0, B >= 0, G > 0, or has no gains in double
            precision; if ``design`` has [Q] whole, or a horizon in continuous time.

    Example:
        >>> settings = [[6.8, 34.0, 1085.0], [3.4, 17.0, 540.0]]  # I, B, G in SI units, a row each
        >>> ff.laws.schedule_gains(ff.elevator(), settings).gains.shape
        (2, 6)
    """
    design = design or DesignSettings()
    if design.q is not None:
        raise InputError("design: expected the weights of eq. (21); leave out q")
    if continuous and design.horizon_s is not None:
        raise InputError("design: expected an endless horizon in continuous time; leave out horizon_s")
    rows = setting_rows(settings)
    if design.horizon_s is not None:
        plant_gains, feel_gains = _over_horizon(loader, design, rows)
    else:
        try:
            plant = (_continuous_plant if continuous else _sampled_plant)(loader, design)
        except np.linalg.LinAlgError as error:
            raise InputError(f"design: the loader has no gains over an endless horizon ({error})") from error
        period = None if continuous else design.step_s
        plant_gains = plant.gains / plant.scale
        feel_gains = _core.schedule(plant.closed, plant.coupling, plant.gain_row, period, rows)
    if not np.isfinite(feel_gains).all():
        bad = int(np.argmin(np.isfinite(feel_gains).all(axis=1)))
        raise InputError(f"settings: row {bad}, {rows[bad].tolist()}, has no gains: its numbers are too far apart")
    gains = np.empty((len(rows), 6))
    gains[:, DESIGN_PLANT], gains[:, DESIGN_FEEL] = plant_gains, feel_gains
    return GainSchedule(rows, gains)


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


def _over_horizon(
    loader: Loader, design: DesignSettings, rows: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gains of the plant's states, and of the feel's for each setting, by recursion (22) over the horizon.

    After j steps the block ``P_j = M_j' P_(j-1) Phi + Q``, ``P_0 = Q``, of the cost couples plant and feel. ``M_j`` and the row
    ``k`` are the plant's alone, so that of N steps ``c_w = -k P_(N-1) Phi = -(q_0 + q_1 Phi + ... + q_(N-1) Phi^(N-1)) Phi``
    with ``q_0 = k Q``, ``q_1 = k M_(N-1)' Q``, ``q_2 = k M_(N-1)' M_(N-2)' Q`` and so on, the same rows for every setting.
    """
    problem = SampledProblem.of(loader, design)
    phi, h, scale = (
        problem.phi[np.ix_(DESIGN_PLANT, DESIGN_PLANT)],
        problem.h[DESIGN_PLANT],
        problem.scale[DESIGN_PLANT],
    )
    weight = problem.q[np.ix_(DESIGN_PLANT, DESIGN_PLANT)]
    cost, closed = weight, []
    for _ in range(round((design.horizon_s or 0.0) / design.step_s)):
        k = h.T / (problem.r + h.T @ cost @ h)
        c = -k @ cost @ phi
        closed.append(phi + h @ c)
        cost = closed[-1].T @ cost @ closed[-1] + weight + c.T @ problem.r @ c
        cost = (cost + cost.T) / 2
    coupling, row = _coupling(loader, design, scale), k
    polynomial = [row @ coupling]
    for m in reversed(closed[:-1]):
        row = row @ m.T
        polynomial.append(row @ coupling)
    # Element by element, so that a setting has the same gains to the last bit in whatever company.
    (f00, f01), (f10, f11) = _core.feel_transitions(rows, np.array([design.step_s]))[:, 0].transpose(1, 2, 0)
    first, second = np.zeros((2, len(rows)))
    for (q,) in reversed(polynomial):
        first, second = q[0] + first * f00 + second * f10, q[1] + first * f01 + second * f11
    return c[0] / scale, -np.stack([first * f00 + second * f10, first * f01 + second * f11], axis=1)


def _sampled_plant(loader: Loader, design: DesignSettings) -> _SolvedPlant:
    problem = SampledProblem.of(loader, design)
    phi, h = problem.phi[np.ix_(DESIGN_PLANT, DESIGN_PLANT)], problem.h[DESIGN_PLANT]
    scale = problem.scale[DESIGN_PLANT]
    cost, _ = stationary(phi, h, problem.q[np.ix_(DESIGN_PLANT, DESIGN_PLANT)], problem.r)
    k = np.linalg.solve(h.T @ cost @ h + problem.r, h.T @ cost @ phi)
    row = h.T / (problem.r + h.T @ cost @ h)
    return _SolvedPlant(-k[0], phi - h @ k, _coupling(loader, design, scale), row[0], scale)


def _continuous_plant(loader: Loader, design: DesignSettings) -> _SolvedPlant:
    plant, scale = design_model(loader), state_scale(loader)[DESIGN_PLANT]
    a = plant.A[np.ix_(DESIGN_PLANT, DESIGN_PLANT)] * scale / scale[:, None]
    b = plant.B[DESIGN_PLANT] / scale[:, None]
    q = design.weight(loader)[np.ix_(DESIGN_PLANT, DESIGN_PLANT)] * np.outer(scale, scale)
    k = np.linalg.solve([[design.r2]], b.T @ stationary_continuous(a, b @ b.T / design.r2, q))
    return _SolvedPlant(-k[0], a - b @ k, _coupling(loader, design, scale), (b.T / design.r2)[0], scale)


def _coupling(loader: Loader, design: DesignSettings, scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weight between the scaled plant states and the feel states, which stay in SI: their matrix is per setting."""
    return np.asarray(design.weight(loader)[np.ix_(DESIGN_PLANT, DESIGN_FEEL)] * scale[:, None])
