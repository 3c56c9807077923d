"""The observer: a stationary Kalman filter that estimates plant, pilot's torque and disturbance from what is sampled.

``xi = [x; T_p; d; e_h]`` its state before the sample · ``y`` what is sampled · ``xi^`` its estimate with the sample

    xi^  = xi + L (y - C xi)
    xi+  = Phi_o xi^ + Gamma_o e
    T_p+ = T_p + noise,   d+ = REMEMBERED d + noise

The command is known, so e_h is no estimate and its row of L is zero. Noise at the plant's input makes the loop recover the
regulator's margins: J. C. Doyle, G. Stein, Robustness with Observers, IEEE Trans. Automatic Control 24 (1979) 607-611.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.tuning import Tuning
from forcefeel.linear.riccati import stationary

REMEMBERED = 1 - 1e-9
"""Share of the disturbance that a period leaves. A law that forgot nothing would have no rest of its own, as any disturbance goes
with the same samples; one that forgets so little takes six days at 2 kHz."""


@dataclass(frozen=True, eq=False)
class Observer:
    """The filter, in the units of the plant, and how well it is proved.

    Attributes:
        transition: Phi_o, (m, m), m the plant's states and three.
        input: Gamma_o, (m,).
        reads: C, (3, m): F_c, x_p, theta.
        gains: L, (m, 3); the column of what is not trusted is zero.
        covariance: Of the error of x, T_p, d before the sample, (m - 1, m - 1).
        riccati_residual: Residual of the Riccati equation, as a share of the covariance.
    """

    transition: NDArray[np.float64] = field(repr=False)
    input: NDArray[np.float64] = field(repr=False)
    reads: NDArray[np.float64] = field(repr=False)
    gains: NDArray[np.float64] = field(repr=False)
    covariance: NDArray[np.float64] = field(repr=False)
    riccati_residual: float


def observe(plant: SampledPlant, tuning: Tuning, inertia_ratio: float) -> Observer:
    """The observer for a programmed inertia of so many of the column's.

    Raises:
        numpy.linalg.LinAlgError: If it has no solution in double precision.
    """
    transition, reads, estimated = observed(plant), readings(plant), plant.places.estimated
    noise, trusted = sensor_noise(plant, tuning, inertia_ratio)
    a, c = transition[estimated, estimated], reads[trusted][:, estimated]
    w, r = process_noise(plant, tuning, inertia_ratio), np.diag(noise**2)
    covariance, left = stationary(a.T, c.T, w, r)
    gains = np.zeros((plant.places.observed, len(reads)))
    gains[estimated, trusted] = np.linalg.solve(r + c @ covariance @ c.T, c @ covariance).T
    return Observer(
        transition=transition,
        input=observed_input(plant),
        reads=reads,
        gains=gains,
        covariance=covariance,
        riccati_residual=left,
    )


def observed(plant: SampledPlant) -> NDArray[np.float64]:
    """Phi_o of ``[x; T_p; d; e_h]``, (m, m)."""
    n, places = len(plant.phi), plant.places
    matrix = np.zeros((places.observed, places.observed))
    matrix[:n, :n] = plant.phi
    enters = (plant.by_torque, plant.by_disturbance, plant.by_held)
    matrix[:n, [places.torque, places.disturbance, places.held]] = np.column_stack(enters)
    matrix[places.torque, places.torque], matrix[places.disturbance, places.disturbance] = 1.0, REMEMBERED
    return matrix


def observed_input(plant: SampledPlant) -> NDArray[np.float64]:
    """Gamma_o, (m,): the command moves the plant and is held."""
    return np.concatenate([plant.by_command, [0.0, 0.0, 1.0]])


def readings(plant: SampledPlant) -> NDArray[np.float64]:
    """C, (3, m): load cell force, the drive's displacement and the column's angle, each one state in its unit."""
    matrix = np.zeros((3, plant.places.observed))
    matrix[[0, 1, 2], plant.places.sampled] = 1.0
    return matrix


def process_noise(plant: SampledPlant, tuning: Tuning, inertia_ratio: float) -> NDArray[np.float64]:
    """Covariance of what a period adds to x, T_p, d."""
    h, places, arm = plant.periods_per_time, plant.places, plant.arm_gain(inertia_ratio)
    covariance = np.zeros((places.held, places.held))
    n = len(plant.phi)
    # White noise of density s^2, held over the period, has the variance s^2 / h.
    covariance[:n, :n] = (
        np.outer(plant.by_disturbance, plant.by_disturbance)
        * tuning.input_noise.at(inertia_ratio, arm_gain=arm) ** 2
        / h
    )
    walks = {
        places.torque: tuning.torque_walk,
        places.disturbance: tuning.disturbance_walk,
        places.drive: tuning.flow_walk,
    }
    for place, walk in walks.items():
        covariance[place, place] += walk.at(inertia_ratio, arm_gain=arm) ** 2 * h
    return covariance


def sensor_noise(plant: SampledPlant, tuning: Tuning, inertia_ratio: float) -> tuple[NDArray[np.float64], list[int]]:
    """Noise of a sample of each trusted sensor, and which those are among F_c, x_p, theta."""
    given = (tuning.pressure_noise, tuning.piston_noise, tuning.angle_noise)
    trusted = [k for k, noise in enumerate(given) if noise is not None]
    arm = plant.arm_gain(inertia_ratio)
    noises = [noise.at(inertia_ratio, arm_gain=arm) for noise in given if noise is not None]
    return np.array(noises) / np.sqrt(plant.periods_per_time), trusted
