"""The load cell's loop for a motor: its position follows the feel, and the load cell drives the feel.

``F`` force of the load cell · ``x = [x_m; F; i; x_b; x_b']`` the plant's states, ``e_h`` the command under way · ``r``, ``K_t``
travel and torque constant of the motor

A motor's command is a force, so that feedback alone would leave an error wherever a force is to be held. The load cell tells that
force: it is fed to the motor, and what is left is a rotor that nothing pulls at and that stays where it is,

    e = r F / K_t + u,    u = -K [x; e_h; delta; delta'] - K_p T_p
    sum of  (delta - theta)^2 + w_u^2 u^2                                                                eqs. (20)-(22)

over the exact sampled plant with its delay, with the load cell's loop of ``load_cell_loop`` closed in it: the regulator knows that
the feel answers the force that its own motion makes. ``T_p`` is the pilot's torque, a constant to the regulator, without which it
would take a feel that a hand holds for one on its way back:

    K_p = (w_u^2 + b' P b)^-1 b' (P d + q),    q = (1 - A_c')^-1 A_c' P d,    A_c = A - b K

with P of eqs. (22) and ``d`` how the torque enters. It is what the column's motion leaves unexplained, ``T_p = w (J theta' - p)``,
``p' = alpha R_b F + T_p``. Otherwise there is no observer: the force stands for the motor's velocity, the column's is the last
period's difference, and the current is that of the commands given.

Position by current with the load cell's force fed to the feel is how electric loaders are usually built (Frasca International,
support pages: closed position loop with a force sensor).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.laws.sampled.feedforward import feel_moves
from forcefeel.laws.sampled.load_cell_loop import heard_torque
from forcefeel.laws.sampled.neutral import trimmed
from forcefeel.laws.sampled.observer_law import feel_rows
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.linear.riccati import stationary
from forcefeel.loader.loader import Loader, check_electric

LAG = 0.5
"""Phase in rad that the whole lag takes at the frequency of the position loop."""


def design(loader: Loader, feel: ArrayLike) -> SampledLaw:
    """The laws for many settings of one loader.

    Args:
        loader: The loader, with a motor and ``controller.period``; its own feel is not used.
        feel: I, B, G in SI units, a row per setting.

    Raises:
        InputError: If the loader has a valve or no period, a row is bad, or a programmed inertia is the column's own.
    """
    check_electric(loader, "the load cell's loop of a motor", "take load-cell, which knows both drives")
    rows, plant = feel_rows(feel), SampledPlant.of(loader)
    torque = heard_torque(loader, rows)
    places, size = plant.places, plant.places.count + 3
    cancel = np.zeros(size)  # in units of the command per unit of force
    cancel[places.effort] = loader["transmission.travel"] / loader["motor.torque_constant"]
    cancel *= plant.scale.sampled[0] / plant.scale.command_v
    by_command = np.append(plant.input, [0.0, 0.0])
    moves = feel_moves(rows, plant.period_s, 1.0)
    whole = np.zeros((len(rows), size, size))
    whole[:, :-2, :-2] = plant.transition
    whole[:, -2:, -2:] = moves[:, :2, :2] + moves[:, :2, 2:] * torque[:, None, 1:]
    whole[:, -2:, places.effort] = moves[:, :2, 2] * torque[:, :1] * plant.scale.sampled[0]
    whole += by_command[:, None] * cancel
    by_torque = np.append(plant.by_torque, np.zeros(3))
    error = np.zeros(size)
    error[places.base], error[-2] = 1.0, -1.0
    try:
        weight = command_weight(loader, plant)
        gains = np.array([_gains(a, by_command, np.outer(error, error), weight, by_torque) for a in whole])
    except np.linalg.LinAlgError as problem:
        raise InputError(f"feel: a setting has no law in double precision ({problem})") from problem
    return trimmed(_law(loader, plant, cancel, gains, torque), loader)


def command_weight(loader: Loader, plant: SampledPlant) -> float:
    """``w_u^2`` over the weight of the squared error in rad², of the largest current squared.

    Rotor and column as one inertia J under the largest torque T_s have the regulator's poles at ``w^4 = (T_s / J)^2 / w_u^2``; w is
    ``LAG`` over the time from a motion to the current that answers it.
    """
    arm, travel = loader["linkage.ratio"] * loader["column.base_arm"], loader["transmission.travel"]
    moved = loader["column.inertia"] + loader["motor.inertia"] * (arm / travel) ** 2
    return float((plant.scale.torque_n_m / moved / _frequency(loader, plant) ** 2) ** 2)


def _frequency(loader: Loader, plant: SampledPlant) -> float:
    """W in rad/s."""
    return LAG / float(plant.delay_s + plant.period_s + 1 / loader["current_loop.bandwidth"])


def _gains(
    a: NDArray[np.float64], b: NDArray[np.float64], q: NDArray[np.float64], weight: float, d: NDArray[np.float64]
) -> NDArray[np.float64]:
    """K and, last, K_p."""
    cost, _ = stationary(a, b[:, None], q, np.array([[weight]]))
    of_command = weight + b @ cost @ b
    gains = (b @ cost @ a) / of_command
    closed = a - np.outer(b, gains)
    ahead = np.linalg.solve(np.eye(len(a)) - closed.T, closed.T @ cost @ d)
    return np.append(gains, b @ (cost @ d + ahead) / of_command)


def _law(
    loader: Loader,
    plant: SampledPlant,
    cancel: NDArray[np.float64],
    gains: NDArray[np.float64],
    torque: NDArray[np.float64],
) -> SampledLaw:
    """The law as data.

    Its states are the angle of the sample before, the current, the command under way, and p.
    """
    n, effort, current = plant.places.count, plant.places.effort, plant.places.drive
    scale, period, settings = plant.scale, plant.period_s, len(gains)
    angle_before, flowing, under_way, explained, force, position, angle, delta, rate = np.eye(9)
    arm, velocity = loader["column.base_arm"], (angle - angle_before) / period
    motion = np.array([position, force, flowing, arm * angle, arm * velocity])
    pilot = _frequency(loader, plant) * (loader["column.inertia"] * velocity - explained)
    of_motion = gains[:, :n] / scale.states
    fed = cancel[effort] / scale.sampled[0] * force
    command = fed - of_motion @ motion - gains[:, [n]] / scale.command_v * under_way
    command -= gains[:, [n + 1]] * delta + gains[:, [n + 2]] * rate + gains[:, [n + 3]] / scale.torque_n_m * pilot
    feel_torque = torque[:, [0]] * force + torque[:, [1]] * delta + torque[:, [2]] * rate
    after = np.zeros((4, 8))  # the states; F_c, x, theta; and the command
    after[0, 6] = after[2, 7] = 1.0
    after[1, [1, 2, 7]] = plant.phi[current, current], plant.by_held[current], plant.by_command[current]
    after[3, :7] = (explained + period * (loader["linkage.ratio"] * arm * force + pilot))[:7]
    return SampledLaw(
        period_s=period,
        delay_s=plant.delay_s,
        transition=np.tile(after[:, :4], (settings, 1, 1)),
        input=np.tile(after[:, 4:], (settings, 1, 1)),
        command=scale.command_v * command,
        torque=feel_torque,
    )
