"""State feedback with the load cell's loop in the plant, and the column's inertia taken off the feel's.

Eq. (19) leaves out that the load cell drives the feel computer, and the column's own inertia adds to the programmed one. Here the
computer runs what is left to it,

    (I - J) delta'' + B delta' + G delta = -alpha R_b F_c

so that the column, whose own ``J theta''`` the load cell does not feel, moves as ``I``; and the regulator knows the loop:

    x = [x_p; p; x_b; x_b'; e_h; delta; delta'],    sum of  w (delta - theta)^2 + R_2 e^2,    e = -K x        eqs. (20)-(22)

over the sampled plant with its delay. As in eq. (19) the valve's own motion is neglected. There is no observer: the base's velocity
is the last period's difference. Its state is the last angle and the command under way.

Of a valve: its command moves the piston, so that an error of the angle dies away by itself. For a motor see ``load_cell_motor``.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.laws.sampled.feedforward import feel_moves
from forcefeel.laws.sampled.neutral import trimmed
from forcefeel.laws.sampled.observer_law import feel_rows
from forcefeel.laws.sampled.plant import Scale, period_and_delay
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.linear.models import DESIGN_PLANT, design_model
from forcefeel.linear.riccati import stationary
from forcefeel.linear.sampled_feel import delayed
from forcefeel.loader.loader import Loader, check_hydraulic

LOAD_CELL = "load-cell"
"""The name of the method."""

_OF_DESIGN = [0, 1, 4, 5]
"""Places of the design plant's states among ``PLANT_STATES``, in its order."""

_PRESSURE, _BASE, _HELD, _FEEL = 1, 2, 4, [5, 6]  # among x

_LEAST_LEFT = 1e-6
"""Of the column's inertia: a programmed one that is nearer to it leaves the computer nothing to run."""

_COMMAND_WEIGHT = 0.1 / 100.0
"""R_2 over the weight of ``(delta - theta)^2`` in rad²/V², the report's numbers (appendix, below eq. (21))."""


def design(loader: Loader, feel: ArrayLike) -> SampledLaw:
    """The laws for many settings of one loader, with the report's weights.

    Args:
        loader: The loader, with ``controller.period``; its own feel is not used.
        feel: I, B, G in SI units, a row per setting.

    Raises:
        InputError: If the loader has a motor or no period, a row is bad, or a programmed inertia is the column's own.
    """
    check_hydraulic(loader, LOAD_CELL, "take another method, such as robust")
    rows = feel_rows(feel)
    loop = _Loop(loader, rows)
    scale, (period, delay) = loop.scale, loop.timing
    q = np.zeros((7, 7))
    q[np.ix_([_BASE, _FEEL[0]], [_BASE, _FEEL[0]])] = [[1.0, -1.0], [-1.0, 1.0]]
    r = np.array([[_COMMAND_WEIGHT * scale.command_v**2]])
    try:
        gains = np.array([_gains(a, loop.input, q, r) for a in loop.transition])
    except np.linalg.LinAlgError as error:
        raise InputError(f"feel: a setting has no law in double precision ({error})") from error
    return trimmed(_law(loop, gains, period, delay), loader)


def heard_torque(loader: Loader, feel: NDArray[np.float64]) -> NDArray[np.float64]:
    """Torque input of the feel computer from F_c, delta, delta', (settings, 3), where the column's inertia is taken off the feel's.

    Raises:
        InputError: If a programmed inertia is the column's own.
    """
    inertia, damping, stiffness = feel.T
    left = inertia - loader["column.inertia"]
    if (close := np.abs(left) < _LEAST_LEFT * loader["column.inertia"]).any():
        raise InputError(
            f"feel: row {int(np.argmax(close))} programs the column's own inertia, which leaves the computer nothing to run; "
            "change it by a little"
        )
    share = inertia / left
    arm = loader["linkage.ratio"] * loader["column.base_arm"]
    # I delta'' + B delta' + G delta = T is then (I - J) delta'' + ... = -alpha R_b F_c.
    return np.column_stack([-arm * share, (1 - share) * stiffness, (1 - share) * damping])


class _Loop:
    """The sampled plant with the load cell's loop closed, in units of ``scale``; a transition matrix for each setting."""

    def __init__(self, loader: Loader, feel: NDArray[np.float64]) -> None:
        self.torque = heard_torque(loader, feel)
        self.scale, self.timing = Scale.of(loader), period_and_delay(loader)
        self.column_arm = loader["column.base_arm"]
        plant = design_model(loader)
        unit = self.scale.states[_OF_DESIGN]
        a = np.asarray(plant.A)[np.ix_(DESIGN_PLANT, DESIGN_PLANT)] * unit / unit[:, None]
        b = np.asarray(plant.B)[DESIGN_PLANT] / unit[:, None] * self.scale.command_v
        phi, by_held, by_command = delayed(a, b, *self.timing)
        self.input = np.concatenate([by_command[:, 0], [1.0, 0.0, 0.0]])
        moves = feel_moves(feel, self.timing[0], 1.0)
        self.transition = np.zeros((len(feel), 7, 7))
        self.transition[:, :4, :4], self.transition[:, :4, _HELD] = phi, by_held[:, 0]
        self.transition[:, 5:, 5:] = moves[:, :2, :2] + moves[:, :2, 2:] * self.torque[:, None, 1:]
        self.transition[:, 5:, _PRESSURE] = moves[:, :2, 2] * self.torque[:, :1] * self.scale.sampled[0]


def _gains(
    a: NDArray[np.float64], b: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]
) -> NDArray[np.float64]:
    cost, _ = stationary(a, b[:, None], q, r)
    row: NDArray[np.float64] = (b @ cost @ a) / (r[0, 0] + b @ cost @ b)
    return row


def _law(loop: _Loop, gains: NDArray[np.float64], period: float, delay: float) -> SampledLaw:
    """The law as data, its state the angle of the sample before and the command under way."""
    settings, volt = len(gains), loop.scale.command_v
    of_plant = -gains[:, :4] / loop.scale.states[_OF_DESIGN] * volt
    rate = of_plant[:, 3] * loop.column_arm / period
    command = np.zeros((settings, 7))
    # [theta of the sample before, e_h; F_c, x_p, theta; delta, delta']
    command[:, 0], command[:, 1] = -rate, -gains[:, _HELD]
    command[:, 2] = of_plant[:, 1] * loop.scale.states[1] / loop.scale.sampled[0]
    command[:, 3], command[:, 4] = of_plant[:, 0], of_plant[:, 2] * loop.column_arm + rate
    command[:, 5:] = -gains[:, _FEEL] * volt
    torque = np.zeros((settings, 7))
    torque[:, [2, 5, 6]] = loop.torque
    remembers = np.zeros((settings, 2, 4))
    remembers[:, 0, 2] = remembers[:, 1, 3] = 1.0
    return SampledLaw(period, delay, np.zeros((settings, 2, 2)), remembers, command, torque)
