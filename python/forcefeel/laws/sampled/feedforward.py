"""Feed-forward: where plant and command must be, so that the column moves as the feel says.

``w`` what is to be followed, ``w+ = S w`` · ``s`` plant with its held command · ``theta`` column angle

The regulator equations, one linear system for each setting: with ``s = Pi w`` and ``e = Gamma_w w`` the column is at
``theta = r w`` without end,

    Pi S = Phi Pi + Gamma Gamma_w + E,    C Pi = r

B. A. Francis, The linear multivariable regulator problem, SIAM J. Control and Optimization 15 (1977) 486-505.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.laws.sampled.observer import REMEMBERED
from forcefeel.laws.sampled.plant import SampledPlant


@dataclass(frozen=True, eq=False)
class FeedForward:
    """Plant and command as the feel, the pilot's torque and the disturbance ask for, ``w = [delta; delta'; T_p; d]``.

    Attributes:
        states: Pi, (settings, n + 1, 4), on ``[x; e_h]`` in the plant's units; delta and delta' are in SI.
        command: Gamma_w, (settings, 4).
        moves: S, (settings, 4, 4).
    """

    states: NDArray[np.float64] = field(repr=False)
    command: NDArray[np.float64] = field(repr=False)
    moves: NDArray[np.float64] = field(repr=False)


def feed_forward(plant: SampledPlant, feel: NDArray[np.float64]) -> FeedForward:
    """The feed-forward for settings I, B, G in SI units, a row each.

    Raises:
        numpy.linalg.LinAlgError: If the plant cannot follow a setting.
    """
    with_held = len(plant.transition)
    # The disturbance has nothing to do with the setting, so it is solved for once.
    moves = (feel_moves(feel, plant.period_s, plant.scale.torque_n_m), np.array([[[REMEMBERED]]]))
    enters = (np.zeros((with_held, 3)), np.append(plant.by_disturbance, 0.0)[:, None])
    enters[0][:-1, 2] = plant.by_torque
    wanted = (np.array([1.0, 0.0, 0.0]), np.zeros(1))
    of_feel, of_disturbance = (follow(plant, s, e, r) for s, e, r in zip(moves, enters, wanted, strict=True))
    states = np.zeros((len(feel), with_held, 4))
    command = np.zeros((len(feel), 4))
    whole = np.zeros((len(feel), 4, 4))
    for part, (pi, gamma), s in zip((slice(0, 3), slice(3, 4)), (of_feel, of_disturbance), moves, strict=True):
        states[..., part], command[:, part], whole[:, part, part] = pi, gamma, s
    return FeedForward(states, command, whole)


def follow(
    plant: SampledPlant, moves: NDArray[np.float64], enters: NDArray[np.float64], wanted: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """``Pi`` (settings, n + 1, k) and ``Gamma_w`` (settings, k) of the regulator equations.

    Args:
        plant: Phi and Gamma.
        moves: S, (settings, k, k).
        enters: E, (n + 1, k): how w enters the plant.
        wanted: r, (k,): what of w the column's angle is to be.

    Raises:
        numpy.linalg.LinAlgError: If a mode of S is a zero of the plant.
    """
    phi, gamma = plant.transition, plant.input
    n, k = enters.shape
    reads = np.zeros((1, n))
    reads[0, plant.places.base] = 1.0
    # [Pi; Gamma_w] row by row: Pi S is (1 x S') on it, Phi Pi is (Phi x 1).
    matrix = np.zeros((len(moves), (n + 1) * k, (n + 1) * k))
    matrix[:, : n * k, : n * k] = np.einsum("ab,mji->maibj", np.eye(n), moves).reshape(-1, n * k, n * k)
    matrix[:, : n * k, : n * k] -= np.kron(phi, np.eye(k))
    matrix[:, : n * k, n * k :] = -np.kron(gamma[:, None], np.eye(k))
    matrix[:, n * k :, : n * k] = np.kron(reads, np.eye(k))
    right = np.concatenate([enters.ravel(), wanted])
    solution = np.linalg.solve(matrix, right[:, None]).reshape(len(moves), n + 1, k)
    return solution[:, :n], solution[:, n]


def against_torque(plant: SampledPlant, gains: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the command is of a torque on the column under which it is to stand still, (settings,), for gains K (settings, n + 1).

    Raises:
        numpy.linalg.LinAlgError: If it cannot.
    """
    enters = np.append(plant.by_torque, 0.0)[:, None]
    states, command = follow(plant, np.ones((1, 1, 1)), enters, np.zeros(1))
    return np.asarray(command[0, 0] + gains @ states[0, :, 0])


def feel_moves(feel: NDArray[np.float64], period_s: float, torque_n_m: float) -> NDArray[np.float64]:
    """S of ``[delta; delta'; T_p]``, (settings, 3, 3): eq. (11) under a torque that stays, in units of ``torque_n_m``."""
    moves = np.zeros((len(feel), 3, 3))
    moves[:, :2] = _core.feel_steps(feel, period_s) * (1.0, 1.0, torque_n_m)
    moves[:, 2, 2] = 1.0
    return moves
